//! Writes a mesh as OBJ or binary PLY. [`super::load`] reads the same mesh back.

use std::io::{self, Write};

use glam::Vec3;

use crate::shape::mesh_data::MeshData;

impl MeshData {
    /// Writes Wavefront OBJ with groups and material names. A triangle gets normals where all three of its corners have one.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_obj(&self, out: &mut dyn Write) -> io::Result<()> {
        // `{:?}` writes the shortest decimal that reads back as the same f32.
        self.positions.iter().try_for_each(|p| writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z))?;
        self.uvs.iter().try_for_each(|uv| writeln!(out, "vt {:?} {:?}", uv.x, uv.y))?;
        let up_if_flat = |n: &Vec3| if *n == Vec3::ZERO { Vec3::Z } else { *n };
        self.normals.iter().map(up_if_flat).try_for_each(|n| writeln!(out, "vn {:?} {:?} {:?}", n.x, n.y, n.z))?;
        for part in &self.parts {
            writeln!(out, "g {}", one_line(&part.group))?;
            writeln!(out, "usemtl {}", one_line(&part.material))?;
            for &triangle in &self.triangles[part.triangles.start as usize..part.triangles.end as usize] {
                let is_smooth = triangle.iter().all(|&i| self.normals.get(i as usize).is_some_and(|&n| n != Vec3::ZERO));
                write!(out, "f")?;
                for i in triangle.map(|i| i + 1) {
                    match (self.uvs.is_empty(), is_smooth) {
                        (true, false) => write!(out, " {i}")?,
                        (true, true) => write!(out, " {i}//{i}")?,
                        (false, false) => write!(out, " {i}/{i}")?,
                        (false, true) => write!(out, " {i}/{i}/{i}")?,
                    }
                }
                writeln!(out)?;
            }
        }
        Ok(())
    }

    /// Writes binary little-endian PLY. Parts are lost, since the format has no place for them.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_ply_binary(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut names = vec!["x", "y", "z"];
        if !self.normals.is_empty() {
            names.extend(["nx", "ny", "nz"]);
        }
        if !self.uvs.is_empty() {
            names.extend(["u", "v"]);
        }
        if !self.colors.is_empty() {
            names.extend(["red", "green", "blue", "alpha"]);
        }
        write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", self.positions.len())?;
        names.iter().try_for_each(|name| writeln!(out, "property float {name}"))?;
        writeln!(out, "element face {}\nproperty list uchar int vertex_indices\nend_header", self.triangles.len())?;
        for (i, position) in self.positions.iter().enumerate() {
            let normal = self.normals.get(i).map(Vec3::to_array);
            let uv = self.uvs.get(i).map(glam::Vec2::to_array);
            let color = self.colors.get(i).map(glam::Vec4::to_array);
            let numbers = position.to_array().into_iter().chain(normal.into_iter().flatten()).chain(uv.into_iter().flatten());
            numbers.chain(color.into_iter().flatten()).map(f32::to_le_bytes).try_for_each(|bytes| out.write_all(&bytes))?;
        }
        for triangle in &self.triangles {
            out.write_all(&[3])?;
            triangle.iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))?;
        }
        Ok(())
    }
}

fn one_line(name: &Option<String>) -> String {
    name.as_deref().unwrap_or_default().replace(|c: char| c.is_control(), " ")
}
