//! Tables for a parameter that varies over a surface.
//!
//! A table is made for one value x. For a range of values there are as many as it takes to be no further apart than a step, at
//! equal steps of a [`Scale`], and between two of them a model reads both. All that it reads is used linearly, so that what holds
//! of each (light goes back the way it came, none is made) holds between them too.

use crate::math::float;

/// Tables at equal steps; one where x is the same everywhere.
#[derive(Debug, PartialEq)]
pub struct TableRange<T: 'static> {
    tables: Vec<&'static T>,
    scale: Scale,
    /// Of the first and of the last, on the scale.
    ends: [f32; 2],
}

/// By what a parameter x > 0 is told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// ln x: by ratios.
    Ratio,
    /// ±√|ln x| of an index of refraction: near 1 by the cosine of the critical angle, which is about √(2 |ln x|), elsewhere about
    /// by ratios.
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

    /// From one table to the next, at most: 17 tables of ratios from 1 to 100; of indices 15 from 1 to 1.6, 5 from 1.3.
    fn step(self) -> f32 {
        match self {
            Scale::Ratio => 0.29,
            Scale::Index => 0.05,
        }
    }
}

/// Two neighbours, and where between them: what a model at a point keeps.
#[derive(Debug, PartialEq)]
pub struct LerpedTable<T: 'static> {
    tables: [&'static T; 2],
    part: f32,
}

impl<T> TableRange<T> {
    /// - `range`: the least and the greatest x, above 0
    /// - `table`: that of one x
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
    /// What is read from each table, interpolated.
    #[inline]
    pub fn value(&self, read: impl Fn(&T) -> f32) -> f32 {
        let low = read(self.tables[0]);
        if self.part == 0.0 { low } else { low + (read(self.tables[1]) - low) * self.part }
    }
}

/// Of one table alone.
impl<T> From<&'static T> for LerpedTable<T> {
    fn from(table: &'static T) -> LerpedTable<T> {
        LerpedTable { tables: [table; 2], part: 0.0 }
    }
}

// By hand: references to tables are copied, whether tables can be or not.
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
