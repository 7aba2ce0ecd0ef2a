//! Integrators and samplers.

use super::Reader;
use super::spelling::{DartsVersion, word};
use crate::import::json_cursor::JsonCursor;
use crate::reader::{Node, unknown};

const INTEGRATORS: &[&str] = &[
    "normals",
    "ao",
    "path_tracer_simple",
    "path_tracer_mats",
    "path_tracer_nee",
    "path_tracer_mis",
    "path_tracer_mixture",
    "direct_mats",
    "direct_nee",
    "direct_mis",
    "volpath_tracer_uni",
    "volpath_tracer_nee",
];
const SAMPLERS: &[&str] = &["independent", "stratified", "halton", "cmj", "stochastic sobol"];
const BOUNCES: &[&str] = &["max_bounces", "max bounces"];

impl Reader<'_> {
    /// Converts the integrator. Without one those programs trace paths without light sampling.
    pub fn integrator(&self, root: &JsonCursor) -> Option<Node> {
        let Some(cursor) = root.get(&["integrator"]) else {
            return Some(root.make_object([("type", root.make_text("path")), ("max_depth", root.make_whole(BOUNCES_OF_DIRT))]));
        };
        cursor.leave_out_others(&[&["type"], BOUNCES].concat());
        let kind = cursor.need(&["type"])?;
        let named = word(kind.text()?);
        let paths = |kind: &str, weights: Option<&str>, depth: Node| {
            let weights = weights.map(|weights| ("weights", cursor.make_text(weights)));
            Some(cursor.make_object([("type", cursor.make_text(kind))].into_iter().chain(weights).chain([("max_depth", depth)])))
        };
        let bounces = || cursor.get(BOUNCES).map_or(cursor.make_whole(BOUNCES_OF_DIRT), |bounces| bounces.same());
        let once = || cursor.make_whole(1);
        if self.media.any() && ["path", "direct"].iter().any(|kind| named.starts_with(kind)) {
            kind.note(
                "approximated: pt simulates the scene's media with this integrator too, the original with volpath_tracer_uni and _nee only",
            );
        }
        match named.as_str() {
            "normals" => {
                let encoding = |version| if version == DartsVersion::Darts { "signed" } else { "absolute" };
                let (encoding, is_sure) = self.spellings.says(encoding);
                if !is_sure {
                    kind.note("it is not clear whether this is a scene of dirt or of darts: read as dirt's, which shows |n|");
                }
                Some(cursor.make_object([("type", cursor.make_text("normals")), ("encoding", cursor.make_text(encoding))]))
            }
            "ao" => Some(cursor.make_object([("type", cursor.make_text("ao"))])),
            "path_tracer_simple" | "path_tracer_mats" => paths("path", None, bounces()),
            "path_tracer_nee" => paths("nee", Some("light"), bounces()),
            "path_tracer_mis" => paths("nee", None, bounces()),
            "path_tracer_mixture" => {
                kind.note("approximated by multiple importance sampling with the balance heuristic: one sample of each density");
                paths("nee", Some("balance"), bounces())
            }
            "direct_mats" => paths("path", None, once()),
            "direct_nee" => paths("nee", Some("light"), once()),
            "direct_mis" => paths("nee", None, once()),
            "volpath_tracer_uni" => paths("path", None, bounces()),
            "volpath_tracer_nee" => paths("nee", None, bounces()),
            _ => {
                kind.fault(unknown("integrator", kind.text()?, INTEGRATORS));
                None
            }
        }
    }

    /// Converts the sampler. The number of samples is its member or, in dirt, one of the scene.
    pub fn sampler(&self, root: &JsonCursor) -> Option<Node> {
        let cursor = root.get(&["sampler"]);
        let within = cursor.as_ref().and_then(|cursor| cursor.get(&["samples", "image_samples"]));
        let spp = match (root.get(&["image_samples"]), within) {
            (Some(top), Some(within)) if top.number()? != within.number()? => {
                within.note("left out: the scene's image_samples say another number");
                top.same()
            }
            (Some(top), _) => top.same(),
            (None, Some(within)) => within.same(),
            (None, None) => root.make_whole(1),
        };
        let Some(cursor) = cursor else { return Some(root.make_object([("type", root.make_text("independent")), ("spp", spp)])) };
        cursor.leave_out_others(&["type", "samples", "image_samples", "dimension"]);
        if let Some(dimension) = cursor.get(&["dimension"]) {
            dimension.note("left out: pt spreads samples over all dimensions");
        }
        let Some(kind) = cursor.get(&["type"]) else {
            return Some(cursor.make_object([("type", cursor.make_text("independent")), ("spp", spp)]));
        };
        let named = match word(kind.text()?).as_str() {
            "independent" => "independent",
            "stratified" => "stratified",
            "halton" => "halton",
            "sobol" | "stochastic_sobol" => "sobol",
            "cmj" => {
                kind.note("correlated multi-jittered samples are approximated by stratified ones");
                "stratified"
            }
            _ => {
                kind.fault(unknown("sampler", kind.text()?, SAMPLERS));
                return None;
            }
        };
        Some(cursor.make_object([("type", kind.make_text(named)), ("spp", spp)]))
    }
}

/// Default number of bounces.
const BOUNCES_OF_DIRT: u64 = 64;
