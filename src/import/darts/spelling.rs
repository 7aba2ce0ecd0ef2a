//! Spellings of the three dialects, which tell the dialect of a scene.

use crate::reader::{Node, Value};

/// Version of the program, and so the dialect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DartsVersion {
    /// dirt, up to 2020, and programs derived from it.
    Dirt,
    /// darts of 2021.
    Darts2021,
    /// darts of 2024 and later.
    Darts,
}

const ALL: [DartsVersion; 3] = [DartsVersion::Dirt, DartsVersion::Darts2021, DartsVersion::Darts];

/// Keys and types that only one version writes. Those that all versions write tell nothing.
const DIRT: &[&str] = &["image_samples", "diffuse light", "blinnphong"];
const DARTS_2021: &[&str] = &["diffuse_light", "blinn_phong", "fresnel_blend", "refr", "refl", "sample_material", "scatter_material"];
const BEFORE: &[&str] = &[
    "vfov",
    "fdist",
    "aperture",
    "lambertian",
    "albedo",
    "emit",
    "blend",
    "amount",
    "even",
    "odd",
    "angle",
    "axis",
    "path_tracer_simple",
    "path_tracer_mats",
    "path_tracer_nee",
    "path_tracer_mis",
    "path_tracer_mixture",
    "direct_mats",
    "direct_nee",
    "direct_mis",
    "max_bounces",
];
const DARTS: &[&str] = &[
    "vertical fov",
    "focus distance",
    "aperture diameter",
    "diffuse",
    "emission",
    "blinn-phong",
    "mix",
    "factor",
    "color1",
    "color2",
    "rotate",
    "path tracer simple",
    "path tracer mats",
    "path tracer nee",
    "path tracer mis",
    "path tracer mixture",
    "direct mats",
    "direct nee",
    "direct mis",
    "max bounces",
];

/// Number of spellings in a scene that are typical of each dialect.
#[derive(Default)]
pub struct Evidence {
    /// Counts, in the order of [`ALL`].
    found: [usize; 3],
}

impl Evidence {
    /// Counts the spellings of a scene.
    pub fn of(node: &Node) -> Evidence {
        let mut evidence = Evidence::default();
        evidence.look(node, None);
        evidence
    }

    /// Dialect with the most spellings, and the first in the order of [`ALL`] if several have as many.
    pub fn version(&self) -> DartsVersion {
        self.likely().next().unwrap_or(DartsVersion::Dirt)
    }

    /// Value of `of` for the most likely dialect, and whether it is certain because all equally likely dialects have that value.
    pub fn says<T: PartialEq>(&self, of: impl Fn(DartsVersion) -> T) -> (T, bool) {
        let answer = of(self.version());
        let is_sure = self.likely().all(|version| of(version) == answer);
        (answer, is_sure)
    }

    /// Dialects with the most spellings.
    fn likely(&self) -> impl Iterator<Item = DartsVersion> {
        let most = self.found.iter().copied().max().unwrap_or(0);
        ALL.into_iter().zip(self.found).filter(move |(_, count)| *count == most).map(|(version, _)| version)
    }

    fn look(&mut self, node: &Node, parent: Option<&str>) {
        match &node.value {
            Value::Object(members) => {
                for member in members {
                    self.word(&member.key);
                    if member.key == "type" {
                        self.word(member.node.as_str().unwrap_or_default());
                    }
                    if parent == Some("sampler") && member.key == "samples" {
                        (self.found[1], self.found[2]) = (self.found[1] + 1, self.found[2] + 1);
                    }
                    self.look(&member.node, Some(&member.key));
                }
            }
            Value::Array(items) => items.iter().for_each(|item| self.look(item, parent)),
            _ => {}
        }
    }

    fn word(&mut self, word: &str) {
        let in_table = |table: &[&str]| usize::from(table.contains(&word));
        let before = in_table(BEFORE);
        let counts = [before + in_table(DIRT), before + in_table(DARTS_2021), in_table(DARTS)];
        self.found.iter_mut().zip(counts).for_each(|(found, more)| *found += more);
    }
}

/// Returns whether a file is a scene, or a file of tests, of any of these dialects.
pub fn is_darts(root: &Node) -> bool {
    let has = |node: &Node, keys: &[&str]| keys.iter().any(|key| node.child(key).is_some());
    let camera = root.child("camera").is_some_and(|camera| {
        has(camera, &["vfov", "fdist", "aperture", "resolution", "vertical fov", "focus distance", "aperture diameter"])
    });
    let scene = has(root, &["surfaces", "image_samples", "accelerator", "media"]) || camera;
    !has(root, &["pt"]) && (scene || is_tests(root))
}

/// Returns whether a file is a file of tests.
pub fn is_tests(root: &Node) -> bool {
    root.child("type").and_then(Node::as_str) == Some("tests")
}

/// Type name with underscores, which makes those of different years equal.
pub fn word(text: &str) -> String {
    text.replace([' ', '-'], "_")
}
