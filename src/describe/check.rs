//! Checks that concern several values at once: unknown names, contradictions, degenerate transforms.
//!
//! Each check gives the JSON pointer of the value it complains about; [`Faults::add_at`] finds the line and column.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use glam::DVec3;

use super::camera::{Camera, Fisheye, FisheyeMapping, Lens, Perspective, Realistic};
use super::cycles;
use super::field_check;
use super::film::Film;
use super::light::{DirectionalLight, Light, PointLight, SpotLight};
use super::medium::{Density, Heterogeneous, Medium, MediumRef};
use super::scene::Scene;
use super::shape::{Instances, Mesh, Sdf, Shape};
use super::shape_check;
use super::{Material, MaterialRef};
use crate::bsdf::microfacet::RoughnessKeys;
use crate::camera::realistic::LensTable;
use crate::format::{Hex, Keyframe, LookAt, Radiometric, Real, Side, Step, Texture, TextureSpace, Textured, Transform};
use crate::primitive::MAX_NESTING;
use crate::reader::{Faults, Node, escaped, unknown};

/// The least sine of the angle between two directions that span a plane.
const LEAST_SINE: f64 = 1e-6;

/// Adds to `faults` all that is wrong with `scene`, which was read from `root`.
pub(super) fn check(scene: &Scene, root: &Node, faults: &Faults) {
    let emitting = groups_with(scene, emits);
    let filled = groups_with(scene, |shape| shape.medium().is_some());
    let checker = Checker { scene, root, faults, emitting, filled };
    checker.camera(&scene.camera);
    checker.shutter();
    checker.film(&scene.film);
    checker.integrator();
    for (name, texture) in &scene.textures {
        checker.texture(&format!("/textures{}", escaped(name)), texture);
    }
    for (pointer, message) in
        cycles::textures(&scene.textures).into_iter().chain(cycles::materials(&scene.materials)).chain(cycles::groups(&scene.groups))
    {
        checker.fault(&pointer, message);
    }
    for (name, material) in &scene.materials {
        checker.material(&format!("/materials{}", escaped(name)), material);
    }
    for (name, shapes) in &scene.groups {
        checker.shapes(&format!("/groups{}", escaped(name)), shapes, false);
    }
    checker.shapes("/shapes", &scene.shapes, false);
    for (name, medium) in &scene.media {
        checker.medium_itself(&format!("/media{}", escaped(name)), medium);
    }
    scene.medium.iter().for_each(|medium| checker.medium_ref("/medium", medium));
    for (i, light) in scene.lights.iter().enumerate() {
        checker.motion(&format!("/lights/{i}/transform"), light.transform());
        match light {
            Light::Spot(spot) => checker.spot(&format!("/lights/{i}"), spot),
            Light::Directional(light) => checker.disk(&format!("/lights/{i}/angle"), light),
            Light::Point(point) => checker.point(&format!("/lights/{i}"), point),
        }
    }
    if let Some(background) = &scene.background {
        checker.transform("/background/transform", &background.transform);
        let sunlight = background.sky.iter().flat_map(|sky| sky.irradiance.linear()).fold(0.0, f64::max);
        if sunlight > MOST_SUNLIGHT {
            let message = format!("expected at most {MOST_SUNLIGHT:e} W/m², found {sunlight:e}: the sun's disk is 15,000 times as bright");
            checker.fault("/background/sky/irradiance", message);
        }
        for (key, message) in background.faults() {
            checker.fault(&format!("/background{key}"), message);
        }
    }
}

/// Greatest time of a keyframe, and of the shutter (s): thirty years, of which a double resolves a tenth of a microsecond.
const LATEST: f64 = 1e9;

/// Least angle of a disk (degrees): directions of 32-bit floats do not tell points of smaller disks apart.
const LEAST_DISK: f64 = 1e-4;

/// Most irradiance of a sun with the angle of ours, so that its disk has a radiance of at most 1e30.
const MOST_SUNLIGHT: f64 = 1e25;

/// Sizes of a sensor relative to the focal length. Beyond them 32-bit floats do not tell the rays of a picture apart.
const WIDTHS: RangeInclusive<f64> = 1e-8..=1e8;

struct Checker<'s> {
    scene: &'s Scene,
    root: &'s Node,
    faults: &'s Faults,
    /// The names of the groups that emit light, also through instances of other groups.
    emitting: BTreeSet<&'s str>,
    /// The names of the groups that contain media, also through instances of other groups.
    filled: BTreeSet<&'s str>,
}

/// The names of the groups with a shape that has some property, also through instances of other groups.
///
/// - `has`: whether a shape has it that is neither a group nor instances
fn groups_with(scene: &Scene, has: impl Fn(&Shape) -> bool) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    // Each round finds the groups with instances of those found before.
    for _ in 0..=MAX_NESTING {
        let more: Vec<&str> = scene.groups.iter().filter(|(_, shapes)| any(shapes, &found, &has)).map(|(name, _)| name.as_str()).collect();
        found.extend(more);
    }
    found
}

/// Whether any shape has a property.
///
/// - `known`: groups that have it
fn any(shapes: &[Shape], known: &BTreeSet<&str>, has: &impl Fn(&Shape) -> bool) -> bool {
    shapes.iter().any(|shape| match shape {
        Shape::Group(group) => any(&group.shapes, known, has),
        Shape::Instances(instances) => known.contains(instances.group.as_str()),
        other => has(other),
    })
}

/// Whether a shape emits light.
fn emits(shape: &Shape) -> bool {
    match shape {
        Shape::Sdf(sdf) => sdf.emission.is_some() || sdf.parts.iter().flatten().any(|part| part.emission.is_some()),
        other => other.emission().is_some(),
    }
}

const MOVING_MEDIUM: &str = "a shape that contains a medium cannot move: leave out \"medium\", or the keyframes";

impl Checker<'_> {
    fn fault(&self, pointer: &str, message: impl Into<String>) {
        self.faults.add_at(self.root, pointer, message);
    }

    fn camera(&self, camera: &Camera) {
        let (look_at, transform) = camera.placement();
        if look_at.is_some() && transform.is_some() {
            self.fault("/camera/transform", "give look_at or transform, not both (a transform may contain look_at)");
        }
        match camera {
            Camera::Perspective(perspective) => self.perspective(perspective),
            Camera::Fisheye(fisheye) => self.fisheye(fisheye),
            Camera::Realistic(realistic) => self.realistic(realistic),
            Camera::Orthographic(_) | Camera::Spherical(_) => {}
        }
        look_at.inspect(|look_at| self.look_at("/camera/look_at", look_at));
        transform.inspect(|transform| self.motion("/camera/transform", transform));
    }

    fn perspective(&self, camera: &Perspective) {
        let angles = [("fov", camera.fov.is_some()), ("horizontal_fov", camera.horizontal_fov.is_some())];
        for (key, _) in angles.into_iter().filter(|(_, is_given)| *is_given && camera.focal_length.is_some()) {
            self.fault("/camera/focal_length", format!("give {key} or focal_length, not both"));
        }
        if camera.f_number.is_some() && camera.lens_radius.get() > 0.0 {
            self.fault("/camera/f_number", "give lens_radius or f_number, not both");
        }
        if camera.sensor.is_some() && camera.focal_length.is_none() && camera.f_number.is_none() {
            self.fault("/camera/sensor", "the size of the sensor counts only with focal_length or f_number: give one of them");
        }
        if let Some(focal_length) = camera.focal_length {
            let sensor = camera.sensor();
            for side in [Some(sensor.height()), sensor.width()].into_iter().flatten() {
                if !WIDTHS.contains(&(side / focal_length.get())) {
                    let message = format!("expected between 1e-8 and 1e8 times the size of the sensor, {side:e} mm");
                    self.fault("/camera/focal_length", message);
                }
            }
        }
        if let Some(1 | 2) = camera.aperture.as_ref().map(|iris| iris.blades.get()) {
            self.fault("/camera/aperture/blades", "expected 0, for a round opening, or at least 3 blades");
        }
    }

    fn fisheye(&self, camera: &Fisheye) {
        let (greatest, is_reached, name) = match camera.mapping {
            FisheyeMapping::Equidistant | FisheyeMapping::Equisolid => return,
            FisheyeMapping::Stereographic => (360.0, false, "a stereographic"),
            FisheyeMapping::Orthographic => (180.0, true, "an orthographic"),
        };
        let fov = camera.fov.get();
        if fov > greatest || fov == greatest && !is_reached {
            let bound = if is_reached { "at most" } else { "below" };
            self.fault("/camera/fov", format!("expected an angle {bound} {greatest} degrees for {name} lens, found {fov}"));
        }
    }

    /// Checks the rows of a lens. What depends on its focus is found when it is built, and so are the faults of a file.
    fn realistic(&self, camera: &Realistic) {
        let Lens::Rows(rows) = &camera.lens else { return };
        let rows: Vec<[f64; 4]> = rows.iter().map(|row| row.map(Real::get)).collect();
        if let Err(fault) = LensTable::new(&rows) {
            let pointer = fault.row.map_or("/camera/lens".to_owned(), |row| format!("/camera/lens/{row}"));
            self.fault(&pointer, fault.message);
        }
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

    /// Checks that an integrator is named. The integrator checks its own options.
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
        if let Some((on, transform)) = texture.space() {
            self.transform(&format!("{pointer}/transform"), transform);
            if on == TextureSpace::Uv && !transform.is_identity() {
                self.fault(&format!("{pointer}/transform"), "only what varies over the \"position\" can be placed in the world");
            }
        }
    }

    fn textured(&self, pointer: &str, color: &Textured) {
        match color {
            Textured::Texture(texture) => self.texture(pointer, texture),
            Textured::Named(name) if self.scene.textures.contains_key(name) => {}
            Textured::Named(name) if name.starts_with('#') => {
                let example = if Hex::parse(name).is_some() { name } else { "#ff8000" };
                self.fault(pointer, format!("unknown texture {name:?}; a colour is written {{\"srgb\": {example:?}}}"));
            }
            Textured::Named(name) => self.unknown_name(pointer, "texture", name, self.scene.textures.keys()),
            Textured::Color(_) => {}
        }
    }

    fn unknown_name<'k>(&self, pointer: &str, what: &str, name: &str, known: impl Iterator<Item = &'k String>) {
        if self.faults.is_full() {
            return; // finding the nearest of many names takes time
        }
        let known: Vec<&str> = known.map(String::as_str).collect();
        self.fault(pointer, unknown(what, name, &known));
    }

    fn material(&self, pointer: &str, material: &Material) {
        for (key, color) in material.description().textures() {
            self.textured(&format!("{pointer}/{key}"), color);
        }
        for (key, part) in material.description().parts() {
            self.material_ref(&format!("{pointer}/{key}"), part);
            self.within(&format!("{pointer}/{key}"), material, part);
        }
        if let Some(keys) = material.description().roughness_keys() {
            self.one_width(pointer, keys);
        }
        for (key, message) in material.description().faults() {
            self.fault(&format!("{pointer}{key}"), message);
        }
    }

    /// Adds a fault where `outer` may not contain `part`.
    fn within(&self, pointer: &str, outer: &Material, part: &MaterialRef) {
        let Some(inner) = self.scene.material(part) else { return };
        let is_surface = matches!(outer, Material::Bumped(_) | Material::Masked(_));
        match inner {
            Material::Masked(_) | Material::Bumped(_) if !is_surface => {
                self.fault(pointer, "\"masked\" and \"bumped\" cannot be a part of this material: put them around it");
            }
            _ if matches!(outer, Material::Bumped(_)) && self.has_relief(part, 0) => {
                self.fault(pointer, "a surface can have only one \"bumped\": remove one of the two");
            }
            _ => {}
        }
    }

    /// Whether a material has a normal or bump map.
    ///
    /// - `depth`: bounds the recursion where a material contains itself, which `cycles` reports
    fn has_relief(&self, material: &MaterialRef, depth: usize) -> bool {
        match self.scene.material(material) {
            Some(Material::Bumped(_)) => true,
            Some(Material::Masked(m)) if depth < 128 => self.has_relief(&m.surface, depth + 1),
            _ => false,
        }
    }

    fn one_width(&self, pointer: &str, RoughnessKeys { alpha, roughness, anisotropy, .. }: RoughnessKeys) {
        if alpha.is_some() && (*roughness != Textured::black() || *anisotropy != Textured::black()) {
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

    /// Checks shapes.
    ///
    /// - `moves`: whether they are in a group that moves
    fn shapes(&self, pointer: &str, shapes: &[Shape], moves: bool) {
        for (i, shape) in shapes.iter().enumerate() {
            self.shape(&format!("{pointer}/{i}"), shape, moves);
        }
    }

    fn shape(&self, pointer: &str, shape: &Shape, moves: bool) {
        self.motion(&format!("{pointer}/transform"), shape.transform());
        let moves = moves || shape.has_keyframes();
        if let Some(material) = shape.material() {
            self.material_ref(&format!("{pointer}/material"), material);
            self.whole_light(&format!("{pointer}/material"), shape, material);
        }
        if let Some(texture) = shape.emission().and_then(|emission| emission.texture.as_ref()) {
            self.textured(&format!("{pointer}/emission/texture"), texture);
        }
        if let Some(medium) = shape.medium() {
            self.medium(pointer, shape, medium);
            if moves {
                self.fault(&format!("{pointer}/medium"), MOVING_MEDIUM);
            }
        }
        let is_interface = match shape.material() {
            Some(material) => matches!(self.scene.material(material), Some(Material::Interface(_))),
            None => shape.medium().is_some(),
        };
        if is_interface && shape.emission().is_some() {
            let message =
                "what is only the boundary of a medium has no surface that could emit: give a \"material\", or leave out \"emission\"";
            self.fault(&format!("{pointer}/emission"), message);
        }
        match shape {
            Shape::Mesh(mesh) => self.mesh(pointer, shape, mesh),
            Shape::Group(group) => self.shapes(&format!("{pointer}/shapes"), &group.shapes, moves),
            Shape::Sdf(sdf) => self.sdf(pointer, sdf),
            Shape::Instances(instances) => self.instances(pointer, instances, moves),
            Shape::Sphere(sphere) => self.lengths(pointer, shape_check::sphere(sphere)),
            Shape::Disk(disk) => self.lengths(pointer, shape_check::disk(disk)),
            Shape::Cylinder(cylinder) => self.lengths(pointer, shape_check::cylinder(cylinder)),
            Shape::BilinearPatch(patch) => self.lengths(pointer, shape_check::bilinear_patch(patch)),
            Shape::Curves(curves) => self.lengths(pointer, shape_check::curves(curves)),
            Shape::Quad(_) | Shape::Cone(_) | Shape::Box(_) => {}
        }
    }

    fn lengths(&self, pointer: &str, faults: shape_check::Faults) {
        let at = |key: &str| if key.is_empty() { pointer.to_owned() } else { format!("{pointer}/{key}") };
        faults.into_iter().for_each(|(key, message)| self.fault(&at(&key), message));
    }

    /// Checks the medium inside a shape.
    fn medium(&self, pointer: &str, shape: &Shape, medium: &MediumRef) {
        let at = format!("{pointer}/medium");
        self.medium_ref(&at, medium);
        if let Some(message) = shape.material().and_then(|material| self.around_no_medium(material)) {
            self.fault(&at, message);
        }
    }

    /// Says why a material cannot be around a medium.
    fn around_no_medium(&self, material: &MaterialRef) -> Option<&'static str> {
        if self.has_holes(material, 0) {
            return Some("a shape with holes cannot contain a medium: leave out \"medium\", or the \"masked\" material");
        }
        match self.scene.material(material) {
            Some(Material::Dielectric(glass)) if glass.absorption.is_some() => {
                Some("the material has an \"absorption\" of its own: give the absorption in the medium")
            }
            _ => None,
        }
    }

    fn medium_ref(&self, pointer: &str, medium: &MediumRef) {
        match medium {
            MediumRef::Named(name) if !self.scene.media.contains_key(name) => {
                self.unknown_name(pointer, "medium", name, self.scene.media.keys());
            }
            MediumRef::Named(_) => {}
            MediumRef::Inline(medium) => self.medium_itself(pointer, medium),
        }
    }

    /// Checks a medium, wherever it is described.
    fn medium_itself(&self, pointer: &str, medium: &Medium) {
        match medium {
            Medium::Homogeneous(_) => {}
            Medium::Heterogeneous(medium) => self.heterogeneous(pointer, medium),
            Medium::Subsurface(body) => {
                let seen = [("albedo", body.albedo.is_some()), ("mean_free_path", body.mean_free_path.is_some())];
                for (key, is_given) in seen {
                    match (body.measured.is_some(), is_given) {
                        (true, true) => {
                            self.fault(&format!("{pointer}/{key}"), "give \"measured\", or albedo and mean_free_path, not both")
                        }
                        (false, false) => self.fault(pointer, format!("expected \"measured\", or albedo and mean_free_path: no \"{key}\"")),
                        _ => {}
                    }
                }
                if body.measured.is_some() && body.g.get() != 0.0 {
                    self.fault(&format!("{pointer}/g"), "measured materials scatter isotropically: leave out g");
                }
            }
        }
    }

    /// Checks how a medium varies.
    fn heterogeneous(&self, pointer: &str, medium: &Heterogeneous) {
        let density = &medium.density;
        let at = |key: &str| format!("{pointer}/density/{key}");
        self.transform(&at("transform"), density.transform());
        if let Some((pointer, message)) = density.bounds().and_then(|bounds| field_check::sides(&at("bounds"), bounds)) {
            self.fault(&pointer, message);
        }
        if let Density::Grid(grid) = density {
            let pointer = format!("{pointer}/density");
            self.grid(&pointer, &grid.file, grid.size, &grid.values);
            self.grid_name(&pointer, &grid.grid, &grid.file);
        }
        for (key, grid) in [("albedo_grid", &medium.albedo_grid), ("emission_grid", &medium.emission_grid)] {
            let Some(grid) = grid else { continue };
            let pointer = format!("{pointer}/{key}");
            self.grid(&pointer, &grid.file, grid.size, &grid.values);
            self.grid_name(&pointer, &grid.grid, &grid.file);
        }
        let albedos = medium.albedo_grid.as_ref().and_then(|grid| grid.values.as_ref());
        for (i, albedo) in albedos.into_iter().flatten().enumerate() {
            if let Some(wrong) = albedo.linear().into_iter().find(|value| *value > 1.0) {
                self.fault(&format!("{pointer}/albedo_grid/values/{i}"), format!("expected albedos from 0 to 1, found {wrong}"));
            }
        }
    }

    /// Checks where the values of a grid are from, and how many there are.
    fn grid<T>(&self, pointer: &str, file: &Option<String>, size: Option<[Side; 3]>, values: &Option<Vec<T>>) {
        let at_values = format!("{pointer}/values");
        match (file, values, size) {
            (None, None, _) => self.fault(pointer, "expected a \"file\", or \"size\" and \"values\""),
            (Some(_), Some(_), _) => self.fault(&at_values, "give a file or values, not both"),
            (None, Some(_), None) => self.fault(&at_values, "expected a \"size\": the number of values along x, y and z"),
            (None, Some(values), Some(size)) => {
                let count: u128 = size.iter().map(|side| u128::from(side.get())).product();
                if count != values.len() as u128 {
                    let size = size.map(|side| side.get().to_string()).join(" × ");
                    self.fault(&at_values, format!("expected {size} = {count} values, found {}", values.len()));
                }
            }
            (Some(_), None, _) => {}
        }
    }

    /// Checks that only grids of files have names.
    fn grid_name(&self, pointer: &str, name: &Option<String>, file: &Option<String>) {
        if name.is_some() && file.is_none() {
            self.fault(&format!("{pointer}/grid"), "the name of a grid in an OpenVDB file, but there is no \"file\"");
        }
    }

    /// - `moves`: whether they move as a whole
    fn instances(&self, pointer: &str, instances: &Instances, moves: bool) {
        if !self.scene.groups.contains_key(&instances.group) {
            self.unknown_name(&format!("{pointer}/group"), "group", &instances.group, self.scene.groups.keys());
        }
        if instances.placements.is_some() && instances.file.is_some() {
            self.fault(&format!("{pointer}/file"), "give placements or a file with points, not both");
        }
        if !instances.materials.is_empty() && instances.file.is_none() {
            self.fault(&format!("{pointer}/materials"), "materials for the points of a file, but there is no \"file\"");
        }
        for (i, placement) in instances.placements.iter().flatten().enumerate() {
            self.motion(&format!("{pointer}/placements/{i}/transform"), &placement.transform);
        }
        let is_filled = self.filled.contains(instances.group.as_str());
        if is_filled && (moves || instances.placements.iter().flatten().any(|placement| placement.transform.has_keyframes())) {
            self.fault(&format!("{pointer}/group"), MOVING_MEDIUM);
        }
        for (at, material) in instances.materials() {
            self.material_ref(&format!("{pointer}/{at}"), material);
        }
        let own = instances.material.iter().map(|material| ("material".to_owned(), material));
        for (at, material) in own.chain(instances.materials()) {
            if self.has_holes(material, 0) && self.emitting.contains(instances.group.as_str()) {
                self.fault(&format!("{pointer}/{at}"), "what emits can have no holes, and a shape of this group has \"emission\"");
            }
            if let Some(message) = self.around_no_medium(material).filter(|_| is_filled) {
                self.fault(&format!("{pointer}/{at}"), format!("a shape of this group contains a medium: {message}"));
            }
        }
    }

    fn sdf(&self, pointer: &str, sdf: &Sdf) {
        for (i, part) in sdf.parts.iter().flatten().enumerate() {
            if let Some(material) = &part.material {
                self.material_ref(&format!("{pointer}/parts/{i}/material"), material);
            }
        }
        field_check::check(pointer, sdf).into_iter().for_each(|(pointer, message)| self.fault(&pointer, message));
    }

    /// Adds a fault for an emitter with holes, because lights are sampled as if they had no holes.
    fn whole_light(&self, pointer: &str, shape: &Shape, material: &MaterialRef) {
        if shape.emission().is_some() && self.has_holes(material, 0) {
            self.fault(pointer, "what emits can have no holes: leave out \"emission\", or the \"masked\" material");
        }
    }

    /// Whether a material has holes.
    ///
    /// - `depth`: bounds the recursion where a material contains itself, which `cycles` reports
    fn has_holes(&self, material: &MaterialRef, depth: usize) -> bool {
        match self.scene.material(material) {
            Some(Material::Masked(_)) => true,
            Some(Material::Bumped(m)) if depth < 8 => self.has_holes(&m.surface, depth + 1),
            _ => false,
        }
    }

    fn mesh(&self, pointer: &str, shape: &Shape, mesh: &Mesh) {
        for (name, material) in &mesh.materials {
            let pointer = format!("{pointer}/materials{}", escaped(name));
            self.material_ref(&pointer, material);
            self.whole_light(&pointer, shape, material);
        }
        if let Some(displacement) = &mesh.displacement {
            self.textured(&format!("{pointer}/displacement/texture"), &displacement.texture);
        }
        match (&mesh.file, &mesh.positions, &mesh.triangles) {
            (Some(_), None, None) => self.nothing_inline(pointer, mesh),
            (None, Some(positions), Some(triangles)) => self.inline_mesh(pointer, mesh, positions.len(), triangles),
            _ => self.fault(pointer, "a mesh needs either \"file\", or \"positions\" and \"triangles\""),
        }
        self.mesh_keyframes(&format!("{pointer}/keyframes"), mesh);
    }

    fn mesh_keyframes(&self, pointer: &str, mesh: &Mesh) {
        self.times(pointer, &mesh.keyframes.iter().map(|keyframe| keyframe.time.get()).collect::<Vec<_>>());
        if mesh.has_computed_normals() && !mesh.keyframes.is_empty() {
            self.fault(pointer, "a mesh with keyframes can have neither \"subdivision_levels\" nor \"displacement\"");
        }
        let vertices = mesh.positions.as_ref().map(Vec::len);
        for (i, keyframe) in mesh.keyframes.iter().enumerate() {
            let fault = |key: &str, message: String| self.fault(&format!("{pointer}/{i}/{key}"), message);
            match (vertices, &keyframe.file, &keyframe.positions) {
                (Some(_), Some(_), _) => fault("file", "a mesh given here has keyframes with \"positions\"".into()),
                (None, _, Some(_)) => fault("positions", "a mesh from a file has keyframes with a \"file\"".into()),
                _ => {}
            }
            let given = [("positions", keyframe.positions.as_ref().map(Vec::len)), ("normals", keyframe.normals.as_ref().map(Vec::len))];
            for (key, len) in given {
                if let (Some(vertices), Some(len)) = (vertices, len.filter(|len| Some(*len) != vertices)) {
                    fault(key, format!("expected one for each of {vertices} positions, found {len}"));
                }
            }
            match (&keyframe.positions, &keyframe.normals, &mesh.normals) {
                (None, Some(_), _) => fault("normals", "normals without positions".into()),
                (Some(_), Some(_), None) => fault("normals", "the mesh has no normals, so that its keyframes can have none".into()),
                (Some(_), None, Some(_)) => fault("positions", "the mesh has normals: give those of the keyframe, too".into()),
                _ => {}
            }
        }
    }

    fn nothing_inline(&self, pointer: &str, mesh: &Mesh) {
        for (key, given) in [("normals", mesh.normals.is_some()), ("uvs", mesh.uvs.is_some()), ("colors", mesh.colors.is_some())] {
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
        let lens = [mesh.normals.as_ref().map(Vec::len), mesh.uvs.as_ref().map(Vec::len), mesh.colors.as_ref().map(Vec::len)];
        for (key, len) in ["normals", "uvs", "colors"].into_iter().zip(lens) {
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

    /// Checks a transform that may have keyframes.
    fn motion(&self, pointer: &str, transform: &Transform) {
        for (i, step) in transform.0.iter().enumerate() {
            let at = format!("{pointer}/{i}/{}", step.key());
            match step {
                Step::Keyframes(keyframes) => self.keyframes(&at, keyframes),
                _ => step.check().err().into_iter().for_each(|message| self.fault(&at, message)),
            }
        }
    }

    fn keyframes(&self, pointer: &str, keyframes: &[Keyframe]) {
        if keyframes.is_empty() {
            self.fault(pointer, "expected at least one keyframe");
        }
        for (i, keyframe) in keyframes.iter().enumerate() {
            let at = format!("{pointer}/{i}/transform");
            for (k, step) in keyframe.transform.0.iter().enumerate() {
                let message = match step {
                    Step::Keyframes(_) => Err("keyframes within keyframes: put them into a step of their own".to_owned()),
                    _ => step.check(),
                };
                message.err().into_iter().for_each(|message| self.fault(&format!("{at}/{k}/{}", step.key()), message));
            }
        }
        self.times(pointer, &keyframes.iter().map(|keyframe| keyframe.time.get()).collect::<Vec<_>>());
    }

    /// Checks the times of keyframes.
    fn times(&self, pointer: &str, times: &[f64]) {
        for (i, time) in times.iter().enumerate() {
            self.time(&format!("{pointer}/{i}/time"), *time);
        }
        for (i, pair) in times.windows(2).enumerate() {
            let [before, after] = [pair[0], pair[1]];
            if after <= before {
                let message = format!("expected a time after that of the keyframe before it, {before} s, found {after}");
                self.fault(&format!("{pointer}/{}/time", i + 1), message);
            }
        }
    }

    /// Checks that a time leaves the digits that differences of times need.
    fn time(&self, pointer: &str, time: f64) {
        if time.abs() > LATEST {
            self.fault(pointer, format!("expected a time from -{LATEST:e} to {LATEST:e} s, found {time:e}"));
        }
    }

    fn shutter(&self) {
        let [open, close] = [self.scene.shutter.open.get(), self.scene.shutter.close.get()];
        self.time("/shutter/open", open);
        self.time("/shutter/close", close);
        if close < open {
            self.fault("/shutter/close", format!("expected a time from {open} s on, when the shutter opens, found {close}"));
        }
    }

    fn look_at(&self, pointer: &str, look_at: &LookAt) {
        if let Err(message) = look_at.check() {
            self.fault(pointer, message);
        }
    }

    /// Checks that the disk of a directional light is not brighter than numbers allow.
    fn disk(&self, pointer: &str, light: &DirectionalLight) {
        let angle = light.angle.get();
        if angle > 0.0 && !light.transform.is_identity() {
            self.fault(pointer, "a light with an angle has no transform: turn its direction, or leave out the angle");
        }
        if angle > 0.0 && angle < LEAST_DISK {
            self.fault(pointer, format!("expected 0, or an angle from {LEAST_DISK}, found {angle}"));
            return;
        }
        let most = light.radiance().map_or(0.0, |radiance| radiance.into_iter().fold(0.0, f64::max));
        if Radiometric::new(most).is_none() {
            self.fault(
                pointer,
                format!("the disk would have a radiance of {most:.1e} W/(m² sr), expected at most 1e30: a larger angle, or 0"),
            );
        }
    }

    fn point(&self, pointer: &str, point: &PointLight) {
        let needs_profile = [("direction", point.direction), ("across", point.across)];
        for (key, _) in needs_profile.into_iter().filter(|(_, given)| given.is_some() && point.profile.is_none()) {
            self.fault(&format!("{pointer}/{key}"), "only a point with a \"profile\" has this");
        }
        let [axis, across] = [point.direction, point.across].map(|direction| direction.map(|d| DVec3::from(d.0).normalize()));
        if across.is_some_and(|across| across.cross(axis.unwrap_or(DVec3::NEG_Y)).length() < LEAST_SINE) {
            self.fault(&format!("{pointer}/across"), "expected a direction that is not along that of the vertical angle 0");
        }
    }

    fn spot(&self, pointer: &str, spot: &SpotLight) {
        let needs_image = [("encoding", !spot.encoding.is_auto()), ("image_angle", spot.image_angle.is_some()), ("up", spot.up.is_some())];
        for (key, _) in needs_image.into_iter().filter(|(_, given)| *given && spot.image.is_none()) {
            self.fault(&format!("{pointer}/{key}"), "only a spot with an \"image\" has this");
        }
        if let (Some(up), Some(axis)) = (spot.up, spot.axis())
            && DVec3::from(up.0).normalize().cross(axis).length() < LEAST_SINE
        {
            self.fault(&format!("{pointer}/up"), "expected a direction that is not along that of the light");
        }
        if spot.image.is_some() && spot.image_angle.is_none() && spot.outer_angle.get() >= 90.0 {
            let message = "with an \"outer_angle\" of 90 or more the width of the picture is needed: \"image_angle\", below 90";
            self.fault(&format!("{pointer}/outer_angle"), message);
        }
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
