//! Shapes and instances as they are added, before anything is built.

use super::PartAppearance;
use crate::bsdf::MaterialId;
use crate::light::Emitter;
use crate::math::{AnimatedTransform, Transform};
use crate::medium::MediumId;
use crate::shape::{Geometry, Sdf};

/// Shapes, and instances of groups, in a common space: that of the scene, or of a group.
#[derive(Default)]
pub struct Objects {
    pub(super) shapes: Vec<Object>,
    pub(super) instances: Vec<Placement>,
    pub(super) moving: Vec<Moving>,
}

/// Shapes and instances that move together.
pub(super) struct Moving {
    pub objects: Objects,
    pub to_outer: AnimatedTransform,
    /// Number of shapes that were added before them.
    pub shapes_before: usize,
}

/// Shape with its transform to the common space, and the appearance of its parts.
pub(super) struct Object {
    pub geometry: Box<dyn Geometry>,
    pub to_outer: Transform,
    pub parts: Vec<PartAppearance>,
    /// Medium inside.
    pub medium: Option<MediumId>,
    /// Number among all shapes, in the order in which they were added.
    pub described: u32,
}

/// Group with its transform to the common space.
pub(super) struct Placement {
    pub group: GroupId,
    pub to_outer: AnimatedTransform,
    pub material: Option<MaterialId>,
}

/// Index of a group of a [`WorldBuilder`](super::WorldBuilder).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupId(pub(super) u32);

impl GroupId {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }

    /// Index of the group's space: that of the scene comes first.
    pub(super) fn space(self) -> usize {
        1 + self.index()
    }
}

impl Objects {
    /// Adds a shape with one material, which emits light if `emitter` is set.
    pub fn shape(&mut self, geometry: impl Geometry + 'static, to_outer: Transform, material: MaterialId, emitter: Option<Emitter>) {
        self.parts(geometry, to_outer, vec![material], emitter);
    }

    /// Adds a shape with one material per part; there must be at least one.
    pub fn parts(&mut self, geometry: impl Geometry + 'static, to_outer: Transform, materials: Vec<MaterialId>, emitter: Option<Emitter>) {
        let parts = materials.into_iter().map(|material| PartAppearance { material, emitter: emitter.clone() }).collect();
        self.shapes.push(Object { geometry: Box::new(geometry), to_outer, parts, medium: None, described: 0 });
    }

    /// Adds a solid whose parts may have different materials and emission.
    pub fn solid(&mut self, sdf: Sdf, to_outer: Transform, parts: Vec<PartAppearance>) {
        self.shapes.push(Object { geometry: Box::new(sdf), to_outer, parts, medium: None, described: 0 });
    }

    /// Fills the shape that was added last with a medium. The shape must be closed. The medium of a shape that moves has no effect. In a group,
    /// the density of the medium is in the space of the group, and its coefficients are per metre of the world.
    pub fn fill(&mut self, medium: MediumId) {
        if let Some(shape) = self.shapes.last_mut() {
            shape.medium = Some(medium);
        }
    }

    /// Adds an instance of a group. The group's shapes are stored once, however many instances there are.
    ///
    /// - `material`: material of all surfaces of the instance, instead of their own
    pub fn instance(&mut self, group: GroupId, to_outer: impl Into<AnimatedTransform>, material: Option<MaterialId>) {
        self.instances.push(Placement { group, to_outer: to_outer.into(), material });
    }

    /// Adds shapes and instances that move together. Their shapes must not have media.
    ///
    /// - `to_outer`: transform from their space to the common space
    pub fn moving(&mut self, objects: Objects, to_outer: AnimatedTransform) {
        let shapes_before = self.shapes.len();
        self.moving.push(Moving { objects, to_outer, shapes_before });
    }

    /// Number of instances, without those within them.
    pub fn instance_count(&self) -> usize {
        self.instances.len() + self.moving.iter().map(|moving| moving.objects.instance_count()).sum::<usize>()
    }

    /// Numbers the shapes in the order in which they were added.
    ///
    /// - `next`: number of the next shape
    pub(super) fn number(&mut self, next: &mut u32) {
        let mut moving = self.moving.iter_mut().peekable();
        for position in 0..=self.shapes.len() {
            while let Some(moving) = moving.next_if(|moving| moving.shapes_before == position) {
                moving.objects.number(next);
            }
            if let Some(shape) = self.shapes.get_mut(position) {
                shape.described = *next;
                *next += 1;
            }
        }
    }

    /// Adds all of some other objects.
    pub(super) fn append(&mut self, mut objects: Objects) {
        let before = self.shapes.len();
        self.shapes.append(&mut objects.shapes);
        self.instances.append(&mut objects.instances);
        self.moving.extend(objects.moving.into_iter().map(|moving| Moving { shapes_before: moving.shapes_before + before, ..moving }));
    }
}

impl Object {
    pub fn emits(&self) -> bool {
        self.parts.iter().any(|part| part.emitter.is_some())
    }

    /// Whether instances show copies of the shape, because each is a light or a body with a medium of its own.
    pub fn is_copied(&self) -> bool {
        self.emits() || self.medium.is_some()
    }
}
