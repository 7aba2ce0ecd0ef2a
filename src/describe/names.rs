//! What the parts of a scene are called, by the numbers that the built scene knows them by.

use std::collections::HashMap;

use super::{Light, MaterialRef, Scene, Shape};
use crate::film::LightNames;
use crate::light;
use crate::light::Lights;

/// Names, or else JSON pointers.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    /// As [`crate::primitive::Hit::shape`] counts.
    pub shapes: Vec<String>,
    /// Of each shape: the name of its material, where it has one.
    pub materials: Vec<Option<String>>,
    /// Those without a surface, as [`Lights`] counts, then the background.
    lights: Vec<String>,
}

impl Names {
    pub fn of(scene: &Scene) -> Names {
        let mut names = Names { shapes: vec![], materials: vec![], lights: vec![] };
        names.add("/shapes", &scene.shapes);
        let named = |(i, light): (usize, &Light)| {
            let name = match light {
                Light::Point(l) => &l.name,
                Light::Directional(l) => &l.name,
                Light::Spot(l) => &l.name,
            };
            name.clone().unwrap_or_else(|| format!("/lights/{i}"))
        };
        names.lights = scene.lights.iter().enumerate().map(named).chain(["background".to_owned()]).collect();
        names
    }

    /// In the order in which shapes are built; the members of a group count as shapes.
    fn add(&mut self, pointer: &str, shapes: &[Shape]) {
        for (i, shape) in shapes.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            if let Shape::Group(group) = shape {
                self.add(&format!("{pointer}/shapes"), &group.shapes);
                continue;
            }
            let material = shape.material().and_then(|material| match material {
                MaterialRef::Named(name) => Some(name.clone()),
                MaterialRef::Inline(_) => None,
            });
            // Whose parts have materials of their own has no name for all.
            let parted = match shape {
                Shape::Mesh(mesh) => !mesh.materials.is_empty(),
                Shape::Sdf(sdf) => sdf.parts.is_some(),
                _ => false,
            };
            self.shapes.push(shape.name().map_or(pointer, str::to_owned));
            self.materials.push(material.filter(|_| !parted));
        }
    }

    /// The light of this number: a surface's is that of the shape.
    pub fn light(&self, lights: &Lights, index: u32) -> &str {
        let name = match lights.iter().nth(index as usize) {
            Some(light::Light::Area(area)) => self.shapes.get(area.shape as usize),
            _ => self.lights.get(index as usize),
        };
        name.map_or("?", String::as_str)
    }

    /// The names of lights, each once, and which of them each light has.
    pub fn lights(&self, lights: &Lights) -> LightNames {
        let (mut known, mut names) = (HashMap::new(), vec![]);
        let mut group = |index: usize| {
            let name = self.light(lights, index as u32);
            *known.entry(name).or_insert_with(|| {
                names.push(name.to_owned());
                names.len() as u32 - 1
            })
        };
        let of = (0..lights.len()).map(&mut group).collect();
        LightNames { names, of }
    }
}
