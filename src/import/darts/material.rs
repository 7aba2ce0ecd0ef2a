//! Materials, by name or inline; and light, which is a material there and a property of shapes here.

use std::collections::BTreeSet;

use super::Reader;
use super::spelling::word;
use super::value::{color, numbers, scalar};
use crate::import::view::View;
use crate::reader::{Node, Value, unknown};

const TYPES: &[&str] = &[
    "lambertian",
    "diffuse",
    "diffuse light",
    "emission",
    "metal",
    "dielectric",
    "phong",
    "blinn-phong",
    "beckmann",
    "oren-nayar",
    "blend",
    "fresnel_blend",
    "mix",
];

/// What a surface wears.
pub struct Dress {
    pub material: Node,
    pub emission: Option<Node>,
}

impl<'a> Reader<'a> {
    /// Of a surface, where `material` is a name or an object, or missing: matte, 0.8.
    pub fn dress(&self, surface: &View<'a>) -> Option<Dress> {
        let Some(given) = surface.get(&["material"]) else {
            let members = [("type", surface.make_text("diffuse")), ("albedo", surface.make_number(ALBEDO))];
            return Some(Dress { material: surface.make_object(members), emission: None });
        };
        let described = if given.is_text() { self.named(&given)? } else { given.clone() };
        if is_light(&described) {
            return Some(Dress { material: black(&given), emission: Some(emission(&described)?) });
        }
        Some(Dress { material: self.reference(&given)?, emission: None })
    }

    /// The material that a text names.
    fn named(&self, name: &View<'a>) -> Option<View<'a>> {
        let found = self.materials.get(name.text()?).cloned();
        if found.is_none() {
            let known: Vec<&str> = self.materials.keys().copied().collect();
            name.fault(unknown("material", name.text()?, &known));
        }
        found
    }

    /// Whether a material, or what it is made of, varies over texture coordinates.
    pub fn varies_over_uv(&self, material: &View<'a>) -> bool {
        let mut open = vec![material.node()];
        let mut seen = BTreeSet::new();
        while let Some(node) = open.pop() {
            match &node.value {
                Value::String(text) if text == "image" || text == "uv" => return true,
                Value::String(name) if seen.insert(name) => {
                    open.extend(self.materials.get(&**name).map(View::node));
                }
                Value::Array(items) => open.extend(items),
                Value::Object(members) => open.extend(members.iter().filter(|member| member.key != "name").map(|member| &member.node)),
                _ => {}
            }
        }
        false
    }

    /// A name or a material, where none may shine.
    fn reference(&self, view: &View<'a>) -> Option<Node> {
        if !view.is_text() {
            return self.material(view);
        }
        if is_light(&self.named(view)?) {
            view.fault("a light within another material is not supported");
            return None;
        }
        Some(view.same())
    }

    /// The materials that have names; what shines is black for those who look a name up that a mesh file says.
    pub fn named_materials(&self, list: &View<'a>) -> Option<Node> {
        let made = self.materials.iter().map(|(name, view)| {
            let node = if is_light(view) { Some(black(view)) } else { self.material(view) };
            node.map(|node| (*name, node))
        });
        Some(list.make_object(made.collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>()?))
    }

    pub fn material(&self, view: &View<'a>) -> Option<Node> {
        let kind = view.need(&["type"])?;
        match word(kind.text()?).as_str() {
            "lambertian" | "diffuse" => self.of(view, "diffuse", &[Part::Color("albedo")], &[]),
            "metal" => self.of(view, "metal", &[Part::Color("color"), Part::Textured("roughness", &["roughness"])], &["roughness"]),
            "dielectric" => self.of(view, "dielectric", &[Part::Number("eta", &["ior"])], &["ior"]),
            "phong" => self.of(view, "phong", &[Part::Color("color"), Part::Number("exponent", &["exponent"])], &["exponent"]),
            "blinnphong" | "blinn_phong" => {
                self.of(view, "blinn_phong", &[Part::Color("color"), Part::Number("exponent", &["exponent"])], &["exponent"])
            }
            "oren_nayar" => self.oren_nayar(view),
            "beckmann" => self.beckmann(view),
            "blend" | "mix" => self.mix(view),
            "fresnel_blend" => self.fresnel_blend(view),
            "diffuse_light" | "emission" => {
                view.fault("a light within another material is not supported");
                None
            }
            _ => {
                kind.fault(unknown("material", kind.text()?, TYPES));
                None
            }
        }
    }

    /// From `a` to `b` by a share, or by how much an interface reflects.
    fn mix(&self, view: &View<'a>) -> Option<Node> {
        view.leave_out_others(&["type", "name", "a", "b", "amount", "factor"]);
        let [a, b] = [self.reference(&view.need(&["a"])?)?, self.reference(&view.need(&["b"])?)?];
        let factor = view.get(&["amount", "factor"]);
        let share = match factor {
            None => ("share", view.make_number(0.5)),
            Some(factor) if is_type(&factor, "fresnel") => {
                factor.leave_out_others(&["type", "ior"]);
                ("fresnel", scalar(&factor.need(&["ior"])?)?)
            }
            Some(factor) => ("share", self.textured(&factor)?),
        };
        Some(view.make_object([("type", view.make_text("mix")), ("a", a), ("b", b), share]))
    }

    /// `refl` as much as an interface reflects, else `refr`.
    fn fresnel_blend(&self, view: &View<'a>) -> Option<Node> {
        view.leave_out_others(&["type", "name", "refr", "refl", "ior"]);
        let [a, b] = [self.reference(&view.need(&["refr"])?)?, self.reference(&view.need(&["refl"])?)?];
        let fresnel = scalar(&view.need(&["ior"])?)?;
        Some(view.make_object([("type", view.make_text("mix")), ("a", a), ("b", b), ("fresnel", fresnel)]))
    }
}

/// Of what names none, and of matte materials without one.
const ALBEDO: f64 = 0.8;
const COLOR: &[&str] = &["albedo", "color"];

/// A key of pt's, and those that it is read from.
enum Part {
    /// From `albedo` or `color`.
    Color(&'static str),
    Textured(&'static str, &'static [&'static str]),
    Number(&'static str, &'static [&'static str]),
}

impl Reader<'_> {
    /// A material that pt has under another name; `more`: the keys that it knows besides a colour.
    fn of(&self, view: &View, kind: &str, parts: &[Part], more: &[&str]) -> Option<Node> {
        view.leave_out_others(&[&["type", "name", "albedo", "color"], more].concat());
        let mut members = vec![("type", view.make_text(kind))];
        for part in parts {
            let made = match part {
                Part::Color(key) => Some((*key, self.albedo(view))),
                Part::Textured(key, from) => view.get(from).map(|view| (*key, self.textured(&view))),
                Part::Number(key, from) => view.get(from).map(|view| (*key, scalar(&view))),
            };
            if let Some((key, node)) = made {
                members.push((key, node?));
            }
        }
        Some(view.make_object(members))
    }

    /// Its colour, or the one that it has where nothing is said.
    fn albedo(&self, view: &View) -> Option<Node> {
        match view.get(COLOR) {
            Some(color) => self.textured(&color),
            None => Some(view.make_number(ALBEDO)),
        }
    }

    /// By the form of the model that loses no energy, with the same ratio of its two terms.
    ///
    /// The slopes' deviation σ gives f = ρ/π (A + B max(0, cos Δφ) sin α tan β), A = 1 − σ²/2 / (σ² + 0.33),
    /// B = 0.45 σ² / (σ² + 0.09); pt's roughness is B/A.
    fn oren_nayar(&self, view: &View) -> Option<Node> {
        view.leave_out_others(&["type", "name", "albedo", "color", "sigma"]);
        let sigma = view.get(&["sigma"]).map_or(Some([0.35]), |sigma| numbers::<1>(&sigma))?[0];
        let square = sigma * sigma;
        let (a, b) = (1.0 - 0.5 * square / (square + 0.33), 0.45 * square / (square + 0.09));
        view.note("approximated by the form of Oren and Nayar's model that loses no energy");
        let roughness = view.make_number((b / a).min(1.0));
        Some(view.make_object([("type", view.make_text("oren_nayar")), ("albedo", self.albedo(view)?), ("roughness", roughness)]))
    }

    /// A rough metal with facets of Beckmann's distribution, each reflecting once; its colour by what it is mixed with black.
    fn beckmann(&self, view: &View) -> Option<Node> {
        view.leave_out_others(&["type", "name", "albedo", "color", "ab", "ior", "ext"]);
        let or = |key: &str, default: f64| view.get(&[key]).map_or(Some(view.make_number(default)), |view| color(&view));
        let metal = view.make_object([
            ("type", view.make_text("conductor")),
            ("eta", or("ior", 0.05)?),
            ("k", or("ext", 3.9)?),
            ("alpha", view.get(&["ab"]).map_or(Some(view.make_number(0.5)), |ab| self.textured(&ab))?),
            ("distribution", view.make_text("beckmann")),
            ("multiscatter", view.make_flag(false)),
        ]);
        let Some(albedo) = view.get(COLOR) else { return Some(metal) };
        if !albedo.is_object() {
            let [r, g, b] = numbers::<3>(&albedo)?;
            if r != g || g != b {
                albedo.note("the colour of a beckmann material is approximated by its mean");
            }
        }
        let share = self.textured(&albedo)?;
        Some(view.make_object([("type", view.make_text("mix")), ("a", black(view)), ("b", metal), ("share", share)]))
    }
}

/// Reflects nothing.
fn black(view: &View) -> Node {
    view.make_object([("type", view.make_text("mirror")), ("color", view.make_number(0.0))])
}

pub fn is_light(view: &View) -> bool {
    is_type(view, "diffuse_light") || is_type(view, "emission")
}

/// Whether it is an object of this type; without faults where it is not.
fn is_type(view: &View, kind: &str) -> bool {
    view.is_object() && view.get(&["type"]).filter(View::is_text).and_then(|view| view.text()).is_some_and(|text| word(text) == kind)
}

/// The radiance of the front.
fn emission(light: &View) -> Option<Node> {
    light.leave_out_others(&["type", "name", "emit", "color"]);
    let Some(emit) = light.get(&["emit", "color"]) else { return Some(light.make_number(1.0)) };
    if emit.is_object() {
        if !is_type(&emit, "constant") {
            emit.fault("light that varies over a surface is not supported");
            return None;
        }
        return color(&emit.need(&["color"])?);
    }
    color(&emit)
}
