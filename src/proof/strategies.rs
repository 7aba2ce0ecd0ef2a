//! Generators of models and of their inputs for property tests; counter-examples shrink to simple ones.
//!
//! They need the feature `proptest`. To add a model: a line in [`any_bsdf`].

use std::f64::consts::TAU;

use glam::Vec2;
use proptest::prelude::*;

use super::at;
use crate::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, DiffuseTransmission, LommelSeeliger, MatteCone, Mirror, OrenNayar, Plastic, Reflectance,
    ThinDielectric, TransportMode,
};
use crate::math::float::{ONE_MINUS_EPSILON, ROUNDING, unit_f32};
use crate::math::{Local, Spectrum};

/// Any of pt's plain models without tables, with parameters at, near, and between their limits.
pub fn any_bsdf() -> impl Strategy<Value = Bsdf<'static>> {
    prop_oneof![
        5 => simple_bsdf(),
        1 => (color(), fraction()).prop_map(|(albedo, roughness)| Bsdf::OrenNayar(OrenNayar { albedo, roughness })),
        1 => color().prop_map(|albedo| Bsdf::LommelSeeliger(LommelSeeliger { albedo })),
        1 => (color(), 1f32..4.0).prop_map(|(albedo, eta)| Bsdf::Plastic(Plastic { albedo, eta, internal: Plastic::internal(eta) })),
        1 => (color(), eta()).prop_map(|(color, eta)| Bsdf::ThinDielectric(ThinDielectric { eta, color })),
        1 => (color(), fraction()).prop_map(|(color, share)| {
            Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: color * (1.0 - share), transmittance: color * share })
        }),
    ]
}

/// Models that sample from one lobe, with weights that never exceed their colour.
pub fn simple_bsdf() -> impl Strategy<Value = Bsdf<'static>> {
    let metal = ([0.05f32..5.0, 0.05f32..5.0, 0.05f32..5.0], [0f32..9.0, 0f32..9.0, 0f32..9.0]);
    prop_oneof![
        color().prop_map(|albedo| Bsdf::Diffuse(Diffuse { albedo })),
        color().prop_map(|color| Bsdf::Mirror(Mirror { color })),
        metal.prop_map(|([a, b, c], [d, e, f])| {
            let reflectance = Reflectance::Index { eta: Spectrum::rgb(a, b, c), k: Spectrum::rgb(d, e, f) };
            Bsdf::Conductor(Conductor { reflectance })
        }),
        (eta(), color()).prop_map(|(eta, color)| Bsdf::Dielectric(Dielectric { eta, color })),
        (color(), fraction()).prop_map(|(color, mattness)| Bsdf::MatteCone(MatteCone { color, mattness })),
    ]
}

/// A reflectance: each coefficient in [0, 1], often exactly white.
pub fn color() -> impl Strategy<Value = Spectrum> {
    prop_oneof![4 => [0f32..=1.0, 0f32..=1.0, 0f32..=1.0].prop_map(|[r, g, b]| Spectrum::rgb(r, g, b)), 1 => Just(Spectrum::ONE)]
}

/// A parameter in [0, 1], such as a roughness: its ends, tiny values, and evenly distributed ones.
pub fn fraction() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), Just(1.0), Just(1e-8), (-6f32..0.0).prop_map(|e| 10f32.powf(e)), 0f32..=1.0]
}

/// An index of refraction, inside over outside: glass in both directions, 1, nearly 1, and from 0.3 to 3.
pub fn eta() -> impl Strategy<Value = f32> {
    prop_oneof![Just(1.0f32), Just(1.5), Just(1.0 / 1.5), Just(1.000001), (-0.5f32..0.5).prop_map(|e| 10f32.powf(e))]
}

/// A direction above the surface: evenly distributed in the cosine, with steep and grazing ones (down to 10⁻⁷) added.
pub fn hemisphere() -> impl Strategy<Value = Local> {
    let cosine = prop_oneof![4 => 1e-3f32..=1.0, 1 => Just(1.0f32), 1 => Just(1e-7), 1 => (-7f32..0.0).prop_map(|e| 10f32.powf(e))];
    (cosine, 0f64..TAU).prop_map(|(cosine, phi)| at(f64::from(cosine), phi))
}

/// A direction on either side of the surface, distributed as [`hemisphere`].
pub fn sphere() -> impl Strategy<Value = Local> {
    (hemisphere(), any::<bool>()).prop_map(|(Local(w), below)| Local(if below { w.with_z(-w.z) } else { w }))
}

/// A number in [0, 1) as samplers make them, often at the ends.
pub fn uniform() -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0.0f32), 1 => Just(ONE_MINUS_EPSILON), 1 => Just(ROUNDING), 8 => any::<u32>().prop_map(unit_f32)]
}

/// A point of [0, 1)².
pub fn square() -> impl Strategy<Value = Vec2> {
    (uniform(), uniform()).prop_map(|(x, y)| Vec2::new(x, y))
}

/// Either mode of transport.
pub fn mode() -> impl Strategy<Value = TransportMode> {
    prop_oneof![Just(TransportMode::Radiance), Just(TransportMode::Importance)]
}
