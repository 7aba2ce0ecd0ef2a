//! Sets of light transport effects. Each part of a scene reports its effects, and the scene takes their union once.

use std::fmt;
use std::ops::{BitOr, BitOrAssign, Sub};

/// Set of light transport effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Effects(u32);

/// Bit and name of an effect, and the cost of simulating it.
struct EffectInfo {
    bit: Effects,
    name: &'static str,
    cost: &'static str,
}

impl Effects {
    /// The empty set.
    pub const NONE: Effects = Effects(0);
    /// Emitting surfaces on which points can be sampled.
    pub const AREA_LIGHT: Effects = Effects(1 << 0);
    /// Lights that a ray cannot hit: point, spot, directional.
    pub const POINT_LIGHT: Effects = Effects(1 << 1);
    /// Light from infinitely far away, all around.
    pub const ENVIRONMENT: Effects = Effects(1 << 2);
    /// Matte surfaces, which scatter into all directions and so light each other.
    pub const INTERREFLECTION: Effects = Effects(1 << 3);
    /// Mirrors: reflection into a single direction.
    pub const SPECULAR_REFLECTION: Effects = Effects(1 << 4);
    /// Rough metals and coats: reflection into a lobe of directions.
    pub const GLOSSY_REFLECTION: Effects = Effects(1 << 5);
    /// Clear glass: refraction into a single direction.
    pub const REFRACTION: Effects = Effects(1 << 6);
    /// Frosted glass: refraction into a lobe of directions.
    pub const ROUGH_REFRACTION: Effects = Effects(1 << 7);
    /// Depth of field.
    pub const THIN_LENS: Effects = Effects(1 << 8);
    /// Shading normals that differ from the geometric normals: interpolated, or from a normal or bump map.
    pub const SHADING_NORMALS: Effects = Effects(1 << 9);
    /// Parameters that vary over a surface.
    pub const TEXTURES: Effects = Effects(1 << 10);
    /// Surfaces with holes.
    pub const CUT_OUTS: Effects = Effects(1 << 11);
    /// Emitting surfaces on which no point can be sampled, so that paths hit them only by chance.
    pub const UNSAMPLED_EMITTER: Effects = Effects(1 << 12);
    /// Coarse meshes whose shadow terminator is that of the smooth surface that they stand for.
    pub const SMOOTH_SHADOWS: Effects = Effects(1 << 13);
    /// Things that move while the shutter is open. Only then samples draw a time.
    pub const MOTION: Effects = Effects(1 << 14);
    /// Textures that are averaged over the part of the surface that a camera ray stands for.
    pub const FOOTPRINTS: Effects = Effects(1 << 15);

    /// Media that absorb, scatter or emit light between surfaces.
    pub const MEDIA: Effects = Effects(1 << 16);
    /// Lenses of spherical surfaces, whose importance for paths from the lights is not known.
    pub const REALISTIC_LENS: Effects = Effects(1 << 17);
    /// Glass that bends light of each wavelength differently. Only then paths may carry light of a single wavelength.
    pub const DISPERSION: Effects = Effects(1 << 18);
    /// Films about as thin as a wavelength, whose colours are those of interference.
    pub const THIN_FILM: Effects = Effects(1 << 19);
    /// Hair, wires and ribbons: curves with a thickness.
    pub const CURVES: Effects = Effects(1 << 20);

    /// Light between surfaces that scatter into a continuum of directions, of which a path follows one at random.
    pub const SCATTERED: Effects = Effects::INTERREFLECTION.union(Effects::GLOSSY_REFLECTION).union(Effects::ROUGH_REFRACTION);

    /// All effects.
    pub const ALL: Effects = Effects((1 << TABLE.len()) - 1);

    /// Effects in either set.
    pub const fn union(self, other: Effects) -> Effects {
        Effects(self.0 | other.0)
    }

    /// Effects in this set and not in the other.
    pub const fn without(self, other: Effects) -> Effects {
        Effects(self.0 & !other.0)
    }

    /// Whether the other set is a subset of this one.
    pub const fn contains(self, other: Effects) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The effects of the same surfaces with roughness: lobes in the place of single directions.
    pub fn roughened(self) -> Effects {
        let lobes = [(Effects::SPECULAR_REFLECTION, Effects::GLOSSY_REFLECTION), (Effects::REFRACTION, Effects::ROUGH_REFRACTION)];
        let rough = |effects: Effects, (smooth, rough): (Effects, Effects)| match effects.contains(smooth) {
            true => effects.without(smooth) | rough,
            false => effects,
        };
        lobes.into_iter().fold(self, rough)
    }

    /// Each effect of the set.
    pub fn iter(self) -> impl Iterator<Item = Effects> {
        TABLE.iter().map(|k| k.bit).filter(move |&bit| self.contains(bit))
    }

    /// Costs of simulating the effects, in words; empty for the empty set.
    pub fn cost(self) -> String {
        self.join(|k| k.cost)
    }

    fn join(self, text: impl Fn(&EffectInfo) -> &'static str) -> String {
        TABLE.iter().filter(|k| self.contains(k.bit)).map(text).collect::<Vec<_>>().join(", ")
    }
}

/// Writes the names, separated by commas.
impl fmt::Display for Effects {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.join(|k| k.name))
    }
}

impl BitOr for Effects {
    type Output = Effects;
    fn bitor(self, other: Effects) -> Effects {
        self.union(other)
    }
}

impl BitOrAssign for Effects {
    fn bitor_assign(&mut self, other: Effects) {
        *self = self.union(other);
    }
}

impl Sub for Effects {
    type Output = Effects;
    fn sub(self, other: Effects) -> Effects {
        self.without(other)
    }
}

/// Table of all effects, in the order of their bits.
const TABLE: [EffectInfo; 21] = [
    EffectInfo { bit: Effects::AREA_LIGHT, name: "area lights", cost: "one shadow ray per vertex, a table of emitting primitives" },
    EffectInfo { bit: Effects::POINT_LIGHT, name: "point lights", cost: "one shadow ray per vertex" },
    EffectInfo { bit: Effects::ENVIRONMENT, name: "environment", cost: "one shadow ray per vertex, a lookup per ray that leaves" },
    EffectInfo { bit: Effects::INTERREFLECTION, name: "diffuse interreflection", cost: "one more ray per bounce" },
    EffectInfo { bit: Effects::SPECULAR_REFLECTION, name: "mirror reflection", cost: "one more ray per bounce" },
    EffectInfo { bit: Effects::GLOSSY_REFLECTION, name: "glossy reflection", cost: "one more ray per bounce" },
    EffectInfo { bit: Effects::REFRACTION, name: "refraction in clear glass", cost: "one more ray per interface" },
    EffectInfo { bit: Effects::ROUGH_REFRACTION, name: "refraction in rough glass", cost: "one more ray per interface" },
    EffectInfo { bit: Effects::THIN_LENS, name: "depth of field", cost: "two random numbers per camera ray" },
    EffectInfo { bit: Effects::SHADING_NORMALS, name: "shading normals", cost: "one interpolation per hit" },
    EffectInfo { bit: Effects::TEXTURES, name: "textures", cost: "one lookup per parameter and hit" },
    EffectInfo { bit: Effects::CUT_OUTS, name: "cut-outs", cost: "one lookup per surface that a ray meets, shadow rays too" },
    EffectInfo { bit: Effects::UNSAMPLED_EMITTER, name: "lights met by chance", cost: "noise: no shadow ray looks for them" },
    EffectInfo { bit: Effects::SMOOTH_SHADOWS, name: "smooth shadows of coarse meshes", cost: "a few operations per hit" },
    EffectInfo { bit: Effects::MOTION, name: "motion blur", cost: "one random number per camera ray" },
    EffectInfo {
        bit: Effects::FOOTPRINTS,
        name: "texture footprints",
        cost: "two more rays of the camera per sample, wider lookups up to the first matte surface",
    },
    EffectInfo {
        bit: Effects::MEDIA,
        name: "participating media",
        cost: "a vertex wherever a medium scatters, a ray through each boundary, paths one by one",
    },
    EffectInfo { bit: Effects::REALISTIC_LENS, name: "realistic lens", cost: "a refraction per surface of the lens and camera ray" },
    EffectInfo {
        bit: Effects::DISPERSION,
        name: "dispersion",
        cost: "noise of colour: one wavelength per path through glass, paths one by one",
    },
    EffectInfo { bit: Effects::THIN_FILM, name: "thin films", cost: "a few to dozens of lookups in a table per hit" },
    EffectInfo { bit: Effects::CURVES, name: "curves", cost: "the roots of a polynomial per piece that a ray comes near to" },
];
