//! Loads meshes, from files or from the scene file, and chooses the material of each of their parts.

use glam::{DVec3, Vec2, Vec3};

use super::Builder;
use crate::bsdf::MaterialId;
use crate::describe::{MaterialRef, Mesh, identity};
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::math::Transform;
use crate::reader::{escaped, locate, unknown};
use crate::shape::{MeshData, MeshPart};

impl Builder<'_> {
    /// Loads a mesh from its file, or from the scene file, subdivides it and displaces it. Returns `None` after adding a fault.
    ///
    /// # Errors
    /// `Io` where the file cannot be read; `Limit` where the file has, or subdivision makes, too many triangles.
    pub(super) fn mesh(&mut self, pointer: &str, mesh: &Mesh, to_world: &Transform) -> Result<Option<MeshData>> {
        let Some(data) = self.loaded(pointer, mesh)? else { return Ok(None) };
        let Some(data) = self.subdivided(pointer, mesh, data)? else { return Ok(None) };
        Ok(match &mesh.displacement {
            Some(described) => self.displaced(&format!("{pointer}/displacement"), described, data, to_world),
            None => Some(data),
        })
    }

    /// Loads a mesh from its file, or from the scene file. Returns `None` after adding a fault.
    ///
    /// # Errors
    /// `Io` where the file cannot be read; `Limit` where it has too many triangles.
    pub(super) fn loaded(&mut self, pointer: &str, mesh: &Mesh) -> Result<Option<MeshData>> {
        let loaded = match &mesh.file {
            Some(file) => self.source.files.mesh(file),
            None => inline(mesh, pointer),
        };
        match loaded {
            Ok((data, warnings)) => {
                self.warn_once(warnings);
                self.contents.extend(mesh.file.clone().map(|file| (file, identity::of_mesh(&data))));
                Ok(Some(data))
            }
            Err(Error::Invalid(faults)) => {
                match &mesh.file {
                    Some(file) => self.file_faults(&format!("{pointer}/file"), file, faults),
                    None => faults.into_iter().for_each(|fault| self.fault(pointer, &fault.message)),
                }
                Ok(None)
            }
            Err(other) => Err(other),
        }
    }

    fn subdivided(&mut self, pointer: &str, mesh: &Mesh, data: MeshData) -> Result<Option<MeshData>> {
        let at = format!("{pointer}/subdivision_levels");
        match data.subdivided(mesh.subdivision_levels.get()) {
            Ok(data) => return Ok(Some(data)),
            Err(Error::Invalid(faults)) => faults.iter().for_each(|fault| self.fault(&at, &fault.message)),
            Err(Error::Limit(fault)) => return Err(Error::Limit(locate(self.source.root, self.source.file, &at, fault.message))),
            Err(other) => return Err(other),
        }
        Ok(None)
    }

    /// Adds the faults of a file that the scene names. One with a line number is about the file, any other about the scene.
    pub(super) fn file_faults(&mut self, pointer: &str, file: &str, faults: Vec<Fault>) {
        for fault in faults {
            match fault.line {
                Some(_) => self.faults.push(fault),
                None => self.fault(pointer, &format!("{file}: {}", fault.message)),
            }
        }
    }

    /// Adds warnings about a file. One that several shapes use is warned about once.
    pub(super) fn warn_once(&mut self, warnings: Vec<String>) {
        let new: Vec<String> = warnings.into_iter().filter(|warning| !self.warnings.contains(warning)).collect();
        self.warnings.extend(new);
    }

    /// Warns about triangles where a normal or bump map has no effect, because their texture coordinates are degenerate.
    pub(super) fn note_no_relief(&mut self, pointer: &str, data: &MeshData) {
        let (flat, all) = (data.flat_uvs(), data.triangles.len());
        if flat > 0 {
            let message =
                format!("the texture coordinates of {flat} of {all} triangles span no area: normal and bump maps have no effect there");
            self.warnings.push(format!("{}: {pointer}: {message}", self.source.file));
        }
    }

    /// The material of each part of a mesh: the one that `materials` gives for the part's material name; otherwise the mesh's own
    /// `material`, or without one the scene's material of that name.
    pub(super) fn part_materials(&mut self, pointer: &str, mesh: &Mesh, data: &MeshData, own: MaterialId) -> (Vec<MaterialId>, Effects) {
        let mut effects = Effects::NONE;
        let mut materials = vec![];
        let names: Vec<&str> = data.parts.iter().filter_map(|part| part.material.as_deref()).collect();
        for unused in mesh.materials.keys().filter(|key| !names.contains(&key.as_str())) {
            let no_such = unknown("material", unused, &names).replacen("unknown", "no", 1);
            self.warnings.push(format!("{pointer}/materials: the mesh has {no_such}"));
        }
        for part in &data.parts {
            let name = part.material.as_deref().unwrap_or_default();
            let mapped = mesh.materials.get(name).cloned();
            let same = self.scene.materials.contains_key(name).then(|| MaterialRef::Named(name.into()));
            let chosen = mapped.or(if mesh.material.is_none() { same } else { None });
            materials.push(match chosen {
                Some(chosen) => {
                    let (_, (id, more)) = self.material(&format!("{pointer}/materials{}", escaped(name)), Some(&chosen));
                    effects |= more;
                    id
                }
                None => own,
            });
        }
        if materials.is_empty() {
            materials.push(own);
        }
        (materials, effects)
    }
}

/// Converts a mesh that is given in the scene file itself.
fn inline(mesh: &Mesh, name: &str) -> Result<(MeshData, Vec<String>)> {
    let vec3 = |v: &[f64; 3]| DVec3::from(*v).as_vec3();
    let triangles = mesh.triangles.clone().unwrap_or_default();
    let whole = MeshPart { triangles: 0..triangles.len() as u32, ..Default::default() };
    let data = MeshData {
        positions: mesh.positions.iter().flatten().map(|p| vec3(&p.0)).collect(),
        normals: mesh.normals.iter().flatten().map(|n| vec3(&n.0)).collect(),
        uvs: mesh.uvs.iter().flatten().map(|uv| Vec2::new(uv[0].get() as f32, uv[1].get() as f32)).collect(),
        colors: mesh.colors.iter().flatten().map(|color| Vec3::from(color.linear().map(|c| c as f32)).extend(1.0)).collect(),
        triangles,
        parts: vec![whole],
    };
    data.usable(0, name)
}
