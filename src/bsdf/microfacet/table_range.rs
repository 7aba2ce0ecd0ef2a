//! Ranges of tables for a parameter that varies over a surface.
//!
//! A table belongs to one value x of the parameter. A range of values has tables at equal steps of a [`Scale`], close enough together,
//! and a model interpolates linearly between two of them. Models are linear in these values, so that properties of each table
//! (reciprocity, energy conservation) hold between tables too.

use crate::math::float;

/// Tables at equal steps of a parameter; a single one for a constant parameter.
#[derive(Debug, PartialEq)]
pub struct TableRange<T: 'static> {
    tables: Vec<&'static T>,
    scale: Scale,
    /// The ends of the range, on the scale.
    ends: [f32; 2],
}

/// The scale on which values of a parameter x > 0 are spaced equally.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// ln x: values at equal ratios.
    Ratio,
    /// ±√|ln x| for an index of refraction. Near 1 it is proportional to the cosine of the critical angle, about √(2 |ln x|); elsewhere
    /// its steps are about equal ratios.
    Index,
}

impl Scale {
    fn of(self, x: f32) -> f32 {
        let log = float::ln(x);
        match self {
            Scale::Ratio => log,
            Scale::Index => log.abs().sqrt().copysign(log),
        }
    }

    fn inverse(self, place: f32) -> f32 {
        match self {
            Scale::Ratio => float::exp(place),
            Scale::Index => float::exp(place * place.abs()),
        }
    }

    /// The largest step from one table to the next. It gives 17 tables for ratios from 1 to 100, and for indices 15 tables from 1 to 1.6
    /// and 5 from 1.3 to 1.6.
    fn step(self) -> f32 {
        match self {
            Scale::Ratio => 0.29,
            Scale::Index => 0.05,
        }
    }
}

/// Two neighbouring tables and the position between them, from 0 to 1.
#[derive(Debug, PartialEq)]
pub struct LerpedTable<T: 'static> {
    tables: [&'static T; 2],
    part: f32,
}

impl<T> TableRange<T> {
    /// Computes the tables of a range.
    ///
    /// - `range`: the least and the greatest x, above 0
    /// - `table`: returns the table of one x
    pub fn new(range: [f32; 2], scale: Scale, table: impl Fn(f32) -> &'static T) -> TableRange<T> {
        let ends = range.map(|x| scale.of(x));
        if range[0] == range[1] {
            return TableRange { tables: vec![table(range[0])], scale, ends };
        }
        let steps = ((ends[1] - ends[0]) / scale.step()).ceil().max(1.0) as usize;
        let x = |k: usize| match k {
            0 => range[0],
            k if k == steps => range[1],
            k => scale.inverse(ends[0] + (ends[1] - ends[0]) * (k as f32 / steps as f32)),
        };
        TableRange { tables: (0..=steps).map(|k| table(x(k))).collect(), scale, ends }
    }

    /// The tables around a value x, which is limited to the range.
    pub fn at(&self, x: f32) -> LerpedTable<T> {
        let last = self.tables.len() - 1;
        if last == 0 {
            return self.tables[0].into();
        }
        let along = ((self.scale.of(x) - self.ends[0]) / (self.ends[1] - self.ends[0])).clamp(0.0, 1.0) * last as f32;
        let k = (along as usize).min(last - 1);
        LerpedTable { tables: [self.tables[k], self.tables[k + 1]], part: along - k as f32 }
    }
}

impl<T> LerpedTable<T> {
    /// Interpolates the value that `read` returns from each table.
    #[inline]
    pub fn value(&self, read: impl Fn(&T) -> f32) -> f32 {
        let low = read(self.tables[0]);
        if self.part == 0.0 { low } else { low + (read(self.tables[1]) - low) * self.part }
    }
}

/// Converts a single table.
impl<T> From<&'static T> for LerpedTable<T> {
    fn from(table: &'static T) -> LerpedTable<T> {
        LerpedTable { tables: [table; 2], part: 0.0 }
    }
}

// Not derived: references to tables can be copied even if tables cannot.
impl<T> Clone for LerpedTable<T> {
    fn clone(&self) -> LerpedTable<T> {
        *self
    }
}

impl<T> Copy for LerpedTable<T> {}

impl<T> Clone for TableRange<T> {
    fn clone(&self) -> TableRange<T> {
        TableRange { tables: self.tables.clone(), ..*self }
    }
}
