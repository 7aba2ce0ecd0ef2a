//! What one value alone cannot show to be wrong: names, contradictions, degenerate transforms.
//!
//! Each check names the JSON pointer it is about; [`Faults::add_at`] finds the line and column.

use super::camera::Camera;
use super::cycles;
use super::film::Film;
use super::light::{Light, SpotLight};
use super::material::{Alpha, Conductor, Material, MaterialRef};
use super::scene::Scene;
use super::shape::{Mesh, Shape};
use super::texture::{Texture, Textured};
use super::transform::{LookAt, Transform};
use super::value::Fraction;
use crate::reader::{Faults, Node, escaped, unknown};

/// Adds to `faults` what is wrong with `scene`, which was read from `root`.
pub(super) fn check(scene: &Scene, root: &Node, faults: &Faults) {
    let checker = Checker { scene, root, faults };
    checker.camera(&scene.camera);
    checker.film(&scene.film);
    checker.integrator();
    for (name, texture) in &scene.textures {
        checker.texture(&format!("/textures{}", escaped(name)), texture);
    }
    for (pointer, message) in cycles::find(&scene.textures) {
        checker.fault(&pointer, message);
    }
    for (name, material) in &scene.materials {
        checker.material(&format!("/materials{}", escaped(name)), material);
    }
    checker.shapes("/shapes", &scene.shapes);
    for (i, light) in scene.lights.iter().enumerate() {
        if let Light::Spot(spot) = light {
            checker.spot(&format!("/lights/{i}"), spot);
        }
    }
}

struct Checker<'s> {
    scene: &'s Scene,
    root: &'s Node,
    faults: &'s Faults,
}

impl Checker<'_> {
    fn fault(&self, pointer: &str, message: impl Into<String>) {
        self.faults.add_at(self.root, pointer, message);
    }

    fn camera(&self, camera: &Camera) {
        let (look_at, transform) = camera.placement();
        if look_at.is_some() && transform.is_some() {
            self.fault("/camera/transform", "give look_at or transform, not both (a transform may contain look_at)");
        }
        look_at.inspect(|look_at| self.look_at("/camera/look_at", look_at));
        transform.inspect(|transform| self.transform("/camera/transform", transform));
    }

    fn film(&self, film: &Film) {
        let Some([x0, x1, y0, y1]) = film.crop else { return };
        let (width, height) = (film.width.get(), film.height.get());
        if x0 >= x1 || y0 >= y1 {
            self.fault("/film/crop", "the crop [x0, x1, y0, y1] is empty: expected x0 < x1 and y0 < y1");
        } else if x1 > width || y1 > height {
            self.fault("/film/crop", format!("the crop reaches to {x1}, {y1}, beyond the image of {width} × {height}"));
        }
    }

    /// The rest is the integrator's own to check.
    fn integrator(&self) {
        let Some(node) = &self.scene.integrator.0 else { return };
        if node.child("type").and_then(Node::as_str).is_none() {
            self.fault("/integrator", "expected an object with a \"type\", the integrator's name");
        }
    }

    fn texture(&self, pointer: &str, texture: &Texture) {
        for (key, part) in texture.parts() {
            self.textured(&format!("{pointer}/{key}"), part);
        }
    }

    fn textured(&self, pointer: &str, color: &Textured) {
        match color {
            Textured::Texture(texture) => self.texture(pointer, texture),
            Textured::Named(name) if !self.scene.textures.contains_key(name) => {
                self.unknown_name(pointer, "texture", name, self.scene.textures.keys());
            }
            Textured::Named(_) | Textured::Color(_) => {}
        }
    }

    fn unknown_name<'k>(&self, pointer: &str, what: &str, name: &str, known: impl Iterator<Item = &'k String>) {
        if self.faults.is_full() {
            return; // the nearest of many names is not free
        }
        let known: Vec<&str> = known.map(String::as_str).collect();
        self.fault(pointer, unknown(what, name, &known));
    }

    fn material(&self, pointer: &str, material: &Material) {
        for (key, color) in material.parts() {
            self.textured(&format!("{pointer}/{key}"), color);
        }
        match material {
            Material::Conductor(m) => {
                self.index(pointer, m);
                self.one_width(pointer, m.alpha, &m.roughness, m.anisotropy);
            }
            Material::Dielectric(m) => self.one_width(pointer, m.alpha, &m.roughness, m.anisotropy),
            _ => {}
        }
    }

    /// By name or by number.
    fn index(&self, pointer: &str, metal: &Conductor) {
        match (metal.metal, metal.eta, metal.k) {
            (Some(_), None, None) | (None, Some(_), Some(_)) => {}
            (Some(_), Some(_), _) => self.fault(&format!("{pointer}/eta"), "give metal, or eta and k, not both"),
            (Some(_), None, Some(_)) => self.fault(&format!("{pointer}/k"), "give metal, or eta and k, not both"),
            (None, Some(_), None) => self.fault(pointer, "missing key \"k\""),
            (None, None, Some(_)) => self.fault(pointer, "missing key \"eta\""),
            (None, None, None) => self.fault(pointer, "a conductor needs \"metal\", or \"eta\" and \"k\""),
        }
    }

    fn one_width(&self, pointer: &str, alpha: Option<Alpha>, roughness: &Textured, anisotropy: Fraction) {
        if alpha.is_some() && (*roughness != Textured::black() || anisotropy.get() != 0.0) {
            self.fault(&format!("{pointer}/alpha"), "give alpha, or roughness and anisotropy, not both");
        }
    }

    fn material_ref(&self, pointer: &str, material: &MaterialRef) {
        match material {
            MaterialRef::Inline(material) => self.material(pointer, material),
            MaterialRef::Named(name) if self.scene.materials.contains_key(name) => {}
            MaterialRef::Named(name) => self.unknown_name(pointer, "material", name, self.scene.materials.keys()),
        }
    }

    fn shapes(&self, pointer: &str, shapes: &[Shape]) {
        for (i, shape) in shapes.iter().enumerate() {
            self.shape(&format!("{pointer}/{i}"), shape);
        }
    }

    fn shape(&self, pointer: &str, shape: &Shape) {
        self.transform(&format!("{pointer}/transform"), shape.transform());
        if let Some(material) = shape.material() {
            self.material_ref(&format!("{pointer}/material"), material);
        }
        match shape {
            Shape::Mesh(mesh) => self.mesh(pointer, mesh),
            Shape::Group(group) => self.shapes(&format!("{pointer}/shapes"), &group.shapes),
            Shape::Sphere(_) | Shape::Quad(_) | Shape::Disk(_) => {}
        }
    }

    fn mesh(&self, pointer: &str, mesh: &Mesh) {
        for (name, material) in &mesh.materials {
            self.material_ref(&format!("{pointer}/materials{}", escaped(name)), material);
        }
        match (&mesh.file, &mesh.positions, &mesh.triangles) {
            (Some(_), None, None) => self.nothing_inline(pointer, mesh),
            (None, Some(positions), Some(triangles)) => self.inline_mesh(pointer, mesh, positions.len(), triangles),
            _ => self.fault(pointer, "a mesh needs either \"file\", or \"positions\" and \"triangles\""),
        }
    }

    fn nothing_inline(&self, pointer: &str, mesh: &Mesh) {
        for (key, given) in [("normals", mesh.normals.is_some()), ("uvs", mesh.uvs.is_some())] {
            if given {
                self.fault(&format!("{pointer}/{key}"), format!("a mesh from a file has its own {key}"));
            }
        }
    }

    fn inline_mesh(&self, pointer: &str, mesh: &Mesh, vertices: usize, triangles: &[[u32; 3]]) {
        if triangles.is_empty() {
            self.fault(&format!("{pointer}/triangles"), "a mesh needs at least one triangle");
        }
        for (i, triangle) in triangles.iter().enumerate() {
            if let Some(k) = triangle.iter().position(|v| *v as usize >= vertices) {
                let message = format!("vertex {} does not exist, the last of {vertices} positions is {}", triangle[k], vertices as i64 - 1);
                self.fault(&format!("{pointer}/triangles/{i}/{k}"), message);
            }
        }
        for (key, len) in [("normals", mesh.normals.as_ref().map(Vec::len)), ("uvs", mesh.uvs.as_ref().map(Vec::len))] {
            if let Some(len) = len.filter(|len| *len != vertices) {
                self.fault(&format!("{pointer}/{key}"), format!("expected one for each of {vertices} positions, found {len}"));
            }
        }
    }

    fn transform(&self, pointer: &str, transform: &Transform) {
        for (i, step) in transform.0.iter().enumerate() {
            if let Err(message) = step.check() {
                self.fault(&format!("{pointer}/{i}/{}", step.key()), message);
            }
        }
    }

    fn look_at(&self, pointer: &str, look_at: &LookAt) {
        if let Err(message) = look_at.check() {
            self.fault(pointer, message);
        }
    }

    fn spot(&self, pointer: &str, spot: &SpotLight) {
        if spot.direction.is_some() == spot.to.is_some() {
            self.fault(pointer, "a spot needs either \"direction\" or \"to\"");
        }
        if spot.to == Some(spot.position) {
            self.fault(&format!("{pointer}/to"), "the spot points at itself: \"to\" equals \"position\"");
        }
        if spot.inner_angle > spot.outer_angle {
            let message = format!("inner_angle {} is larger than outer_angle {}", spot.inner_angle.get(), spot.outer_angle.get());
            self.fault(&format!("{pointer}/inner_angle"), message);
        }
    }
}
