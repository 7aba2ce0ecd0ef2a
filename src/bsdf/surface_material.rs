//! What a surface wears: a material, the fine shape of its surface, and where it is there at all.

use glam::{DVec3, Vec2, Vec3};

use super::Material;
use super::description::{Description, MaterialRef, Prepare, given};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::Frame;
use crate::shape::{SurfacePoint, bent};
use crate::texture::{Number, Product, Texture};

/// A material with what belongs to a place on a surface, not to how light is scattered there.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMaterial {
    pub material: Material,
    pub normal_modifier: Option<NormalModifier>,
    /// The share of rays that meet the surface, from 0 to 1; the others go on as if it were not there.
    pub opacity: Option<Texture>,
}

/// Shape too fine for triangles: it turns normals, and moves no points.
#[derive(Clone, Debug, PartialEq)]
pub enum NormalModifier {
    /// n ∝ s (2 r − 1) t + s (2 g − 1) b + (2 b − 1) n₀, of a picture's red, green and blue, along the texture coordinates.
    NormalMap { map: Texture, strength: Number },
    /// n ∝ n₀ − ∇ₛ h, of heights h = scale · texture (m) above the surface.
    BumpMap { map: Texture, scale: Number },
}

/// Texture coordinates are moved by this for the slope of heights: half a pixel of a picture of 1024.
const STEP: f32 = 1.0 / 2048.0;

/// Normals are not turned further away from the surface's own, and from the viewer, than to this cosine.
const LEAST_COS: f32 = 1.0 / 64.0;

impl NormalModifier {
    /// The turned normal at a point, as seen from `wo`.
    ///
    /// - `tangents`: ∂p/∂u, ∂p/∂v (m)
    ///
    /// What turns below the surface, or away from the viewer, cannot be seen, and would be black: there the normal is bent back,
    /// towards the surface's own and then towards `wo`. A bent normal lights the point as the map does not say.
    ///
    /// Tests: mapped_planes_are_lit_as_by_quadrature, turned_normals_are_seen.
    pub fn normal(&self, point: &SurfacePoint, tangents: [Vec3; 2], wo: Vec3) -> Vec3 {
        let turned = match self {
            NormalModifier::NormalMap { map, strength } => mapped(map, strength.at(point), point, tangents),
            NormalModifier::BumpMap { map, scale } => sloped(map, scale, point, tangents),
        };
        let normal = turned.and_then(Vec3::try_normalize).map_or(point.ns, |n| bent(n, point.ng, LEAST_COS));
        // Of the side that is looked at.
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
    // Pictures are mirrored where their coordinates are.
    let hand = 1f32.copysign(frame.y.dot(dv));
    let [x, y, z] = map.at(point).to_array().map(|c| 2.0 * c - 1.0);
    Some(frame.x * (strength * x) + frame.y * (strength * y * hand) + frame.z * z)
}

/// ∇ₛ h = (h_u (∂p/∂v × n) + h_v (n × ∂p/∂u)) / (n · (∂p/∂u × ∂p/∂v)), by differences across the point.
///
/// Source: Mikkelsen, *Bump Mapping Unparametrized Surfaces on the GPU* (2010).
fn sloped(map: &Texture, scale: &Number, point: &SurfacePoint, [du, dv]: [Vec3; 2]) -> Option<Vec3> {
    // In f64, where no slope of f32 heights is too steep to be normalized.
    let height = |uv: Vec2| {
        let p = point.p + du * uv.x + dv * uv.y;
        let moved = SurfacePoint { p, uv: point.uv + uv, ..*point };
        f64::from(scale.at(&moved)) * f64::from(map.scalar(&moved))
    };
    let slope = |step: Vec2| (height(step) - height(-step)) / (2.0 * f64::from(STEP));
    let (h_u, h_v) = (slope(Vec2::new(STEP, 0.0)), slope(Vec2::new(0.0, STEP)));
    let [n, du, dv] = [point.ns, du, dv].map(|v| v.as_dvec3());
    let gradient = (dv.cross(n) * h_u + n.cross(du) * h_v) / n.dot(du.cross(dv));
    gradient.is_finite().then(|| (n - gradient).normalize().as_vec3())
}

impl SurfaceMaterial {
    /// Whether it matters where the axes of the surface point.
    pub fn needs_tangents(&self) -> bool {
        self.normal_modifier.is_some() || self.material.is_anisotropic()
    }

    /// What simulating it takes.
    pub fn effects(&self) -> Effects {
        let textured = |texture: &Texture| if texture.is_constant() { Effects::NONE } else { Effects::TEXTURES };
        let normal_modifier = self.normal_modifier.as_ref().map_or(Effects::NONE, |normal_modifier| {
            normal_modifier.textures().map(textured).fold(Effects::SHADING_NORMALS, Effects::union)
        });
        let opacity = self.opacity.as_ref().map_or(Effects::NONE, |o| Effects::CUT_OUTS | textured(o));
        self.material.effects() | normal_modifier | opacity
    }

    /// The same skin after the world has moved by −`origin`.
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

/// As a scene file says it.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;
    use crate::format::{Real, Textured, Varying};

    /// A relief too fine for triangles: it turns normals, and moves no points. A normal that points below the surface, or away from the
    /// viewer, is bent back until its cosine to the surface's own normal, then to the viewer, is 1/64: what is seen of it along the
    /// surface is lit a little differently than the map says. Where texture coordinates span no area there is no relief. Not within
    /// other materials.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Bumped {
        /// What is bumped.
        pub surface: MaterialRef,
        /// A picture of normals: red, green and blue from 0 to 1 are −1 to 1 along u, along v (up), and out. Read as linear unless
        /// its `encoding` says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normal_map: Option<Textured>,
        /// In its place, heights.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub bump_map: Option<Textured>,
        /// The height of white above black (m); with `normal_map`, the strength of the relief.
        #[serde(default = "one")]
        pub scale: Varying<Real>,
    }

    /// A surface with holes: leaves, lace, a fence on one quad. Light of all kinds goes through them, shadow rays too; through 4096
    /// on one line, then it is stopped. Not within other materials, and not on what emits.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Masked {
        /// What has holes.
        pub surface: MaterialRef,
        /// The share of rays that meet the surface: 0 is a hole. (Of a colour, the mean.)
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

    /// A scene that puts it within another material is refused when it is checked.
    fn prepare(&self, _builder: &mut dyn Prepare) -> Material {
        Material::diffuse(0.0)
    }

    fn surface(&self, builder: &mut dyn Prepare) -> SurfaceMaterial {
        let scale = builder.number("scale", &self.scale);
        let normals = self.normal_map.as_ref().map(|map| builder.normal_map("normal_map", map));
        let heights = self.bump_map.as_ref().map(|map| builder.texture("bump_map", map));
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

    /// A scene that puts it within another material is refused when it is checked.
    fn prepare(&self, _builder: &mut dyn Prepare) -> Material {
        Material::diffuse(0.0)
    }

    fn surface(&self, builder: &mut dyn Prepare) -> SurfaceMaterial {
        let opacity = builder.texture("opacity", &self.opacity);
        let inner = builder.surface("surface", &self.surface);
        let opacity = match inner.opacity {
            None => opacity,
            Some(more) => Texture::Product(Box::new(Product { a: opacity, b: more })),
        };
        SurfaceMaterial { opacity: Some(opacity), ..inner }
    }
}
