//! A bench that runs the program on one input after the other, and checks its exit code and message.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::marked::unmark;

/// The beginning of a valid scene, to which a case adds further keys.
pub const RIGHT: &str = r#"{"pt": 1,
"camera": {"look_at": {"from": [0, 0, 3], "to": [0, 0, 0]}},
"film": {"width": 8, "height": 6},
"sampler": {"spp": 1},
"background": {"radiance": 1}"#;

/// The beginning of a valid scene without light, to which a case adds further keys.
pub const UNLIT: &str = r#"{"pt": 1, "camera": {}, "film": {"width": 8, "height": 6}"#;

/// The first four lines of `mesh.obj`.
pub const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
/// The end of a scene that names `mesh.obj`.
const MESH: &str = r#", "shapes": [{"type": "mesh", "file": "mesh.obj"}]}"#;

/// A folder of valid and invalid files in which the program is run, with the results.
pub struct Bench {
    pub folder: tempfile::TempDir,
    /// The rows whose cases were run.
    pub met: BTreeSet<&'static str>,
    /// Descriptions of the cases whose exit code or message was not the expected one.
    pub wrong: Vec<String>,
}

impl Bench {
    pub fn new() -> Bench {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at = folder.path();
        fs::create_dir(at.join("folder")).expect("folder");
        fs::create_dir(at.join("folder.exr")).expect("folder");
        let right = format!("{RIGHT}}}");
        for name in ["right.json", "scene.exr", "szene-ä-🫖.json", "-dash.json", "with space.json", &long_name()] {
            fs::write(at.join(name), &right).expect("write");
        }
        fs::write(at.join("list.json"), "[]").expect("write");
        #[cfg(unix)]
        {
            assert!(Command::new("mkfifo").arg(at.join("pipe")).status().expect("mkfifo runs").success());
            std::os::unix::fs::symlink("/etc/passwd", at.join("link.obj")).expect("a link");
        }
        Bench { folder, met: BTreeSet::new(), wrong: vec![] }
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("pt"));
        command.current_dir(self.folder.path()).args(["--progress", "none"]).env_remove("PT_THREADS");
        command
    }

    pub fn call(&mut self, row: &'static str, args: &[&str], code: i32, phrase: &str) {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("pt"));
        command.current_dir(self.folder.path()).args(args);
        self.judge(row, &args.join(" "), command, code, phrase);
    }

    /// Runs the program on a `scene.json`. The message must give the position of the mark.
    pub fn scene(&mut self, row: &'static str, marked: &str, code: i32, phrase: &str) {
        let (text, places) = unmark(marked);
        let place = places.first().map_or(String::new(), |place| format!("error: scene.json:{place}"));
        self.bytes(row, text.as_bytes(), code, &format!("{place}{phrase}"));
    }

    pub fn bytes(&mut self, row: &'static str, text: &[u8], code: i32, phrase: &str) {
        fs::write(self.folder.path().join("scene.json"), text).expect("write");
        let mut command = self.command();
        command.args(["scene.json", "-o", "x.exr"]);
        let shown = String::from_utf8_lossy(&text[..text.len().min(300)]).into_owned();
        self.judge(row, &shown, command, code, phrase);
    }

    pub fn mesh(&mut self, row: &'static str, statements: &str, code: i32, phrase: &str) {
        fs::write(self.folder.path().join("mesh.obj"), format!("{SQUARE}{statements}")).expect("write");
        self.scene(row, &format!("{RIGHT}{MESH}"), code, phrase);
    }

    /// Runs the program on scenes that name this file (in JSON): as a mesh, as a named picture, and as a picture within a material.
    pub fn file(&mut self, row: &'static str, name: &str, code: i32, phrase: &str) {
        let picture = format!(r#"{{"type": "image", "file": ^{name}}}"#);
        let disk = |albedo: &str| format!(r#""shapes": [{{"type": "disk", "material": {{"type": "diffuse", "albedo": {albedo}}}}}]"#);
        for (keys, pointer) in [
            (format!(r#""shapes": [{{"type": "mesh", "file": ^{name}}}]"#), "/shapes/0"),
            (format!(r#""textures": {{"t": {picture}}}, {}"#, disk(r#""t""#)), "/textures/t"),
            (disk(&format!(r#"{{"type": "mix", "a": {picture}, "b": 0, "share": 0}}"#)), "/shapes/0/material/albedo/a"),
        ] {
            self.scene(row, &format!("{RIGHT},\n{keys}}}"), code, &format!("{pointer}/file: {phrase}"));
        }
    }

    pub fn judge(&mut self, row: &'static str, given: &str, mut command: Command, code: i32, phrase: &str) {
        self.met.insert(row);
        let before = contents(self.folder.path());
        let Output { status, stderr, .. } = command.output().expect("it runs");
        let said = String::from_utf8_lossy(&stderr);
        let given: String = given.chars().take(300).collect();
        let mut note = |what: &str| self.wrong.push(format!("{row}: {given}\n  {what}, said:\n{said}"));
        if status.code() != Some(code) {
            note(&format!("expected exit code {code}, found {status}"));
        }
        if !said.contains(phrase) || said.contains("panicked") {
            note(&format!("expected {phrase:?}"));
        }
        let picture = self.folder.path().join("x.exr");
        if code == 0 && fs::remove_file(picture).is_err() {
            note("no picture");
        }
        if contents(self.folder.path()) != before {
            note("files are not as they were");
        }
    }
}

/// A file name of 255 bytes, the limit of file systems.
pub fn long_name() -> String {
    format!("{}.json", "n".repeat(250))
}

/// Names in a folder, and the bytes of its files.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entry = |entry: std::io::Result<fs::DirEntry>| {
        let path = entry.expect("an entry").path();
        let bytes = if path.is_file() { fs::read(&path).expect("readable") } else { vec![] };
        (path.display().to_string(), bytes)
    };
    let mut all: Vec<_> = fs::read_dir(folder).expect("a folder").map(entry).collect();
    all.sort();
    all
}
