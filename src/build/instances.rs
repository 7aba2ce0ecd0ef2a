//! Builds groups, and places their instances.

use glam::DVec3;

use super::{Builder, transform};
use crate::bsdf::MaterialId;
use crate::describe::mesh::points::{InstancePoint, MAX_POINTS};
use crate::describe::{Instances, MaterialRef, Placement, identity};
use crate::effects::Effects;
use crate::error::{Error, Result};
use crate::math::{AnimatedTransform, Transform};
use crate::reader::{escaped, locate};
use crate::world::{GroupId, Objects};

/// A box: its lower and upper corner, in metres.
type Bounds = (DVec3, DVec3);

/// A group that was built.
#[derive(Clone, Copy)]
pub(super) struct BuiltGroup {
    id: GroupId,
    /// The bounding box in the space of the group; `None` for an empty group.
    bounds: Option<Bounds>,
}

/// Instances while they are placed.
struct Placer<'p> {
    /// The JSON pointer of the instances.
    pointer: &'p str,
    group: BuiltGroup,
    /// The transform that acts after that of each instance.
    to_outer: Transform,
    /// The material of instances without one of their own.
    material: Option<MaterialId>,
    objects: Objects,
    /// The bounding box of the instances placed so far.
    bounds: Option<Bounds>,
    /// The effects of the materials that replace others.
    effects: Effects,
}

impl Placer<'_> {
    /// Places an instance.
    ///
    /// - `to_outer`: the whole transform of the instance
    fn place(&mut self, to_outer: AnimatedTransform, material: Option<MaterialId>) {
        self.effects |= if to_outer.is_moving() { Effects::MOTION } else { Effects::NONE };
        self.objects.instance(self.group.id, to_outer.clone(), material.or(self.material));
        let placed = self.group.bounds.map(|(low, high)| to_outer.bounds([low, high]).into());
        self.bounds = placed.into_iter().chain(self.bounds).reduce(union);
    }
}

impl Builder<'_> {
    /// Builds the groups that the scene shows.
    ///
    /// # Errors
    /// Those of the shapes.
    pub(super) fn groups(&mut self) -> Result<()> {
        let scene = self.scene;
        for name in scene.shown_groups() {
            let outer = (std::mem::take(&mut self.objects), std::mem::take(&mut self.boxes), std::mem::take(&mut self.lamps));
            self.shapes(&format!("/groups{}", escaped(name)), &scene.groups[name], &Transform::IDENTITY)?;
            let id = self.world.group(std::mem::take(&mut self.objects));
            let bounds = self.boxes.iter().copied().reduce(union);
            (self.objects, self.boxes, self.lamps) = outer;
            self.groups.insert(name.to_owned(), BuiltGroup { id, bounds });
        }
        for name in scene.groups.keys().filter(|name| !self.groups.contains_key(*name)) {
            self.warnings.push(format!("{}: /groups{}: no shape of type \"instances\" shows this group", self.source.file, escaped(name)));
        }
        Ok(())
    }

    /// Places the instances of a group.
    ///
    /// # Errors
    /// `Limit` for too many instances; those of [`Builder::place_points`].
    pub(super) fn instances(&mut self, pointer: &str, described: &Instances, to_outer: &Transform) -> Result<()> {
        // Scenes that name unknown groups are refused.
        let Some(&group) = self.groups.get(&described.group) else { return Ok(()) };
        let objects = std::mem::take(&mut self.objects);
        let before = objects.instance_count();
        let mut placer = Placer { pointer, group, to_outer: *to_outer, material: None, objects, bounds: None, effects: Effects::NONE };
        placer.material = self.own_material(&mut placer, "material", described.material.as_ref());
        match (&described.placements, &described.file) {
            (Some(placements), _) => self.place_each(&mut placer, placements),
            (None, Some(file)) => self.place_points(&mut placer, file, &described.materials)?,
            (None, None) => placer.place((*to_outer).into(), None),
        }
        let Placer { objects, bounds, effects, .. } = placer;
        if objects.instance_count() == before {
            self.warnings.push(format!("{}: {pointer}: no placements: the group does not show", self.source.file));
        }
        self.objects = objects;
        self.boxes.extend(bounds);
        if !effects.is_empty() {
            let name = described.name.as_ref().map_or_else(|| format!("{pointer}, instances"), |name| format!("{name:?}, instances"));
            self.override_needs.push((name, effects));
        }
        if self.objects.instance_count() > MAX_POINTS {
            let message = format!("more than {MAX_POINTS} instances");
            return Err(Error::Limit(locate(self.source.root, self.source.file, pointer, message)));
        }
        Ok(())
    }

    /// The material that replaces those of a group; `None` if none is given.
    fn own_material(&mut self, placer: &mut Placer, key: &str, given: Option<&MaterialRef>) -> Option<MaterialId> {
        let (_, (id, effects)) = self.material(&format!("{}/{key}", placer.pointer), Some(given?));
        placer.effects |= effects;
        Some(id)
    }

    fn place_each(&mut self, placer: &mut Placer, placements: &[Placement]) {
        for (i, placement) in placements.iter().enumerate() {
            let material = self.own_material(placer, &format!("placements/{i}/material"), placement.material.as_ref());
            match transform::animated(&placement.transform, &placer.to_outer, &self.scene.shutter) {
                Ok(to_outer) => placer.place(to_outer, material),
                Err(message) => self.fault(&format!("{}/placements/{i}/transform", placer.pointer), &message),
            }
        }
    }

    /// Places an instance at each point of a file.
    ///
    /// # Errors
    /// `Io` where the file cannot be read, `Limit` for too many points. What is wrong with the points becomes a fault.
    fn place_points(&mut self, placer: &mut Placer, file: &str, materials: &[MaterialRef]) -> Result<()> {
        let (points, warnings) = match self.source.files.points(file) {
            Ok(read) => read,
            Err(Error::Invalid(faults)) => {
                self.file_faults(&format!("{}/file", placer.pointer), file, faults);
                return Ok(());
            }
            Err(other) => return Err(other),
        };
        self.warn_once(warnings);
        self.contents.insert(file.to_owned(), identity::of_points(&points));
        let chosen = |(i, material): (usize, &MaterialRef)| self.own_material(placer, &format!("materials/{i}"), Some(material));
        let chosen: Vec<Option<MaterialId>> = materials.iter().enumerate().map(chosen).collect();
        if chosen.is_empty() && points.iter().any(|point| point.material > 0) {
            self.warn_once(vec![format!("{file}: the numbers of materials are left out: the instances have no \"materials\"")]);
        }
        for (i, point) in points.iter().enumerate() {
            let material = chosen.get(point.material as usize).copied().flatten();
            if material.is_none() && !chosen.is_empty() {
                let message = format!("{file}: vertex {i} has the material {}, but there are {}", point.material, chosen.len());
                self.fault(&format!("{}/materials", placer.pointer), &message);
                return Ok(());
            }
            let Some(to_outer) = matrix(point).map(|matrix| matrix.then(&placer.to_outer)) else {
                self.fault(&format!("{}/file", placer.pointer), &format!("{file}: vertex {i}: its transform has no inverse"));
                return Ok(());
            };
            placer.place(to_outer.into(), material);
        }
        Ok(())
    }
}

fn union((low, high): Bounds, (other_low, other_high): Bounds) -> Bounds {
    (low.min(other_low), high.max(other_high))
}

fn matrix(point: &InstancePoint) -> Option<Transform> {
    Transform::from_matrix(point.matrix()).ok()
}
