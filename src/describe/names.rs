//! Names of shapes, materials and lights, by their numbers in the built scene.

use std::collections::HashMap;

use super::{Light, MaterialRef, Scene, Shape};
use crate::film::LightNames;
use crate::light;
use crate::light::Lights;
use crate::reader::escaped;
use crate::world::World;

/// The names of a scene's parts. A part without a name has its JSON pointer instead.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    /// The name of each shape, numbered as [`crate::primitive::Hit::shape`] is.
    pub shapes: Vec<String>,
    /// The name of each shape's material, where the shape has a single named one, and no instance may replace it.
    pub materials: Vec<Option<String>>,
    /// The names of the media, numbered as [`MediumId`](crate::medium::MediumId) is.
    pub media: Vec<String>,
    /// The names of the lights without a surface, numbered as in [`Lights`], then of the background and of the sun in its sky.
    lights: Vec<String>,
}

impl Names {
    /// Collects the names of a scene's parts.
    ///
    /// - `world`: the scene as it was built; it has copies of shapes
    /// - `media`: the names of the media, in the order in which they were built
    pub fn of(scene: &Scene, world: &World, media: Vec<String>) -> Names {
        let mut described = Described::default();
        described.add("/shapes", &scene.shapes);
        let own = described.shapes.len();
        for name in scene.shown_groups() {
            described.add(&format!("/groups{}", escaped(name)), &scene.groups[name]);
        }
        if scene.groups.values().chain([&scene.shapes]).any(|shapes| replace_materials(shapes)) {
            described.materials[own..].fill(None);
        }
        let of_world = || (0..world.shapes().len() as u32).map(|shape| world.described_shape(shape) as usize);
        let shapes = of_world().map(|shape| described.shapes[shape].clone()).collect();
        let materials = of_world().map(|shape| described.materials[shape].clone()).collect();
        let named = |(i, light): (usize, &Light)| light.name().map_or_else(|| format!("/lights/{i}"), str::to_owned);
        let lights = scene.lights.iter().enumerate().map(named).chain(["background", "sun"].map(str::to_owned)).collect();
        Names { shapes, materials, media, lights }
    }
}

/// The names of shapes and of their materials, in the order in which they are described.
#[derive(Default)]
struct Described {
    shapes: Vec<String>,
    materials: Vec<Option<String>>,
}

impl Described {
    /// Adds shapes in the order in which they are built. Each member of a group counts as a shape; the group itself and instances do not.
    fn add(&mut self, pointer: &str, shapes: &[Shape]) {
        for (i, shape) in shapes.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            match shape {
                Shape::Group(group) => {
                    self.add(&format!("{pointer}/shapes"), &group.shapes);
                    continue;
                }
                Shape::Instances(_) => continue,
                _ => {}
            }
            let material = shape.material().and_then(|material| match material {
                MaterialRef::Named(name) => Some(name.clone()),
                MaterialRef::Inline(_) => None,
            });
            // A shape whose parts have their own materials has no single name.
            let parted = match shape {
                Shape::Mesh(mesh) => !mesh.materials.is_empty(),
                Shape::Sdf(sdf) => sdf.parts.is_some(),
                _ => false,
            };
            self.shapes.push(shape.name().map_or(pointer, str::to_owned));
            self.materials.push(material.filter(|_| !parted));
        }
    }
}

impl Names {
    /// The name of the light with this number. The name of an area light is that of its shape.
    pub fn light(&self, lights: &Lights, index: u32) -> &str {
        let name = match lights.iter().nth(index as usize) {
            Some(light::Light::Area(area)) => self.shapes.get(area.shape as usize),
            _ => self.lights.get(index as usize),
        };
        name.map_or("?", String::as_str)
    }

    /// The distinct names of the lights, and the number of each light's name.
    ///
    /// - `media_emit`: whether media emit light, which counts as one more light
    pub fn lights(&self, lights: &Lights, media_emit: bool) -> LightNames {
        let (mut known, mut names) = (HashMap::new(), vec![]);
        let mut group = |index: usize| {
            let name = self.light(lights, index as u32);
            *known.entry(name).or_insert_with(|| {
                names.push(name.to_owned());
                names.len() as u32 - 1
            })
        };
        let mut of: Vec<u32> = (0..lights.len()).map(&mut group).collect();
        if media_emit {
            of.push(names.len() as u32);
            names.push("media".to_owned());
        }
        LightNames { names, of: of.into() }
    }
}

/// Whether some instances have other materials than their shapes.
fn replace_materials(shapes: &[Shape]) -> bool {
    shapes.iter().any(|shape| match shape {
        Shape::Group(group) => replace_materials(&group.shapes),
        Shape::Instances(instances) => instances.material.is_some() || instances.materials().next().is_some(),
        _ => false,
    })
}
