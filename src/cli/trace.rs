//! Output of `--pixel x,y --sample k --trace`: the paths of one camera sample, vertex by vertex.

use std::collections::VecDeque;
use std::fmt::Write;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::stats::TextOrJson;
use crate::bsdf::Lobe;
use crate::describe::Names;
use crate::film::Splat;
use crate::integrator::CameraSample;
use crate::light::{EmittedRay, Lights};
use crate::math::{Density, Spectrum};
use crate::medium::MediumId;
use crate::recorder::{Contribution, End, Event, MediumVertex, Scattering, Technique, Vertex};
use crate::render::SampleId;

/// Command that shows the paths of a sample.
///
/// - `replay`: start of the command: scene and options that decide the samples
pub fn command(replay: &str, id: SampleId) -> String {
    let (x, y) = id.pixel;
    format!("{replay} --pixel {x},{y} --sample {} --trace", id.index)
}

/// Paths of a camera sample.
pub struct Trace<'a> {
    /// Name of the integrator.
    pub integrator: &'a str,
    /// Pixel and index of the sample.
    pub id: SampleId,
    /// Camera ray.
    pub camera: CameraSample,
    /// Value of the sample.
    pub value: Spectrum,
    /// Recorded events.
    pub events: &'a [Event],
    /// Names of shapes, materials and lights.
    pub names: &'a Names,
    /// Lights of the scene.
    pub lights: &'a Lights,
    /// Origin of the world, which was subtracted from the scene's coordinates.
    pub origin: DVec3,
}

impl Trace<'_> {
    /// Text or JSON of the paths.
    pub fn print(&self, form: TextOrJson) -> String {
        match form {
            TextOrJson::Text => self.text(),
            TextOrJson::Json => format!("{}\n", self.json()),
        }
    }

    /// Radiance that the events add up to, in their order.
    fn sum(&self) -> Spectrum {
        self.contributions().map(|c| c.value).fold(Spectrum::BLACK, |sum, value| sum + value)
    }

    fn contributions(&self) -> impl Iterator<Item = &Contribution> {
        self.events.iter().filter_map(|event| match event {
            Event::Light(contribution) => Some(contribution),
            _ => None,
        })
    }

    /// Converts a point to the coordinates of the scene file.
    fn place(&self, p: Vec3) -> [f64; 3] {
        (self.origin + p.as_dvec3()).to_array()
    }

    fn text(&self) -> String {
        let SampleId { pixel: (x, y), index } = self.id;
        let head = format!("pixel {x},{y} sample {index} of {}", self.integrator);
        if self.events.is_empty() {
            return format!("{head}: {}\n{} tells nothing of its paths\n", exact(self.value), self.integrator);
        }
        let ray = self.camera.ray;
        let mut text = format!("{head}, from {} towards {}\n", point(self.place(ray.origin)), direction(ray.direction));
        let mut branches = Branches::default();
        let mut ns = None;
        for event in self.events {
            let indent = "    ".repeat(branches.indent(event));
            // Writing to a string cannot fail.
            let _ = match event {
                Event::Vertex(vertex) => {
                    ns = Some(vertex.ns);
                    writeln!(text, "{indent}{}", self.vertex(vertex))
                }
                Event::Medium(vertex) => {
                    ns = None;
                    writeln!(text, "{indent}{}", self.medium_vertex(vertex))
                }
                Event::Wavelength { wavelength, factors, .. } => {
                    let nanometres = wavelength.nanometres();
                    writeln!(text, "{indent}     takes the wavelength {nanometres:.1} nm: throughput times {}", exact(*factors))
                }
                Event::Light(contribution) => writeln!(text, "{indent}     + {}", self.contribution(contribution, ns)),
                Event::Scattering(scattering) => writeln!(text, "{indent}     {}", scattered(scattering)),
                Event::Emission(emitted) => writeln!(text, "{}", self.emitted(emitted)),
                Event::Splat(splat) => writeln!(text, "{indent}     + {}", splatted(splat)),
                Event::End { why, .. } => writeln!(text, "{indent}     end: {}", ended(*why)),
            };
        }
        let (sum, value) = (self.sum(), self.value);
        text += &format!("sum {}", exact(sum));
        if self.camera.weight != 1.0 {
            text += &format!(", filter weight {:?}", self.camera.weight);
        }
        text += &format!("\nsample {}\n", exact(value));
        if sum * self.camera.weight != value {
            text += &format!("{} tells of a part of its light only\n", self.integrator);
        }
        text
    }

    fn vertex(&self, vertex: &Vertex) -> String {
        let Vertex { depth, distance, hit, point: p, ns, wo, model, beta, .. } = vertex;
        let shape = self.names.shapes.get(hit.shape as usize).map_or("?", String::as_str);
        let material = match self.names.materials.get(hit.shape as usize) {
            Some(Some(name)) => format!("{name} ({model})"),
            _ => (*model).to_owned(),
        };
        let triangle = if hit.primitive > 0 { format!(" #{}", hit.primitive) } else { String::new() };
        let instance = hit.instance.map_or(String::new(), |id| format!(" of instance {}", id.get()));
        let (at, cos, distance) = (point(self.place(*p)), short(ns.dot(*wo)), short(*distance));
        format!("{depth:<4} {shape}{triangle}{instance}, {material}, at {at} after {distance} m, cos {cos}, throughput {}", color(*beta))
    }

    /// Text of a point where a medium scatters the path.
    fn medium_vertex(&self, vertex: &MediumVertex) -> String {
        let MediumVertex { depth, distance, medium, point: p, phase, beta, .. } = vertex;
        let (name, at, distance) = (self.medium(*medium), point(self.place(*p)), short(*distance));
        format!("{depth:<4} {name} ({phase}), at {at} after {distance} m, throughput {}", color(*beta))
    }

    /// Name of a medium.
    fn medium(&self, medium: MediumId) -> &str {
        self.names.media.get(medium.0 as usize).map_or("?", String::as_str)
    }

    /// Text of the start of a path at a light.
    fn emitted(&self, emitted: &EmittedRay) -> String {
        let (name, ray) = (self.names.light(self.lights, emitted.light), emitted.ray);
        let (from, towards) = (point(self.place(ray.origin)), direction(ray.direction));
        format!("light path of {name}, from {from} towards {towards}, flux {} W", color(emitted.flux()))
    }

    /// Text of a contribution.
    ///
    /// - `ns`: shading normal where the light was sampled; `None` in a medium
    fn contribution(&self, contribution: &Contribution, ns: Option<Vec3>) -> String {
        let Contribution { value, whole, origin, depth } = contribution;
        let name = origin.light.map_or("a medium", |light| self.names.light(self.lights, light));
        let how = match origin.technique {
            Technique::Emission => "emission".to_owned(),
            Technique::Light { wi, density } => {
                let cos = ns.map_or(String::new(), |ns| format!(", cos {}", short(ns.dot(wi))));
                format!("light sample{cos}, {}", dense(density))
            }
        };
        let weight = if origin.weight == 1.0 { String::new() } else { format!(", MIS weight {}", short(origin.weight)) };
        let clamped = if value == whole { String::new() } else { format!(", clamped from {}", exact(*whole)) };
        format!("{} from {name} ({how}{weight}; depth {depth}{clamped})", exact(*value))
    }

    fn json(&self) -> Value {
        let SampleId { pixel: (x, y), index } = self.id;
        let events: Vec<Value> = self.events.iter().map(|event| self.event(event)).collect();
        json!({
            "integrator": self.integrator, "pixel": [x, y], "sample": index,
            "camera": { "from": self.place(self.camera.ray.origin), "towards": self.camera.ray.direction.to_array() },
            "events": events, "sum": self.sum().to_rgb(), "filter_weight": self.camera.weight, "value": self.value.to_rgb(),
        })
    }

    fn event(&self, event: &Event) -> Value {
        match event {
            Event::Vertex(v) => json!({
                "event": "vertex", "depth": v.depth, "shape": self.names.shapes.get(v.hit.shape as usize), "primitive": v.hit.primitive,
                "instance": v.hit.instance.map(|id| id.get()),
                "material": self.names.materials.get(v.hit.shape as usize), "model": v.model, "point": self.place(v.point),
                "distance": v.distance, "ng": v.ng.to_array(), "ns": v.ns.to_array(), "wo": v.wo.to_array(), "throughput": v.beta.to_rgb(),
            }),
            Event::Medium(v) => json!({
                "event": "medium", "depth": v.depth, "medium": self.medium(v.medium), "phase": v.phase, "point": self.place(v.point),
                "distance": v.distance, "wo": v.wo.to_array(), "throughput": v.beta.to_rgb(),
            }),
            Event::Wavelength { depth, wavelength, factors } => json!({
                "event": "wavelength", "depth": depth, "nanometres": wavelength.nanometres(), "factors": factors.to_rgb(),
            }),
            Event::Light(c) => {
                let (technique, wi, density) = match c.origin.technique {
                    Technique::Emission => ("emission", None, None),
                    Technique::Light { wi, density } => ("light", Some(wi.to_array()), Some(density)),
                };
                json!({
                    "event": "light", "depth": c.depth, "value": c.value.to_rgb(), "whole": c.whole.to_rgb(),
                    "light": c.origin.light.map(|light| self.names.light(self.lights, light)), "technique": technique, "wi": wi,
                    "density": density.map(number), "weight": c.origin.weight,
                })
            }
            Event::Scattering(s) => json!({
                "event": "scattering", "depth": s.depth, "wi": s.wi.to_array(), "cos": s.cos, "lobe": lobe(s.lobe),
                "density": number(s.density), "value": s.value.to_rgb(), "weight": s.weight.to_rgb(), "survival": s.survival,
            }),
            Event::Emission(e) => json!({
                "event": "emission", "light": self.names.light(self.lights, e.light), "from": self.place(e.ray.origin),
                "towards": e.ray.direction.to_array(), "flux": e.flux().to_rgb(),
            }),
            Event::Splat(s) => json!({
                "event": "splat", "depth": s.depth, "raster": s.raster.to_array(), "value": s.value.to_rgb(),
                "light": self.names.light(self.lights, s.light),
            }),
            Event::End { depth, why } => json!({ "event": "end", "depth": depth, "why": reason(*why) }),
        }
    }
}

/// Indentation of events: the branches of a path are indented further than the vertex they start from.
#[derive(Default)]
struct Branches {
    /// Indentations of the branches still to come, for each depth on the way to the current event.
    waiting: Vec<VecDeque<usize>>,
    /// Depth of the current branch, until it ends.
    at: Option<u32>,
    here: usize,
}

impl Branches {
    fn indent(&mut self, event: &Event) -> usize {
        match event {
            Event::Vertex(Vertex { depth, .. }) | Event::Medium(MediumVertex { depth, .. }) => self.enter(*depth),
            // Light of the background, and the end of a path there, belong to no vertex.
            Event::Light(c) if c.origin.technique == Technique::Emission && self.at != Some(c.depth) => self.enter(c.depth),
            Event::End { depth, .. } => {
                if self.at != Some(*depth) {
                    self.enter(*depth);
                }
                self.waiting.truncate(*depth as usize);
                self.at = None;
            }
            Event::Scattering(s) => self.leave(s.depth as usize),
            Event::Emission(_) => *self = Branches::default(),
            Event::Light(_) | Event::Splat(_) | Event::Wavelength { .. } => {}
        }
        self.here
    }

    /// Enters a depth. Events come depth first: depth d + 1 is the next branch of the last vertex of depth d.
    fn enter(&mut self, depth: u32) {
        let before = depth.checked_sub(1).and_then(|before| self.waiting.get_mut(before as usize));
        self.here = before.and_then(VecDeque::pop_front).unwrap_or(0);
        self.at = Some(depth);
    }

    fn leave(&mut self, depth: usize) {
        self.waiting.resize(depth + 1, VecDeque::new());
        let branches = &mut self.waiting[depth];
        branches.push_back(self.here);
        if branches.len() == 2 {
            branches.iter_mut().for_each(|place| *place = self.here + 1);
        }
    }
}

/// Text of light that is brought to the film.
pub fn splatted(splat: &Splat) -> String {
    let Splat { raster, value, depth, .. } = splat;
    format!("{} to the film at {}, {} (depth {depth})", exact(*value), short(raster.x), short(raster.y))
}

fn scattered(s: &Scattering) -> String {
    let eval = match s.density {
        Density::Smooth(_) => format!(", f·cos {}", color(s.value)),
        Density::Delta => String::new(),
    };
    let (eval, cos) = match s.lobe {
        Lobe::Medium => (String::new(), String::new()),
        _ => (eval, format!(", cos {}", short(s.cos))),
    };
    let chance = if s.survival < 1.0 { format!(", lives on with a chance of {}", short(s.survival)) } else { String::new() };
    format!("→ {} towards {}{cos}{eval}, {}, weight {}{chance}", lobe(s.lobe), direction(s.wi), dense(s.density), color(s.weight))
}

fn lobe(lobe: Lobe) -> &'static str {
    match lobe {
        Lobe::Reflection => "reflection",
        Lobe::Transmission => "transmission",
        Lobe::Medium => "phase function",
    }
}

fn ended(why: End) -> &'static str {
    match why {
        End::Escaped => "leaves the scene",
        End::DepthLimit => "the depth limit",
        End::Absorbed => "nothing is scattered",
        End::Roulette => "Russian roulette",
        End::NotFollowed => "no mirror to follow",
    }
}

fn reason(why: End) -> &'static str {
    match why {
        End::Escaped => "escaped",
        End::DepthLimit => "depth_limit",
        End::Absorbed => "absorbed",
        End::Roulette => "roulette",
        End::NotFollowed => "not_followed",
    }
}

fn dense(density: Density) -> String {
    match density {
        Density::Smooth(pdf) => format!("density {} sr⁻¹", short(pdf.get())),
        Density::Delta => "one direction".into(),
    }
}

/// Density as JSON; `null` for a single direction.
fn number(density: Density) -> Option<f32> {
    match density {
        Density::Smooth(pdf) => Some(pdf.get()),
        Density::Delta => None,
    }
}

/// Value with all significant digits, as these numbers are meant to be added.
fn exact(value: Spectrum) -> String {
    let [r, g, b] = value.to_rgb();
    format!("{r:?} {g:?} {b:?}")
}

fn color(value: Spectrum) -> String {
    let [r, g, b] = value.to_rgb().map(short);
    if r == g && g == b { r } else { format!("{r} {g} {b}") }
}

fn direction(w: Vec3) -> String {
    let [x, y, z] = w.to_array().map(|x| format!("{x:.3}"));
    format!("({x}, {y}, {z})")
}

fn point(p: [f64; 3]) -> String {
    let [x, y, z] = p.map(|x| short(x as f32));
    format!("({x}, {y}, {z})")
}

/// Number with four digits.
fn short(x: f32) -> String {
    let magnitude = x.abs().log10().floor();
    if x == 0.0 || (-3.0..6.0).contains(&magnitude) {
        let places = if x == 0.0 { 0 } else { (3.0 - magnitude).max(0.0) as usize };
        let text = format!("{x:.places$}");
        return if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text };
    }
    format!("{x:.3e}")
}
