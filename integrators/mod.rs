//! Integrators that come with pt, one file each. They use public names of `pt` only.
//!
//! A new integrator is a file in this folder and a row in [`ALL`], from which the command line, its help, comparisons and the tests
//! take it.

pub mod ao;
pub mod card;
pub mod light;
pub mod nee;
pub mod normals;
pub mod path;
pub mod whitted;

use pt::effects::Effects;
use pt::integrator::Entry;

/// Table of the integrators.
pub const ALL: &[Entry] = &[
    Entry::of::<path::Path>(
        "path",
        "path tracing that finds light by chance: slow, simple, the reference for the others",
        Effects::ALL.without(Effects::POINT_LIGHT),
    ),
    Entry::of::<nee::Nee>("nee", "path tracing with next-event estimation and multiple importance sampling", Effects::ALL),
    Entry::of::<light::LightTracer>(
        "light",
        "light tracing: paths from the lights, each point of them connected to the camera; finds caustics",
        Effects::ALL.without(light::NOT_SIMULATED),
    )
    .when_missing(&[
        (
            Effects::SPECULAR_REFLECTION.union(Effects::REFRACTION),
            "mirrors and glass are black, and the light that they cast elsewhere is there",
        ),
        (Effects::REALISTIC_LENS, "only lamps and the background are seen, because paths from lights do not find the way through the lens"),
    ]),
    Entry::of::<whitted::Whitted>(
        "whitted",
        "Whitted's ray tracing: direct light, and branches at mirrors and glass",
        Effects::ALL.without(Effects::SCATTERED.union(Effects::UNSAMPLED_EMITTER).union(Effects::MEDIA)),
    ),
    Entry::of::<card::Card>(
        "card",
        "path tracing as short programs have it: fixed steps off surfaces, a sun behind windows; else the same as path",
        Effects::ALL.without(Effects::POINT_LIGHT.union(Effects::MEDIA)),
    ),
    Entry::of::<normals::Normals>("normals", "the shading normal of what the camera sees, as a colour", Effects::NONE),
    Entry::of::<ao::AmbientOcclusion>("ao", "ambient occlusion: the share of sampled directions in which nothing is hit", Effects::NONE),
];
