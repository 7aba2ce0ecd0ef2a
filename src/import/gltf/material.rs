//! Materials: metallic-roughness and its extensions as `principled`, `dielectric` and `thin_dielectric`.
//!
//! pt's `principled` has the same parameters: roughness is perceptual in both (alpha = roughness²), and every factor multiplies its
//! texture. The thickness decides between kinds of glass: without KHR_materials_volume a surface is a thin pane.

use super::document::Document;
use super::texture::{Kind, Mapping, numbers};
use crate::bsdf::Dispersion;
use crate::format::Index;
use crate::import::json_cursor::JsonCursor;
use crate::reader::Node;

/// Extensions that are left out, each with the note about its effect.
const LEFT_OUT: &[(&str, &str)] = &[
    ("KHR_materials_diffuse_transmission", "light that goes through a thin matte sheet is left out: its back stays dark"),
    ("KHR_materials_unlit", "an unlit material is lit like any other: it has shades and is as bright as its light"),
];

/// The greatest index of refraction and thickness (nm) of a film that pt reads.
const MOST_ETA: f64 = 4.0;
const MOST_THICKNESS: f64 = 2000.0;

/// Vertex colours, which multiply those of the material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Colors {
    /// No vertex colours.
    None,
    /// Colours without opacity.
    Opaque,
    /// Colours with opacity.
    Blended,
}

impl Colors {
    /// Kind of the vertex colours of a primitive.
    pub fn of(primitive: &gltf::Primitive) -> Colors {
        match primitive.get(&gltf::Semantic::Colors(0)).map(|accessor| accessor.dimensions().multiplicity()) {
            None => Colors::None,
            Some(4) => Colors::Blended,
            Some(_) => Colors::Opaque,
        }
    }
}

/// Converted material, with the properties that a shape needs.
pub struct PreparedMaterial {
    /// Material node.
    pub node: Node,
    /// Emission node, if the material emits.
    pub emission: Option<Node>,
    /// Whether the emission is meant to light other surfaces.
    pub is_lamp: bool,
    /// Map for the texture coordinates of shapes with this material.
    pub mapping: Mapping,
}

impl<'a> Document<'a> {
    /// Converts a material by index, or the default material, for these vertex colours.
    pub fn material(&self, index: Option<usize>, colors: Colors) -> PreparedMaterial {
        let at = index.map_or_else(|| self.root.clone(), |i| self.item("materials", i));
        let pbr = index.and_then(|_| at.get(&["pbrMetallicRoughness"]));
        let own = index.map(|_| at.clone());
        let glossy = own.as_ref().and_then(|own| own.get(&["extensions"])?.get(&["KHR_materials_pbrSpecularGlossiness"]));
        let reader = Reader { document: self, pbr, own, at, glossy, colors };
        for (extension, sentence) in LEFT_OUT.iter().filter(|(name, _)| reader.extension(name).is_some()) {
            self.note(&reader.extension(extension).unwrap_or(reader.at.clone()), *sentence);
        }
        reader.note_textures();
        let (emission, is_lamp) = reader.emission();
        let node = reader.masked(reader.bumped(reader.surface()), emission.is_some());
        PreparedMaterial { node, emission, is_lamp, mapping: reader.mapping() }
    }
}

pub(super) struct Reader<'d, 'a> {
    pub(super) document: &'d Document<'a>,
    /// Cursor at the material; at the file if there is none.
    pub(super) at: JsonCursor<'a>,
    /// Cursor at the material, if there is one.
    own: Option<JsonCursor<'a>>,
    pbr: Option<JsonCursor<'a>>,
    /// Specular and glossiness, which replace metalness and roughness if the file has them.
    pub(super) glossy: Option<JsonCursor<'a>>,
    colors: Colors,
}

impl<'a> Reader<'_, 'a> {
    fn extension(&self, name: &str) -> Option<JsonCursor<'a>> {
        self.own.as_ref()?.get(&["extensions"])?.get(&[name])
    }

    /// Product of a texture and a factor, without those that are missing.
    fn textured(&self, of: Option<&JsonCursor<'a>>, texture: &str, kind: Kind, factor: Node, is_one: bool) -> Node {
        let image = of.and_then(|of| of.get(&[texture])).and_then(|info| Some((self.document.texture(&info, kind)?, info)));
        match image {
            None => factor,
            Some((image, _)) if is_one => image,
            Some((image, info)) => info.make_object([("type", info.make_text("product")), ("a", image), ("b", factor)]),
        }
    }

    /// Product of a factor and a channel of a texture.
    fn share(&self, of: Option<&JsonCursor<'a>>, key: &str, default: f64, [texture, channel]: [&'static str; 2]) -> Node {
        let (factor, at) = self.number(of, key, default);
        self.textured(of, texture, Kind::Share(channel), at.make_number(factor), factor == 1.0)
    }

    fn color(&self, of: Option<&JsonCursor<'a>>, key: &str, default: [f64; 3], texture: &str) -> Node {
        let at = of.and_then(|of| of.get(&[key]));
        let factor = at.as_ref().and_then(numbers).unwrap_or(default);
        let location = at.unwrap_or(self.at.clone());
        self.textured(of, texture, Kind::Color, location.make_numbers(factor), factor == [1.0; 3])
    }

    /// Value of a number, or `default` if the key is missing, and the cursor to which faults of the number belong.
    fn number(&self, of: Option<&JsonCursor<'a>>, key: &str, default: f64) -> (f64, JsonCursor<'a>) {
        let at = of.and_then(|of| of.get(&[key]));
        (at.as_ref().and_then(JsonCursor::number).unwrap_or(default), at.or_else(|| of.cloned()).unwrap_or_else(|| self.at.clone()))
    }

    /// Cursor at the object of the base colour, and the keys of its texture and its factor.
    fn base(&self) -> (Option<&JsonCursor<'a>>, [&'static str; 2]) {
        match &self.glossy {
            Some(glossy) => (Some(glossy), ["diffuseTexture", "diffuseFactor"]),
            None => (self.pbr.as_ref(), ["baseColorTexture", "baseColorFactor"]),
        }
    }

    /// Red, green, blue and opacity.
    fn base_factor(&self) -> ([f64; 4], JsonCursor<'a>) {
        let (of, [_, factor]) = self.base();
        let at = of.and_then(|of| of.get(&[factor]));
        (at.as_ref().and_then(numbers).unwrap_or([1.0; 4]), at.unwrap_or_else(|| self.at.clone()))
    }

    fn base_color(&self) -> Node {
        let ([r, g, b, _], at) = self.base_factor();
        let (of, [texture, _]) = self.base();
        let color = self.textured(of, texture, Kind::Color, at.make_numbers([r, g, b]), [r, g, b] == [1.0; 3]);
        self.colored(color)
    }

    /// Product of a colour and that of the vertices.
    pub(super) fn colored(&self, color: Node) -> Node {
        match self.colors {
            Colors::None => color,
            _ => self.times_vertices(color, None),
        }
    }

    fn times_vertices(&self, factor: Node, channel: Option<&str>) -> Node {
        let at = &self.at;
        let channel = channel.map(|channel| ("channel", at.make_text(channel)));
        let vertices = at.make_object([("type", at.make_text("vertex_color"))].into_iter().chain(channel));
        at.make_object([("type", at.make_text("product")), ("a", vertices), ("b", factor)])
    }

    /// Material without normal map and opacity.
    fn surface(&self) -> Node {
        let glass = self.extension("KHR_materials_transmission");
        let volume = self.extension("KHR_materials_volume");
        let share = glass.as_ref().map(|glass| self.share(Some(glass), "transmissionFactor", 0.0, ["transmissionTexture", "r"]));
        let is_solid = volume.as_ref().is_some_and(|volume| self.number(Some(volume), "thicknessFactor", 0.0).0 > 0.0);
        let factor = self.number(glass.as_ref(), "transmissionFactor", 0.0).0;
        match (share, glass) {
            (Some(share), Some(glass)) if factor > 0.0 => {
                let all_of_it = factor == 1.0 && !glass.has("transmissionTexture") && self.metallic().0 == 0.0;
                match (is_solid, all_of_it) {
                    (true, true) => self.body(volume),
                    (true, false) => self.principled(Some((share, volume))),
                    (false, _) => self.pane(&glass, share),
                }
            }
            _ => self.principled(None),
        }
    }

    fn metallic(&self) -> (f64, JsonCursor<'a>) {
        self.number(self.pbr.as_ref(), "metallicFactor", 1.0)
    }

    fn roughness(&self) -> Node {
        self.share(self.pbr.as_ref(), "roughnessFactor", 1.0, ["metallicRoughnessTexture", "g"])
    }

    fn eta(&self) -> Node {
        let (eta, at) = self.eta_number();
        at.make_number(eta)
    }

    /// The index of refraction, and its place.
    fn eta_number(&self) -> (f64, JsonCursor<'a>) {
        let (eta, at) = self.number(self.extension("KHR_materials_ior").as_ref(), "ior", 1.5);
        if eta != 0.0 {
            return (eta, at);
        }
        self.document.note(&at, "an index of refraction of 0, which reflects all light, is taken as 100");
        (100.0, at)
    }

    /// The dispersion 20/V of glass with the Abbe number V, and its place; `None` if there is none.
    fn dispersion(&self) -> Option<(f64, JsonCursor<'a>)> {
        let (dispersion, at) = self.number(self.extension("KHR_materials_dispersion").as_ref(), "dispersion", 0.0);
        (dispersion > 0.0).then_some((dispersion, at))
    }

    /// Converts to `principled`.
    ///
    /// - `glass`: share of the transmission, and the volume behind the surface
    fn principled(&self, glass: Option<(Node, Option<JsonCursor<'a>>)>) -> Node {
        let at = &self.at;
        let pbr = self.pbr.as_ref();
        let [base_color, metallic, roughness] = self.of_glossiness().unwrap_or_else(|| {
            let metallic = self.share(pbr, "metallicFactor", 1.0, ["metallicRoughnessTexture", "b"]);
            [self.base_color(), metallic, self.roughness()]
        });
        let mut members = vec![
            ("type", at.make_text("principled")),
            ("base_color", base_color),
            ("metallic", metallic),
            ("roughness", roughness),
            ("eta", self.eta()),
        ];
        if let Some((share, volume)) = glass {
            members.push(("transmission", share));
            if let Some(color) = volume.and_then(|volume| volume.get(&["attenuationColor"])) {
                self.document.note(&color, "the absorption of a material that transmits only in part is left out");
            }
            if let Some((_, dispersion)) = self.dispersion() {
                self.document
                    .note(&dispersion, "the dispersion of a material that transmits only in part is left out: all colours refract alike");
            }
        }
        if let Some(coat) = self.extension("KHR_materials_clearcoat") {
            members.push(("coat", self.share(Some(&coat), "clearcoatFactor", 0.0, ["clearcoatTexture", "r"])));
            members.push(("coat_roughness", self.share(Some(&coat), "clearcoatRoughnessFactor", 0.0, ["clearcoatRoughnessTexture", "g"])));
            if let Some(relief) = coat.get(&["clearcoatNormalTexture"]) {
                self.document.note(&relief, "the coat has the relief of what it coats: its own normal map is left out");
            }
        }
        if let Some(sheen) = self.extension("KHR_materials_sheen") {
            members.push(("sheen_color", self.color(Some(&sheen), "sheenColorFactor", [0.0; 3], "sheenColorTexture")));
            members.push(("sheen_roughness", self.share(Some(&sheen), "sheenRoughnessFactor", 0.0, ["sheenRoughnessTexture", "a"])));
        }
        if let Some((_, share, [eta, thickness])) = self.film() {
            members.extend([("iridescence", share), ("iridescence_eta", eta), ("iridescence_thickness", thickness)]);
        }
        if let Some(specular) = self.extension("KHR_materials_specular") {
            members.push(("specular", self.share(Some(&specular), "specularFactor", 1.0, ["specularTexture", "a"])));
            let tint = specular.get(&["specularColorFactor"]).filter(|tint| numbers(tint) != Some([1.0; 3]));
            if let Some(tint) = tint.or_else(|| specular.get(&["specularColorTexture"])) {
                self.document.note(&tint, "the colour of plastic's reflection is left out: it is white");
            }
        }
        if let Some(brushed) = self.extension("KHR_materials_anisotropy") {
            let (strength, location) = self.number(Some(&brushed), "anisotropyStrength", 0.0);
            members.push(("anisotropy", location.make_number(strength)));
            self.document.note(&brushed, "anisotropy runs along u, with pt's own widths; its rotation and texture are left out");
        }
        at.make_object(members)
    }

    /// Solid glass; the absorption is given by colour and distance, as in KHR_materials_volume.
    fn body(&self, volume: Option<JsonCursor<'a>>) -> Node {
        // Looked up once, because notes about it are counted.
        let (at, (index, index_at)) = (&self.at, self.eta_number());
        let (color, roughness, eta) = (self.base_color(), self.roughness(), index_at.make_number(index));
        let mut members = vec![("type", at.make_text("dielectric")), ("color", color), ("roughness", roughness), ("eta", eta)];
        let mut least_index = index;
        if let Some((dispersion, location)) = self.dispersion() {
            let abbe = 20.0 / dispersion;
            let is_index = |range: [f64; 2]| range.iter().all(|n| Index::RANGE.contains(*n));
            match Dispersion::of_abbe_number(index, abbe).range().filter(|range| abbe.is_finite() && is_index(*range)) {
                Some(range) => {
                    least_index = range[0];
                    members.push(("abbe", location.make_number(abbe)));
                }
                None => self.document.note(&location, "the dispersion is left out: it gives indices of refraction below 0.01 or above 100"),
            }
        }
        let distance = volume.as_ref().and_then(|volume| volume.get(&["attenuationDistance"]));
        if let Some((volume, distance)) = volume.zip(distance) {
            let color = self.color(Some(&volume), "attenuationColor", [1.0; 3], "");
            members.push(("absorption", volume.make_object([("color", color), ("distance", distance.same())])));
        }
        self.note_layers("glass");
        let Some((film, share, [eta, thickness])) = self.film() else { return at.make_object(members) };
        if least_index < 1.0 {
            self.document.note(&film, "the film on glass with an index of refraction below 1 is left out");
            return at.make_object(members);
        }
        let bare = members.clone();
        members.push(("film", film.make_object([("eta", eta), ("thickness", thickness)])));
        let covered = at.make_object(members);
        if self.is_all_filmed(&film) {
            return covered;
        }
        let kind = ("type", at.make_text("mix"));
        at.make_object([kind, ("a", at.make_object(bare)), ("b", covered), ("share", share)])
    }

    /// Pane without thickness, or a mix with one.
    fn pane(&self, glass: &JsonCursor<'a>, share: Node) -> Node {
        let at = &self.at;
        let kind = |kind: &str| ("type", at.make_text(kind));
        let has_texture = self.pbr.as_ref().is_some_and(|pbr| pbr.has("metallicRoughnessTexture"));
        if has_texture || self.number(self.pbr.as_ref(), "roughnessFactor", 1.0).0 > 0.0 {
            self.document.note(glass, "a thin pane is clear: its roughness is left out");
        }
        let bare = || at.make_object([kind("thin_dielectric"), ("color", self.base_color()), ("eta", self.eta())]);
        let pane = match self.film() {
            None => bare(),
            Some((film, share, [eta, thickness])) => {
                let members =
                    [kind("thin_film"), ("color", self.base_color()), ("pane", self.eta()), ("eta", eta), ("thickness", thickness)];
                let covered = at.make_object(members);
                if self.is_all_filmed(&film) {
                    covered
                } else {
                    at.make_object([kind("mix"), ("a", bare()), ("b", covered), ("share", share)])
                }
            }
        };
        if glass.get(&["transmissionFactor"]).and_then(|at| at.number()) == Some(1.0)
            && !glass.has("transmissionTexture")
            && self.metallic().0 == 0.0
        {
            self.note_layers("a pane");
            return pane;
        }
        at.make_object([kind("mix"), ("a", self.principled(None)), ("b", pane), ("share", share)])
    }

    /// The thin film of KHR_materials_iridescence: its place, the share that it covers, its index of refraction and its thickness (nm).
    /// `None` where it covers nothing.
    fn film(&self) -> Option<(JsonCursor<'a>, Node, [Node; 2])> {
        let film = self.extension("KHR_materials_iridescence")?;
        if !self.has_film() {
            return None;
        }
        let share = self.share(Some(&film), "iridescenceFactor", 0.0, ["iridescenceTexture", "r"]);
        let (eta, eta_at) = self.number(Some(&film), "iridescenceIor", 1.3);
        if eta > MOST_ETA {
            self.document.note(&eta_at, "a film with an index of more than 4 is taken as 4");
        }
        let ends = [("iridescenceThicknessMinimum", 100.0), ("iridescenceThicknessMaximum", 400.0)];
        let [least, greatest] = ends.map(|(key, default)| {
            let (thickness, at) = self.number(Some(&film), key, default);
            if thickness > MOST_THICKNESS {
                self.document.note(&at, "a film of more than 2000 nm is taken as one of 2000: its colours are pale in either case");
            }
            at.make_number(thickness.min(MOST_THICKNESS))
        });
        let map = film.get(&["iridescenceThicknessTexture"]).and_then(|info| self.document.texture(&info, Kind::Share("g")));
        // Without a texture the film is as thick as can be.
        let thickness = match map {
            None => greatest,
            Some(by) => film.make_object([("from", least), ("to", greatest), ("by", by)]),
        };
        Some((film, share, [eta_at.make_number(eta.min(MOST_ETA)), thickness]))
    }

    fn is_all_filmed(&self, film: &JsonCursor<'a>) -> bool {
        self.number(Some(film), "iridescenceFactor", 0.0).0 == 1.0 && !film.has("iridescenceTexture")
    }

    fn has_film(&self) -> bool {
        self.extension("KHR_materials_iridescence").is_some_and(|film| self.number(Some(&film), "iridescenceFactor", 0.0).0 != 0.0)
    }

    fn note_layers(&self, what: &str) {
        let layers = ["KHR_materials_clearcoat", "KHR_materials_sheen", "KHR_materials_anisotropy"];
        for name in layers {
            if let Some(layer) = self.extension(name) {
                self.document.note(&layer, format!("{name} on {what} is left out"));
            }
        }
    }

    fn bumped(&self, surface: Node) -> Node {
        let info = self.own.as_ref().and_then(|own| own.get(&["normalTexture"]));
        let Some((map, info)) = info.and_then(|info| Some((self.document.texture(&info, Kind::Normal)?, info))) else { return surface };
        let (scale, at) = self.number(Some(&info), "scale", 1.0);
        info.make_object([("type", info.make_text("bumped")), ("surface", surface), ("normal_map", map), ("scale", at.make_number(scale))])
    }

    fn masked(&self, surface: Node, emits: bool) -> Node {
        let Some(mode) = self.own.as_ref().and_then(|own| own.get(&["alphaMode"])) else { return surface };
        let word = mode.text().unwrap_or_default();
        if word == "OPAQUE" {
            return surface;
        }
        let ([.., alpha], at) = self.base_factor();
        let (of, [texture, _]) = self.base();
        let varies = of.is_some_and(|of| of.has(texture)) || self.colors == Colors::Blended;
        let opacity = self.textured(of, texture, Kind::Share("a"), at.make_number(alpha), alpha == 1.0);
        let opacity = if self.colors == Colors::Blended { self.times_vertices(opacity, Some("a")) } else { opacity };
        let opacity = if word == "MASK" {
            let (cutoff, location) = self.number(self.own.as_ref(), "alphaCutoff", 0.5);
            let at = location.make_number(cutoff);
            location.make_object([("type", location.make_text("threshold")), ("by", opacity), ("at", at)])
        } else {
            self.document.note(&mode, "alphaMode BLEND: each ray hits the surface with the probability alpha, whatever the order");
            opacity
        };
        if !varies && alpha == 1.0 {
            return surface;
        }
        if emits {
            self.document.note(&mode, "what shines has no holes: its opacity is left out");
            return surface;
        }
        mode.make_object([("type", mode.make_text("masked")), ("surface", surface), ("opacity", opacity)])
    }

    /// Emission, and whether it is meant to light others: a file that gives a strength means so.
    fn emission(&self) -> (Option<Node>, bool) {
        let Some(own) = &self.own else { return (None, false) };
        let extension = self.extension("KHR_materials_emissive_strength");
        let (strength, _) = self.number(extension.as_ref(), "emissiveStrength", 1.0);
        let Some(at) = own.get(&["emissiveFactor"]) else { return (None, false) };
        let Some(factor) = numbers::<3>(&at).filter(|factor| *factor != [0.0; 3]) else { return (None, false) };
        let two_sided = own.get(&["doubleSided"]).and_then(|flag| flag.flag()).unwrap_or(false);
        let radiance = factor.map(|c| c * strength);
        let mut members = vec![("radiance", at.make_numbers(radiance)), ("two_sided", at.make_flag(two_sided))];
        if let Some(info) = own.get(&["emissiveTexture"]) {
            // Without its picture the whole surface would emit.
            let Some(texture) = self.document.texture(&info, Kind::Emission) else { return (None, false) };
            members.push(("texture", texture));
        }
        (Some(at.make_object(members)), extension.is_some() && radiance.iter().any(|c| *c > 0.0))
    }

    /// All references to textures, the most important first.
    fn references(&self) -> Vec<JsonCursor<'a>> {
        let base = self.pbr.iter().flat_map(|pbr| [pbr.get(&["baseColorTexture"]), pbr.get(&["metallicRoughnessTexture"])]);
        let own = self.own.iter().flat_map(|own| [own.get(&["normalTexture"]), own.get(&["emissiveTexture"])]);
        let extensions = self.own.iter().filter_map(|own| own.get(&["extensions"])?.members()).flatten();
        let of_extensions = extensions.filter(|(_, view)| view.is_object()).filter_map(|(_, view)| view.members()).flatten();
        let infos = of_extensions.filter(|(key, view)| key.ends_with("Texture") && view.is_object()).map(|(_, view)| Some(view));
        base.chain(own).chain(infos).flatten().collect()
    }

    fn mapping(&self) -> Mapping {
        self.references().first().map(Mapping::of).unwrap_or_default()
    }

    /// Notes texture coordinates that are left out: a mesh of pt has one set.
    fn note_textures(&self) {
        let mapping = self.mapping();
        for other in self.references().iter().filter(|info| Mapping::of(info) != mapping) {
            self.document.note(other, "all textures of a material use the coordinates of its first one: those of this one are left out");
        }
        if let Some(occlusion) = self.own.as_ref().and_then(|own| own.get(&["occlusionTexture"])) {
            self.document.note(&occlusion, "baked occlusion is left out: light finds its way by itself");
        }
    }
}
