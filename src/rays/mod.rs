//! A ray caster in double precision for triangle meshes, without pictures: what a ray meets is decided by exact arithmetic.
//!
//! ```
//! use pt::glam::DVec3;
//! use pt::rays::{Ray, RayCaster};
//!
//! # fn main() -> pt::Result<()> {
//! // A tetrahedron, its triangles counter-clockwise seen from outside.
//! let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let caster = RayCaster::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//!
//! let ray = Ray::new(DVec3::new(0.2, 0.2, -1.0), DVec3::Z);
//! let hit = caster.closest(&ray).expect("the ray meets the base");
//! assert_eq!((hit.t, hit.triangle, hit.enters), (1.0, 0, true));
//!
//! // In through the base, out through the slanted face.
//! assert_eq!(caster.all(&ray).iter().map(|hit| hit.triangle).collect::<Vec<_>>(), [0, 3]);
//! assert!(caster.contains(DVec3::splat(0.2)) && !caster.contains(DVec3::splat(0.4)));
//! # Ok(())
//! # }
//! ```
//!
//! # What holds
//!
//! - Whether a ray meets a triangle is decided by the signs of determinants of the given `f64` coordinates, computed exactly
//!   (`exact.rs`).
//! - A ray that passes exactly through an edge or a vertex meets exactly one of the triangles there that a ray beside it would meet: its
//!   direction is taken as if it were turned by an infinitely small angle, always the same. So no ray slips through a closed mesh, no
//!   crossing is counted twice, and the crossings of a ray from outside are even in number.
//! - A ray that starts in the plane of a triangle does not meet it there: hits have t > 0.
//! - Distances, weights and normals are `f64` results with a few roundings. The same input gives the same bits on every machine and for
//!   any number of threads.
//!
//! Tests: row G2 of `pt torture`, the_caster_agrees_with_a_search_in_integers, rays_through_features_cross_once.

mod exact;
mod scene;
pub mod table;
mod tree;
mod triangle;

use std::ffi::OsStr;
use std::path::Path;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::describe::mesh;
use crate::error::{Error, Fault, Result};
use crate::import::{AutoCamera, ImportOptions, import_with};
use crate::integrators;
use crate::load::load;
use crate::reader::Node;
use tree::Tree;

pub use scene::{SceneCaster, SceneHit};

/// Half line, or part of it: the points origin + t · direction with 0 < t < `t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start (m).
    pub origin: DVec3,
    /// Direction; its greatest component is between 10⁻¹⁰⁰ and 10¹⁰⁰, and one below 10⁻⁶⁰ of that counts as 0.
    pub direction: DVec3,
    /// End, in lengths of the direction.
    pub t_max: f64,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance, in lengths of the direction.
    pub t: f64,
    /// Index of the triangle.
    pub triangle: u32,
    /// Weights of the second and third corner, in [0, 1].
    pub uv: DVec2,
    /// Whether the ray comes from the side to which the triangle's normal points; its corners are counter-clockwise seen from there.
    pub enters: bool,
}

/// The triangles of a glTF model as [`RayCaster::load`] returns them, with warnings.
fn load_model(path: &Path) -> Result<(RayCaster, Vec<String>)> {
    let auto_camera = AutoCamera { ground: Some(false), ..AutoCamera::default() };
    // With a camera and a background the importer adds none, and has no notes about them.
    let alone = |root: &mut Node, _: &str| {
        root.set("/camera", r#"{"type": "perspective"}"#)?;
        root.set("/background", r#"{"radiance": 1}"#)
    };
    let imported = import_with(path, &ImportOptions { auto_camera, ..ImportOptions::default() }, alone)?;
    let mut warnings: Vec<String> = imported.notes.iter().map(Fault::to_string).collect();
    let (caster, curved) = SceneCaster::new(load(imported, None, &[integrators::ALL])?.world)?.triangles()?;
    let name = path.to_string_lossy();
    warnings.extend((curved > 0).then(|| format!("{name}: {curved} shapes without triangles are left out")));
    if caster.is_empty() {
        return Err(Error::invalid(Fault::new("no triangles").in_file(path)));
    }
    Ok((caster, warnings))
}

/// A triangle mesh that answers where rays meet it.
pub struct RayCaster {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    tree: Tree,
}

impl Ray {
    /// A ray without end.
    pub fn new(origin: DVec3, direction: DVec3) -> Ray {
        Ray { origin, direction, t_max: f64::INFINITY }
    }

    fn is_nan(&self) -> bool {
        self.origin.is_nan() || self.direction.is_nan() || self.t_max.is_nan()
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

impl RayCaster {
    /// Greatest magnitude of a coordinate, and the inverse of the least, within which products of three differences are exact.
    pub const LIMIT: f64 = 1e60;

    /// A mesh of these corners and triangles.
    ///
    /// # Errors
    /// `Invalid` for an index without a corner, and for a coordinate that is not 0 or between 10⁻⁶⁰ and 10⁶⁰; `Limit` beyond 2³² − 1
    /// triangles.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<RayCaster> {
        let invalid = |text: String| Err(Error::invalid(Fault::new(text)));
        if let Some((k, p)) = positions.iter().enumerate().find(|(_, p)| !p.to_array().into_iter().all(is_exact)) {
            return invalid(format!("vertex {k} at {p}: expected coordinates of 0, or between 1e-60 and 1e60"));
        }
        let is_missing = |triangle: &&[u32; 3]| triangle.iter().any(|&v| v as usize >= positions.len());
        if let Some(triangle) = triangles.iter().find(is_missing) {
            return invalid(format!("triangle {triangle:?}: there are only {} vertices", positions.len()));
        }
        if u32::try_from(triangles.len()).is_err() {
            return Err(Error::Limit(Fault::new(format!("{} triangles: at most 4294967295 are possible", triangles.len()))));
        }
        let bounds = |[a, b, c]: [DVec3; 3]| [a.min(b).min(c), a.max(b).max(c)];
        let tree = Tree::new(triangles.iter().map(|t| bounds(t.map(|v| positions[v as usize]))));
        Ok(RayCaster { positions, triangles, tree })
    }

    /// The mesh in a file: OBJ, PLY or STL, recognised by its content, or all triangles of a glTF model (`.gltf`, `.glb`) in the pose that the file
    /// shows: first of the meshes that one node shows, then of those that several nodes show. Returns it with warnings.
    ///
    /// # Errors
    /// Those of [`mesh::load`], of [`import_with`] and of [`RayCaster::new`].
    pub fn load(path: &Path) -> Result<(RayCaster, Vec<String>)> {
        let is_model = |extension: &OsStr| ["gltf", "glb"].iter().any(|known| extension.eq_ignore_ascii_case(known));
        if path.extension().is_some_and(is_model) {
            return load_model(path);
        }
        let (data, warnings) = mesh::load(path, &path.to_string_lossy())?;
        let positions = data.positions.iter().map(|p| p.as_dvec3()).collect();
        Ok((RayCaster::new(positions, data.triangles)?, warnings))
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Corners of a triangle.
    ///
    /// # Panics
    /// There is no triangle of this index.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// Unit normal of a triangle, towards the side from which its corners are counter-clockwise; zero for a triangle without area.
    ///
    /// # Panics
    /// There is no triangle of this index.
    pub fn normal(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// The first hit; of equal distances that of the lowest index.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let line = Line::new(ray)?;
        let mut best: Option<Hit> = None;
        self.tree.visit(&line, ray.t_max, |triangle| {
            let end = best.map_or(ray.t_max, |hit| hit.t);
            let hit = self.hit(&line, ray, triangle);
            if let Some(hit) = hit.filter(|hit| best.is_none_or(|best| (hit.t, hit.triangle) < (best.t, best.triangle))) {
                best = Some(hit);
                return Some(hit.t);
            }
            Some(end)
        });
        best
    }

    /// Whether there is a hit.
    pub fn any(&self, ray: &Ray) -> bool {
        let Some(line) = Line::new(ray) else { return false };
        let mut found = false;
        self.tree.visit(&line, ray.t_max, |triangle| {
            found |= self.hit(&line, ray, triangle).is_some();
            (!found).then_some(ray.t_max)
        });
        found
    }

    /// All hits, in order of their distance; of equal distances in order of their indices.
    pub fn all(&self, ray: &Ray) -> Vec<Hit> {
        let mut hits = vec![];
        if let Some(line) = Line::new(ray) {
            self.tree.visit(&line, ray.t_max, |triangle| {
                hits.extend(self.hit(&line, ray, triangle));
                Some(ray.t_max)
            });
        }
        hits.sort_by(|a: &Hit, b: &Hit| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits
    }

    /// Whether a point lies within a closed mesh: a ray from there crosses it an odd number of times. Points on the surface may count as
    /// either.
    pub fn contains(&self, point: DVec3) -> bool {
        self.all(&Ray::new(point, DVec3::new(0.36, 0.48, 0.8))).len() % 2 == 1
    }

    /// How often the mesh surrounds a point: exits less entries of a ray from there. 1 within a closed mesh whose triangles are
    /// counter-clockwise seen from outside, −1 if it is turned inside out, 0 outside.
    pub fn winding(&self, point: DVec3) -> i64 {
        let hits = self.all(&Ray::new(point, DVec3::new(0.36, 0.48, 0.8)));
        hits.iter().map(|hit| if hit.enters { -1 } else { 1 }).sum()
    }

    /// The first hits of many rays, on all threads, in the order of the rays.
    pub fn closest_of(&self, rays: &[Ray]) -> Vec<Option<Hit>> {
        rays.par_iter().map(|ray| self.closest(ray)).collect()
    }

    fn hit(&self, line: &Line, ray: &Ray, index: u32) -> Option<Hit> {
        triangle::hit(line, self.corners(index)).map(|hit| Hit { triangle: index, ..hit }).filter(|hit| hit.t < ray.t_max)
    }
}

/// Whether products of three differences of such coordinates are exact.
fn is_exact(x: f64) -> bool {
    x == 0.0 || (1.0 / RayCaster::LIMIT..=RayCaster::LIMIT).contains(&x.abs())
}

/// A ray for the tests: its direction with components of 0 where they do not count.
struct Line {
    origin: DVec3,
    direction: DVec3,
    /// The direction times a power of two, so that the greatest component is between 1 and 2; signs of determinants do not depend on it.
    scaled: DVec3,
}

impl Line {
    /// `None` for rays that meet nothing: without direction, or with numbers that are not finite or out of range.
    fn new(ray: &Ray) -> Option<Line> {
        let Ray { origin, direction, .. } = *ray;
        let greatest = direction.abs().max_element();
        let is_usable = (1e-100..=1e100).contains(&greatest) && origin.abs().max_element() <= RayCaster::LIMIT && !ray.is_nan();
        if !is_usable {
            return None;
        }
        let kept = |v: DVec3, least: f64| DVec3::select(v.abs().cmplt(DVec3::splat(least)), DVec3::ZERO, v);
        let direction = kept(direction, greatest / RayCaster::LIMIT);
        // The power of two below the greatest component, without its fraction.
        let scaled = direction / f64::from_bits(greatest.to_bits() & !((1 << 52) - 1));
        Some(Line { origin: kept(origin, 1.0 / RayCaster::LIMIT), direction, scaled })
    }
}
