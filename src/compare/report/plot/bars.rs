//! How long each method takes to each error.

use super::axis::Axis;
use super::drawing::{Anchor, Dashes, Drawing, Ink};
use super::frame::{Format, Quantity};
use crate::compare::{Comparison, Cost, Method, TARGETS};
use crate::measure::words;

/// Time to error: a bar for each method and target on a logarithmic axis, its interval as a line.
///
/// As tall as it needs be. Foretold times are paler and dashed at the end.
pub fn bars(comparison: &Comparison, format: Format) -> Drawing {
    let Format { width, letters, .. } = format;
    let row = 1.75 * letters;
    let group = 2.1 * letters + comparison.methods.len() as f64 * row;
    let (top, bottom) = (3.0 * letters, 3.0 * letters + TARGETS.len() as f64 * group);
    let mut drawing = Drawing::new(width, bottom + 3.6 * letters);
    drawing.text([0.0, letters + 3.0], "Time to an error", Ink::Text, letters + 2.0, Anchor::Start);

    let names = comparison.methods.iter().map(|method| Drawing::width_of(&method.name, letters)).fold(0.0, f64::max);
    let left = names.min(0.4 * width) + 1.2 * letters;
    let prices = || comparison.methods.iter().flat_map(|method| method.prices.iter().flatten());
    // To the right of each bar stands its time.
    let times = prices().map(|cost| Drawing::width_of(&time(cost), letters)).fold(0.0, f64::max);
    let axis = Axis::over(prices().flat_map(|cost| [0.7 * cost.seconds, cost.low, cost.high]), [left, width - times - 8.0]);
    for tick in axis.times(((width - left) / (6.5 * letters)) as usize) {
        let x = axis.at(tick);
        drawing.line(vec![[x, top], [x, bottom]], Ink::Grid, 1.0, Dashes::None);
        drawing.text([x, bottom + 1.4 * letters], Quantity::Seconds.label(tick), Ink::Muted, letters, Anchor::Middle);
    }
    drawing.text([width, bottom + 2.9 * letters], "time of rendering; pale: foretold", Ink::Muted, letters, Anchor::End);

    for (i, target) in TARGETS.into_iter().enumerate() {
        let y = top + i as f64 * group;
        drawing.text([0.0, y + 1.5 * letters], format!("{} %", words::per_cent(target)), Ink::Text, letters, Anchor::Start);
        for (place, method) in comparison.methods.iter().enumerate() {
            let middle = y + 2.1 * letters + (place as f64 + 0.5) * row;
            let cost = method.prices.get(i).copied().flatten();
            drawing.text([0.0, middle + 0.35 * letters], &method.name, Ink::Muted, letters, Anchor::Start);
            bar(&mut drawing, &axis, [left, middle], letters, (place, method), cost, target);
        }
    }
    drawing.description = describe(comparison);
    drawing
}

fn bar(
    drawing: &mut Drawing,
    axis: &Axis,
    [left, middle]: [f64; 2],
    letters: f64,
    (place, method): (usize, &Method),
    cost: Option<Cost>,
    target: f64,
) {
    let Some(cost) = cost else {
        let text = super::unpriced(method, target);
        drawing.text([left + 4.0, middle + 0.35 * letters], text, Ink::Muted, letters, Anchor::Start);
        return;
    };
    let half = 0.45 * letters;
    let [low, end, high] = [cost.low, cost.seconds, cost.high].map(|s| axis.at(s));
    let corners = vec![[left, middle - half], [end, middle - half], [end, middle + half], [left, middle + half]];
    let opacity = if cost.extrapolated { 0.3 } else { 0.85 };
    drawing.area(corners, Ink::Method(place), opacity, format!("{}: {}", method.name, super::price(&cost)));
    if cost.extrapolated {
        drawing.line(vec![[end, middle - half], [end, middle + half]], Ink::Method(place), 1.5, Dashes::Long);
    }
    drawing.line(vec![[low, middle], [high, middle]], Ink::Text, 1.2, Dashes::None);
    for x in [low, high] {
        drawing.line(vec![[x, middle - 3.0], [x, middle + 3.0]], Ink::Text, 1.2, Dashes::None);
    }
    drawing.text([high.max(end) + 6.0, middle + 0.35 * letters], time(&cost), Ink::Text, letters, Anchor::Start);
}

fn time(cost: &Cost) -> String {
    format!("{}{}", if cost.extrapolated { "≈ " } else { "" }, words::duration(cost.seconds))
}

fn describe(comparison: &Comparison) -> String {
    let target = |(i, target): (usize, f64)| {
        let one = |method: &Method| {
            let price = method.prices.get(i).copied().flatten();
            format!("{} {}", method.name, price.map_or_else(|| super::unpriced(method, target), |cost| super::price(&cost)))
        };
        let each: Vec<String> = comparison.methods.iter().map(one).collect();
        format!("{} %: {}", words::per_cent(target), each.join(", "))
    };
    let targets: Vec<String> = TARGETS.into_iter().enumerate().map(target).collect();
    format!("Time to an error. {}.", targets.join("; "))
}
