//! From the description to the world: files are read, names resolved, transforms composed.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DVec3, UVec2, Vec2, Vec3};

use super::color::Color;
use super::scene::Scene;
use super::{camera, film, light, material, mesh, sampler, shape, texture, transform};
use crate::bsdf::Material;
use crate::camera::{Camera, Orthographic, Perspective, Pose, Spherical};
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::film::{Crop, FilmSpec, Filter};
use crate::light::{Directional, Emission, Environment, Falloff, Light, Point, Spot};
use crate::math::{Spectrum, Transform, float};
use crate::reader::{Node, locate};
use crate::sampler::{Kind, SamplerSpec};
use crate::shape::{Disk, MeshData, Quad, Sphere, TriangleMesh};
use crate::texture::{Checker, Space, Texture};
use crate::world::{MaterialId, World, WorldBuilder};

/// A scene ready to render.
pub struct Built {
    pub world: World,
    pub film: FilmSpec,
    pub sampler: SamplerSpec,
    /// Sentences about what was found odd, and what was done about it.
    pub warnings: Vec<String>,
    /// Which part of the scene calls for which effects.
    pub needs: Vec<(String, Effects)>,
}

/// Where the description came from, for messages and for the files that it names.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    pub root: &'a Node,
    /// The scene file, as the user named it.
    pub file: &'a str,
    /// Relative paths start here.
    pub folder: &'a Path,
}

/// Builds the world that `scene` describes.
///
/// # Errors
/// `Invalid`: mesh files that cannot be used, shapes that cannot be placed; all of them. `Io`: files that cannot be read.
pub fn build(scene: &Scene, source: Source) -> Result<Built> {
    let camera = camera_of(&scene.camera);
    let mut needs = vec![("camera".to_owned(), camera.effects())];
    let world = World::builder(camera);
    let mut builder =
        Builder { scene, source, world, materials: BTreeMap::new(), textures: 0, needs: vec![], warnings: vec![], faults: vec![] };
    builder.shapes("/shapes", &scene.shapes, &Transform::IDENTITY)?;
    builder.lights();
    if builder.textures > MOST_TEXTURES {
        let message = format!("textures within textures make more than {MOST_TEXTURES} of them");
        return Err(Error::Limit(locate(source.root, source.file, "/textures", message)));
    }
    if !builder.faults.is_empty() {
        builder.faults.truncate(crate::MAX_FAULTS);
        return Err(Error::Invalid(builder.faults));
    }
    needs.append(&mut builder.needs);
    let mut warnings = builder.warnings;
    let place = |fault: Fault| if fault.file.is_empty() { locate(source.root, source.file, "/shapes", fault.message) } else { fault };
    let world = builder.world.build().map_err(|error| match error {
        Error::Invalid(faults) => Error::Invalid(faults.into_iter().map(place).collect()),
        other => other,
    })?;
    if crate::scene::Scene::lights(&world).is_empty() {
        warnings.push(format!("{}: no light, the image will be black", source.file));
    }
    Ok(Built { world, film: film_of(&scene.film), sampler: sampler_of(&scene.sampler), warnings, needs })
}

/// Textures within textures are copied where they are used: checkers of checkers of … grow as 2ⁿ.
const MOST_TEXTURES: usize = 1 << 16;

struct Builder<'a> {
    scene: &'a Scene,
    source: Source<'a>,
    world: WorldBuilder,
    /// By JSON pointer: each is made once.
    materials: BTreeMap<String, (MaterialId, Effects)>,
    /// Made so far.
    textures: usize,
    needs: Vec<(String, Effects)>,
    warnings: Vec<String>,
    faults: Vec<Fault>,
}

impl Builder<'_> {
    fn shapes(&mut self, pointer: &str, shapes: &[shape::Shape], outer: &Transform) -> Result<()> {
        for (i, shape) in shapes.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            match placed(shape.transform()) {
                Some(inner) => self.shape(&pointer, shape, &inner.then(outer))?,
                None => self.fault(&format!("{pointer}/transform"), "the steps together leave nothing: det 0"),
            }
        }
        Ok(())
    }

    fn shape(&mut self, pointer: &str, shape: &shape::Shape, to_world: &Transform) -> Result<()> {
        let emission = shape.emission().map(|e| Emission { radiance: spectrum(&e.radiance), two_sided: e.two_sided });
        if let shape::Shape::Group(group) = shape {
            return self.shapes(&format!("{pointer}/shapes"), &group.shapes, to_world);
        }
        let (kind, own) = self.material(&format!("{pointer}/material"), shape.material());
        let mut effects = own.1;
        effects |= emission.map_or(Effects::NONE, |_| Effects::AREA_LIGHT);
        let own = own.0;
        match shape {
            shape::Shape::Sphere(s) => match Transform::translate(DVec3::from(s.center.0)) {
                Some(to_center) => {
                    self.world.shape(Sphere { radius: s.radius.get() }, to_center.then(to_world), own, emission);
                }
                None => self.fault(&format!("{pointer}/center"), "too far away"),
            },
            shape::Shape::Quad(s) => {
                let size = match s.size {
                    shape::Size::Square(side) => [side.get(); 2],
                    shape::Size::Sides(sides) => sides.map(|side| side.get()),
                };
                self.world.shape(Quad { size }, *to_world, own, emission);
            }
            shape::Shape::Disk(s) => self.world.shape(Disk { radius: s.radius.get() }, *to_world, own, emission),
            shape::Shape::Mesh(s) => {
                let Some(data) = self.mesh(pointer, s)? else { return Ok(()) };
                effects |= if data.normals.is_empty() { Effects::NONE } else { Effects::SHADING_NORMALS };
                let (parts, more) = self.part_materials(pointer, s, &data, own);
                effects |= more;
                self.world.parts(TriangleMesh::new(data), *to_world, parts, emission);
            }
            shape::Shape::Group(_) => {}
        }
        let name = shape.name().map_or_else(|| format!("{pointer}, {kind}"), |name| format!("{name:?}, {kind}"));
        self.needs.push((name, effects));
        Ok(())
    }

    /// Read from its file, or as given; `None` with a fault noted.
    fn mesh(&mut self, pointer: &str, mesh: &shape::Mesh) -> Result<Option<MeshData>> {
        let (key, loaded) = match &mesh.file {
            Some(file) => ("/file", mesh::load(&self.source.folder.join(file), file)),
            None => ("", inline(mesh, pointer)),
        };
        match loaded {
            Ok((data, warnings)) => {
                self.warnings.extend(warnings);
                Ok(Some(data))
            }
            Err(Error::Invalid(faults)) => {
                for fault in faults {
                    // A fault with a line of its own is about the mesh file, any other about the scene that names it.
                    let own = fault.line.is_some();
                    let text = if fault.file.is_empty() { fault.message.clone() } else { format!("{}: {}", fault.file, fault.message) };
                    let scene = || locate(self.source.root, self.source.file, &format!("{pointer}{key}"), text);
                    let fault = if own { fault.clone() } else { scene() };
                    self.faults.push(fault);
                }
                Ok(None)
            }
            Err(other) => Err(other),
        }
    }

    /// One material per part of the mesh: the one that its name is mapped to, or that the scene has under it, or the mesh's own.
    fn part_materials(&mut self, pointer: &str, mesh: &shape::Mesh, data: &MeshData, own: MaterialId) -> (Vec<MaterialId>, Effects) {
        let mut effects = Effects::NONE;
        let mut materials = vec![];
        let names: Vec<&str> = data.parts.iter().filter_map(|part| part.material.as_deref()).collect();
        for unused in mesh.materials.keys().filter(|key| !names.contains(&key.as_str())) {
            self.warnings.push(format!(
                "{pointer}/materials: the mesh has {}",
                crate::reader::unknown("material", unused, &names).replacen("unknown", "no", 1)
            ));
        }
        for part in &data.parts {
            let name = part.material.as_deref().unwrap_or_default();
            let mapped = mesh.materials.get(name).cloned();
            let same = self.scene.materials.contains_key(name).then(|| material::MaterialRef::Named(name.into()));
            let chosen = mapped.or(if mesh.material.is_none() { same } else { None });
            materials.push(match chosen {
                Some(chosen) => {
                    let (_, (id, more)) = self.material(&format!("{pointer}/materials{}", crate::reader::escaped(name)), Some(&chosen));
                    effects |= more;
                    id
                }
                None => own,
            });
        }
        if materials.is_empty() {
            materials.push(own);
        }
        (materials, effects)
    }

    /// The material's name in words, its id and what it calls for.
    fn material(&mut self, pointer: &str, chosen: Option<&material::MaterialRef>) -> (String, (MaterialId, Effects)) {
        let default = material::Material::default();
        let (key, described) = match chosen {
            None => (String::new(), &default),
            Some(material::MaterialRef::Inline(inline)) => (pointer.to_owned(), &**inline),
            Some(material::MaterialRef::Named(name)) => (format!("/materials/{name}"), self.scene.materials.get(name).unwrap_or(&default)),
        };
        let (id, effects) = match self.materials.get(&key) {
            Some(known) => *known,
            None => {
                let made = self.material_of(described);
                let effects = made.effects();
                let known = (self.world.material(made), effects);
                self.materials.insert(key, known);
                known
            }
        };
        (kind(described).to_owned(), (id, effects))
    }

    fn material_of(&mut self, described: &material::Material) -> Material {
        use material::Material as M;
        match described {
            M::Diffuse(m) => Material::Diffuse { albedo: self.textured(&m.albedo) },
            M::Mirror(m) => Material::Mirror { color: self.textured(&m.color) },
            M::Conductor(m) => Material::Conductor { eta: rgb(m.eta.each()), k: rgb(m.k.each()) },
            M::Dielectric(m) => Material::Dielectric { eta: m.eta.get() as f32, color: self.textured(&m.color) },
            M::MatteCone(m) => Material::MatteCone { color: self.textured(&m.color), mattness: m.mattness.get() as f32 },
        }
    }

    fn textured(&mut self, described: &texture::Textured) -> Texture {
        match described {
            texture::Textured::Color(color) => Texture::Constant(spectrum(color)),
            texture::Textured::Texture(inline) => self.texture(inline),
            texture::Textured::Named(name) => match self.scene.textures.get(name) {
                Some(texture) => self.texture(texture),
                None => Spectrum::BLACK.into(),
            },
        }
    }

    fn texture(&mut self, described: &texture::Texture) -> Texture {
        self.textures += 1;
        if self.textures > MOST_TEXTURES {
            return Spectrum::BLACK.into();
        }
        match described {
            texture::Texture::Constant(t) => Texture::Constant(spectrum(&t.color)),
            texture::Texture::Checker(t) => {
                let space = match t.on {
                    texture::CheckerOn::Uv => Space::Uv,
                    texture::CheckerOn::Position => Space::World(Transform::IDENTITY),
                };
                let scale = Vec3::splat(t.scale.get() as f32);
                Texture::Checker(Box::new(Checker { even: self.textured(&t.even), odd: self.textured(&t.odd), scale, space }))
            }
        }
    }

    fn lights(&mut self) {
        for (i, described) in self.scene.lights.iter().enumerate() {
            let (made, name) = light_of(described);
            let name = name.map_or_else(|| format!("/lights/{i}"), |name| format!("{name:?}"));
            self.needs.push((name, made.effects()));
            self.world.light(made);
        }
        if let Some(background) = &self.scene.background {
            let made = Light::Environment(Environment { radiance: spectrum(&background.radiance) });
            self.needs.push(("background".into(), made.effects()));
            self.world.light(made);
        }
    }

    fn fault(&mut self, pointer: &str, message: &str) {
        self.faults.push(locate(self.source.root, self.source.file, pointer, message));
    }
}

/// A mesh given in the scene file itself.
fn inline(mesh: &shape::Mesh, name: &str) -> Result<(MeshData, Vec<String>)> {
    let vec3 = |v: &[f64; 3]| DVec3::from(*v).as_vec3();
    let triangles = mesh.triangles.clone().unwrap_or_default();
    let whole = crate::shape::Part { triangles: 0..triangles.len() as u32, ..Default::default() };
    let data = MeshData {
        positions: mesh.positions.iter().flatten().map(|p| vec3(&p.0)).collect(),
        normals: mesh.normals.iter().flatten().map(|n| vec3(&n.0)).collect(),
        uvs: mesh.uvs.iter().flatten().map(|uv| Vec2::new(uv[0].get() as f32, uv[1].get() as f32)).collect(),
        triangles,
        parts: vec![whole],
    };
    let (data, report) = data.clean();
    let mut warnings = report.warnings(name);
    warnings.extend(data.validate(name)?);
    Ok((data, warnings))
}

fn kind(described: &material::Material) -> &'static str {
    match described {
        material::Material::Diffuse(_) => "diffuse",
        material::Material::Mirror(_) => "mirror",
        material::Material::Conductor(_) => "conductor",
        material::Material::Dielectric(_) => "dielectric",
        material::Material::MatteCone(_) => "matte_cone",
    }
}

fn light_of(described: &light::Light) -> (Light, Option<&String>) {
    match described {
        light::Light::Point(l) => {
            (Light::Point(Point { position: l.position.0.into(), intensity: spectrum(&l.intensity) }), l.name.as_ref())
        }
        light::Light::Directional(l) => {
            let direction = DVec3::from(l.direction.0).normalize().as_vec3();
            (Light::Directional(Directional { direction, irradiance: spectrum(&l.irradiance) }), l.name.as_ref())
        }
        light::Light::Spot(l) => {
            let position = DVec3::from(l.position.0);
            let towards = l.to.map(|to| DVec3::from(to.0) - position);
            let axis = l.direction.map(|d| DVec3::from(d.0)).or(towards).unwrap_or(DVec3::NEG_Z);
            let cos = |angle: super::value::ConeAngle| float::sin_cos_degrees(angle.get()).1;
            let falloff = match l.falloff {
                light::Falloff::Smooth => Falloff::Smooth,
                light::Falloff::Linear => Falloff::Linear,
            };
            let spot = Spot {
                position,
                axis: axis.normalize().as_vec3(),
                intensity: spectrum(&l.intensity),
                cos_inner: cos(l.inner_angle),
                cos_outer: cos(l.outer_angle),
                falloff,
            };
            (Light::Spot(spot), l.name.as_ref())
        }
    }
}

fn camera_of(described: &camera::Camera) -> Camera {
    let (look_at, transform) = described.placement();
    let stood = look_at.and_then(look).or_else(|| transform.and_then(placed));
    let pose = Pose::new(&stood.unwrap_or(Transform::IDENTITY));
    match described {
        camera::Camera::Perspective(c) => {
            let (lens, focus) = (c.lens_radius.get() as f32, c.focus_distance.get() as f32);
            Camera::Perspective(Perspective::new(pose, c.fov.get(), lens, focus))
        }
        camera::Camera::Orthographic(c) => Camera::Orthographic(Orthographic { pose, height: c.height.get() as f32 }),
        camera::Camera::Spherical(_) => Camera::Spherical(Spherical { pose }),
    }
}

fn film_of(described: &film::Film) -> FilmSpec {
    let [x0, x1, y0, y1] = described.bounds();
    let filter = match &described.filter {
        film::Filter::Box(f) => Filter::pixel_box(f.radius.get() as f32),
        film::Filter::Tent(f) => Filter::tent(f.radius.get() as f32),
        film::Filter::Gaussian(f) => Filter::gaussian(f.radius.get() as f32, f.sigma.get() as f32),
        film::Filter::Mitchell(f) => Filter::mitchell(f.radius.get() as f32, f.b.get() as f32, f.c.get() as f32),
    };
    let size = UVec2::new(described.width.get(), described.height.get());
    FilmSpec { size, crop: Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) }, filter }
}

fn sampler_of(described: &sampler::Sampler) -> SamplerSpec {
    let kind = match described.kind {
        sampler::SamplerKind::Independent => Kind::Independent,
        sampler::SamplerKind::Stratified => Kind::Stratified,
        sampler::SamplerKind::Halton => Kind::Halton,
        sampler::SamplerKind::Sobol => Kind::Sobol,
    };
    SamplerSpec { kind, seed: described.seed, spp: described.spp.get().into() }
}

/// All steps, the first acting first; `None` where they cannot be undone.
fn placed(described: &transform::Transform) -> Option<Transform> {
    let mut total = Transform::IDENTITY;
    for step in &described.0 {
        total = total.then(&step_of(step)?);
    }
    let finite = total.matrix().is_finite() && total.inverse().matrix().is_finite();
    finite.then_some(total)
}

fn step_of(step: &transform::Step) -> Option<Transform> {
    use transform::{Scale, Step};
    match step {
        Step::Translate(by) => Transform::translate(by.0.into()),
        Step::Scale(Scale::Uniform(by)) => Transform::scale(DVec3::splat(*by)),
        Step::Scale(Scale::PerAxis(by)) => Transform::scale((*by).into()),
        Step::Rotate(rotate) => Transform::rotate(rotate.axis.0.into(), rotate.degrees.get()),
        Step::LookAt(look_at) => look(look_at),
        Step::Matrix(rows) => Transform::from_matrix(DMat4::from_cols_array(&rows.map(|x| x.get())).transpose()),
    }
}

fn look(at: &transform::LookAt) -> Option<Transform> {
    Transform::look_at(at.from.0.into(), at.to.0.into(), at.up.0.into())
}

fn spectrum<T: Copy + Into<f64>>(color: &Color<T>) -> Spectrum {
    rgb(color.linear())
}

fn rgb(values: [f64; 3]) -> Spectrum {
    let [r, g, b] = values.map(|v| v as f32);
    Spectrum::rgb(r, g, b)
}
