//! A file imports only from its own layer or from below, and modules of one folder do not import each other in a circle
//! (ARCHITECTURE.md, layers).
//!
//! Both tables stand here, once. A file or folder of `src/` that the table of layers does not name fails too, and so does a line of
//! either table that names nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Bottom first: layers, and the rows within them. Modules import from the rows before their own, so that
/// no two can import each other; modules of one row know nothing of one another.
const LAYERS: &[&[&[&str]]] = &[
    &[&["error"], &["reader"]],
    &[&["math"], &["effects"], &["format"]],
    &[&["sampler"]],
    // Families that meet: a texture is looked up at a shape's point, a light may be a shape.
    &[&["shape"], &["texture"], &["bsdf"], &["medium"], &["light"], &["camera"]],
    &[&["primitive"], &["accel"], &["scene"], &["world"]],
    &[&["film"], &["recorder"], &["integrator"], &["render"]],
    &[&["output"], &["describe"], &["build"], &["import"], &["load"]],
    &[&["integrators"]],
    &[
        &["measure"],
        &["part"],
        &["summary"],
        &["proof"],
        &["rays"],
        &["double"],
        &["compare"],
        &["torture"],
        &["stress"],
        &["cli"],
        &["main"],
    ],
];

/// Circles that stay: folder, modules, and the reason.
const CIRCLES: &[(&str, &[&str], &str)] = &[(
    "bsdf",
    &[
        "compound",
        "conductor",
        "description",
        "diffuse",
        "material",
        "microfacet",
        "oren_nayar",
        "parameter",
        "plastic",
        "rough_conductor",
        "surface_material",
        "table",
    ],
    "the table lists every material, and layered and mixed materials hold any material of the table: the types contain one another",
)];

/// Every module's rank: a row's modules share one, ranks grow upwards.
fn ranks() -> BTreeMap<&'static str, usize> {
    let rows = LAYERS.iter().flat_map(|layer| layer.iter());
    rows.enumerate().flat_map(|(rank, row)| row.iter().map(move |module| (*module, rank))).collect()
}

/// Path of a module from the root of the library.
type Module = Vec<String>;

/// A source file and what its code names, without tests and comments.
struct File {
    path: PathBuf,
    module: Module,
    /// What its `use` lines bring into the module.
    uses: Vec<Import>,
    /// All paths of the code that begin with `crate`, `pt`, `super` or `self`. Those within a module that is written inside the file
    /// are read as if they stood in the file itself.
    paths: Vec<Import>,
    code: String,
}

/// The files of the library, by module.
type Tree = BTreeMap<Module, File>;

/// A path as written, and the name that a `use` of it gives: the last segment, or the one after `as`.
struct Import {
    path: Vec<String>,
    name: String,
}

impl File {
    fn new(path: PathBuf, module: Module, source: &str) -> File {
        let code = source.lines().take_while(|line| !line.trim_start().starts_with("#[cfg(test)]"));
        let code: String = code.filter(|line| !line.trim_start().starts_with("//")).map(|line| format!("{line}\n")).collect();
        // `foo_crate::`, `a::pt::`, and `self as pt` are other paths.
        let begins = |at: &usize| !code[..*at].ends_with(|c: char| is_word(c) || c == ':');
        let find = |what: &'static str| code.match_indices(what).map(|(at, _)| at).filter(begins);
        // Indented lines belong to a function, or to a module that is written inside the file.
        let line_before = |at: usize| code[..at].rsplit('\n').next().unwrap_or_default();
        let is_own = |at: &usize| line_before(*at).is_empty() || line_before(*at).starts_with("pub");
        let uses = find("use ").filter(is_own).flat_map(|at| opened(&code[at + "use ".len()..])).collect();
        let paths = ["crate::", "pt::", "super::", "self::"].into_iter().flat_map(find).flat_map(|at| opened(&code[at..])).collect();
        File { path, module, uses, paths, code }
    }

    /// Top-level modules that the code names.
    ///
    /// Names that begin in capitals are the library's own re-exports: those of `error`.
    fn imports(&self) -> BTreeSet<&str> {
        let rooted = self.paths.iter().filter(|import| ["crate", "pt"].contains(&import.path[0].as_str()));
        let heads = rooted.filter_map(|import| import.path.get(1));
        heads.map(|head| if head.starts_with(char::is_uppercase) { "error" } else { head }).collect()
    }

    /// Returns whether an item of this name is defined here.
    fn defines(&self, name: &str) -> bool {
        ["struct", "enum", "trait", "type", "fn", "const", "static"].iter().any(|kind| {
            let definition = format!("{kind} {name}");
            self.code.match_indices(&definition).any(|(at, _)| !self.code[at + definition.len()..].starts_with(is_word))
        })
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The paths at the start of a piece of code, braces opened: `a::{b, c::d as e}` gives a::b and a::c::d, the second by the name e.
fn opened(code: &str) -> Vec<Import> {
    let code = code.trim_start();
    if let Some(list) = code.strip_prefix('{') {
        return items(list).into_iter().flat_map(opened).collect();
    }
    let (head, rest) = code.split_at(if code.starts_with('*') { 1 } else { code.find(|c| !is_word(c)).unwrap_or(code.len()) });
    if head.is_empty() {
        return vec![];
    }
    let mut found = rest.strip_prefix("::").map(opened).unwrap_or_default();
    if found.is_empty() {
        let renamed = rest.trim_start().strip_prefix("as ").and_then(|rest| rest.split(|c| !is_word(c)).next());
        found.push(Import { path: vec![], name: renamed.unwrap_or(head).into() });
    }
    found.iter_mut().for_each(|import| import.path.insert(0, head.into()));
    found
}

/// The items of a list up to its closing brace.
fn items(list: &str) -> Vec<&str> {
    let count = |depth: &mut i32, c: char| {
        *depth += i32::from(c == '{') - i32::from(c == '}');
        *depth
    };
    let mut depth = 0;
    let end = list.find(|c| count(&mut depth, c) < 0).unwrap_or(list.len());
    depth = 0;
    list[..end].split(|c| count(&mut depth, c) == 0 && c == ',').collect()
}

/// What breaks the law of layers, one sentence each; empty where all is well.
fn violations(tree: &Tree, ranks: &BTreeMap<&str, usize>) -> Vec<String> {
    let mut found = vec![];
    for file in tree.values() {
        let module = file.module[0].as_str();
        let Some(own) = ranks.get(module) else {
            found.push(format!("{}: `{module}` is in no layer", file.path.display()));
            continue;
        };
        for import in file.imports().into_iter().filter(|import| *import != module) {
            match ranks.get(import) {
                Some(other) if other < own => {}
                Some(_) => found.push(format!("{}: `{module}` must not import `{import}`", file.path.display())),
                None => found.push(format!("{}: imports `{import}`, which is in no layer", file.path.display())),
            }
        }
    }
    found
}

/// A path as written in `module`, from the root of the library.
fn absolute(path: &[String], module: &[String]) -> Module {
    let mut found = module.to_vec();
    for segment in path {
        match segment.as_str() {
            "crate" | "pt" => found.clear(),
            "super" => drop(found.pop()),
            "self" => {}
            _ => found.push(segment.clone()),
        }
    }
    found
}

/// The module that defines what a path from the root names. Re-exports lead to the module that they name.
fn home(tree: &Tree, path: &[String]) -> Module {
    let end = (1..=path.len()).rev().find(|end| tree.contains_key(&path[..*end])).unwrap_or(0);
    let (module, rest) = path.split_at(end);
    let (Some(file), [name, more @ ..]) = (tree.get(module), rest) else { return module.to_vec() };
    for import in &file.uses {
        let target = absolute(&import.path, module);
        if import.name == *name && target != path[..=end] {
            return home(tree, &[&target, more].concat());
        }
        if let Some((glob, child)) = target.split_last()
            && glob == "*"
            && tree.get(child).is_some_and(|file| file.defines(name))
        {
            return child.to_vec();
        }
    }
    module.to_vec()
}

/// For each folder, the modules of it that import siblings, with those siblings.
fn siblings(tree: &Tree) -> BTreeMap<Module, BTreeMap<String, BTreeSet<String>>> {
    let mut found: BTreeMap<Module, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (module, file) in tree {
        for import in &file.paths {
            let target = home(tree, &absolute(&import.path, module));
            let common = module.iter().zip(&target).take_while(|(a, b)| a == b).count();
            if let (Some(from), Some(to)) = (module.get(common), target.get(common)) {
                found.entry(module[..common].to_vec()).or_default().entry(from.clone()).or_default().insert(to.clone());
            }
        }
    }
    found
}

/// All modules that a module imports, directly or not.
fn reachable<'a>(imports: &'a BTreeMap<String, BTreeSet<String>>, from: &'a String) -> BTreeSet<&'a String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(module) = open.pop() {
        open.extend(imports.get(module).into_iter().flatten().filter(|next| seen.insert(*next)));
    }
    seen
}

/// Groups of modules of one folder that import each other, directly or not: the folder and its modules.
fn circles(tree: &Tree) -> BTreeSet<(String, Vec<String>)> {
    let mut found = BTreeSet::new();
    for (folder, imports) in siblings(tree) {
        let reaches = |from, to| reachable(&imports, from).contains(to);
        for module in imports.keys() {
            let circle: Vec<String> = reachable(&imports, module).into_iter().filter(|other| reaches(other, module)).cloned().collect();
            if !circle.is_empty() {
                found.insert((folder.join("::"), circle));
            }
        }
    }
    found
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
fn tree() -> Tree {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = |base: &Path, path: PathBuf| {
        let source = std::fs::read_to_string(&path).expect("source is text");
        let inner = path.strip_prefix(base).expect("found there").with_extension("");
        let module = inner.iter().map(|name| name.to_string_lossy().into_owned()).filter(|name| name != "mod").collect();
        File::new(path, module, &source)
    };
    let source = root.join("src");
    let in_source = rust_files(&source).into_iter().filter(|path| *path != source.join("lib.rs")).map(|path| file(&source, path));
    let plugged_in = rust_files(&root.join("integrators")).into_iter().map(|path| file(root, path));
    in_source.chain(plugged_in).map(|file| (file.module.clone(), file)).collect()
}

#[test]
fn imports_point_downwards() {
    let found = violations(&tree(), &ranks());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn siblings_do_not_import_each_other_in_circles() {
    let found = circles(&tree());
    let stays = |(folder, modules, _): &(&str, &[&str], &str)| (folder.to_string(), modules.iter().map(|name| name.to_string()).collect());
    let expected: BTreeSet<(String, Vec<String>)> = CIRCLES.iter().map(stays).collect();
    let new = found.difference(&expected).map(|(folder, modules)| format!("{folder}: {} import each other", modules.join(", ")));
    let gone = expected.difference(&found).map(|(folder, modules)| format!("{folder}: {} are no circle any more", modules.join(", ")));
    let messages: Vec<String> = new.chain(gone).collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
}

/// The table of layers names what is there, each module once.
#[test]
fn the_table_is_the_source_tree() {
    let named: Vec<&str> = LAYERS.iter().flat_map(|layer| layer.iter()).flat_map(|row| row.iter().copied()).collect();
    assert_eq!(named.len(), ranks().len(), "a module stands in the table twice");
    let there: BTreeSet<String> = tree().into_keys().map(|module| module[0].clone()).collect();
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

/// A tree of these modules, each with its source.
fn planted(files: &[(&str, &str)]) -> Tree {
    let module = |name: &str| -> Module { name.split("::").map(str::to_owned).collect() };
    files.iter().map(|(name, source)| (module(name), File::new(PathBuf::from(name), module(name), source))).collect()
}

/// The law of layers can fail: upwards, sideways in a circle, into the unknown, and for a folder without a layer.
#[test]
fn violations_are_seen() {
    let ranks = ranks();
    let count = |files: &[(&str, &str)]| violations(&planted(files), &ranks).len();
    assert_eq!(count(&[("math", "use crate::error::Result;\nuse crate::math::Ray;")]), 0);
    assert_eq!(count(&[("math", "use crate::shape::Shape;")]), 1);
    assert_eq!(count(&[("math", "fn f() -> crate::shape::Shape {}")]), 1);
    assert_eq!(count(&[("math", "use crate::{error::Fault, film::{Film, Crop}, render};")]), 2);
    assert_eq!(count(&[("film", "use pt::integrators::ALL;")]), 1);
    assert_eq!(count(&[("scene", "use crate::accel::List;"), ("accel", "use crate::scene::Scene;")]), 1);
    assert_eq!(count(&[("mystery", "")]), 1);
    assert_eq!(count(&[("film", "use crate::mystery::Thing;")]), 1);
    assert_eq!(count(&[("film", "// use crate::render::render;\nuse crate::Error;")]), 0);
}

/// A circle of siblings is seen: direct or longer, from files below them, and through re-exports by name, by another name or by `*`.
#[test]
fn circles_are_seen() {
    let is_circle = |root: &str, a: &str, b: &str| {
        let found = circles(&planted(&[("f", root), ("f::a", a), ("f::a::deep", "use super::super::c::X;"), ("f::b", b), ("f::c", "")]));
        assert!(found.is_empty() || found == BTreeSet::from([("f".into(), vec!["a".into(), "b".into()])]), "{found:?}");
        !found.is_empty()
    };
    let (a, b) = ("use super::b::B;\npub struct A;", "pub struct B;\nfn f(a: crate::f::a::A) {}");
    assert!(is_circle("", a, b));
    assert!(is_circle(
        "pub use a::{A, deep};\npub use b::*;",
        "use super::{B, c};\npub struct A;",
        "use crate::f::{self, A};\npub enum B {}"
    ));
    assert!(is_circle("use a::A as Other;", a, "use super::Other;"));
    assert!(!is_circle("pub use a::A;", a, "use super::{Another, c::A};"));
    assert!(!is_circle("", a, "#[cfg(test)]\nuse super::a::A;"));
    let long = [("f::a", "use super::b;"), ("f::b::deep", "use crate::f::c::{self, X};"), ("f::b", ""), ("f::c", "use super::a::A;")];
    assert_eq!(circles(&planted(&long)).len(), 1);
}
