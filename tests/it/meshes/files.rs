//! Meshes in the file system: names, kinds of files, formats by content, libraries.

use super::*;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn load(path: &Path) -> Read {
    mesh::load(path, "mesh")
}

fn refusal(path: &Path) -> (u8, String) {
    let error = load(path).expect_err("refused");
    (error.exit_code(), error.to_string())
}

#[test]
fn names_of_any_kind_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let long = "x".repeat(251) + ".obj";
    for name in ["seinät.obj", "🫖.obj", "a b.obj", "-o.obj", "UPPER.OBJ", &long] {
        let (mesh, warnings) = load(&write_to(folder.path(), name, TRIANGLE)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((mesh.triangles.len(), warnings.len()), (1, 0), "{name}");
    }
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let path = folder.path().join(std::ffi::OsStr::from_bytes(b"\xff\xfe.obj"));
        std::fs::write(&path, TRIANGLE).expect("Linux takes any bytes");
        assert!(load(&path).is_ok());
    }
}

#[test]
fn what_is_no_regular_file_is_refused_at_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert_eq!(refusal(&folder.path().join("none.obj")), (3, "mesh: no such file".to_string()));
    assert_eq!(refusal(&write_to(folder.path(), "a.obj", "").join("b.obj")), (3, "mesh: no such file".to_string()));
    assert_eq!(refusal(Path::new("a\0b.obj")), (3, "mesh: not a file name".to_string()));
    let not_regular = (3, "mesh: not a regular file".to_string());
    assert_eq!(refusal(folder.path()), not_regular);
    #[cfg(unix)]
    {
        let pipe = folder.path().join("pipe.obj");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs");
        assert!(made.success());
        assert_eq!(refusal(&pipe), not_regular);
        assert_eq!(refusal(Path::new("/dev/zero")), not_regular);
    }
}

#[test]
fn content_decides_the_format() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut ply = Vec::new();
    mesh_of(TRIANGLE).write_ply_binary(&mut ply).expect("memory takes it");
    for name in ["a.obj", "a.stl", "a"] {
        let (mesh, warnings) = load(&write_to(folder.path(), name, &ply)).expect("PLY by content");
        assert_eq!((mesh.triangles.len(), &warnings[..]), (1, &["mesh: read as PLY, which its content says it is".to_string()][..]));
    }
    assert_eq!(load(&write_to(folder.path(), "a.PLY", &ply)).expect("PLY").1, [""; 0]);
    let other = refusal(&write_to(folder.path(), "b.off", "solid"));
    assert!(other.0 == 3 && other.1.starts_with("mesh: unknown mesh format"), "{}", other.1);
    let no_magic = refusal(&write_to(folder.path(), "b.ply", TRIANGLE));
    assert_eq!(no_magic, (3, "mesh: not a PLY file: its first line is not \"ply\"".to_string()));
}

/// Meshes of other renderers load, if such files are there.
#[test]
fn meshes_of_other_programs_load() {
    let Some(data) = crate::shared::shared("") else { return };
    let (mut folders, mut count) = (vec![data], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a readable folder").map(|e| e.expect("an entry").path()) {
            let is_mesh = entry.extension().is_some_and(|e| e == "obj" || e == "ply");
            if entry.is_dir() {
                folders.push(entry);
            } else if is_mesh {
                let (mesh, warnings) = mesh::load(&entry, &entry.display().to_string()).unwrap_or_else(|e| panic!("{e}"));
                assert_sound(&mesh);
                warnings.iter().for_each(|w| println!("{w}"));
                count += 1;
            }
        }
    }
    println!("{count} meshes");
}
