//! The spaces of the scene and of its groups, with their shapes, instances and hierarchies.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec3;

use super::objects::{Object, Placement};
use crate::accel;
use crate::bsdf::MaterialId;
use crate::error::{Error, Fault, Result};
use crate::light::EmitterMotion;
use crate::math::{AnimatedTransform, Transform};
use crate::primitive::{Group, Instance, InstanceId, MAX_NESTING, Primitive};
use crate::shape::Shape;

/// Greatest number of copies of shapes with emission or a medium that instances show.
pub const MAX_COPIES: usize = 1 << 20;

/// Shapes in a common space, and the shift to the coordinates in which they are stored. The first space is that of the scene; those of
/// groups follow.
pub(super) struct Space<'a> {
    pub objects: &'a [Object],
    /// Index of the first shape.
    pub first_shape: u32,
    /// Transform to the coordinates in which shapes are stored.
    to_stored: Transform,
}

/// The spaces of the scene and of all groups.
///
/// - `origins`: origin of the stored coordinates of each space
pub(super) fn spaces(objects: &[Vec<Object>], origins: impl Iterator<Item = DVec3>) -> Vec<Space<'_>> {
    let mut first_shape = 0;
    let mut spaces = vec![];
    for (objects, origin) in objects.iter().zip(origins) {
        spaces.push(Space { objects, first_shape, to_stored: Transform::translate(-origin).unwrap_or(Transform::IDENTITY) });
        first_shape += objects.len() as u32;
    }
    spaces
}

/// Copy of a shape of a group, for one of the group's instances.
pub(super) struct ShapeCopy<'a> {
    pub object: &'a Object,
    /// Index of the group's space.
    pub space: usize,
    to_world: AnimatedTransform,
    pub material: Option<MaterialId>,
}

/// Copies of all shapes with emission or a medium that instances show. Each of them is a light or a body of its own, so that sharing would save
/// little memory, and lights and media know nothing of instances.
///
/// - `objects`, `placements`: shapes and instances of each space; groups follow those that they show
///
/// # Errors
/// `Limit` for more than [`MAX_COPIES`].
pub(super) fn copies<'a>(objects: &'a [Vec<Object>], placements: &[Vec<Placement>]) -> Result<Vec<ShapeCopy<'a>>> {
    let mut has_copied = vec![false; objects.len()];
    for space in 1..objects.len() {
        let within = placements[space].iter().any(|placement| has_copied[placement.group.space()]);
        has_copied[space] = within || objects[space].iter().any(Object::is_copied);
    }
    let mut copies = vec![];
    let mut open = vec![(0, AnimatedTransform::from(Transform::IDENTITY), None)];
    while let Some((space, to_world, material)) = open.pop() {
        if space > 0 {
            let copied = objects[space].iter().filter(|object| object.is_copied());
            copies.extend(copied.map(|object| ShapeCopy { object, space, to_world: to_world.clone(), material }));
        }
        let shown = placements[space].iter().rev().filter(|placement| has_copied[placement.group.space()]);
        open.extend(shown.map(|p| (p.group.space(), p.to_outer.then(&to_world), material.or(p.material))));
        if copies.len() + open.len() > MAX_COPIES {
            let message = format!("instances show more than {MAX_COPIES} copies of shapes with emission or a medium");
            return Err(Error::Limit(Fault::new(message)));
        }
    }
    Ok(copies)
}

/// Copies that do not move, with the indices of their shapes and their transforms to the world.
pub(super) fn still<'c>(spaces: &[Space], copies: &'c [ShapeCopy]) -> impl Iterator<Item = (u32, &'c ShapeCopy<'c>, &'c Transform)> {
    let first = spaces.iter().map(Space::end).max().unwrap_or(0);
    (first..).zip(copies).filter_map(|(shape, copy)| match &copy.to_world {
        AnimatedTransform::Still(to_world) => Some((shape, copy, to_world)),
        AnimatedTransform::Moving(_) => None,
    })
}

/// Shapes of all spaces, in the order of their indices, and then the copies.
///
/// # Errors
/// `Invalid` for shapes that no ray can hit.
pub(super) fn baked(spaces: &[Space], copies: &[ShapeCopy]) -> Result<Arc<[Box<dyn Shape>]>> {
    let own = spaces.iter().flat_map(|space| {
        let bake = |object: &Object| object.geometry.bake(&object.to_outer.then(&space.to_stored));
        space.objects.iter().map(bake)
    });
    let copied = copies.iter().map(|copy| {
        // What moves stays in the space of its group.
        let to_stored = match &copy.to_world {
            AnimatedTransform::Still(to_world) => copy.object.to_outer.then(to_world).then(&spaces[0].to_stored),
            AnimatedTransform::Moving(_) => copy.object.to_outer.then(&spaces[copy.space].to_stored),
        };
        copy.object.geometry.bake(&to_stored)
    });
    Ok(own.chain(copied).collect::<Result<Vec<_>>>()?.into())
}

/// Hierarchy of the scene, with those of the groups in its instances.
pub(super) struct Hierarchies {
    pub scene: Box<dyn Primitive>,
    /// An instance of each space; `None` for the scene and for groups that no instance shows.
    pub shown: Vec<Option<InstanceId>>,
    /// Instance of each copy that moves, and how it moves.
    pub moving: Vec<Option<(InstanceId, Arc<EmitterMotion>)>>,
}

impl Hierarchies {
    /// Builds the hierarchies of all spaces.
    ///
    /// - `copies`: the last shapes
    /// - `left_out`: shapes of the scene, and copies, that rays do not hit
    ///
    /// # Errors
    /// `Limit` for more than 2³² − 2 instances with those within them, or more than [`MAX_NESTING`] within each other.
    pub fn new(
        spaces: &[Space],
        mut placements: Vec<Vec<Placement>>,
        shapes: &Arc<[Box<dyn Shape>]>,
        copies: &[ShapeCopy],
        left_out: &BTreeSet<u32>,
    ) -> Result<Hierarchies> {
        let mut groups: Vec<Arc<Group>> = vec![];
        let mut depths: Vec<usize> = vec![];
        for (space, placements) in spaces.iter().zip(&placements).skip(1) {
            let depth = 1 + placements.iter().map(|placement| depths[placement.group.index()]).max().unwrap_or(0);
            if depth > MAX_NESTING {
                return Err(Error::Limit(Fault::new(format!("more than {MAX_NESTING} instances within each other"))));
            }
            depths.push(depth);
            let is_copied = |shape: &u32| space.objects[(shape - space.first_shape) as usize].is_copied();
            let own = (space.first_shape..space.end()).filter(|shape| !is_copied(shape)).collect();
            let instances = instances(space, placements, &groups, spaces)?;
            let primitives = accel::build_with_instances(shapes.clone(), own, instances);
            groups.push(Arc::new(Group::new(primitives, space.first_shape..space.end())));
        }
        let last = spaces.iter().map(Space::end).max().unwrap_or(0);
        let copied = still(spaces, copies).map(|(shape, ..)| shape);
        let own = (0..spaces[0].end()).chain(copied).filter(|shape| !left_out.contains(shape)).collect();
        let mut instances = instances(&spaces[0], &placements[0], &groups, spaces)?;
        let mut moving = vec![];
        for (shape, copy) in (last..).zip(copies) {
            if !copy.to_world.is_moving() {
                moving.push(None);
                continue;
            }
            let number = numbered(instances.last().map_or(0, Instance::last).checked_add(1))?;
            let group = Group::new(accel::build_with_instances(shapes.clone(), vec![shape], vec![]), shape..shape + 1);
            let to_outer = spaces[copy.space].stored(&copy.to_world, &spaces[0]);
            let motion = Arc::new(EmitterMotion { to_world: to_outer.clone(), tolerance: group.tolerance() });
            instances.push(Instance::new(Arc::new(group), to_outer, None, number));
            moving.push(InstanceId::new(number).map(|id| (id, motion)));
        }
        let shown = shown(&placements, &groups);
        // Before the hierarchy takes memory: there may be millions of placements.
        placements.clear();
        Ok(Hierarchies { scene: accel::build_with_instances(shapes.clone(), own, instances), shown, moving })
    }
}

impl Space<'_> {
    /// Index after the last shape.
    fn end(&self) -> u32 {
        self.first_shape + self.objects.len() as u32
    }

    /// Transform between the coordinates in which shapes are stored, those of this space and those of `outer`.
    fn stored(&self, to_outer: &AnimatedTransform, outer: &Space) -> AnimatedTransform {
        AnimatedTransform::from(self.to_stored.inverse()).then(to_outer).then(&outer.to_stored.into())
    }
}

/// The number of an instance, if there is one.
fn numbered(number: Option<u32>) -> Result<u32> {
    number.ok_or_else(|| Error::Limit(Fault::new("instances within instances make more than 2^32 - 2 instances")))
}

/// Instances in a space, numbered from 1.
fn instances(space: &Space, placements: &[Placement], groups: &[Arc<Group>], spaces: &[Space]) -> Result<Vec<Instance>> {
    let mut next = 1u32;
    let instance = |placement: &Placement| {
        let (group, inner) = (&groups[placement.group.index()], &spaces[placement.group.space()]);
        let to_outer = inner.stored(&placement.to_outer, space);
        let first = next;
        next = numbered(group.instance_count().checked_add(1).and_then(|count| next.checked_add(count)))?;
        Ok(Instance::new(group.clone(), to_outer, placement.material, first))
    };
    placements.iter().map(instance).collect()
}

/// An instance of each space, see [`Hierarchies::shown`]: outer spaces first, so that the place of each is known when its groups follow.
fn shown(placements: &[Vec<Placement>], groups: &[Arc<Group>]) -> Vec<Option<InstanceId>> {
    let mut shown = vec![None; placements.len()];
    for outer in std::iter::once(0).chain((1..placements.len()).rev()) {
        let around = if outer == 0 { Some(0) } else { shown[outer].map(InstanceId::get) };
        let Some(mut next) = around.map(|number| number + 1) else { continue };
        for placement in &placements[outer] {
            let first = &mut shown[placement.group.space()];
            *first = first.or(InstanceId::new(next));
            next += 1 + groups[placement.group.index()].instance_count();
        }
    }
    shown
}
