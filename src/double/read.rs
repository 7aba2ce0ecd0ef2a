//! Reading of a scene's description for the path tracer in double precision.

use glam::{DVec2, DVec3};

use super::camera::{DoubleCamera, Lens};
use super::materials::DoubleMaterial;
use super::surfaces::{Appearance, Facet, Round, SurfaceList, Surfaces};
use crate::build::placed;
use crate::describe::{
    self, Camera, Color, Fraction, Material, MaterialRef, Shape, Size, Texture, TextureSpace, Textured, Varying, VaryingPerChannel,
};
use crate::error::{Error, Result};
use crate::load::Loaded;
use crate::math::{Transform, float};
use crate::reader::locate;
use crate::scene::Scene as _;

/// A scene in double precision.
pub struct DoubleScene {
    pub camera: DoubleCamera,
    pub surfaces: Surfaces,
    /// Radiance from all directions.
    pub background: DVec3,
}

impl DoubleScene {
    /// Whether rays start at different points of a lens.
    pub fn has_lens(&self) -> bool {
        matches!(self.camera.lens, Lens::Perspective { radius, .. } if radius > 0.0)
    }
}

/// Reads the description of a loaded scene.
///
/// # Errors
/// `Invalid` for the first thing that is not known in double precision; those of mesh files.
pub fn read(loaded: &Loaded) -> Result<DoubleScene> {
    let reader = Reader { loaded, scene: &loaded.description, origin: loaded.world.origin() };
    let scene = &loaded.description;
    let refused = [
        ("/media", !scene.media.is_empty() || scene.medium.is_some(), "media"),
        ("/lights", !scene.lights.is_empty(), "lights without a surface"),
        ("/shutter", scene.has_keyframes(), "things that move"),
    ];
    if let Some((pointer, _, what)) = refused.iter().find(|(_, is_there, _)| *is_there) {
        return Err(reader.unknown(pointer, what));
    }
    let mut surfaces = SurfaceList::default();
    reader.shapes("/shapes", &scene.shapes, &Transform::IDENTITY, &mut surfaces)?;
    let unusable = |error: Error| Error::invalid(locate(&loaded.root, &loaded.file, "/shapes", error.to_string()));
    Ok(DoubleScene { camera: reader.camera()?, surfaces: surfaces.build().map_err(unusable)?, background: reader.background()? })
}

struct Reader<'a> {
    loaded: &'a Loaded,
    scene: &'a describe::Scene,
    /// Origin that the world has subtracted before it was rounded (m).
    origin: DVec3,
}

impl Reader<'_> {
    /// The error for something that only the renderer knows.
    fn unknown(&self, pointer: &str, what: &str) -> Error {
        let message = format!("{what} are not known in double precision (docs/reliability.md)");
        Error::invalid(locate(&self.loaded.root, &self.loaded.file, pointer, message))
    }

    fn shapes(&self, pointer: &str, shapes: &[Shape], outer: &Transform, surfaces: &mut SurfaceList) -> Result<()> {
        for (i, shape) in shapes.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            let fault = |message| Error::invalid(locate(&self.loaded.root, &self.loaded.file, &pointer, message));
            let to_world = placed(shape.transform(), outer).map_err(fault)?;
            match shape {
                Shape::Group(group) => self.shapes(&format!("{pointer}/shapes"), &group.shapes, &to_world, surfaces)?,
                _ => self.shape(&pointer, shape, &to_world, surfaces)?,
            }
        }
        Ok(())
    }

    fn shape(&self, pointer: &str, shape: &Shape, to_world: &Transform, surfaces: &mut SurfaceList) -> Result<()> {
        if shape.medium().is_some() {
            return Err(self.unknown(pointer, "media"));
        }
        if let Shape::Mesh(mesh) = shape {
            return self.mesh(pointer, shape, mesh, to_world, surfaces);
        }
        let appearance = self.appearance(pointer, shape, shape.material())?;
        let centred = |center: describe::Point| Transform::translate(DVec3::from(center.0)).map(|moved| moved.then(to_world));
        match shape {
            Shape::Sphere(sphere) if sphere.is_whole() => {
                let to_world = centred(sphere.center)?;
                let linear = to_world.matrix().matrix3 * sphere.radius.get();
                let center = to_world.point(DVec3::ZERO);
                surfaces.round(Round::Sphere { center, inverse: linear.inverse() }, appearance);
            }
            Shape::Disk(disk) if disk.is_whole() => {
                let [x, y] = [DVec3::X, DVec3::Y].map(|axis| to_world.vector(axis * disk.radius.get()));
                let normal = to_world.normal(DVec3::Z);
                surfaces.round(Round::Disk { center: to_world.point(DVec3::ZERO), x, y, normal }, appearance);
            }
            Shape::Quad(quad) => {
                let size = match quad.size {
                    Size::Square(side) => DVec2::splat(side.get()),
                    Size::Sides(sides) => DVec2::from(sides.map(|side| side.get())),
                };
                let corner = |x: f64, y: f64| DVec3::new(x * size.x, y * size.y, 0.0) * 0.5;
                self.rectangle(
                    [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
                    to_world,
                    appearance,
                    surfaces,
                );
            }
            Shape::Box(cuboid) => {
                let (to_world, half) = (centred(cuboid.center)?, 0.5 * DVec3::from(cuboid.size.get()));
                for axis in 0..3 {
                    for side in [1.0, -1.0] {
                        let along = |k: usize, by: f64| DVec3::AXES[(axis + k) % 3] * by;
                        let corner = |u: f64, v: f64| (along(0, side) + along(1, u) + along(2, v * side)) * half;
                        self.rectangle(
                            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
                            &to_world,
                            appearance,
                            surfaces,
                        );
                    }
                }
            }
            Shape::Sphere(_) | Shape::Disk(_) => return Err(self.unknown(pointer, "parts of spheres and disks")),
            other => return Err(self.unknown(pointer, &format!("shapes of the type {}", kind(other)))),
        }
        Ok(())
    }

    /// Adds a rectangle of object space, counter-clockwise seen from outside.
    fn rectangle(&self, corners: [DVec3; 4], to_world: &Transform, appearance: Appearance, surfaces: &mut SurfaceList) {
        let [a, b, c, d] = corners.map(|corner| to_world.point(corner));
        let mirrored = if to_world.flips_handedness() { -1.0 } else { 1.0 };
        let normal = ((b - a).cross(d - a) * mirrored).normalize();
        let rounded = self.rounded([a, b, d]);
        let up = (rounded[1] - rounded[0]).cross(rounded[2] - rounded[0]).normalize_or_zero().z * mirrored;
        let uv = |u: f64, v: f64| DVec2::new(u, v);
        for (corners, uvs) in
            [([a, b, c], [uv(0.0, 0.0), uv(1.0, 0.0), uv(1.0, 1.0)]), ([a, c, d], [uv(0.0, 0.0), uv(1.0, 1.0), uv(0.0, 1.0)])]
        {
            surfaces.triangle(corners, Facet { appearance, normal, normals: None, uvs, up });
        }
    }

    /// Corners as the renderer has them.
    fn rounded(&self, corners: [DVec3; 3]) -> [DVec3; 3] {
        corners.map(|corner| (corner - self.origin).as_vec3().as_dvec3())
    }

    fn mesh(&self, pointer: &str, shape: &Shape, mesh: &describe::Mesh, to_world: &Transform, surfaces: &mut SurfaceList) -> Result<()> {
        if mesh.has_computed_normals() || mesh.smooth_shadows || !mesh.keyframes.is_empty() {
            return Err(self.unknown(pointer, "meshes with subdivision, displacement, keyframes or smooth_shadows"));
        }
        let (positions, normals, triangles, parts) = match &mesh.file {
            Some(file) => {
                let (data, _) = self.loaded.files.mesh(file)?;
                let places = |list: &[glam::Vec3]| list.iter().map(|v| v.as_dvec3()).collect::<Vec<DVec3>>();
                let parts = data.parts.iter().map(|part| (part.triangles.end, part.material.clone())).collect();
                (places(&data.positions), places(&data.normals), data.triangles, parts)
            }
            None => {
                let positions = mesh.positions.iter().flatten().map(|p| DVec3::from(p.0)).collect();
                let normals = mesh.normals.iter().flatten().map(|n| DVec3::from(n.0)).collect();
                (positions, normals, mesh.triangles.clone().unwrap_or_default(), vec![])
            }
        };
        let appearances = self.part_appearances(pointer, shape, mesh, &parts)?;
        let positions: Vec<DVec3> = positions.into_iter().map(|p| to_world.point(p)).collect();
        // A normal of zero marks a flat surface.
        let placed = |n: DVec3| if n == DVec3::ZERO { n } else { to_world.normal(n) };
        let normals: Vec<DVec3> = normals.into_iter().map(placed).collect();
        for (i, [a, b, c]) in (0..).zip(triangles) {
            let wound = if to_world.flips_handedness() { [a, c, b] } else { [a, b, c] };
            let of = |list: &[DVec3]| wound.map(|v| list[v as usize]);
            let corner_normals = (!normals.is_empty()).then(|| of(&normals));
            let corners = of(&positions);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            // Where vertex normals and the order of the corners disagree, the normals decide which side is the front.
            let is_turned = corner_normals.is_some_and(|[a, b, c]| (a + b + c).dot(normal) < 0.0);
            let turned = |[a, b, c]: [DVec3; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
            let corners = turned(corners);
            let rounded = self.rounded(corners);
            let up = (rounded[1] - rounded[0]).cross(rounded[2] - rounded[0]).normalize_or_zero().z;
            let normals = corner_normals.map(turned).filter(|normals| !normals.contains(&DVec3::ZERO));
            let part = parts.partition_point(|(end, _)| *end <= i).min(appearances.len() - 1);
            surfaces.triangle(
                corners,
                Facet {
                    appearance: appearances[part],
                    normal: if is_turned { -normal } else { normal },
                    normals,
                    uvs: [DVec2::ZERO; 3],
                    up,
                },
            );
        }
        Ok(())
    }

    /// What each part of a mesh looks like; at least one.
    fn part_appearances(
        &self,
        pointer: &str,
        shape: &Shape,
        mesh: &describe::Mesh,
        parts: &[(u32, Option<String>)],
    ) -> Result<Vec<Appearance>> {
        let named = |(_, name): &(u32, Option<String>)| {
            let name = name.as_deref().unwrap_or_default();
            let same = (mesh.material.is_none() && self.scene.materials.contains_key(name)).then(|| MaterialRef::Named(name.into()));
            mesh.materials.get(name).cloned().or(same).or(mesh.material.clone())
        };
        let own = [mesh.material.clone()];
        let chosen: Vec<Option<MaterialRef>> = if parts.is_empty() { own.into() } else { parts.iter().map(named).collect() };
        chosen.iter().map(|material| self.appearance(pointer, shape, material.as_ref())).collect()
    }

    fn appearance(&self, pointer: &str, shape: &Shape, material: Option<&MaterialRef>) -> Result<Appearance> {
        let material = material.and_then(|chosen| self.scene.material(chosen));
        let material = match material {
            None => DoubleMaterial::Diffuse { albedo: DVec3::splat(0.5) },
            Some(material) => self.known(material).map_err(|what| self.unknown(&format!("{pointer}/material"), &what))?,
        };
        if matches!(material, DoubleMaterial::Checkered { .. }) && !matches!(shape, Shape::Quad(_)) {
            return Err(self.unknown(&format!("{pointer}/material"), "textures on other shapes than quads"));
        }
        let Some(emission) = shape.emission() else { return Ok(Appearance { material, emission: DVec3::ZERO, two_sided: false }) };
        if emission.texture.is_some() {
            return Err(self.unknown(&format!("{pointer}/emission/texture"), "textures"));
        }
        Ok(Appearance { material, emission: emission.radiance.linear().into(), two_sided: emission.two_sided })
    }

    fn background(&self) -> Result<DVec3> {
        match &self.scene.background {
            None => Ok(DVec3::ZERO),
            Some(background) => match &background.radiance {
                Some(radiance) => Ok(radiance.linear().into()),
                None => Err(self.unknown("/background", "backgrounds of an image or a sky")),
            },
        }
    }

    fn camera(&self) -> Result<DoubleCamera> {
        let lens = match &self.scene.camera {
            Camera::Orthographic(camera) => Lens::Orthographic { height: camera.height.get() },
            Camera::Perspective(camera) => self.perspective(camera)?,
            _ => return Err(self.unknown("/camera/type", "other cameras than perspective and orthographic ones")),
        };
        let to_world = match self.scene.camera.placement() {
            (Some(at), _) => Transform::look_at(at.from.0.into(), at.to.0.into(), at.up.0.into())?,
            (None, Some(steps)) => placed(steps, &Transform::IDENTITY)
                .map_err(|message| Error::invalid(locate(&self.loaded.root, &self.loaded.file, "/camera/transform", message)))?,
            (None, None) => Transform::IDENTITY,
        };
        let axis = |v: DVec3| to_world.vector(v).normalize();
        Ok(DoubleCamera { eye: to_world.point(DVec3::ZERO), right: axis(DVec3::X), up: axis(DVec3::Y), back: axis(DVec3::Z), lens })
    }

    fn perspective(&self, camera: &describe::Perspective) -> Result<Lens> {
        if camera.aperture.as_ref().is_some_and(|iris| iris.blades.get() > 0) {
            return Err(self.unknown("/camera/aperture", "lenses with blades"));
        }
        let tan_half = |degrees: f64| {
            let (sin, cos) = float::sin_cos_degrees(0.5 * degrees);
            sin / cos
        };
        let (sensor, of_view) = (camera.sensor(), tan_half(camera.fov()));
        // 2 tan(fov/2) = height / focal length
        let focal_length = camera.focal_length.map_or(0.5 * sensor.height() / of_view, |given| given.get());
        let (tan, aspect) = match camera.focal_length {
            Some(_) => (0.5 * sensor.height() / focal_length, sensor.width().map(|width| width / sensor.height())),
            None => (of_view, camera.horizontal_fov.map(|across| tan_half(across.get()) / of_view)),
        };
        let millimetre = 1e-3;
        let radius = camera.f_number.map_or(camera.lens_radius.get(), |number| 0.5 * focal_length / number.get() * millimetre);
        let focus_distance = camera.focus_distance.get();
        // The plane of focus has the normal (sin y cos x, −sin x, cos y cos x).
        let [(sin_x, cos_x), (sin_y, cos_y)] = camera.tilt.map(|angle| float::sin_cos_degrees(angle.get()));
        let tilt = DVec2::new(sin_y / cos_y, -sin_x / (cos_y * cos_x)) / focus_distance;
        Ok(Lens::Perspective {
            tan,
            aspect,
            shift: DVec2::from(camera.shift.map(|by| by.get())),
            radius,
            focus: 1.0 / focus_distance,
            tilt,
        })
    }

    /// The model of a material, or what is not known of it.
    fn known(&self, material: &Material) -> std::result::Result<DoubleMaterial, String> {
        let rough = "rough materials";
        Ok(match material {
            Material::Diffuse(diffuse) => self.diffuse(&diffuse.albedo)?,
            Material::Mirror(mirror) => DoubleMaterial::Mirror { color: constant(&mirror.color)? },
            Material::ThinDielectric(thin) => DoubleMaterial::ThinDielectric { eta: number(&thin.eta)?, color: constant(&thin.color)? },
            Material::Conductor(metal) => {
                if metal.alpha.is_some() || constant(&metal.roughness)? != DVec3::ZERO {
                    return Err(rough.into());
                }
                if metal.film.is_some() {
                    return Err("thin films".into());
                }
                match (&metal.color, metal.metal) {
                    (Some(color), _) => DoubleMaterial::Schlick { normal: constant(color)? },
                    (None, Some(element)) => {
                        let (eta, k) = element.index();
                        let [eta, k] = [eta, k].map(|index| DVec3::from(index.to_array().map(f64::from)));
                        DoubleMaterial::Metal { eta, k }
                    }
                    (None, None) => DoubleMaterial::Metal {
                        eta: metal.eta.as_ref().map_or(Ok(DVec3::ZERO), channels)?,
                        k: metal.k.as_ref().map_or(Ok(DVec3::ZERO), channels)?,
                    },
                }
            }
            Material::Dielectric(glass) => {
                if glass.alpha.is_some() || constant(&glass.roughness)? != DVec3::ZERO {
                    return Err(rough.into());
                }
                if glass.dispersion().is_some() {
                    return Err("materials with dispersion".into());
                }
                let absorption = glass.absorption.as_ref().map_or(DVec3::ZERO, |body| {
                    let left = DVec3::from(body.color.linear());
                    -left.map(f64::ln) / body.distance.get()
                });
                DoubleMaterial::Dielectric { eta: number(&glass.index())?, color: constant(&glass.color)?, absorption }
            }
            other => return Err(format!("materials of the type {}", other.kind())),
        })
    }

    /// A matte material of one colour, or with a checkerboard of two.
    fn diffuse(&self, albedo: &Textured) -> std::result::Result<DoubleMaterial, String> {
        let texture = match albedo {
            Textured::Color(_) => return Ok(DoubleMaterial::Diffuse { albedo: constant(albedo)? }),
            Textured::Named(name) => self.scene.textures.get(name),
            Textured::Texture(texture) => Some(&**texture),
        };
        match texture {
            Some(Texture::Checker(checker)) if checker.on == TextureSpace::Uv && !self.scene.film.has_footprints() => {
                let (even, odd) = (constant(&checker.even)?, constant(&checker.odd)?);
                Ok(DoubleMaterial::Checkered { even, odd, scale: checker.scale.get() })
            }
            Some(Texture::Constant(one)) => Ok(DoubleMaterial::Diffuse { albedo: one.color.linear().into() }),
            Some(Texture::Checker(_)) => Err("textures that are averaged over pixels (-D /film/texture_footprint=0)".into()),
            _ => Err("textures other than checkerboards".into()),
        }
    }
}

/// The type of a shape in scene files.
fn kind(shape: &Shape) -> String {
    let described = serde_json::to_value(shape).unwrap_or_default();
    described["type"].as_str().unwrap_or("shape").to_owned()
}

/// A colour that is the same everywhere.
fn constant(textured: &Textured) -> std::result::Result<DVec3, String> {
    let linear = |color: &Color<Fraction>| DVec3::from(color.linear());
    match textured {
        Textured::Color(color) => Ok(linear(color)),
        Textured::Named(_) | Textured::Texture(_) => Err("textures".into()),
    }
}

fn number<T: Copy + Into<f64>>(varying: &Varying<T>) -> std::result::Result<f64, String> {
    match varying {
        Varying::Same(value) => Ok((*value).into()),
        Varying::Between(_) => Err("textures".into()),
    }
}

fn channels<T: Copy + Into<f64>>(varying: &VaryingPerChannel<T>) -> std::result::Result<DVec3, String> {
    match varying {
        VaryingPerChannel::Equal(value) => Ok(DVec3::splat((*value).into())),
        VaryingPerChannel::Each(values) => Ok(DVec3::from(values.map(Into::into))),
        VaryingPerChannel::Between(_) => Err("textures".into()),
    }
}
