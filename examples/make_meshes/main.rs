//! Makes the meshes and the hair of the demo scenes: `cargo run --release --example make_meshes`.
//!
//! Every number comes from arithmetic that is exact to the last bit on every machine (and pt's own sine and
//! cosine), so that the files are the same everywhere: a test compares them with those in `scenes/meshes/`.

mod flag;
mod fur;
mod jack;
mod pawn;
mod stack;
mod statue;
mod surface_nets;

use std::io;
use std::path::Path;

use pt::shape::mesh_data::MeshData;

/// Returns the names and contents of the files.
pub fn files() -> io::Result<Vec<(&'static str, Vec<u8>)>> {
    Ok(vec![
        ("flag-0.ply", ply(&flag::flag(0.0))?),
        ("flag-1.ply", ply(&flag::flag(0.7))?),
        ("flag-2.ply", ply(&flag::flag(1.4))?),
        ("fur.hair", fur::fur()),
        ("statue.ply", ply(&statue::statue())?),
        ("pawn.ply", ply(&pawn::pawn())?),
        ("jack.obj", obj(&jack::cage())?),
        ("triangle-stack.obj", obj(&stack::triangles())?),
        ("prism-stack.obj", obj(&stack::prisms())?),
    ])
}

fn ply(mesh: &MeshData) -> io::Result<Vec<u8>> {
    let mut bytes = vec![];
    mesh.write_ply_binary(&mut bytes)?;
    Ok(bytes)
}

fn obj(mesh: &MeshData) -> io::Result<Vec<u8>> {
    let mut bytes = vec![];
    mesh.write_obj(&mut bytes)?;
    Ok(bytes)
}

#[allow(dead_code)] // A test includes this file and calls only `files`.
fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes");
    std::fs::create_dir_all(&folder)?;
    for (name, bytes) in files()? {
        std::fs::write(folder.join(name), &bytes)?;
        println!("{name}: {} kB", bytes.len().div_ceil(1000));
    }
    Ok(())
}
