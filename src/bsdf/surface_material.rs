//! The material of a surface with its normal or bump map and its opacity.

use glam::{DVec3, Vec2, Vec3};

use super::Material;
use super::description::{Description, MaterialRef, Prepare, given};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::Frame;
use crate::shape::{SurfacePoint, bent};
use crate::texture::{Number, Product, Texture, TextureContext};

/// A material with the properties that belong to the surface and not to scattering: a normal modifier and opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMaterial {
    /// How the surface scatters light.
    pub material: Material,
    /// The normal or bump map.
    pub normal_modifier: Option<NormalModifier>,
    /// The share of rays that hit the surface, from 0 to 1. The others continue as if it were not there.
    pub opacity: Option<Texture>,
}

/// The index of a material in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// A normal or bump map: it changes shading normals, and moves no points.
#[derive(Clone, Debug, PartialEq)]
pub enum NormalModifier {
    /// n ∝ s (2 r − 1) t + s (2 g − 1) b + (2 b − 1) n₀, with red r, green g and blue b of the map, along the texture coordinates.
    NormalMap {
        /// The normals as colours, with components from 0 to 1.
        map: Texture,
        /// s, the factor of the tangential part.
        strength: Number,
    },
    /// n ∝ n₀ − ∇ₛ h, with heights h = scale · map (m) above the surface.
    BumpMap {
        /// The heights, from 0 to 1.
        map: Texture,
        /// The height of 1 (m).
        scale: Number,
    },
}

/// The step of texture coordinates in the differences of heights: half a pixel of a picture 1024 pixels wide.
const STEP: f32 = 1.0 / 2048.0;

/// The smallest cosine between a modified normal and the surface's own normal, and between it and the view direction.
const LEAST_COS: f32 = 1.0 / 64.0;

impl NormalModifier {
    /// The modified normal at a point, as seen from `wo`.
    ///
    /// - `tangents`: ∂p/∂u, ∂p/∂v (m)
    ///
    /// A normal that points below the surface, or away from the viewer, would make the point black. It is bent back, towards the
    /// surface's own normal and then towards `wo`, so that the shading there differs from that of the map. Maps are not averaged over
    /// footprints, since the mean of normals is that of a flatter surface.
    ///
    /// Tests: mapped_planes_are_lit_as_by_quadrature, modified_normals_face_the_viewer.
    pub fn normal(&self, point: &SurfacePoint, tangents: [Vec3; 2], wo: Vec3) -> Vec3 {
        let turned = match self {
            NormalModifier::NormalMap { map, strength } => mapped(map, strength.at(&TextureContext::exact(point)), point, tangents),
            NormalModifier::BumpMap { map, scale } => sloped(map, scale, point, tangents),
        };
        let normal = turned.and_then(Vec3::try_normalize).map_or(point.ns, |n| bent(n, point.ng, LEAST_COS));
        // The direction to the viewer, or its opposite where the viewer is behind the surface.
        let seen = if point.ng.dot(wo) < 0.0 { -wo } else { wo };
        bent(normal, seen, LEAST_COS)
    }

    fn textures(&self) -> impl Iterator<Item = &Texture> {
        let (NormalModifier::NormalMap { map, strength: scale } | NormalModifier::BumpMap { map, scale }) = self;
        scale.texture().into_iter().chain([map])
    }

    fn recentred(self, origin: DVec3) -> NormalModifier {
        match self {
            NormalModifier::NormalMap { map, strength } => {
                NormalModifier::NormalMap { map: map.recentred(origin), strength: strength.recentred(origin) }
            }
            NormalModifier::BumpMap { map, scale } => {
                NormalModifier::BumpMap { map: map.recentred(origin), scale: scale.recentred(origin) }
            }
        }
    }
}

fn mapped(map: &Texture, strength: f32, point: &SurfacePoint, [du, dv]: [Vec3; 2]) -> Option<Vec3> {
    let frame = Frame::along(point.ns, du)?;
    // A mirrored parametrization mirrors the map.
    let hand = 1f32.copysign(frame.y.dot(dv));
    let [x, y, z] = map.at(&TextureContext::exact(point)).to_array().map(|c| 2.0 * c - 1.0);
    Some(frame.x * (strength * x) + frame.y * (strength * y * hand) + frame.z * z)
}

/// The normal n − ∇ₛ h of a bump map, normalized.
///
/// ∇ₛ h = (h_u (∂p/∂v × n) + h_v (n × ∂p/∂u)) / (n · (∂p/∂u × ∂p/∂v)), with central differences h_u and h_v.
///
/// Source: Mikkelsen, *Bump Mapping Unparametrized Surfaces on the GPU* (2010).
fn sloped(map: &Texture, scale: &Number, point: &SurfacePoint, [du, dv]: [Vec3; 2]) -> Option<Vec3> {
    // f64, because steep slopes of f32 heights would overflow in the normalization.
    let height = |uv: Vec2| {
        let p = point.p + du * uv.x + dv * uv.y;
        let moved = TextureContext::exact(&SurfacePoint { p, uv: point.uv + uv, ..*point });
        f64::from(scale.at(&moved)) * f64::from(map.scalar(&moved))
    };
    let slope = |step: Vec2| (height(step) - height(-step)) / (2.0 * f64::from(STEP));
    let (h_u, h_v) = (slope(Vec2::new(STEP, 0.0)), slope(Vec2::new(0.0, STEP)));
    let [n, du, dv] = [point.ns, du, dv].map(|v| v.as_dvec3());
    let gradient = (dv.cross(n) * h_u + n.cross(du) * h_v) / n.dot(du.cross(dv));
    gradient.is_finite().then(|| (n - gradient).normalize().as_vec3())
}

impl SurfaceMaterial {
    /// Whether shading depends on the directions of the surface's tangents.
    pub fn needs_tangents(&self) -> bool {
        self.normal_modifier.is_some() || self.material.is_anisotropic()
    }

    /// The effects that simulating the surface needs.
    pub fn effects(&self) -> Effects {
        // They are looked up without footprints.
        let textured = |texture: &Texture| texture.effects().without(Effects::FOOTPRINTS);
        let normal_modifier = self.normal_modifier.as_ref().map_or(Effects::NONE, |normal_modifier| {
            normal_modifier.textures().map(textured).fold(Effects::SHADING_NORMALS, Effects::union)
        });
        let opacity = self.opacity.as_ref().map_or(Effects::NONE, |o| Effects::CUT_OUTS | textured(o));
        self.material.effects() | normal_modifier | opacity
    }

    /// The surface material after the world has been moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> SurfaceMaterial {
        let normal_modifier = self.normal_modifier.map(|normal_modifier| normal_modifier.recentred(origin));
        let opacity = self.opacity.map(|opacity| opacity.recentred(origin));
        SurfaceMaterial { material: self.material.recentred(origin), normal_modifier, opacity }
    }
}

impl From<Material> for SurfaceMaterial {
    fn from(material: Material) -> SurfaceMaterial {
        SurfaceMaterial { material, normal_modifier: None, opacity: None }
    }
}

/// The descriptions in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;
    use crate::format::{Real, Textured, Varying};

    /// A normal map or bump map: it changes shading normals, and moves no points. A normal that points below the surface, or away from
    /// the viewer, is bent back until its cosine to the surface's own normal, and then to the viewer, is 1/64. At grazing view the
    /// shading therefore differs a little from the map. The map has no effect where texture coordinates are degenerate. This material cannot
    /// be a part of other materials.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Bumped {
        /// The material of the surface.
        pub surface: MaterialRef,
        /// A picture of normals: red, green and blue from 0 to 1 mean −1 to 1 along u, along v (up) and along the normal. It is read as
        /// linear unless its `encoding` says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normal_map: Option<Textured>,
        /// A texture of heights, in place of `normal_map`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub bump_map: Option<Textured>,
        /// The height of white above black (m); with `normal_map`, a factor of the slope.
        #[serde(default = "one")]
        pub scale: Varying<Real>,
    }

    /// A surface with holes: leaves, lace, a fence on one quad. Rays pass through the holes, shadow rays too. A ray passes through at
    /// most 4096 of them and is then blocked. This material cannot be a part of other
    /// materials, nor be used on shapes that emit.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Masked {
        /// The material of the surface.
        pub surface: MaterialRef,
        /// The share of rays that hit the surface: 0 is a hole. A colour counts by its mean.
        pub opacity: Textured,
    }

    fn one() -> Varying<Real> {
        Varying::Same(Real::known(1.0))
    }
}

impl Description for described::Bumped {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let maps = [("normal_map", self.normal_map.as_ref()), ("bump_map", self.bump_map.as_ref()), ("scale/by", self.scale.by())];
        maps.into_iter().filter_map(given).collect()
    }

    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![("surface", &self.surface)]
    }

    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        let either = self.normal_map.is_some() != self.bump_map.is_some();
        if either { vec![] } else { vec![("", "a bumped material needs either \"normal_map\" or \"bump_map\"")] }
    }

    /// A placeholder: a scene with this material within another one is refused when it is checked.
    fn prepare(&self, _builder: &mut dyn Prepare) -> Material {
        Material::diffuse(0.0)
    }

    fn surface(&self, builder: &mut dyn Prepare) -> SurfaceMaterial {
        let scale = builder.number("scale", &self.scale);
        let normals = self.normal_map.as_ref().map(|map| builder.normal_map("normal_map", map));
        let heights = self.bump_map.as_ref().map(|map| builder.texture_at_points("bump_map", map));
        let normals = normals.map(|map| NormalModifier::NormalMap { map, strength: scale.clone() });
        let normal_modifier = normals.or(heights.map(|map| NormalModifier::BumpMap { map, scale }));
        SurfaceMaterial { normal_modifier, ..builder.surface("surface", &self.surface) }
    }
}

impl Description for described::Masked {
    fn textures(&self) -> Vec<(String, &Textured)> {
        vec![("opacity".into(), &self.opacity)]
    }

    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![("surface", &self.surface)]
    }

    /// A placeholder: a scene with this material within another one is refused when it is checked.
    fn prepare(&self, _builder: &mut dyn Prepare) -> Material {
        Material::diffuse(0.0)
    }

    fn surface(&self, builder: &mut dyn Prepare) -> SurfaceMaterial {
        let opacity = builder.texture_at_points("opacity", &self.opacity);
        let inner = builder.surface("surface", &self.surface);
        let opacity = match inner.opacity {
            None => opacity,
            Some(more) => Texture::Product(Box::new(Product { a: opacity, b: more })),
        };
        SurfaceMaterial { opacity: Some(opacity), ..inner }
    }
}
