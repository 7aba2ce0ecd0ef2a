//! Conversion of the file's scene, node by node.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat4, Vec3};

use super::document::Document;
use super::material::{Colors, PreparedMaterial};
use super::pose::Pose;
use crate::import::auto_camera;
use crate::import::view::{ASPECT, Bounds, MissingParts};
use crate::reader::Node;

/// pt's tree of the file's scene; `None` with a fault noted.
pub fn scene(document: &Document) -> Option<Node> {
    let pose = Pose::new(document)?;
    let mut found = SceneBuilder {
        document,
        pose: &pose,
        meshes: BTreeMap::new(),
        materials: BTreeMap::new(),
        names: vec![],
        shapes: vec![],
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

/// Mesh file of a primitive.
#[derive(Clone)]
struct MeshFile {
    file: String,
    positions: Arc<[Vec3]>,
    is_posed: bool,
}

/// State of the conversion.
struct SceneBuilder<'d, 'a> {
    document: &'d Document<'a>,
    pose: &'d Pose,
    /// Mesh files by mesh, primitive, and the node if its pose changes the mesh.
    meshes: BTreeMap<(usize, usize, Option<usize>), Option<MeshFile>>,
    /// Names and materials, by index and vertex colours.
    materials: BTreeMap<(Option<usize>, Colors), (String, PreparedMaterial)>,
    /// Names of the materials.
    names: Vec<String>,
    shapes: Vec<Node>,
    lights: Vec<Node>,
    /// Cameras with the ratio of width to height and their index.
    cameras: Vec<(Node, f64, usize)>,
    /// Whether a surface lights the scene.
    lit: bool,
    bounds: Bounds,
}

impl SceneBuilder<'_, '_> {
    fn node(&mut self, node: &gltf::Node) {
        let to_world = self.pose.of(node);
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
        let own_pose = (node.skin().is_some() || node.weights().is_some()).then_some(node.index());
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
        let own = if made.is_posed { DMat4::IDENTITY } else { self.pose.of(node) };
        self.lit |= prepared.is_lamp;
        for instance in self.document.instances(node).unwrap_or_default() {
            let to_world = own * instance;
            let shape = self.placed(node, mesh, &made, (name, prepared), &to_world);
            if shape.is_some() {
                made.positions.iter().for_each(|p| self.bounds.add(to_world.transform_point3(p.as_dvec3())));
            }
            self.shapes.extend(shape);
        }
    }

    /// Shape of an instance of a primitive; `None` if it is scaled to nothing, with a note.
    fn placed(
        &self,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        made: &MeshFile,
        (name, prepared): (&str, &PreparedMaterial),
        to_world: &DMat4,
    ) -> Option<Node> {
        let at = self.document.item("nodes", node.index());
        if to_world.determinant() == 0.0 {
            self.document.note(&at, "what is scaled to nothing is left out: it does not show");
            return None;
        }
        let mut members = vec![("type", at.make_text("mesh"))];
        members.extend(node.name().or(mesh.name()).map(|name| ("name", at.make_text(name))));
        members.extend([("file", at.make_text(&*made.file)), ("material", at.make_text(name))]);
        members.extend(prepared.emission.clone().map(|emission| ("emission", emission)));
        if *to_world != DMat4::IDENTITY {
            // Row by row.
            let matrix = at.make_numbers(to_world.transpose().to_cols_array());
            members.push(("transform", at.make_array([at.make_object([("matrix", matrix)])])));
        }
        Some(at.make_object(members))
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

    /// Writes the triangles as a file; `None` if there are none.
    fn write_mesh(
        &self,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        prepared: &PreparedMaterial,
        own_pose: Option<usize>,
    ) -> Option<MeshFile> {
        let geometry = self.document.geometry(node, mesh, primitive, &prepared.mapping, self.pose)?;
        let of_node = own_pose.map_or(String::new(), |node| format!("-node-{node}"));
        let file = self.document.made_name(&format!("mesh-{}-{}{of_node}", mesh.index(), primitive.index()), "ply");
        let mut bytes = vec![];
        geometry.mesh.write_ply_binary(&mut bytes).ok()?;
        self.document.root.context().make(&*file, bytes);
        Some(MeshFile { file, positions: geometry.mesh.positions.into(), is_posed: geometry.is_posed })
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
