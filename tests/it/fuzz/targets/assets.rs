//! Files that scenes name: meshes, pictures, lamps, points and libraries of materials.

use std::collections::HashSet;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use pt::describe::mesh;
use pt::glam::DVec3;
use pt::output::{Format, Tonemap, facts, hash, read, write};
use pt::rays::{Ray, RayCaster};

use super::{judged, scene};

/// Renders a fixed scene, one of whose files has these bytes.
pub fn within(at: &Path, name: &str, bytes: &[u8], scene: &str) -> Result<bool, String> {
    let path = at.join(name);
    let before = fs::read(&path).unwrap_or_default();
    fs::write(&path, bytes).expect("write");
    let answer = scene::render_file(&at.join(scene));
    fs::write(&path, before).expect("write");
    answer
}

/// A mesh in a scene, in a ray caster, and written again: what is read from that is the same, but for triangles that several parts have.
pub fn mesh(at: &Path, bytes: &[u8]) -> Result<bool, String> {
    within(at, "mesh.obj", bytes, "mesh.json")?;
    let path = at.join("cast.obj");
    fs::write(&path, bytes).expect("write");
    if let Some((caster, _)) = judged(RayCaster::load(&path))? {
        for triangle in 0..caster.len().min(8) as u32 {
            let corners = caster.corners(triangle);
            let target = corners.iter().sum::<DVec3>() / 3.0;
            let ray = Ray::new(corners[0] * 2.0 - target + DVec3::Z, target - corners[0] - DVec3::Z);
            let hits = caster.all(&ray);
            if hits.first().map(|hit| hit.t) != caster.closest(&ray).map(|hit| hit.t) || hits.iter().any(|hit| hit.t.is_nan()) {
                return Err(format!("hits of {ray:?}: {hits:?}"));
            }
            caster.winding(target);
        }
    }
    let Some((mesh, _)) = judged(mesh::read(Cursor::new(bytes), "mesh"))? else { return Ok(false) };
    let mut written = vec![];
    mesh.write_ply_binary(&mut written).expect("memory takes it");
    let (again, _) = mesh::read(Cursor::new(&written), "again").map_err(|e| format!("pt's own file: {e}"))?;
    // A PLY file has no parts, and of triangles of one part with the same corners, in any rotation, only the first is kept.
    let once = |mesh: &pt::shape::MeshData| {
        let mut known = HashSet::new();
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| mesh.positions[vertex as usize].to_array().map(f32::to_bits));
        let is_new =
            |&[a, b, c]: &[[u32; 3]; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().is_some_and(|least| known.insert(least));
        mesh.triangles.iter().map(corners).filter(is_new).collect::<Vec<_>>()
    };
    let [found, expected] = [&again, &mesh].map(once);
    if found == expected { Ok(true) } else { Err(format!("another mesh was written: {found:?}, not {expected:?}")) }
}

/// A picture for `pt image`: read, described, hashed, and written in all formats.
pub fn picture(at: &Path, bytes: &[u8]) -> Result<bool, String> {
    let path = at.join("picture");
    fs::write(&path, bytes).expect("write");
    let answer = judged(read(&path))?;
    let Some((image, attributes)) = answer else { return Ok(false) };
    judged(facts(&path))?;
    hash(&image);
    // Large pictures are read in the same way as small ones, and written more slowly.
    if image.size.element_product() > 1 << 12 {
        return Ok(false);
    }
    for extension in Format::EXTENSIONS.split([' ', ',']).filter(|word| word.starts_with('.')) {
        judged(write(&at.join(format!("again{extension}")), &image, &attributes, &Tonemap::default()))?;
    }
    let (again, _) = read(&at.join("again.exr")).map_err(|e| format!("pt's own file: {e}"))?;
    if again.size == image.size { Ok(true) } else { Err(format!("{} became {}", image.size, again.size)) }
}
