//! How the three dialects spell things, and by that which of them a scene is written in.

use crate::reader::{Node, Value};

/// A dialect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// dirt, up to 2020, and its forks.
    Dirt,
    /// darts of 2021.
    Darts2021,
    /// darts of 2024 and later.
    Darts,
}

const ALL: [Course; 3] = [Course::Dirt, Course::Darts2021, Course::Darts];

/// Keys and types by who writes them so; what all write alike tells nothing.
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

/// How many spellings of each dialect's own a scene has.
#[derive(Default)]
pub struct Evidence {
    /// In the order of [`ALL`].
    found: [usize; 3],
}

impl Evidence {
    pub fn of(node: &Node) -> Evidence {
        let mut evidence = Evidence::default();
        evidence.look(node, None);
        evidence
    }

    /// The dialect that most of a scene is written in, of several the first.
    pub fn course(&self) -> Course {
        self.likely().next().unwrap_or(Course::Dirt)
    }

    /// What holds of the scene's dialect; and whether that is sure: whether it holds of all dialects that are as likely.
    pub fn says<T: PartialEq>(&self, of: impl Fn(Course) -> T) -> (T, bool) {
        let answer = of(self.course());
        let is_sure = self.likely().all(|course| of(course) == answer);
        (answer, is_sure)
    }

    /// The dialects that most of a scene is written in.
    fn likely(&self) -> impl Iterator<Item = Course> {
        let most = self.found.iter().copied().max().unwrap_or(0);
        ALL.into_iter().zip(self.found).filter(move |(_, count)| *count == most).map(|(course, _)| course)
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

/// Whether it is a scene, or a file of tests, of any of them.
pub fn is_of_the_course(root: &Node) -> bool {
    let has = |node: &Node, keys: &[&str]| keys.iter().any(|key| node.child(key).is_some());
    let camera = root.child("camera").is_some_and(|camera| {
        has(camera, &["vfov", "fdist", "aperture", "resolution", "vertical fov", "focus distance", "aperture diameter"])
    });
    let scene = has(root, &["surfaces", "image_samples", "accelerator", "media"]) || camera;
    !has(root, &["pt"]) && (scene || is_tests(root))
}

/// Whether it is a file of tests.
pub fn is_tests(root: &Node) -> bool {
    root.child("type").and_then(Node::as_str) == Some("tests")
}

/// The type names of different years as one word: with underscores.
pub fn word(text: &str) -> String {
    text.replace([' ', '-'], "_")
}
