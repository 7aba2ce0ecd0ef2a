//! Extents of the scene and of groups, before anything is built.

use glam::DVec3;

use super::objects::Objects;
use super::{MAX_EXTENT, origin};
use crate::error::{Error, Fault, Result};
use crate::math::AnimatedTransform;
use crate::shape::Detail;

/// Lower and upper corner of a box (m).
type Bounds = [DVec3; 2];

/// Bounding box and details of some objects, in their common space.
pub(super) struct Extent {
    bounds: Bounds,
    details: Vec<Detail>,
}

/// Bounding box of a group, in its space, and a detail that stands for all of its details.
pub(super) struct GroupExtent {
    bounds: Bounds,
    pub detail: Detail,
}

const EMPTY: Bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];

impl Extent {
    /// Extent of some objects.
    ///
    /// - `groups`: extents of the groups that the objects show
    pub fn of(objects: &Objects, groups: &[GroupExtent]) -> Extent {
        let shapes = objects.shapes.iter().map(|o| (o.geometry.bounds(&o.to_outer).into(), o.geometry.detail(&o.to_outer)));
        let instances = objects.instances.iter().map(|placement| groups[placement.group.index()].placed(&placement.to_outer));
        let mut extent = Extent { bounds: EMPTY, details: vec![] };
        for ([low, high], detail) in shapes.chain(instances) {
            extent.bounds = [extent.bounds[0].min(low), extent.bounds[1].max(high)];
            extent.details.push(detail);
        }
        extent
    }

    /// The extent itself.
    ///
    /// # Errors
    /// `Invalid` for coordinates beyond [`MAX_EXTENT`].
    pub fn checked(self) -> Result<Extent> {
        let [min, max] = self.bounds;
        let extent = if self.bounds == EMPTY { 0.0 } else { min.abs().max(max.abs()).max_element() };
        if extent > MAX_EXTENT || extent.is_nan() {
            return Err(Error::invalid(Fault::new(format!("the scene's extent {extent:.3e} exceeds {MAX_EXTENT:e}"))));
        }
        Ok(self)
    }

    /// Origin of the stored coordinates, see [`origin`].
    pub fn origin(self, eye: DVec3) -> DVec3 {
        origin::of(self.details.into_iter().map(|detail| origin::seen_from(detail, eye)), eye)
    }
}

impl GroupExtent {
    /// Extents of groups, each of which comes after those that it shows.
    ///
    /// # Errors
    /// `Invalid` for coordinates beyond [`MAX_EXTENT`].
    pub fn all(groups: &[Objects]) -> Result<Vec<GroupExtent>> {
        groups.iter().try_fold(vec![], |mut extents, objects| {
            let Extent { bounds, details } = Extent::of(objects, &extents).checked()?;
            let center = if bounds == EMPTY { DVec3::ZERO } else { 0.5 * bounds[0] + 0.5 * bounds[1] };
            let density = details.iter().map(|detail| detail.density).sum();
            extents.push(GroupExtent { bounds, detail: Detail { middle: origin::of(details.into_iter(), center), density } });
            Ok(extents)
        })
    }

    /// Bounding box over all times, and detail in the middle of the exposure, of an instance of the group.
    fn placed(&self, to_outer: &AnimatedTransform) -> (Bounds, Detail) {
        let middle = to_outer.at(0.5);
        if self.bounds == EMPTY {
            return (EMPTY, Detail { middle: middle.point(DVec3::ZERO), density: f64::MIN_POSITIVE });
        }
        let density = self.detail.density / middle.determinant().abs().cbrt();
        (to_outer.bounds(self.bounds), Detail { middle: middle.point(self.detail.middle), density })
    }
}
