//! Participating media. In those programs each surface says which medium is inside and outside of it, and the camera says which one it is in.
//! In pt a shape has a medium inside, and the scene has one around everything.

use std::collections::BTreeMap;

use glam::DVec3;

use super::value::{color, numbers, scalar};
use super::{by_name, transform};
use crate::import::json_cursor::JsonCursor;
use crate::math::Transform;
use crate::reader::{Node, unknown};

const TYPES: &[&str] = &["homogeneous", "perlin"];
/// Surfaces that can contain a medium.
const BODIES: &[&str] = &["sphere", "mesh"];
const COEFFICIENTS: &[&str] = &["type", "name", "phase", "sigma_a", "sigma_s"];
const PERLIN: &[&str] = &["spatial_scale", "density_scale", "density_offset"];

/// A medium that a surface or the camera names, or describes; `None` if there is none.
type MediumRef<'a> = Option<JsonCursor<'a>>;

/// A sphere or a mesh between two different media.
struct Boundary<'a> {
    surface: JsonCursor<'a>,
    inside: MediumRef<'a>,
    outside: MediumRef<'a>,
    /// Transforms of the surface and of the groups around it, the innermost first.
    transforms: Vec<JsonCursor<'a>>,
}

/// The media of a scene.
pub struct Media<'a> {
    /// Media with names.
    named: BTreeMap<&'a str, JsonCursor<'a>>,
    boundaries: Vec<Boundary<'a>>,
    /// What the camera is in.
    camera: MediumRef<'a>,
}

/// How a `medium_interface` is expressed in pt's shape.
pub enum Interior {
    /// The shape has no medium.
    Nothing,
    /// The surface has no material and the same medium on both sides: light passes it as if it were not there.
    IndexMatched,
    /// The shape has this medium inside.
    Medium(Node),
}

impl<'a> Media<'a> {
    /// Finds the media of a scene and the surfaces between them.
    pub fn new(root: &JsonCursor<'a>) -> Option<Media<'a>> {
        let named = by_name(root, "media", "medium")?;
        let mut boundaries = vec![];
        root.get(&["surfaces"]).iter().for_each(|list| collect(list, &[], &mut boundaries));
        let camera = root.get(&["camera"]).and_then(|camera| camera.get(&["medium"]));
        Some(Media { named, boundaries, camera })
    }

    /// Returns whether the scene has media.
    pub fn any(&self) -> bool {
        self.camera.is_some() || !self.boundaries.is_empty()
    }

    /// Converts the media with names; `None` if there are none.
    pub fn named_media(&self, root: &JsonCursor<'a>) -> Option<Option<Node>> {
        let list = root.get(&["media"])?;
        let used = self.named.iter().filter(|(name, cursor)| self.is_used(name, cursor));
        let made: Vec<(&str, Option<Node>)> = used.map(|(name, cursor)| (*name, self.medium(cursor, name))).collect();
        if made.is_empty() {
            return None;
        }
        let made: Option<Vec<_>> = made.into_iter().map(|(name, node)| Some((name, node?))).collect();
        Some(made.map(|made| list.make_object(made)))
    }

    /// Returns whether anything has this medium; notes that one is left out.
    fn is_used(&self, name: &str, cursor: &JsonCursor) -> bool {
        let named = self.boundaries.iter().flat_map(|boundary| [&boundary.inside, &boundary.outside]).chain([&self.camera]);
        let is_used = named.flatten().any(|medium| key(medium) == name);
        if !is_used {
            cursor.note("left out: neither a surface nor the camera has this medium");
        }
        is_used
    }

    /// Converts the medium around everything: the one outside of those boundaries that are not within others, or else the camera's. `None` if
    /// there is none.
    pub fn exterior(&self) -> Option<Option<Node>> {
        // What is wrong with a surface without a box is reported when it is read.
        let boxed: Vec<(&Boundary, [DVec3; 2])> =
            self.boundaries.iter().filter_map(|boundary| Some((boundary, boundary.extent().ok()?))).collect();
        // Boxes that are equal count as within each other only in their order.
        let is_within = |i: usize, j: usize| {
            let ([low, high], [outer_low, outer_high]) = (boxed[i].1, boxed[j].1);
            let fits = outer_low.cmple(low).all() && high.cmple(outer_high).all();
            i != j && fits && (boxed[i].1 != boxed[j].1 || j < i)
        };
        let bodies = |i: usize| (0..boxed.len()).filter(move |j| is_within(i, *j));
        let Some((first, _)) = boxed.iter().enumerate().find(|(i, _)| bodies(*i).next().is_none()).map(|(_, body)| body) else {
            return self.camera.as_ref().map(|medium| self.reference(medium));
        };
        let exterior = &first.outside;
        let mut is_consistent = true;
        for (i, (boundary, _)) in boxed.iter().enumerate() {
            let is_known =
                same_medium(&boundary.outside, exterior) || bodies(i).any(|j| same_medium(&boxed[j].0.inside, &boundary.outside));
            if !is_known {
                boundary.surface.fault(format!(
                    "{} is outside of this surface, but inside of no surface around it; outside of {} is {}: make them agree",
                    in_words(&boundary.outside),
                    first.surface.pointer,
                    in_words(exterior)
                ));
                is_consistent = false;
            }
        }
        if !is_consistent {
            return Some(None);
        }
        if let (false, Some(place)) = (same_medium(exterior, &self.camera), self.camera.as_ref().or(exterior.as_ref())) {
            let is_inside = self.boundaries.iter().any(|boundary| same_medium(&boundary.inside, &self.camera));
            let approximated = if is_inside { "" } else { "approximated: " };
            let exterior = in_words(exterior);
            place.note(format!(
                "{approximated}pt derives the camera's medium from the shapes that contain it; outside of all shapes it is {exterior}"
            ));
        }
        exterior.as_ref().map(|medium| self.reference(medium))
    }

    /// Converts the medium inside of a surface. Faults are reported.
    pub fn interior(&self, surface: &JsonCursor<'a>) -> Option<Interior> {
        let Some(interface) = surface.get(&["medium_interface"]) else { return Some(Interior::Nothing) };
        interface.leave_out_others(&["inside", "outside"]);
        let (inside, outside) = (interface.get(&["inside"]), interface.get(&["outside"]));
        let has_material = surface.has("material");
        if same_medium(&inside, &outside) {
            return Some(if has_material { Interior::Nothing } else { Interior::IndexMatched });
        }
        let kind = surface.get(&["type"])?.text()?;
        if !BODIES.contains(&kind) {
            let message = format!("a {kind} contains no medium: only spheres and closed meshes do");
            if has_material {
                interface.note(format!("left out: {message}"))
            } else {
                interface.fault(message)
            }
            return has_material.then_some(Interior::Nothing);
        }
        match &inside {
            Some(medium) => Some(Interior::Medium(self.reference(medium)?)),
            None => Some(Interior::Medium(interface.make_object([("type", interface.make_text("homogeneous"))]))),
        }
    }

    /// Converts a medium that is a name or an object.
    fn reference(&self, medium: &JsonCursor<'a>) -> Option<Node> {
        if !medium.is_text() {
            return self.medium(medium, &medium.pointer);
        }
        if !self.named.contains_key(medium.text()?) {
            let known: Vec<&str> = self.named.keys().copied().collect();
            medium.fault(unknown("medium", medium.text()?, &known));
            return None;
        }
        Some(medium.same())
    }

    /// Converts a medium.
    ///
    /// - `key`: what tells it from others, from [`key`]
    fn medium(&self, cursor: &JsonCursor<'a>, key: &str) -> Option<Node> {
        let kind = cursor.need(&["type"])?;
        match kind.text()? {
            "homogeneous" => {
                cursor.leave_out_others(COEFFICIENTS);
                let members = coefficients(cursor, 1.0)?;
                Some(cursor.make_object([("type", kind.make_text("homogeneous"))].into_iter().chain(members)))
            }
            "perlin" => self.perlin(cursor, key),
            other => {
                kind.fault(unknown("medium", other, TYPES));
                None
            }
        }
    }

    /// Converts a medium with the density max(0, a · noise(s p) + b), with `density_scale` a, `density_offset` b and `spatial_scale` s.
    fn perlin(&self, cursor: &JsonCursor<'a>, key: &str) -> Option<Node> {
        cursor.leave_out_others(&[COEFFICIENTS, PERLIN].concat());
        let number = |name: &str, default: f64| cursor.get(&[name]).map_or(Some(default), |given| given.number());
        let (amplitude, offset) = (number("density_scale", 1.0)?.abs(), number("density_offset", 0.0)?);
        let per_axis = cursor.get(&["spatial_scale"]).map_or(Some([1.0; 3]), |given| numbers(&given)).map(DVec3::from)?;
        let peak = amplitude + offset;
        if peak <= 0.0 {
            cursor.fault("the sum of density_scale and density_offset must be above 0: the medium has no density anywhere");
            return None;
        }
        if per_axis.min_element() <= 0.0 {
            cursor.get(&["spatial_scale"])?.expected("numbers above 0");
            return None;
        }
        let [low, high] = self.extent(cursor, key)?.map(|corner| corner * per_axis);
        let longest = (high - low).max_element();
        let values = (VALUES_PER_LUMP * longest).ceil().clamp(MIN_RESOLUTION, MAX_RESOLUTION);
        let lost = if values < VALUES_PER_LUMP * longest {
            format!(" of {:.1} values for each lump, which shows no finer structure", values / longest)
        } else {
            String::new()
        };
        cursor.note(format!("approximated by similar noise, whose lumps are at other places, on a grid{lost}"));
        let corner = |p: DVec3| cursor.make_numbers(p.to_array());
        let density = cursor.make_object([
            ("type", cursor.make_text("noise")),
            ("size", cursor.make_whole(1)),
            ("octaves", cursor.make_whole(1)),
            ("amplitude", cursor.make_number(amplitude / peak)),
            ("offset", cursor.make_number(offset / peak)),
            ("falloff", cursor.make_whole(0)),
            ("resolution", cursor.make_whole(values as u64)),
            ("bounds", cursor.make_object([("low", corner(low)), ("high", corner(high))])),
            ("transform", cursor.make_array([cursor.make_object([("scale", corner(per_axis.recip()))])])),
        ]);
        let own = [("type", cursor.make_text("heterogeneous")), ("density", density)];
        Some(cursor.make_object(own.into_iter().chain(coefficients(cursor, peak)?)))
    }

    /// Box around all surfaces that have a medium inside; `None` after a fault.
    fn extent(&self, cursor: &JsonCursor, medium: &str) -> Option<[DVec3; 2]> {
        let mut all: Option<[DVec3; 2]> = None;
        for boundary in self.boundaries.iter().filter(|boundary| boundary.inside.as_ref().is_some_and(|inside| key(inside) == medium)) {
            match boundary.extent() {
                Ok([low, high]) => all = Some(all.map_or([low, high], |other| [low.min(other[0]), high.max(other[1])])),
                Err(reason) => {
                    boundary.surface.fault(format!("the grid of its medium needs the box around it: {reason}"));
                    return None;
                }
            }
        }
        if all.is_none() {
            cursor.fault("a medium of type perlin needs spheres or meshes with this medium inside: without an end it has no grid");
        }
        all
    }
}

/// Number of values of the grid along a lump of the noise, whose size is 1: enough for linear interpolation to look smooth.
const VALUES_PER_LUMP: f64 = 8.0;
/// Number of values along the longest side of the box: at least so many, so that bodies smaller than a lump have a gradient, and at most as many as
/// pt's noise may have.
const MIN_RESOLUTION: f64 = 64.0;
const MAX_RESOLUTION: f64 = 256.0;

impl Boundary<'_> {
    /// Box around the surface in the world.
    ///
    /// # Errors
    /// Why there is none.
    fn extent(&self) -> Result<[DVec3; 2], String> {
        let radius = || match self.surface.get(&["radius"]) {
            None => Some(1.0),
            Some(radius) => numbers(&radius).map(|[radius]| f64::abs(radius)),
        };
        let own = match self.surface.get(&["filename"]) {
            Some(file) => {
                let name = file.text().ok_or("it has no file")?;
                vertices(&file.context().files.bytes(name).map_err(|error| error.to_string())?)
            }
            None => radius().map(|radius| [DVec3::splat(-radius), DVec3::splat(radius)]),
        };
        let to_world = self.transforms.iter().try_fold(Transform::IDENTITY, |all, next| Some(all.then(&transform::composed(next)?)));
        let [low, high] = to_world.ok_or("its transform is not invertible")?.bounds(own.ok_or("it has no size")?);
        let is_box = low.is_finite() && high.is_finite() && low.cmple(high).all();
        is_box.then_some([low, high]).ok_or("it is too large".into())
    }
}

/// Box around the vertices of an OBJ file; `None` if there are none. What is wrong with the file is reported when it is read as a mesh.
fn vertices(text: &[u8]) -> Option<[DVec3; 2]> {
    let of_line = |line: &[u8]| {
        let mut words = std::str::from_utf8(line).ok()?.split_ascii_whitespace();
        let is_vertex = words.next() == Some("v");
        let mut number = || words.next()?.parse().ok();
        is_vertex.then_some(())?;
        Some(DVec3::new(number()?, number()?, number()?)).filter(|p| p.is_finite())
    };
    text.split(|byte| *byte == b'\n').filter_map(of_line).map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
}

/// Collects the surfaces between two media.
///
/// - `around`: transforms of the groups around the list, the innermost first
fn collect<'a>(list: &JsonCursor<'a>, around: &[JsonCursor<'a>], boundaries: &mut Vec<Boundary<'a>>) {
    // What is not a list is reported when the surfaces are converted.
    for surface in list.is_array().then(|| list.items()).flatten().unwrap_or_default() {
        let transforms: Vec<JsonCursor> = surface.get(&["transform"]).into_iter().chain(around.iter().cloned()).collect();
        if let Some(children) = surface.get(&["children"]) {
            collect(&children, &transforms, boundaries);
        } else if let Some(interface) = surface.get(&["medium_interface"]) {
            let (inside, outside) = (interface.get(&["inside"]), interface.get(&["outside"]));
            let is_body = surface.node().child("type").and_then(Node::as_str).is_some_and(|kind| BODIES.contains(&kind));
            if is_body && !same_medium(&inside, &outside) {
                boundaries.push(Boundary { surface, inside, outside, transforms });
            }
        }
    }
}

/// What tells a medium from others: its name, or its place in the file.
fn key(medium: &JsonCursor) -> String {
    medium.node().as_str().map_or_else(|| medium.pointer.clone(), str::to_owned)
}

fn same_medium(a: &MediumRef, b: &MediumRef) -> bool {
    a.as_ref().map(key) == b.as_ref().map(key)
}

fn in_words(medium: &MediumRef) -> String {
    medium.as_ref().map_or("no medium".into(), |medium| format!("the medium {:?}", key(medium)))
}

type Members = Vec<(&'static str, Node)>;

/// Converts coefficients, multiplied by a factor, and the phase function.
fn coefficients(cursor: &JsonCursor, factor: f64) -> Option<Members> {
    let mut members = vec![];
    for (theirs, ours) in [("sigma_a", "absorption"), ("sigma_s", "scattering")] {
        if let Some(given) = cursor.get(&[theirs]) {
            let node = match factor {
                1.0 => color(&given)?,
                _ => given.make_numbers(numbers::<3>(&given)?.map(|x| factor * x)),
            };
            members.push((ours, node));
        }
    }
    let phase = cursor.need(&["phase"])?;
    let kind = phase.need(&["type"])?;
    if kind.text()? != "hg" {
        kind.fault(unknown("phase function", kind.text()?, &["hg"]));
        return None;
    }
    phase.leave_out_others(&["type", "g"]);
    let g = phase.get(&["g"]).map_or(Some(phase.make_whole(0)), |g| scalar(&g))?;
    members.push(("phase", phase.make_object([("type", phase.make_text("henyey_greenstein")), ("g", g)])));
    Some(members)
}
