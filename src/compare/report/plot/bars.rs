//! Bars of the time that each method takes for each error.

use super::axis::Axis;
use super::drawing::{Anchor, Color, Dashes, Drawing};
use super::font;
use super::frame::{Format, Quantity};
use super::{price_of, time};
use crate::compare::{Comparison, Cost, CostKind, Method, TARGETS};
use crate::measure::format;

/// Draws the time to each error: a bar for each method and target on a logarithmic axis, with its interval as a line.
///
/// The drawing is as tall as the bars need. Extrapolated times are paler and have a dashed end.
pub fn bars(comparison: &Comparison, format: Format) -> Drawing {
    let Format { width, font_size, .. } = format;
    let row = 1.75 * font_size;
    let group = 2.1 * font_size + comparison.methods.len() as f64 * row;
    let (top, bottom) = (3.0 * font_size, 3.0 * font_size + TARGETS.len() as f64 * group);
    let mut drawing = Drawing::new(width, bottom + 3.6 * font_size);
    drawing.text([0.0, font_size + 3.0], "Time to an error", Color::Text, font_size + 2.0, Anchor::Start);

    let names = comparison.methods.iter().map(|method| font::width_in_any_font(&method.name, font_size)).fold(0.0, f64::max);
    let left = names.min(0.4 * width) + 1.2 * font_size;
    let prices = || comparison.methods.iter().flat_map(|method| method.prices.iter().filter_map(|price| price.ok()));
    // The time stands to the right of each bar.
    let times = prices().map(|cost| font::width_in_any_font(&time(&cost), font_size)).fold(0.0, f64::max);
    let axis = Axis::over(prices().flat_map(|cost| [0.7 * cost.seconds, cost.low, cost.high]), [left, width - times - 8.0]);
    for tick in axis.times(((width - left) / (6.5 * font_size)) as usize) {
        let x = axis.at(tick);
        drawing.line(vec![[x, top], [x, bottom]], Color::Grid, 1.0, Dashes::None);
        drawing.text([x, bottom + 1.4 * font_size], Quantity::Seconds.label(tick), Color::Muted, font_size, Anchor::Middle);
    }
    drawing.text(
        [width, bottom + 2.9 * font_size],
        "time of rendering; pale: extrapolated, <: a bound",
        Color::Muted,
        font_size,
        Anchor::End,
    );

    for (i, target) in TARGETS.into_iter().enumerate() {
        let y = top + i as f64 * group;
        drawing.text([0.0, y + 1.5 * font_size], format!("{} %", format::per_cent(target)), Color::Text, font_size, Anchor::Start);
        for (index, method) in comparison.methods.iter().enumerate() {
            let middle = y + 2.1 * font_size + (index as f64 + 0.5) * row;
            drawing.text([0.0, middle + 0.35 * font_size], &method.name, Color::Muted, font_size, Anchor::Start);
            bar(&mut drawing, &axis, [left, middle], font_size, (index, method), price_of(method, i));
        }
    }
    drawing.description = describe(comparison);
    drawing
}

fn bar(
    drawing: &mut Drawing,
    axis: &Axis,
    [left, middle]: [f64; 2],
    font_size: f64,
    (index, method): (usize, &Method),
    cost: Result<Cost, &'static str>,
) {
    let cost = match cost {
        Ok(cost) => cost,
        Err(reason) => {
            drawing.text([left + 4.0, middle + 0.35 * font_size], reason, Color::Muted, font_size, Anchor::Start);
            return;
        }
    };
    let half = 0.45 * font_size;
    let [low, end, high] = [cost.low, cost.seconds, cost.high].map(|s| axis.at(s));
    let corners = vec![[left, middle - half], [end, middle - half], [end, middle + half], [left, middle + half]];
    let opacity = if cost.kind == CostKind::Measured { 0.85 } else { 0.3 };
    drawing.area(corners, Color::Method(index), opacity, format!("{}: {}", method.name, super::price(&cost)));
    if cost.kind != CostKind::Measured {
        drawing.line(vec![[end, middle - half], [end, middle + half]], Color::Method(index), 1.5, Dashes::Long);
    }
    // A bound has no interval.
    if cost.kind != CostKind::AtMost {
        drawing.line(vec![[low, middle], [high, middle]], Color::Text, 1.2, Dashes::None);
        for x in [low, high] {
            drawing.line(vec![[x, middle - 3.0], [x, middle + 3.0]], Color::Text, 1.2, Dashes::None);
        }
    }
    drawing.text([high.max(end) + 6.0, middle + 0.35 * font_size], time(&cost), Color::Text, font_size, Anchor::Start);
}

fn describe(comparison: &Comparison) -> String {
    let target = |(i, target): (usize, f64)| {
        let one = |method: &Method| format!("{} {}", method.name, price_of(method, i).map_or_else(Into::into, |cost| super::price(&cost)));
        let each: Vec<String> = comparison.methods.iter().map(one).collect();
        format!("{} %: {}", format::per_cent(target), each.join(", "))
    };
    let targets: Vec<String> = TARGETS.into_iter().enumerate().map(target).collect();
    format!("Time to an error. {}.", targets.join("; "))
}
