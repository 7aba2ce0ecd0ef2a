//! What a scene calls for, as a set: the parts report, the scene takes the union once.

use std::fmt;
use std::ops::{BitOr, BitOrAssign, Sub};

/// A set of light-transport effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Effects(u32);

/// One effect: its bit, its name, and what it costs to simulate.
struct Known {
    bit: Effects,
    name: &'static str,
    cost: &'static str,
}

impl Effects {
    pub const NONE: Effects = Effects(0);
    /// Surfaces that emit.
    pub const AREA_LIGHT: Effects = Effects(1 << 0);
    /// Lights that a ray cannot hit: point, spot, directional.
    pub const POINT_LIGHT: Effects = Effects(1 << 1);
    /// Light from infinitely far away, all around.
    pub const ENVIRONMENT: Effects = Effects(1 << 2);
    /// Surfaces that scatter into a continuum of directions, so that they light each other.
    pub const INTERREFLECTION: Effects = Effects(1 << 3);
    /// Mirrors: reflection into a single direction.
    pub const SPECULAR_REFLECTION: Effects = Effects(1 << 4);
    /// Clear glass: refraction into a single direction.
    pub const REFRACTION: Effects = Effects(1 << 5);
    /// Depth of field.
    pub const THIN_LENS: Effects = Effects(1 << 6);
    /// Normals that are not the surface's own: interpolated, or turned by a relief.
    pub const SHADING_NORMALS: Effects = Effects(1 << 7);
    /// Parameters that vary over a surface.
    pub const TEXTURES: Effects = Effects(1 << 8);
    /// Surfaces with holes.
    pub const CUT_OUTS: Effects = Effects(1 << 9);
    /// Surfaces that emit and on which no point can be drawn: paths meet them by chance.
    pub const FOUND_LIGHT: Effects = Effects(1 << 10);

    /// Everything pt knows.
    pub const ALL: Effects = Effects((1 << KNOWN.len()) - 1);

    pub const fn union(self, other: Effects) -> Effects {
        Effects(self.0 | other.0)
    }

    pub const fn without(self, other: Effects) -> Effects {
        Effects(self.0 & !other.0)
    }

    pub const fn contains(self, other: Effects) -> bool {
        self.0 & other.0 == other.0
    }

    pub const fn intersects(self, other: Effects) -> bool {
        self.0 & other.0 != 0
    }

    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The members, one by one.
    pub fn iter(self) -> impl Iterator<Item = Effects> {
        KNOWN.iter().map(|k| k.bit).filter(move |&bit| self.contains(bit))
    }

    /// What simulating these costs, in words; empty for none.
    pub fn cost(self) -> String {
        self.join(|k| k.cost)
    }

    fn join(self, text: impl Fn(&Known) -> &'static str) -> String {
        KNOWN.iter().filter(|k| self.contains(k.bit)).map(text).collect::<Vec<_>>().join(", ")
    }
}

/// The names, separated by commas.
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

const KNOWN: [Known; 11] = [
    Known { bit: Effects::AREA_LIGHT, name: "area lights", cost: "one shadow ray per vertex, a table of emitting primitives" },
    Known { bit: Effects::POINT_LIGHT, name: "point lights", cost: "one shadow ray per vertex" },
    Known { bit: Effects::ENVIRONMENT, name: "environment", cost: "one shadow ray per vertex, a lookup per ray that leaves" },
    Known { bit: Effects::INTERREFLECTION, name: "diffuse interreflection", cost: "one more ray per bounce" },
    Known { bit: Effects::SPECULAR_REFLECTION, name: "mirror reflection", cost: "one more ray per bounce" },
    Known { bit: Effects::REFRACTION, name: "refraction", cost: "one more ray per interface" },
    Known { bit: Effects::THIN_LENS, name: "depth of field", cost: "two random numbers per camera ray" },
    Known { bit: Effects::SHADING_NORMALS, name: "shading normals", cost: "one interpolation per hit" },
    Known { bit: Effects::TEXTURES, name: "textures", cost: "one lookup per parameter and hit" },
    Known { bit: Effects::CUT_OUTS, name: "cut-outs", cost: "one lookup per surface that a ray meets, shadow rays too" },
    Known { bit: Effects::FOUND_LIGHT, name: "lights met by chance", cost: "noise: no shadow ray looks for them" },
];
