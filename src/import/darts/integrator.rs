//! How light is followed, and how samples are spread.

use super::Reader;
use super::spelling::{Course, word};
use crate::import::view::View;
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
];
const SAMPLERS: &[&str] = &["independent", "stratified", "halton", "cmj", "stochastic sobol"];
const BOUNCES: &[&str] = &["max_bounces", "max bounces"];

impl Reader<'_> {
    /// pt's integrator; without one the loaders follow paths by their materials.
    pub fn integrator(&self, root: &View) -> Option<Node> {
        let Some(view) = root.get(&["integrator"]) else {
            return Some(root.make_object([("type", root.make_text("path")), ("max_depth", root.make_whole(BOUNCES_OF_DIRT))]));
        };
        view.leave_out_others(&[&["type"], BOUNCES].concat());
        let kind = view.need(&["type"])?;
        let named = word(kind.text()?);
        let paths = |kind: &str, weights: Option<&str>, depth: Node| {
            let weights = weights.map(|weights| ("weights", view.make_text(weights)));
            Some(view.make_object([("type", view.make_text(kind))].into_iter().chain(weights).chain([("max_depth", depth)])))
        };
        let bounces = || view.get(BOUNCES).map_or(view.make_whole(BOUNCES_OF_DIRT), |bounces| bounces.same());
        let once = || view.make_whole(1);
        match named.as_str() {
            "normals" => {
                let encoding = |course| if course == Course::Darts { "signed" } else { "absolute" };
                let (encoding, is_sure) = self.spellings.says(encoding);
                if !is_sure {
                    kind.note("nothing tells which of the dialects of dirt and darts this is: read as dirt's, |n|");
                }
                Some(view.make_object([("type", view.make_text("normals")), ("encoding", view.make_text(encoding))]))
            }
            "ao" => Some(view.make_object([("type", view.make_text("ao"))])),
            "path_tracer_simple" | "path_tracer_mats" => paths("path", None, bounces()),
            "path_tracer_nee" => paths("nee", Some("light"), bounces()),
            "path_tracer_mis" => paths("nee", None, bounces()),
            "path_tracer_mixture" => {
                kind.note("one direction from the mixture of two densities: approximated by one from each, weighed the same way");
                paths("nee", Some("balance"), bounces())
            }
            "direct_mats" => paths("path", None, once()),
            "direct_nee" => paths("nee", Some("light"), once()),
            "direct_mis" => paths("nee", None, once()),
            "volpath_tracer_uni" | "volpath_tracer_nee" | "volpath_tracer_mis" => {
                kind.fault(super::NO_MEDIA);
                None
            }
            _ => {
                kind.fault(unknown("integrator", kind.text()?, INTEGRATORS));
                None
            }
        }
    }

    /// pt's sampler. The samples stand in it, or in dirt at the top.
    pub fn sampler(&self, root: &View) -> Option<Node> {
        let view = root.get(&["sampler"]);
        let within = view.as_ref().and_then(|view| view.get(&["samples", "image_samples"]));
        let spp = match (root.get(&["image_samples"]), within) {
            (Some(top), Some(within)) if top.number()? != within.number()? => {
                within.note("left out: the scene's image_samples say another number");
                top.same()
            }
            (Some(top), _) => top.same(),
            (None, Some(within)) => within.same(),
            (None, None) => root.make_whole(1),
        };
        let Some(view) = view else { return Some(root.make_object([("type", root.make_text("independent")), ("spp", spp)])) };
        view.leave_out_others(&["type", "samples", "image_samples", "dimension"]);
        if let Some(dimension) = view.get(&["dimension"]) {
            dimension.note("left out: pt spreads samples over all dimensions");
        }
        let Some(kind) = view.get(&["type"]) else {
            return Some(view.make_object([("type", view.make_text("independent")), ("spp", spp)]));
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
        Some(view.make_object([("type", kind.make_text(named)), ("spp", spp)]))
    }
}

/// Where nothing else is said.
const BOUNCES_OF_DIRT: u64 = 64;
