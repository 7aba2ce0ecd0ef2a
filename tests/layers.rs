//! A file imports only from its own layer or from below (ARCHITECTURE.md, layers).
//!
//! The table stands here, once. A file or folder of `src/` that it does not name fails too, and so
//! does a line of the table that names nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Bottom first: layers, and the rows within them. Modules import from the rows before their own, so that
/// no two can import each other; modules of one row know nothing of one another.
const LAYERS: &[&[&[&str]]] = &[
    &[&["error"], &["reader"]],
    &[&["math"], &["effects"], &["format"]],
    &[&["sampler"]],
    // Families that meet: a texture is looked up at a shape's point, a light may be a shape.
    &[&["shape"], &["texture"], &["bsdf"], &["light"], &["camera"]],
    &[&["primitive"], &["accel"], &["scene"], &["world"]],
    &[&["film"], &["recorder"], &["integrator"], &["render"]],
    &[&["output"], &["describe"], &["build"], &["import"]],
    &[&["integrators"]],
    &[&["measure"], &["part"], &["proof"], &["compare"], &["cli"], &["main"]],
];

/// Every module's rank: a row's modules share one, ranks grow upwards.
fn ranks() -> BTreeMap<&'static str, usize> {
    let rows = LAYERS.iter().flat_map(|layer| layer.iter());
    rows.enumerate().flat_map(|(rank, row)| row.iter().map(move |module| (*module, rank))).collect()
}

/// A source file, the module it belongs to, and the modules its `use` lines name.
struct File {
    path: PathBuf,
    module: String,
    imports: BTreeSet<String>,
}

/// What breaks the law, one sentence each; empty where all is well.
fn violations(files: &[File], ranks: &BTreeMap<&str, usize>) -> Vec<String> {
    let mut found = vec![];
    for file in files {
        let Some(own) = ranks.get(file.module.as_str()) else {
            found.push(format!("{}: `{}` is in no layer", file.path.display(), file.module));
            continue;
        };
        for import in file.imports.iter().filter(|import| **import != file.module) {
            match ranks.get(import.as_str()) {
                Some(other) if other < own => {}
                Some(_) => found.push(format!("{}: `{}` must not import `{import}`", file.path.display(), file.module)),
                None => found.push(format!("{}: imports `{import}`, which is in no layer", file.path.display())),
            }
        }
    }
    found
}

/// The first path segments after `crate::` or `pt::` on a line of code, braces opened.
///
/// Names that begin in capitals are the library's own re-exports: those of `error`.
fn imports(source: &str) -> BTreeSet<String> {
    let code = source.lines().take_while(|line| !line.trim_start().starts_with("#[cfg(test)]"));
    let code: String = code.filter(|line| !line.trim_start().starts_with("//")).map(|line| format!("{line}\n")).collect();
    let mut found = BTreeSet::new();
    for root in ["crate::", "pt::"] {
        for (at, _) in code.match_indices(root) {
            let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
            // `foo_crate::`, `a::pt::`, and `self as pt` are other paths.
            if !code[..at].ends_with(is_word) {
                found.extend(heads(&code[at + root.len()..]));
            }
        }
    }
    found.into_iter().map(|name| if name.starts_with(char::is_uppercase) { "error".to_string() } else { name }).collect()
}

/// `a::b` gives a, `{a::b, c::{d, e}}` gives a and c.
fn heads(path: &str) -> Vec<String> {
    let word = |s: &str| s.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(list) = path.strip_prefix('{') else { return vec![word(path)] };
    let mut depth = 0;
    let mut items = vec![String::new()];
    for c in list.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                items.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(item) = items.last_mut() {
            item.push(c);
        }
    }
    items.iter().map(|item| word(item)).filter(|head| !head.is_empty()).collect()
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut found = vec![];
    for path in entries.map(|entry| entry.expect("a folder can be listed").path()) {
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// All files of the library but its root, which mounts the modules.
fn files() -> Vec<File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: PathBuf, module: String| {
        let source = std::fs::read_to_string(&path).expect("source is text");
        File { imports: imports(&source), module, path }
    };
    let source = root.join("src");
    let in_source = rust_files(&source).into_iter().filter(|path| *path != source.join("lib.rs")).map(|path| {
        let first = path.strip_prefix(&source).expect("found there").iter().next().expect("not empty");
        let module = Path::new(first).file_stem().expect("a name").to_string_lossy().into_owned();
        read(path, module)
    });
    let plugged_in = rust_files(&root.join("integrators")).into_iter().map(|path| read(path, "integrators".into()));
    in_source.chain(plugged_in).collect()
}

#[test]
fn imports_point_downwards() {
    let found = violations(&files(), &ranks());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The table names what is there, each module once.
#[test]
fn the_table_is_the_source_tree() {
    let named: Vec<&str> = LAYERS.iter().flat_map(|layer| layer.iter()).flat_map(|row| row.iter().copied()).collect();
    assert_eq!(named.len(), ranks().len(), "a module stands in the table twice");
    let there: BTreeSet<String> = files().into_iter().map(|file| file.module).collect();
    for module in named {
        assert!(there.contains(module), "`{module}` is in the table but not in the source tree");
    }
}

/// Integrators know the library as any other crate does.
#[test]
fn integrators_use_public_names() {
    for path in rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("integrators")) {
        let source = std::fs::read_to_string(&path).expect("source is text");
        assert!(!source.contains("crate::"), "{}: write `pt::`", path.display());
    }
}

fn file(module: &str, source: &str) -> File {
    File { path: PathBuf::from(format!("{module}.rs")), module: module.into(), imports: imports(source) }
}

/// The law can fail: upwards, sideways in a circle, into the unknown, and for a folder without a layer.
#[test]
fn violations_are_seen() {
    let ranks = ranks();
    let count = |files: &[File]| violations(files, &ranks).len();
    assert_eq!(count(&[file("math", "use crate::error::Result;\nuse crate::math::Ray;")]), 0);
    assert_eq!(count(&[file("math", "use crate::shape::Shape;")]), 1);
    assert_eq!(count(&[file("math", "fn f() -> crate::shape::Shape {}")]), 1);
    assert_eq!(imports("use crate::{error::Fault, film::{Film, Crop}, render};").len(), 3);
    assert_eq!(count(&[file("math", "use crate::{error::Fault, film::{Film, Crop}, render};")]), 2);
    assert_eq!(count(&[file("film", "use pt::integrators::ALL;")]), 1);
    assert_eq!(count(&[file("scene", "use crate::accel::List;"), file("accel", "use crate::scene::Scene;")]), 1);
    assert_eq!(count(&[file("mystery", "")]), 1);
    assert_eq!(count(&[file("film", "use crate::mystery::Thing;")]), 1);
    assert_eq!(count(&[file("film", "// use crate::render::render;\nuse crate::Error;")]), 0);
}
