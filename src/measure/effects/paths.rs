//! What a path meets on its way, for the question which effects its light contains.

use glam::Vec3;

use crate::bsdf::Lobe;
use crate::effects::Effects;
use crate::light::Light;
use crate::math::{Density, Spectrum};
use crate::recorder::{Contribution, Event, PathRecorder, Scattering, Technique};
use crate::scene::Scene as _;
use crate::shape::Shape;
use crate::world::World;

/// What the path of one contribution met between light and camera.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathFacts {
    /// Number of scattering events.
    pub depth: u32,
    /// Effect of the light at its end: the kind of lamp.
    pub light: Effects,
    /// Effects that scattered it, and those of the surfaces on which that happened.
    pub scattered: Effects,
    /// Number of times that a matte surface scattered it.
    pub matte: u32,
    /// Whether mirrors, glass or glossy surfaces sent light from the lamp to a matte surface that the path meets nearer to the camera.
    pub is_caustic: bool,
}

/// Effects of surfaces that count for a path if one of them scatters it.
const OF_SURFACES: Effects = Effects::SHADING_NORMALS
    .union(Effects::TEXTURES)
    .union(Effects::CUT_OUTS)
    .union(Effects::SMOOTH_SHADOWS)
    .union(Effects::DISPERSION)
    .union(Effects::THIN_FILM)
    .union(Effects::CURVES);

impl PathFacts {
    /// The path with one more scattering event, farther from the camera.
    ///
    /// - `by`: what scatters it; a surface that is matte and glossy at once counts as both
    fn scattered(self, by: Effects) -> PathFacts {
        let is_matte = by.contains(Effects::INTERREFLECTION);
        let focuses = !is_matte && !by.contains(Effects::MEDIA);
        PathFacts {
            depth: self.depth + 1,
            scattered: self.scattered | by,
            matte: self.matte + u32::from(is_matte),
            is_caustic: focuses && self.matte > 0,
            ..self
        }
    }
}

/// Point at which a path is, before it is scattered there.
#[derive(Clone, Copy)]
enum Place {
    Surface { effects: Effects, ng: Vec3, wo: Vec3 },
    Medium,
}

impl Place {
    /// The effects that scatter a path here into a direction.
    fn scatters(&self, lobe: Lobe, is_delta: bool) -> Effects {
        let Place::Surface { effects, .. } = *self else { return Effects::MEDIA };
        let is_through = lobe == Lobe::Transmission;
        let kinds = match (is_delta, is_through) {
            (true, false) => Effects::SPECULAR_REFLECTION,
            (true, true) => Effects::REFRACTION,
            (false, false) => part(effects, Effects::INTERREFLECTION | Effects::GLOSSY_REFLECTION),
            (false, true) => part(effects, Effects::INTERREFLECTION | Effects::ROUGH_REFRACTION),
        };
        // What is neither matte nor glossy by name scatters into all directions.
        let kinds = if kinds.is_empty() { Effects::INTERREFLECTION } else { kinds };
        kinds | part(effects, OF_SURFACES)
    }
}

fn part(effects: Effects, of: Effects) -> Effects {
    effects - (effects - of)
}

/// Recorder of one camera sample that gives each contribution to `add`, with the facts of its path.
///
/// It follows a single path: integrators that branch need another one.
pub struct PathSorter<'a, F> {
    world: &'a World,
    shapes: &'a [Box<dyn Shape>],
    /// The path up to the last scattering event.
    path: PathFacts,
    /// The point after it, once the path has arrived there.
    at: Option<Place>,
    add: F,
}

impl<'a, F: FnMut(Spectrum, &PathFacts)> PathSorter<'a, F> {
    /// The recorder of the next camera sample.
    ///
    /// - `shapes`: those of the world
    pub fn new(world: &'a World, shapes: &'a [Box<dyn Shape>], add: F) -> PathSorter<'a, F> {
        PathSorter { world, shapes, path: PathFacts::default(), at: None, add }
    }

    /// Where the path is. Between two surfaces light is found only at points of a medium.
    fn place(&self) -> Place {
        self.at.unwrap_or(Place::Medium)
    }

    /// The effect that a light calls for.
    fn kind_of_light(&self, light: u32) -> Effects {
        match self.world.lights().iter().nth(light as usize) {
            Some(Light::Area(area)) if !self.shapes[area.shape as usize].is_sampled() => Effects::UNSAMPLED_EMITTER,
            Some(light) => light.effects(),
            None => Effects::NONE,
        }
    }

    fn light(&mut self, light: &Contribution) {
        let path = match light.origin.technique {
            Technique::Emission => self.path,
            Technique::Light { wi, .. } => {
                let place = self.place();
                let lobe = match place {
                    Place::Surface { ng, wo, .. } if ng.dot(wo) * ng.dot(wi) < 0.0 => Lobe::Transmission,
                    _ => Lobe::Reflection,
                };
                self.path.scattered(place.scatters(lobe, false))
            }
        };
        // What media emit has no light.
        let kind = light.origin.light.map_or(Effects::UNSAMPLED_EMITTER, |light| self.kind_of_light(light));
        (self.add)(light.value, &PathFacts { light: kind, ..path });
    }
}

impl<F: FnMut(Spectrum, &PathFacts)> PathRecorder for PathSorter<'_, F> {
    fn record(&mut self, event: Event) {
        match event {
            Event::Vertex(vertex) => {
                let shape = &self.shapes[vertex.hit.shape as usize];
                let normals = if shape.has_shading_normals() { Effects::SHADING_NORMALS } else { Effects::NONE };
                let curves = if shape.is_of_curves() { Effects::CURVES } else { Effects::NONE };
                let effects = self.world.material(&vertex.hit).effects() | normals | curves;
                self.at = Some(Place::Surface { effects, ng: vertex.ng, wo: vertex.wo });
            }
            Event::Medium(_) => self.at = Some(Place::Medium),
            Event::Light(light) => self.light(&light),
            Event::Scattering(Scattering { lobe, density, .. }) => {
                self.path = self.path.scattered(self.place().scatters(lobe, density == Density::Delta));
                self.at = None;
            }
            Event::Wavelength { .. } | Event::Emission(_) | Event::Splat(_) | Event::End { .. } => {}
        }
    }
}
