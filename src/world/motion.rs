//! Makes groups of the objects that move together, so that only instances move.

use super::objects::{GroupId, Objects, Placement};

/// The scene and all groups, without moving objects: those are groups of their own, of which there is one moving instance each. Each group
/// still follows those that it shows. Shapes are numbered as they were added, those of the scene first.
pub(super) fn as_instances(mut scene: Objects, mut groups: Vec<Objects>) -> (Objects, Vec<Objects>) {
    let mut next = 0;
    scene.number(&mut next);
    groups.iter_mut().for_each(|group| group.number(&mut next));
    let mut made = Made { groups: vec![], of_given: vec![] };
    for group in groups {
        let id = made.group(group);
        made.of_given.push(id);
    }
    let scene = made.still(scene);
    (scene, made.groups)
}

/// The groups that were made so far.
struct Made {
    groups: Vec<Objects>,
    /// Group that was made of each given one.
    of_given: Vec<GroupId>,
}

impl Made {
    /// Makes a group of objects, after groups of those among them that move.
    fn group(&mut self, objects: Objects) -> GroupId {
        let objects = self.still(objects);
        self.groups.push(objects);
        GroupId(self.groups.len() as u32 - 1)
    }

    /// Replaces what moves by instances.
    fn still(&mut self, objects: Objects) -> Objects {
        let Objects { shapes, mut instances, moving } = objects;
        instances.iter_mut().for_each(|placement| placement.group = self.of_given[placement.group.index()]);
        let moving =
            moving.into_iter().map(|moving| Placement { group: self.group(moving.objects), to_outer: moving.to_outer, material: None });
        instances.extend(moving);
        Objects { shapes, instances, moving: vec![] }
    }
}
