//! Makes instances of meshes that an imported scene shows several times, so that each is loaded once.

use std::collections::BTreeMap;

use crate::reader::{Member, Node, Value};

/// Replaces all shapes that show the same mesh file by instances of one group. Emitting shapes stay, because each is a light of its own.
pub fn share(root: &mut Node) {
    let Value::Object(members) = &mut root.value else { return };
    let Some(shapes) = members.iter().find(|member| member.key == "shapes") else { return };
    let mut shapes = shapes.node.clone();
    let mut meshes = own_groups(members);
    count(&shapes, &mut meshes);
    meshes.retain(|_, mesh| mesh.count > 1);
    if meshes.is_empty() {
        return;
    }
    let location = shapes.location.clone();
    let of_groups = |member: &Member| member.key == "groups";
    if !members.iter().any(of_groups) {
        let node = Node { value: Value::Object(vec![]), location: location.clone() };
        members.push(Member { key: "groups".into(), key_location: location, node });
    }
    for member in members.iter_mut() {
        if let (true, Value::Object(groups)) = (of_groups(member), &mut member.node.value) {
            replace(&mut shapes, &mut meshes, groups);
        }
    }
    members.iter_mut().filter(|member| member.key == "shapes").for_each(|member| member.node = shapes.clone());
}

/// A mesh that shapes show.
#[derive(Default)]
struct Mesh {
    count: u32,
    /// The name and the material of its group, when there is one.
    group: Option<(String, Option<Node>)>,
}

/// The meshes of groups that the scene already has, each of one mesh.
fn own_groups(members: &[Member]) -> BTreeMap<String, Mesh> {
    let groups = members.iter().find(|member| member.key == "groups").map(|member| &member.node.value);
    let Some(Value::Object(groups)) = groups else { return BTreeMap::new() };
    let mesh = |group: &Member| {
        let shape = group.node.child("0").filter(|shape| group.node.child("1").is_none() && shape.child("transform").is_none())?;
        Some((mesh_key(shape)?, Mesh { count: 1, group: Some((group.key.clone(), shape.child("material").cloned())) }))
    };
    groups.iter().filter_map(mesh).collect()
}

/// Counts the shapes that show each mesh.
fn count(shapes: &Node, meshes: &mut BTreeMap<String, Mesh>) {
    let Value::Array(shapes) = &shapes.value else { return };
    for shape in shapes {
        if let Some(key) = mesh_key(shape) {
            meshes.entry(key).or_default().count += 1;
        }
        shape.child("shapes").into_iter().for_each(|inner| count(inner, meshes));
    }
}

/// Key that is equal for shapes which can share a group: everything but name and transform, and but the material if there is only one,
/// because instances can replace it. `None` if the shape shows no mesh file, or emits light.
fn mesh_key(shape: &Node) -> Option<String> {
    let Value::Object(members) = &shape.value else { return None };
    let is_mesh = shape.child("type").and_then(Node::as_str) == Some("mesh") && shape.child("file").is_some();
    if !is_mesh || shape.child("emission").is_some() {
        return None;
    }
    let has_one_material = shape.child("material").is_some() && shape.child("materials").is_none();
    let is_own = |key: &str| matches!(key, "name" | "transform") || (key == "material" && has_one_material);
    let mut texts: Vec<String> = members.iter().filter(|m| !is_own(&m.key)).map(|m| format!("{}: {}", m.key, m.node)).collect();
    texts.sort();
    texts.extend(has_one_material.then(|| "any material".into()));
    Some(texts.join("\n"))
}

/// Replaces the shapes of meshes by instances, and adds their groups.
fn replace(shapes: &mut Node, meshes: &mut BTreeMap<String, Mesh>, groups: &mut Vec<Member>) {
    let Value::Array(shapes) = &mut shapes.value else { return };
    for shape in shapes {
        if let Some(mesh) = mesh_key(shape).and_then(|key| meshes.get_mut(&key)) {
            *shape = instance(shape, mesh, groups);
        } else if let Value::Object(members) = &mut shape.value {
            members.iter_mut().filter(|member| member.key == "shapes").for_each(|inner| replace(&mut inner.node, meshes, groups));
        }
    }
}

/// Instances of a mesh in the place of a shape. The first shape of a mesh becomes its group.
fn instance(shape: &Node, mesh: &mut Mesh, groups: &mut Vec<Member>) -> Node {
    let made = |value: Value| Node { value, location: shape.location.clone() };
    let member = |key: &str, node: Node| Member { key: key.into(), key_location: shape.location.clone(), node };
    let Value::Object(members) = &shape.value else { return shape.clone() };
    let (group, material) = mesh.group.get_or_insert_with(|| {
        let file = shape.child("file").and_then(Node::as_str).unwrap_or_default();
        let is_taken = |name: &String| groups.iter().any(|group| group.key == *name);
        let name = (1..).map(|n| if n == 1 { file.to_owned() } else { format!("{file} ({n})") }).find(|name| !is_taken(name));
        let name = name.unwrap_or_default();
        let shown = members.iter().filter(|m| !matches!(m.key.as_str(), "name" | "transform")).cloned();
        groups.push(member(&name, made(Value::Array(vec![made(Value::Object(shown.collect()))]))));
        (name, shape.child("material").cloned())
    });
    let mut instance = vec![member("type", made(Value::String("instances".into()))), member("group", made(Value::String(group.clone())))];
    instance.extend(members.iter().filter(|m| matches!(m.key.as_str(), "name" | "transform")).cloned());
    let own = members.iter().find(|m| m.key == "material").filter(|m| Some(&m.node) != material.as_ref());
    instance.extend(own.cloned());
    made(Value::Object(instance))
}
