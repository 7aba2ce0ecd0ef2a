//! Materials, by name or inline. Emission is a material in those programs and a property of shapes in pt.

use std::collections::BTreeSet;

use super::Reader;
use super::spelling::word;
use super::value::{color, numbers, scalar};
use crate::import::json_cursor::JsonCursor;
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

/// Material and emission of a surface.
pub struct SurfaceAppearance {
    /// Material.
    pub material: Node,
    /// Emission, if the surface is a light.
    pub emission: Option<Node>,
}

impl<'a> Reader<'a> {
    /// Material and emission of a surface, whose `material` is a name or an object. Without one it is matte with albedo 0.8.
    pub fn appearance(&self, surface: &JsonCursor<'a>) -> Option<SurfaceAppearance> {
        let Some(given) = surface.get(&["material"]) else {
            let members = [("type", surface.make_text("diffuse")), ("albedo", surface.make_number(ALBEDO))];
            return Some(SurfaceAppearance { material: surface.make_object(members), emission: None });
        };
        let described = if given.is_text() { self.named(&given)? } else { given.clone() };
        if is_light(&described) {
            return Some(SurfaceAppearance { material: black(&given), emission: Some(emission(&described)?) });
        }
        Some(SurfaceAppearance { material: self.reference(&given)?, emission: None })
    }

    /// Material of a name.
    fn named(&self, name: &JsonCursor<'a>) -> Option<JsonCursor<'a>> {
        let found = self.materials.get(name.text()?).cloned();
        if found.is_none() {
            let known: Vec<&str> = self.materials.keys().copied().collect();
            name.fault(unknown("material", name.text()?, &known));
        }
        found
    }

    /// Returns whether a material, or a material it is made of, varies over texture coordinates.
    pub fn varies_over_uv(&self, material: &JsonCursor<'a>) -> bool {
        let mut open = vec![material.node()];
        let mut seen = BTreeSet::new();
        while let Some(node) = open.pop() {
            match &node.value {
                Value::String(text) if text == "image" || text == "uv" => return true,
                Value::String(name) if seen.insert(name) => {
                    open.extend(self.materials.get(&**name).map(JsonCursor::node));
                }
                Value::Array(items) => open.extend(items),
                Value::Object(members) => open.extend(members.iter().filter(|member| member.key != "name").map(|member| &member.node)),
                _ => {}
            }
        }
        false
    }

    /// Name of a material, or a material; lights are refused.
    fn reference(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        if !cursor.is_text() {
            return self.material(cursor);
        }
        if is_light(&self.named(cursor)?) {
            cursor.fault("a light within another material is not supported");
            return None;
        }
        Some(cursor.same())
    }

    /// Materials with names. A light becomes black, for mesh files that name it.
    pub fn named_materials(&self, list: &JsonCursor<'a>) -> Option<Node> {
        let made = self.materials.iter().map(|(name, cursor)| {
            let node = if is_light(cursor) { Some(black(cursor)) } else { self.material(cursor) };
            node.map(|node| (*name, node))
        });
        Some(list.make_object(made.collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>()?))
    }

    /// Converts a material.
    pub fn material(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        let kind = cursor.need(&["type"])?;
        match word(kind.text()?).as_str() {
            "lambertian" | "diffuse" => self.of(cursor, "diffuse", &[ParameterSource::Color("albedo")], &[]),
            "metal" => self.of(
                cursor,
                "metal",
                &[ParameterSource::Color("color"), ParameterSource::Textured("roughness", &["roughness"])],
                &["roughness"],
            ),
            "dielectric" => self.of(cursor, "dielectric", &[ParameterSource::Number("eta", &["ior"])], &["ior"]),
            "phong" => self.of(
                cursor,
                "phong",
                &[ParameterSource::Color("color"), ParameterSource::Number("exponent", &["exponent"])],
                &["exponent"],
            ),
            "blinnphong" | "blinn_phong" => self.of(
                cursor,
                "blinn_phong",
                &[ParameterSource::Color("color"), ParameterSource::Number("exponent", &["exponent"])],
                &["exponent"],
            ),
            "oren_nayar" => self.oren_nayar(cursor),
            "beckmann" => self.beckmann(cursor),
            "blend" | "mix" => self.mix(cursor),
            "fresnel_blend" => self.fresnel_blend(cursor),
            "diffuse_light" | "emission" => {
                cursor.fault("a light within another material is not supported");
                None
            }
            _ => {
                kind.fault(unknown("material", kind.text()?, TYPES));
                None
            }
        }
    }

    /// Mix of `a` and `b` by a share, or by the reflectance of an interface.
    fn mix(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        cursor.leave_out_others(&["type", "name", "a", "b", "amount", "factor"]);
        let [a, b] = [self.reference(&cursor.need(&["a"])?)?, self.reference(&cursor.need(&["b"])?)?];
        let factor = cursor.get(&["amount", "factor"]);
        let share = match factor {
            None => ("share", cursor.make_number(0.5)),
            Some(factor) if is_type(&factor, "fresnel") => {
                factor.leave_out_others(&["type", "ior"]);
                ("fresnel", scalar(&factor.need(&["ior"])?)?)
            }
            Some(factor) => ("share", self.textured(&factor)?),
        };
        Some(cursor.make_object([("type", cursor.make_text("mix")), ("a", a), ("b", b), share]))
    }

    /// Mix of `refl`, by the reflectance of an interface, and `refr`.
    fn fresnel_blend(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        cursor.leave_out_others(&["type", "name", "refr", "refl", "ior"]);
        let [a, b] = [self.reference(&cursor.need(&["refr"])?)?, self.reference(&cursor.need(&["refl"])?)?];
        let fresnel = scalar(&cursor.need(&["ior"])?)?;
        Some(cursor.make_object([("type", cursor.make_text("mix")), ("a", a), ("b", b), ("fresnel", fresnel)]))
    }
}

/// Albedo of a surface without material, and of a matte material without one.
const ALBEDO: f64 = 0.8;
const COLOR: &[&str] = &["albedo", "color"];

/// A key of pt's material, with the keys that it is read from.
enum ParameterSource {
    /// Colour from `albedo` or `color`.
    Color(&'static str),
    Textured(&'static str, &'static [&'static str]),
    Number(&'static str, &'static [&'static str]),
}

impl Reader<'_> {
    /// Converts a material that pt has under another name.
    ///
    /// - `more`: known keys besides a colour
    fn of(&self, cursor: &JsonCursor, kind: &str, parts: &[ParameterSource], more: &[&str]) -> Option<Node> {
        cursor.leave_out_others(&[&["type", "name", "albedo", "color"], more].concat());
        let mut members = vec![("type", cursor.make_text(kind))];
        for part in parts {
            let made = match part {
                ParameterSource::Color(key) => Some((*key, self.albedo(cursor))),
                ParameterSource::Textured(key, from) => cursor.get(from).map(|cursor| (*key, self.textured(&cursor))),
                ParameterSource::Number(key, from) => cursor.get(from).map(|cursor| (*key, scalar(&cursor))),
            };
            if let Some((key, node)) = made {
                members.push((key, node?));
            }
        }
        Some(cursor.make_object(members))
    }

    /// Colour of a material, or the default.
    fn albedo(&self, cursor: &JsonCursor) -> Option<Node> {
        match cursor.get(COLOR) {
            Some(color) => self.textured(&color),
            None => Some(cursor.make_number(ALBEDO)),
        }
    }

    /// Converts an Oren–Nayar material to the energy-preserving form of the model, with the same ratio of its two terms.
    ///
    /// The standard deviation σ of the slopes gives f = ρ/π (A + B max(0, cos Δφ) sin α tan β), A = 1 − σ²/2 / (σ² + 0.33), B =
    /// 0.45 σ² / (σ² + 0.09); pt's roughness is B/A.
    fn oren_nayar(&self, cursor: &JsonCursor) -> Option<Node> {
        cursor.leave_out_others(&["type", "name", "albedo", "color", "sigma"]);
        let sigma = cursor.get(&["sigma"]).map_or(Some([0.35]), |sigma| numbers::<1>(&sigma))?[0];
        let square = sigma * sigma;
        let (a, b) = (1.0 - 0.5 * square / (square + 0.33), 0.45 * square / (square + 0.09));
        cursor.note("approximated by the form of Oren and Nayar's model that loses no energy");
        let roughness = cursor.make_number((b / a).min(1.0));
        Some(cursor.make_object([("type", cursor.make_text("oren_nayar")), ("albedo", self.albedo(cursor)?), ("roughness", roughness)]))
    }

    /// Rough metal with Beckmann's distribution of facets and single scattering. Its colour is a mix with black.
    fn beckmann(&self, cursor: &JsonCursor) -> Option<Node> {
        cursor.leave_out_others(&["type", "name", "albedo", "color", "ab", "ior", "ext"]);
        let or = |key: &str, default: f64| cursor.get(&[key]).map_or(Some(cursor.make_number(default)), |cursor| color(&cursor));
        let metal = cursor.make_object([
            ("type", cursor.make_text("conductor")),
            ("eta", or("ior", 0.05)?),
            ("k", or("ext", 3.9)?),
            ("alpha", cursor.get(&["ab"]).map_or(Some(cursor.make_number(0.5)), |ab| self.textured(&ab))?),
            ("distribution", cursor.make_text("beckmann")),
            ("multiscatter", cursor.make_flag(false)),
        ]);
        let Some(albedo) = cursor.get(COLOR) else { return Some(metal) };
        if !albedo.is_object() {
            let [r, g, b] = numbers::<3>(&albedo)?;
            if r != g || g != b {
                albedo.note("the colour of a beckmann material is approximated by its mean");
            }
        }
        let share = self.textured(&albedo)?;
        Some(cursor.make_object([("type", cursor.make_text("mix")), ("a", black(cursor)), ("b", metal), ("share", share)]))
    }
}

/// Material that reflects nothing.
fn black(cursor: &JsonCursor) -> Node {
    cursor.make_object([("type", cursor.make_text("mirror")), ("color", cursor.make_number(0.0))])
}

/// Returns whether a material is a light.
pub fn is_light(cursor: &JsonCursor) -> bool {
    is_type(cursor, "diffuse_light") || is_type(cursor, "emission")
}

/// Returns whether a value is an object of this type; reports no faults.
fn is_type(cursor: &JsonCursor, kind: &str) -> bool {
    cursor.is_object()
        && cursor.get(&["type"]).filter(JsonCursor::is_text).and_then(|cursor| cursor.text()).is_some_and(|text| word(text) == kind)
}

/// Radiance of the front side.
fn emission(light: &JsonCursor) -> Option<Node> {
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
