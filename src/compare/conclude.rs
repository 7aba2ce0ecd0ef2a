//! Conclusions of a comparison, as sentences.

use super::{Method, TARGETS};
use crate::measure::format::{duration, per_cent};

/// Returns the conclusions: which method is cheapest for which error, how much slower the others are, where two of them cross, and
/// what each leaves out.
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

/// Sentence about one target: `For 3 %, nee is the cheapest with 4.1 s; path takes 33 (31–35) times as long.`
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
            true => format!("; {} takes {} ({}–{}) times as long", other.name, two_digits(ratio), two_digits(low), two_digits(high)),
            false => {
                format!("; {} takes about as long ({} times, {}–{})", other.name, two_digits(ratio), two_digits(low), two_digits(high))
            }
        };
    }
    let unable: Vec<&str> = methods.iter().filter(|method| priced(method).is_none()).map(|method| method.name.as_str()).collect();
    if !unable.is_empty() {
        text += &format!("; {} never {} there", unable.join(" and "), if unable.len() == 1 { "gets" } else { "get" });
    }
    Some(text + ".")
}

/// Interval of the ratio of two independent times: the half widths of the logarithms add as squares.
fn ratio_interval(a: (f64, f64, f64), b: (f64, f64, f64)) -> (f64, f64) {
    let reach = |(middle, _, high): (f64, f64, f64)| (high / middle).ln();
    let both = reach(a).hypot(reach(b));
    (b.0 / a.0 * (-both).exp(), b.0 / a.0 * both.exp())
}

/// Sentences about methods that change their order from one error to a smaller one: `nee and path cross between 3 % and 1 %.`
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

fn two_digits(x: f64) -> String {
    per_cent(x / 100.0)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::compare::Cost;
    use crate::film::Image;

    /// - `prices`: seconds of each target, known to a factor of 1.1; `None` where the method never reaches it
    fn method(name: &str, prices: [Option<f64>; 4]) -> Method {
        let cost = |seconds: f64| Cost { seconds, low: seconds / 1.1, high: seconds * 1.1, extrapolated: false };
        let image = Image { full_size: UVec2::ZERO, origin: UVec2::ZERO, size: UVec2::ZERO, channels: vec![] };
        Method {
            name: name.into(),
            integrator: name.into(),
            sampler: "sobol".into(),
            measurements: vec![],
            curve: vec![],
            image: image.clone(),
            sample: image,
            slope: None,
            bias: None,
            prices: prices.map(|price| price.map(cost)).into(),
            lacks: String::new(),
        }
    }

    #[test]
    fn the_cheapest_is_named_and_how_much_longer_others_take() {
        let methods = [method("a", [Some(1.0), Some(10.0), Some(100.0), Some(1000.0)]), method("b", [Some(4.0), Some(10.5), None, None])];
        let said = conclusions(&methods);
        // 4 times; the half widths of the logarithms add as squares: e^(√2 ln 1.1) = 1.144.
        assert_eq!(said[0], "For 10 %, a is the cheapest with 1 s; b takes 4 (3.5–4.6) times as long.");
        assert_eq!(said[1], "For 3 %, a is the cheapest with 10 s; b takes about as long (1.1 times, 0.92–1.2).");
        assert_eq!(said[2], "For 1 %, a is the cheapest with 100 s; b never gets there.");
        assert_eq!(said.len(), 3, "{said:?}");
    }

    #[test]
    fn methods_cross_where_the_cheaper_is_another() {
        let methods =
            [method("a", [Some(1.0), Some(10.0), Some(300.0), None]), method("b", [Some(3.0), Some(11.0), Some(50.0), Some(90.0)])];
        assert_eq!(conclusions(&methods).last().map(String::as_str), Some("a and b cross between 10 % and 1 %."));
    }

    #[test]
    fn bias_and_what_is_left_out_are_told() {
        let prices = [Some(1.0), None, None, None];
        let biased = Method { bias: Some((0.05, 0.002)), lacks: "glass".into(), ..method("a", prices) };
        let said = conclusions(&[biased]);
        assert!(said.contains(&"a settles 5 ± 0.2 % away from the reference: that is bias, which no time removes.".to_owned()), "{said:?}");
        assert!(said.contains(&"a does not simulate glass, which the scene calls for.".to_owned()), "{said:?}");
    }
}
