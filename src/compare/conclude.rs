//! What a comparison comes to, in words.

use super::{Method, TARGETS};
use crate::measure::words::{duration, per_cent};

/// Which method is cheapest for which error, how much slower the others are, where they cross, what each leaves out.
pub fn conclusions(methods: &[Method]) -> Vec<String> {
    let mut sentences: Vec<String> = (0..3).filter_map(|k| cheapest(methods, k)).collect();
    sentences.extend(crossings(methods));
    for method in methods {
        if let Some((bias, error)) = method.bias {
            let (bias, error) = (per_cent(bias), per_cent(error));
            sentences
                .push(format!("{} settles {bias} ± {error} % away from the reference: that is bias, which no time removes.", method.name));
        }
        if !method.lacks.is_empty() {
            sentences.push(format!("{} does not simulate {}, which the scene calls for.", method.name, method.lacks));
        }
    }
    sentences
}

/// `For 3 %, nee is the cheapest with 4.1 s; path takes 33 (31–35) times as long.`
fn cheapest(methods: &[Method], k: usize) -> Option<String> {
    let priced = |method: &Method| method.prices.get(k).copied().flatten();
    let mut able: Vec<&Method> = methods.iter().filter(|method| priced(method).is_some()).collect();
    able.sort_by(|a, b| priced(a).map(|p| p.seconds).partial_cmp(&priced(b).map(|p| p.seconds)).unwrap_or(std::cmp::Ordering::Equal));
    let (best, others) = able.split_first()?;
    let cost = priced(best)?;
    let foretold = if cost.extrapolated { "about " } else { "" };
    let mut text = format!("For {} %, {} is the cheapest with {foretold}{}", per_cent(TARGETS[k]), best.name, duration(cost.seconds));
    for other in others {
        let theirs = priced(other)?;
        let ratio = theirs.seconds / cost.seconds;
        let (low, high) = ratio_interval((cost.seconds, cost.low, cost.high), (theirs.seconds, theirs.low, theirs.high));
        text += &match low > 1.0 {
            true => format!("; {} takes {} ({}–{}) times as long", other.name, two(ratio), two(low), two(high)),
            false => format!("; {} takes about as long ({} times, {}–{})", other.name, two(ratio), two(low), two(high)),
        };
    }
    let unable: Vec<&str> = methods.iter().filter(|method| priced(method).is_none()).map(|method| method.name.as_str()).collect();
    if !unable.is_empty() {
        text += &format!("; {} never {} there", unable.join(" and "), if unable.len() == 1 { "gets" } else { "get" });
    }
    Some(text + ".")
}

/// Of a ratio of two independent times: their logarithms' reaches add as squares.
fn ratio_interval(a: (f64, f64, f64), b: (f64, f64, f64)) -> (f64, f64) {
    let reach = |(middle, _, high): (f64, f64, f64)| (high / middle).ln();
    let both = reach(a).hypot(reach(b));
    (b.0 / a.0 * (-both).exp(), b.0 / a.0 * both.exp())
}

/// `nee and path cross between 3 % and 1 %.`: where the cheaper of two is another at a smaller error.
fn crossings(methods: &[Method]) -> Vec<String> {
    let mut found = vec![];
    for (i, a) in methods.iter().enumerate() {
        for b in &methods[i + 1..] {
            let order = |k: usize| match (a.prices.get(k).copied().flatten(), b.prices.get(k).copied().flatten()) {
                (Some(x), Some(y)) if x.high < y.low => Some(true),
                (Some(x), Some(y)) if y.high < x.low => Some(false),
                (Some(_), None) => Some(true),
                (None, Some(_)) => Some(false),
                _ => None,
            };
            let orders: Vec<(usize, bool)> = (0..TARGETS.len()).filter_map(|k| Some((k, order(k)?))).collect();
            if let Some(pair) = orders.windows(2).find(|pair| pair[0].1 != pair[1].1) {
                let (from, to) = (per_cent(TARGETS[pair[0].0]), per_cent(TARGETS[pair[1].0]));
                found.push(format!("{} and {} cross between {from} % and {to} %.", a.name, b.name));
            }
        }
    }
    found
}

fn two(x: f64) -> String {
    per_cent(x / 100.0)
}
