//! Conversion of the file's scene, node by node.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{BVec3, DMat4, Vec3};

use super::bent;
use super::document::Document;
use super::instances::NOT_SHOWN;
use super::material::{Colors, PreparedMaterial};
use super::pose::Poses;
use crate::describe::mesh::points;
use crate::import::auto_camera;
use crate::import::json_cursor::JsonCursor;
use crate::import::view::{ASPECT, Bounds, MissingParts};
use crate::reader::Node;
use crate::shape::MeshData;

/// pt's tree of the file's scene; `None` with a fault noted.
pub fn scene(document: &Document) -> Option<Node> {
    let poses = Poses::new(document)?;
    let mut found = SceneBuilder {
        document,
        poses: &poses,
        meshes: BTreeMap::new(),
        materials: BTreeMap::new(),
        names: vec![],
        shapes: vec![],
        groups: BTreeMap::new(),
        lights: vec![],
        cameras: vec![],
        lit: false,
        bounds: Bounds::empty(&document.root.context().auto_camera),
    };
    for node in scene_nodes(document) {
        found.node(&node);
    }
    Some(found.root())
}

/// Nodes of the default scene, or of the first one, or all nodes; parents before their children, in the order of the file.
fn scene_nodes<'a>(document: &Document<'a>) -> Vec<gltf::Node<'a>> {
    let gltf = document.gltf;
    let Some(scene) = gltf.default_scene().or_else(|| gltf.scenes().next()) else { return gltf.nodes().collect() };
    if gltf.scenes().len() > 1 {
        let index = scene.index();
        document.note(&document.at(&["scenes"]), format!("of {} scenes number {index} is shown, counted from 0", gltf.scenes().len()));
    }
    let mut nodes = vec![];
    let mut open: Vec<_> = scene.nodes().collect();
    open.reverse();
    while let Some(node) = open.pop() {
        let children: Vec<_> = node.children().collect();
        open.extend(children.into_iter().rev());
        nodes.push(node);
    }
    nodes
}

/// Transform with one step, or with keyframes of it if there are several times.
pub fn transform(at: &JsonCursor, moments: &[(f64, DMat4)], step: impl Fn(&DMat4) -> Node) -> Node {
    if let [(_, to_world)] = moments {
        return at.make_array([step(to_world)]);
    }
    let keyframe =
        |(time, to_world): &(f64, DMat4)| at.make_object([("time", at.make_number(*time)), ("transform", at.make_array([step(to_world)]))]);
    at.make_array([at.make_object([("keyframes", at.make_array(moments.iter().map(keyframe)))])])
}

/// Mesh file of a primitive.
#[derive(Clone)]
struct MeshFile {
    file: String,
    positions: Arc<[Vec3]>,
    is_posed: bool,
    /// Files of the mesh at several times, if skins or morph targets bend it while the shutter is open.
    keyframes: Vec<(f64, String)>,
}

/// State of the conversion.
struct SceneBuilder<'d, 'a> {
    document: &'d Document<'a>,
    poses: &'d Poses,
    /// Mesh files by mesh, primitive, and the node if its pose changes the mesh.
    meshes: BTreeMap<(usize, usize, Option<usize>), Option<MeshFile>>,
    /// Names and materials, by index and vertex colours.
    materials: BTreeMap<(Option<usize>, Colors), (String, PreparedMaterial)>,
    /// Names of the materials.
    names: Vec<String>,
    shapes: Vec<Node>,
    /// Groups of one mesh, by its file.
    groups: BTreeMap<String, Node>,
    lights: Vec<Node>,
    /// Cameras with the ratio of width to height and their index.
    cameras: Vec<(Node, f64, usize)>,
    /// Whether a surface lights the scene.
    lit: bool,
    bounds: Bounds,
}

impl SceneBuilder<'_, '_> {
    fn node(&mut self, node: &gltf::Node) {
        let to_world = self.poses.of(node);
        if let Some(mesh) = node.mesh() {
            mesh.primitives().for_each(|primitive| self.primitive(node, &mesh, &primitive));
        }
        if let Some(camera) = node.camera() {
            let described = self.document.camera(&camera, node, &to_world);
            self.cameras.extend(described.map(|(described, aspect)| (described, aspect, camera.index())));
        }
        if let Some(light) = self.document.light(node, &to_world) {
            self.lights.push(light);
        }
    }

    fn primitive(&mut self, node: &gltf::Node, mesh: &gltf::Mesh, primitive: &gltf::Primitive) {
        let material_key = (primitive.material().index(), Colors::of(primitive));
        self.read_material(material_key);
        let Some((name, prepared)) = self.materials.get(&material_key) else { return };
        let pose = &self.poses.middle;
        let has_weights = node.weights().is_some() || pose.weights(node).is_some();
        let own_pose = (node.skin().is_some() || has_weights).then_some(node.index());
        let key = (mesh.index(), primitive.index(), own_pose);
        let made = match self.meshes.get(&key) {
            Some(known) => known.clone(),
            None => {
                let made = self.write_mesh(node, mesh, primitive, prepared, own_pose);
                self.meshes.insert(key, made.clone());
                made
            }
        };
        let Some(made) = made else { return };
        let at = self.document.item("nodes", node.index());
        let moments = if made.is_posed { vec![(0.0, DMat4::IDENTITY)] } else { self.shown(node) };
        let Some((_, to_world)) = moments.get(moments.len() / 2).copied() else {
            self.document.note(&at, NOT_SHOWN);
            return;
        };
        let Some(instances) = self.document.instances(node) else { return };
        let places = self.places(node, mesh, primitive, prepared, &made);
        self.lit |= prepared.is_lamp;
        let mut shown = vec![("file", at.make_text(&*made.file)), ("material", at.make_text(name))];
        shown.extend(prepared.emission.clone().map(|emission| ("emission", emission)));
        let keyframe = |(time, file): &(f64, String)| at.make_object([("time", at.make_number(*time)), ("file", at.make_text(&**file))]);
        let keyframes = (!made.keyframes.is_empty()).then(|| at.make_array(made.keyframes.iter().map(keyframe)));
        shown.extend(keyframes.map(|keyframes| ("keyframes", keyframes)));
        let mut members = vec![];
        members.extend(node.name().or(mesh.name()).map(|name| ("name", at.make_text(name))));
        match instances {
            None => {
                members.extend([("type", at.make_text("mesh"))].into_iter().chain(shown));
                match &places {
                    None => made.positions.iter().for_each(|p| self.bounds.add(to_world.transform_point3(p.as_dvec3()))),
                    Some(places) => places.iter().for_each(|(to_world, ends)| self.add_box(to_world, *ends)),
                }
            }
            Some(points) => {
                let shape = at.make_object([("type", at.make_text("mesh"))].into_iter().chain(shown));
                self.groups.entry(made.file.clone()).or_insert_with(|| at.make_array([shape]));
                let file = self.document.made_name(&format!("instances-{}", node.index()), "ply");
                self.document.root.context().make(&*file, points::ply_binary(&points));
                let instances = [("type", "instances"), ("group", &made.file), ("file", &file)];
                members.extend(instances.map(|(key, value)| (key, at.make_text(value))));
                let places = places.unwrap_or_else(|| vec![(to_world, box_of(&made.positions))]);
                let instances = points.iter().flat_map(|point| places.iter().map(|(to_world, ends)| (*to_world * point.matrix(), *ends)));
                // Boxes, because looking at all vertices of all instances may take long.
                instances.for_each(|(to_world, ends)| self.add_box(&to_world, ends));
            }
        }
        if moments.iter().any(|(_, to_world)| *to_world != DMat4::IDENTITY) {
            // Row by row.
            let matrix = |to_world: &DMat4| at.make_object([("matrix", at.make_numbers(to_world.transpose().to_cols_array()))]);
            members.push(("transform", transform(&at, &moments, matrix)));
        }
        self.shapes.push(at.make_object(members));
    }

    /// Transforms of a node at several times, none if it is scaled to nothing. What is scaled to nothing for a part of the exposure stands
    /// still.
    fn shown(&self, node: &gltf::Node) -> Vec<(f64, DMat4)> {
        let moments = self.poses.of(node);
        let is_shown = |(_, to_world): &(f64, DMat4)| to_world.determinant() != 0.0;
        if moments.iter().all(is_shown) {
            return moments;
        }
        let still: Option<(f64, DMat4)> = moments.iter().copied().find(is_shown);
        if still.is_some() {
            let at = self.document.item("nodes", node.index());
            self.document.note(&at, "its scale is 0 during a part of the exposure: it is shown at rest, for the whole exposure");
        }
        still.into_iter().collect()
    }

    /// Boxes of what a node shows during the animations, with their transforms to the world; `None` if it does not move. The bounds of the
    /// scene hold all of them, so that the camera stands still in a sequence.
    fn places(
        &self,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        prepared: &PreparedMaterial,
        made: &MeshFile,
    ) -> Option<Vec<(DMat4, [Vec3; 2])>> {
        let poses = self.poses.all();
        if made.is_posed {
            let posed = |pose| self.document.geometry(node, mesh, primitive, &prepared.mapping, pose);
            let boxes: Vec<_> = poses.iter().filter_map(posed).map(|of| (DMat4::IDENTITY, box_of(&of.mesh.positions))).collect();
            return (!boxes.is_empty()).then_some(boxes);
        }
        let moves = poses.windows(2).any(|pair| pair[0].of(node) != pair[1].of(node));
        let own = box_of(&made.positions);
        moves.then(|| poses.iter().map(|pose| (pose.of(node), own)).collect())
    }

    /// Adds the corners of a box to the bounds.
    fn add_box(&mut self, to_world: &DMat4, [low, high]: [Vec3; 2]) {
        for k in 0..8 {
            let corner = Vec3::select(BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low);
            self.bounds.add(to_world.transform_point3(corner.as_dvec3()));
        }
    }

    /// Reads a material, once.
    fn read_material(&mut self, material_key: (Option<usize>, Colors)) {
        if self.materials.contains_key(&material_key) {
            return;
        }
        let (index, colors) = material_key;
        let given = index.and_then(|i| self.document.gltf.materials().nth(i)).and_then(|material| material.name().map(str::to_owned));
        let otherwise = index.map_or("default".to_owned(), |i| format!("material {i}"));
        let name = given.filter(|name| !name.is_empty() && !self.names.contains(name)).unwrap_or(otherwise);
        let name = if self.names.contains(&name) { format!("{name} ({})", self.names.len()) } else { name };
        self.names.push(name.clone());
        self.materials.insert(material_key, (name, self.document.material(index, colors)));
    }

    /// Writes the triangles as a file, and as one for each pose that they need; `None` if there are none.
    fn write_mesh(
        &self,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        prepared: &PreparedMaterial,
        own_pose: Option<usize>,
    ) -> Option<MeshFile> {
        let geometry = self.document.geometry(node, mesh, primitive, &prepared.mapping, &self.poses.middle)?;
        let of_node = own_pose.map_or(String::new(), |node| format!("-node-{node}"));
        let name = format!("mesh-{}-{}{of_node}", mesh.index(), primitive.index());
        let file = self.write(&name, &geometry.mesh)?;
        let bent = match own_pose {
            Some(_) => bent::poses(&geometry.mesh, self.poses.keys(), |pose| {
                Some(self.document.geometry(node, mesh, primitive, &prepared.mapping, pose)?.mesh)
            }),
            None => Some(vec![]),
        };
        if bent.is_none() {
            let at = self.document.item("nodes", node.index());
            self.document.note(&at, "in some poses triangles have no area: the mesh is shown at rest, as in the middle of the exposure");
        }
        let written = |(k, (time, mesh)): (usize, (f64, MeshData))| Some((time, self.write(&format!("{name}-pose-{k}"), &mesh)?));
        let keyframes = bent.into_iter().flatten().enumerate().map(written).collect::<Option<_>>()?;
        Some(MeshFile { file, positions: geometry.mesh.positions.into(), is_posed: geometry.is_posed, keyframes })
    }

    /// Writes a mesh and returns the name of its file.
    fn write(&self, name: &str, mesh: &MeshData) -> Option<String> {
        let file = self.document.made_name(name, "ply");
        let mut bytes = vec![];
        mesh.write_ply_binary(&mut bytes).ok()?;
        self.document.root.context().make(&*file, bytes);
        Some(file)
    }

    fn root(mut self) -> Node {
        let at = self.document.root.clone();
        if self.shapes.is_empty() {
            at.note("no triangles: the picture shows nothing of the model");
        }
        let bounds = self.bounds.or_unit();
        let own = self.camera();
        let camera = own.as_ref().map_or_else(|| auto_camera::camera(&at, &bounds), |(camera, _)| camera.clone());
        let placed = camera.child("look_at").filter(|_| own.is_none()).cloned();
        at.context().set_missing(MissingParts { bounds, placed, light: self.lights.is_empty() && !self.lit });
        let film = auto_camera::film(&at, own.map_or(ASPECT, |(_, aspect)| aspect));
        let mut root = vec![("pt", at.make_number(1.0)), ("camera", camera), ("film", film)];
        let materials: Vec<(String, Node)> = self.materials.into_values().map(|(name, prepared)| (name, prepared.node)).collect();
        root.push(("materials", at.make_object(materials)));
        root.push(("lights", at.make_array(self.lights)));
        if !self.groups.is_empty() {
            root.push(("groups", at.make_object(self.groups)));
        }
        root.push(("shapes", at.make_array(self.shapes)));
        at.make_object(root)
    }

    /// First camera, with the ratio of width to height of its picture; `None` if there is none, or if another view is requested.
    fn camera(&mut self) -> Option<(Node, f64)> {
        let at = self.document.at(&["cameras"]);
        let auto_camera = &self.document.root.context().auto_camera;
        if auto_camera.view.is_some() || auto_camera.up.is_some() {
            return None;
        }
        if self.cameras.len() > 1 {
            let others: Vec<String> = self.cameras[1..].iter().take(8).map(|(.., index)| index.to_string()).collect();
            self.document.note(&at, format!("the first camera of the scene is used, not {}", others.join(", ")));
        }
        self.cameras.first().map(|(camera, aspect, _)| (camera.clone(), *aspect))
    }
}

/// The least and the greatest coordinates of points.
fn box_of(points: &[Vec3]) -> [Vec3; 2] {
    points.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], p| [low.min(*p), high.max(*p)])
}
