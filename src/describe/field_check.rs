//! Checks of distance fields before they are built.

use super::field::*;
use super::shape::Sdf;
use crate::format::Transform;

/// Returns what is wrong with a solid: the JSON pointer of each fault, and its message.
pub(super) fn check(pointer: &str, sdf: &Sdf) -> Vec<(String, String)> {
    let mut checker = Checker(vec![]);
    match (&sdf.field, &sdf.parts) {
        (Some(field), None) => checker.field(&format!("{pointer}/field"), field, Thickness::Needed),
        (None, Some(parts)) if parts.is_empty() => checker.fault(format!("{pointer}/parts"), "expected at least one part"),
        (None, Some(parts)) => {
            for (i, part) in parts.iter().enumerate() {
                checker.field(&format!("{pointer}/parts/{i}/field"), &part.field, Thickness::Needed);
            }
        }
        _ => checker.fault(pointer, "an sdf needs either \"field\" or \"parts\""),
    }
    if let Some(bounds) = &sdf.bounds {
        checker.sides(&format!("{pointer}/bounds"), bounds);
    }
    checker.0
}

/// Whether lines and circles need a thickness to be visible, or an extrusion gives it to them.
#[derive(Clone, Copy)]
enum Thickness {
    Needed,
    FromExtrusion,
}

/// Says what is wrong with the corners of a box, with its JSON pointer.
pub(super) fn sides(pointer: &str, sides: &impl Sides) -> Option<(String, String)> {
    let axis = sides.sides().into_iter().position(|side| side <= 0.0)?;
    let [low, high] = sides.corners().map(|corner| corner.0[axis]);
    Some((format!("{pointer}/high/{axis}"), format!("expected a number above {low}, that of low, found {high}")))
}

struct Checker(Vec<(String, String)>);

impl Checker {
    fn fault(&mut self, pointer: impl Into<String>, message: impl Into<String>) {
        self.0.push((pointer.into(), message.into()));
    }

    fn field(&mut self, pointer: &str, field: &Field, thickness: Thickness) {
        let of = format!("{pointer}/of");
        match field {
            Field::Sphere(_) | Field::Plane(_) => {}
            Field::Box(f) => {
                self.sides(pointer, f);
                let least = f.sides().into_iter().fold(f64::INFINITY, f64::min);
                if f.rounding.get() > 0.5 * least.max(0.0) {
                    let message = format!("expected at most {}, half the shortest side, found {}", 0.5 * least, f.rounding.get());
                    self.fault(format!("{pointer}/rounding"), message);
                }
            }
            Field::ChebyshevBox(f) => self.sides(pointer, f),
            Field::Segment(f) => {
                if f.from == f.to {
                    self.fault(format!("{pointer}/to"), "from and to are the same point: that is a sphere");
                }
                self.thick(pointer, "radius", f.radius.get(), thickness);
            }
            Field::Torus(f) => self.thick(pointer, "tube", f.tube.get(), thickness),
            Field::HalfRing(f) => self.thick(pointer, "tube", f.tube.get(), thickness),
            Field::Union(f) => self.fields(&of, &f.of, thickness),
            Field::Intersection(f) => self.fields(&of, &f.of, thickness),
            Field::SmoothUnion(f) => self.fields(&of, &f.of, thickness),
            Field::Difference(f) => {
                self.field(&format!("{pointer}/from"), &f.from, thickness);
                self.fields(&format!("{pointer}/minus"), &f.minus, Thickness::Needed);
            }
            Field::Complement(f) => self.field(&of, &f.of, Thickness::Needed),
            Field::Place(f) => {
                self.field(&of, &f.of, thickness);
                self.transform(&format!("{pointer}/transform"), &f.transform);
            }
            Field::Mirror(f) => self.field(&of, &f.of, thickness),
            Field::Repeat(f) => {
                self.field(&of, &f.of, thickness);
                if let (Some(first), Some(last)) = (f.first, f.last)
                    && first > last
                {
                    self.fault(format!("{pointer}/last"), format!("the last copy, {last}, comes before the first, {first}"));
                }
            }
            Field::Extrude(f) => self.field(&of, &f.of, Thickness::FromExtrusion),
        }
    }

    fn fields(&mut self, pointer: &str, fields: &[Field], thickness: Thickness) {
        if fields.is_empty() {
            self.fault(pointer, "expected at least one field");
        }
        for (i, field) in fields.iter().enumerate() {
            self.field(&format!("{pointer}/{i}"), field, thickness);
        }
    }

    fn sides(&mut self, pointer: &str, box_: &impl Sides) {
        self.0.extend(sides(pointer, box_));
    }

    fn thick(&mut self, pointer: &str, key: &str, radius: f64, thickness: Thickness) {
        if matches!(thickness, Thickness::Needed) && radius == 0.0 {
            self.fault(pointer, format!("expected a \"{key}\" above 0: only within an \"extrude\" it may be 0"));
        }
    }

    fn transform(&mut self, pointer: &str, transform: &Transform) {
        for (i, step) in transform.0.iter().enumerate() {
            if let Err(message) = step.check() {
                self.fault(format!("{pointer}/{i}/{}", step.key()), message);
            }
        }
    }
}
