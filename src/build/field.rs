//! Builds solids from distance fields, with the material and emission of each part.

use glam::DVec3;

use super::{Builder, transform};
use crate::bsdf::MaterialId;
use crate::describe::{self, Axis, FixedMarch, Point};
use crate::effects::Effects;
use crate::math::Transform;
use crate::math::transform::unit;
use crate::shape::Sdf;
use crate::shape::sdf::*;
use crate::world::PartAppearance;

impl Builder<'_> {
    /// Builds a solid, and the appearance and the effects of its parts. Returns `None` after adding a fault.
    pub(super) fn sdf(&mut self, pointer: &str, sdf: &describe::Sdf, own: PartAppearance) -> Option<(Sdf, Vec<PartAppearance>, Effects)> {
        let (mut fields, mut appearances, mut effects) = (vec![], vec![], Effects::NONE);
        if let Some(field) = &sdf.field {
            fields.push(self.field(&format!("{pointer}/field"), field)?);
            appearances.push(own.clone());
        }
        for (i, part) in sdf.parts.iter().flatten().enumerate() {
            let pointer = format!("{pointer}/parts/{i}");
            let (material, more) = self.part_material(&pointer, part, own.material);
            effects |= more;
            let emitter = part.emission.as_ref().map(|described| self.emitter(&format!("{pointer}/emission"), described));
            appearances.push(PartAppearance { material, emitter: emitter.or_else(|| own.emitter.clone()) });
            fields.push(self.field(&format!("{pointer}/field"), &part.field)?);
        }
        let within = sdf.bounds.map_or([DVec3::NEG_INFINITY, DVec3::INFINITY], |b| [at(&b.low), at(&b.high)]);
        let solid = Sdf { parts: Union::new(fields), within, march: sdf.march.map_or(March::Exact, march) };
        self.within(pointer, &solid).then_some((solid, appearances, effects))
    }

    fn part_material(&mut self, pointer: &str, part: &describe::SdfPart, own: MaterialId) -> (MaterialId, Effects) {
        match &part.material {
            Some(chosen) => self.material(&format!("{pointer}/material"), Some(chosen)).1,
            None => (own, Effects::NONE),
        }
    }

    /// Whether the solid is bounded and not empty. Adds a fault otherwise.
    fn within(&mut self, pointer: &str, solid: &Sdf) -> bool {
        let ends = solid.ends();
        let [low, high] = solid.extent();
        let endless: Vec<&str> = ["x", "y", "z"].into_iter().enumerate().filter(|(k, _)| !ends.test(*k)).map(|(_, name)| name).collect();
        if !endless.is_empty() {
            self.fault(pointer, &format!("the field has no end along {}: give it \"bounds\"", endless.join(", ")));
        } else if !low.cmplt(high).all() {
            self.fault(pointer, "nothing of the field lies within its bounds");
        }
        endless.is_empty() && low.cmplt(high).all()
    }

    /// Builds a distance field. Returns `None` after adding a fault.
    fn field(&mut self, pointer: &str, field: &describe::Field) -> Option<Field> {
        use describe::Field as Of;
        let of = format!("{pointer}/of");
        Some(match field {
            Of::Sphere(f) => Field::Ball(Ball { center: at(&f.center), radius: f.radius.get() }),
            Of::Box(f) => Field::Cuboid(Cuboid { low: at(&f.low), high: at(&f.high), rounding: f.rounding.get() }),
            Of::ChebyshevBox(f) => Field::ChebyshevBox(ChebyshevBox { low: at(&f.low), high: at(&f.high) }),
            Of::Segment(f) => Field::Capsule(Capsule::new(at(&f.from), at(&f.to), f.radius.get())),
            Of::Torus(f) => Field::Ring(Ring { center: at(&f.center), radius: f.radius.get(), tube: f.tube.get(), half: false }),
            Of::HalfRing(f) => Field::Ring(Ring { center: at(&f.center), radius: f.radius.get(), tube: f.tube.get(), half: true }),
            Of::Plane(f) => Field::HalfSpace(HalfSpace { point: at(&f.point), normal: unit(DVec3::from(f.normal.0))? }),
            Of::Union(f) => Field::Union(Union::new(self.fields(&of, &f.of)?)),
            Of::Intersection(f) => Field::Intersection(Intersection { of: self.fields(&of, &f.of)? }),
            Of::SmoothUnion(f) => Field::SmoothUnion(SmoothUnion { of: self.fields(&of, &f.of)?, width: f.width.get() }),
            Of::Difference(f) => Field::Difference(Difference {
                from: self.field(&format!("{pointer}/from"), &f.from)?.into(),
                minus: self.fields(&format!("{pointer}/minus"), &f.minus)?,
            }),
            Of::Complement(f) => Field::Complement(Complement { of: self.field(&of, &f.of)?.into() }),
            Of::Place(f) => match transform::placed(&f.transform, &Transform::IDENTITY) {
                Ok(to_world) => Field::Placed(Placed::new(self.field(&of, &f.of)?, to_world).into()),
                Err(message) => {
                    self.fault(&format!("{pointer}/transform"), &message);
                    return None;
                }
            },
            Of::Mirror(f) => Field::Mirrored(Mirrored { of: self.field(&of, &f.of)?.into(), axis: number(f.axis) }),
            Of::Repeat(f) => {
                let copies = [f.first.map_or(f64::NEG_INFINITY, f64::from), f.last.map_or(f64::INFINITY, f64::from)];
                let repeated = Repeated::new(self.field(&of, &f.of)?, number(f.axis), f.period.get(), copies);
                if repeated.is_none() {
                    self.fault(&of, "what is repeated must be no longer than the period along the axis");
                }
                Field::Repeated(repeated?)
            }
            Of::Extrude(f) => Field::Extruded(Extruded {
                of: self.field(&of, &f.of)?.into(),
                half_thickness: f.half_thickness.get(),
                log_power: f.power.log2(),
            }),
        })
    }

    fn fields(&mut self, pointer: &str, fields: &[describe::Field]) -> Option<Vec<Field>> {
        fields.iter().enumerate().map(|(i, field)| self.field(&format!("{pointer}/{i}"), field)).collect()
    }
}

fn at(point: &Point) -> DVec3 {
    point.0.into()
}

fn number(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

fn march(m: FixedMarch) -> March {
    March::Fixed(Fixed { stop: m.stop.get(), most_steps: m.most_steps, reach: m.reach.get(), normal_step: m.normal_step.get() })
}
