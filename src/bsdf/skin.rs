//! What a surface wears: a material, the fine shape of its surface, and where it is there at all.

use glam::{DVec3, Vec2, Vec3};

use super::Material;
use crate::effects::Effects;
use crate::math::Frame;
use crate::shape::{SurfacePoint, bent};
use crate::texture::{Number, Texture};

/// A material with what belongs to a place on a surface, not to how light is scattered there.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    pub material: Material,
    pub relief: Option<Relief>,
    /// The share of rays that meet the surface, from 0 to 1; the others go on as if it were not there.
    pub opacity: Option<Texture>,
}

/// Shape too fine for triangles: it turns normals, and moves no points.
#[derive(Clone, Debug, PartialEq)]
pub enum Relief {
    /// n ∝ s (2 r − 1) t + s (2 g − 1) b + (2 b − 1) n₀, of a picture's red, green and blue, along the texture coordinates.
    Normals { map: Texture, strength: Number },
    /// n ∝ n₀ − ∇ₛ h, of heights h = scale · texture (m) above the surface.
    Heights { map: Texture, scale: Number },
}

/// Texture coordinates are moved by this for the slope of heights: half a pixel of a picture of 1024.
const STEP: f32 = 1.0 / 2048.0;

/// Normals are not turned further away from the surface's own, and from the viewer, than to this cosine.
const LEAST_COS: f32 = 1.0 / 64.0;

impl Relief {
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
            Relief::Normals { map, strength } => mapped(map, strength.at(point), point, tangents),
            Relief::Heights { map, scale } => sloped(map, scale, point, tangents),
        };
        let normal = turned.and_then(Vec3::try_normalize).map_or(point.ns, |n| bent(n, point.ng, LEAST_COS));
        // Of the side that is looked at.
        let seen = if point.ng.dot(wo) < 0.0 { -wo } else { wo };
        bent(normal, seen, LEAST_COS)
    }

    fn textures(&self) -> impl Iterator<Item = &Texture> {
        let (Relief::Normals { map, strength: scale } | Relief::Heights { map, scale }) = self;
        scale.texture().into_iter().chain([map])
    }

    fn recentred(self, origin: DVec3) -> Relief {
        match self {
            Relief::Normals { map, strength } => Relief::Normals { map: map.recentred(origin), strength: strength.recentred(origin) },
            Relief::Heights { map, scale } => Relief::Heights { map: map.recentred(origin), scale: scale.recentred(origin) },
        }
    }
}

fn mapped(map: &Texture, strength: f32, point: &SurfacePoint, [du, dv]: [Vec3; 2]) -> Option<Vec3> {
    let frame = Frame::along(point.ns, du)?;
    // Pictures are mirrored where their coordinates are.
    let hand = 1f32.copysign(frame.y.dot(dv));
    let [x, y, z] = map.at(point).to_rgb().map(|c| 2.0 * c - 1.0);
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

impl Skin {
    /// Whether it matters where the axes of the surface point.
    pub fn needs_tangents(&self) -> bool {
        self.relief.is_some() || self.material.is_anisotropic()
    }

    /// What simulating it takes.
    pub fn effects(&self) -> Effects {
        let textured = |texture: &Texture| if texture.is_constant() { Effects::NONE } else { Effects::TEXTURES };
        let relief = self
            .relief
            .as_ref()
            .map_or(Effects::NONE, |relief| relief.textures().map(textured).fold(Effects::SHADING_NORMALS, Effects::union));
        let opacity = self.opacity.as_ref().map_or(Effects::NONE, |o| Effects::CUT_OUTS | textured(o));
        self.material.effects() | relief | opacity
    }

    /// The same skin after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Skin {
        let relief = self.relief.map(|relief| relief.recentred(origin));
        let opacity = self.opacity.map(|opacity| opacity.recentred(origin));
        Skin { material: self.material.recentred(origin), relief, opacity }
    }
}

impl From<Material> for Skin {
    fn from(material: Material) -> Skin {
        Skin { material, relief: None, opacity: None }
    }
}
