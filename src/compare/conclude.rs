//! Conclusions of a comparison, as sentences.

use super::{Commands, Conclusion, Cost, CostKind, Method, NoPrice, Reference, TARGETS};
use crate::measure::format::{duration, per_cent};

/// Number of the [`TARGETS`] that have sentences.
const TOLD: usize = 3;

/// Returns the conclusions: which method is cheapest for which error, how much slower the others are, why no time is stated, where two
/// methods cross, and what each leaves out. Each comes with the command that shows it.
pub fn conclusions(methods: &[Method], reference: &Reference, confidence: f64, commands: &Commands) -> Vec<Conclusion> {
    let with = |text: String, command: String| Conclusion { text, command: Some(command) };
    let mut sentences = prices(methods, commands);
    let whole = coarse_reference(methods, reference, confidence).into_iter().chain(reasons(methods)).chain(crossings(methods));
    sentences.extend(whole.map(|text| with(text, commands.whole.clone())));
    for method in methods {
        if let Some((bias, error)) = method.bias {
            let (bias, error) = (per_cent(bias), per_cent(error));
            let what = match method.scene_file {
                None => "that is bias, which no time removes",
                Some(_) if method.lacks.is_empty() => "so much the scenes differ, which no time removes",
                Some(_) => "that is what the scenes differ by and what the method leaves out",
            };
            let text = format!("{} settles {bias} ± {error} % away from the reference: {what}.", method.name);
            sentences.push(with(text, commands.verify(method)));
        }
        if !method.lacks.is_empty() {
            let text = format!("{} does not simulate {}, which the scene calls for.", method.name, method.lacks);
            sentences.push(with(text, commands.check(method)));
        }
    }
    sentences
}

/// Price of a method, if one is stated.
fn priced(method: &Method, k: usize) -> Option<Cost> {
    method.prices.get(k).and_then(|price| price.ok())
}

/// Sentences about the targets. Neighbours of which the same is said share one: `For 3 % and 1 %, whitted never gets there.`
///
/// The command renders with the fastest method to the first of the targets; where no time is known it repeats the comparison.
fn prices(methods: &[Method], commands: &Commands) -> Vec<Conclusion> {
    let mut told: Vec<(Vec<String>, String, String)> = vec![];
    for (k, target) in TARGETS.iter().enumerate().take(TOLD) {
        let text = about(methods, k);
        let able = methods.iter().filter_map(|method| Some((method, priced(method, k)?.seconds)));
        let fastest = able.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(method, _)| commands.render(method, *target));
        let target = format!("{} %", per_cent(*target));
        match told.last_mut() {
            _ if text.is_empty() => {}
            Some((targets, same, _)) if *same == text => targets.push(target),
            _ => told.push((vec![target], text, fastest.unwrap_or_else(|| commands.whole.clone()))),
        }
    }
    let sentence = |(targets, text, command): (Vec<String>, String, String)| Conclusion {
        text: format!("For {}, {text}.", and(&targets)),
        command: Some(command),
    };
    told.into_iter().map(sentence).collect()
}

/// What is known of the times to one target; empty if nothing is.
fn about(methods: &[Method], k: usize) -> String {
    let mut able: Vec<(&Method, Cost)> = methods.iter().filter_map(|method| Some((method, priced(method, k)?))).collect();
    able.sort_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds));
    let mut clauses = match able.iter().any(|(_, cost)| cost.kind == CostKind::AtMost) {
        // A bound may be far above the time: no method is known to be the cheapest.
        true => able.iter().map(|(method, cost)| format!("{} takes {}", method.name, time(cost))).collect(),
        false => ranking(&able),
    };
    let unable = |reasons: &[NoPrice]| -> Vec<String> {
        let is_one = |method: &&Method| method.prices.get(k).is_some_and(|price| price.err().is_some_and(|why| reasons.contains(&why)));
        methods.iter().filter(is_one).map(|method| method.name.clone()).collect()
    };
    let mut tell = |reasons: &[NoPrice], text: &dyn Fn(&[String]) -> String| match &unable(reasons)[..] {
        [] => {}
        names => clauses.push(text(names)),
    };
    let plural = |names: &[String], one: &str, many: &str| format!("{} {}", and(names), if names.len() == 1 { one } else { many });
    tell(&[NoPrice::Bias], &|names| plural(names, "never gets there", "never get there"));
    tell(&[NoPrice::Lacks], &|names| plural(names, "is not known to get there", "are not known to get there"));
    tell(&[NoPrice::FewPixels, NoPrice::Rising, NoPrice::Spread, NoPrice::Single], &|names| {
        format!("the time{} of {} cannot be established", if names.len() == 1 { "" } else { "s" }, and(names))
    });
    tell(&[NoPrice::Reference], &|names| {
        format!("the reference is too coarse to tell the time{} of {}", if names.len() == 1 { "" } else { "s" }, and(names))
    });
    clauses.join("; ")
}

/// The cheapest method, and how many times as long the others take. `able` is in order of time.
fn ranking(able: &[(&Method, Cost)]) -> Vec<String> {
    let Some(((best, cost), others)) = able.split_first() else { return vec![] };
    let first = format!("{} is the cheapest with {}", best.name, time(cost));
    let other = |(other, theirs): &(&Method, Cost)| {
        let (ratio, [low, high]) = (theirs.seconds / cost.seconds, ratio_interval(cost, theirs));
        let [times, from, to] = [ratio, low, high].map(two_digits);
        match (low > 1.0, low >= 0.5 && high <= 2.0) {
            _ if !high.is_finite() => format!("{} takes longer by a factor that cannot be established", other.name),
            (true, _) => format!("{} takes {times} ({from}–{to}) times as long", other.name),
            (false, true) => format!("{} takes about as long ({times} times, {from}–{to})", other.name),
            (false, false) => format!("{} may take longer ({times} times, {from}–{to})", other.name),
        }
    };
    std::iter::once(first).chain(others.iter().map(other)).collect()
}

/// Time of a sentence: `4.1 s`, `about 14 s`, `less than 1 s`.
fn time(cost: &Cost) -> String {
    match cost.kind {
        CostKind::Measured => duration(cost.seconds),
        CostKind::Extrapolated => format!("about {}", duration(cost.seconds)),
        CostKind::AtMost => format!("less than {}", duration(cost.seconds)),
    }
}

/// Interval of the ratio of two independent times: the half widths of the logarithms add as squares.
fn ratio_interval(a: &Cost, b: &Cost) -> [f64; 2] {
    let reach = |cost: &Cost| (cost.high / cost.seconds).ln();
    let both = reach(a).hypot(reach(b));
    [-both, both].map(|reach| b.seconds / a.seconds * reach.exp())
}

/// Sentence about the reference, if it is too coarse for one of the targets.
fn coarse_reference(methods: &[Method], reference: &Reference, confidence: f64) -> Option<String> {
    let is_refused = |method: &Method| method.prices.iter().take(TOLD).any(|price| *price == Err(NoPrice::Reference));
    let error = reference.error.filter(|_| methods.iter().any(is_refused))?;
    Some(match error.refusal() {
        None => format!("No time is stated for errors below that of the reference itself, {}.", reference.own_error(confidence)),
        Some(refusal) => format!("The reference's own error cannot be established ({refusal}), so no time is stated."),
    })
}

/// Sentences that say why times cannot be established.
fn reasons(methods: &[Method]) -> Vec<String> {
    let of = |reason: NoPrice| -> Vec<String> {
        let has = |method: &&Method| method.prices.iter().take(TOLD).any(|price| *price == Err(reason));
        methods.iter().filter(has).map(|method| method.name.clone()).collect()
    };
    let sentence = |reason: NoPrice| {
        let names = and(&of(reason));
        Some(match reason {
            _ if names.is_empty() => return None,
            NoPrice::FewPixels => {
                format!("A few pixels hold most of the error of {names} (heavy tail): the next bright sample may change it.")
            }
            NoPrice::Rising => format!("The error of {names} has not fallen with time (heavy tail), so that no time is extrapolated."),
            NoPrice::Spread => format!("The renders of {names} differ by too much to state a time; more --replicates or --time may tell."),
            NoPrice::Single => {
                format!("There is one picture of {names}; repeats with other random numbers may tell its times and its bias.")
            }
            // What is said of the times says it.
            NoPrice::Bias | NoPrice::Lacks | NoPrice::Reference => return None,
        })
    };
    [NoPrice::FewPixels, NoPrice::Rising, NoPrice::Spread, NoPrice::Single].into_iter().filter_map(sentence).collect()
}

/// Sentences about methods that change their order from one error to a smaller one: `nee and path cross between 3 % and 1 %.`
fn crossings(methods: &[Method]) -> Vec<String> {
    let mut found = vec![];
    for (i, a) in methods.iter().enumerate() {
        for b in &methods[i + 1..] {
            // A method that never gets there is the slower one. Where no time is known for another reason, no order is.
            let order = |k: usize| match (*a.prices.get(k)?, *b.prices.get(k)?) {
                (Ok(x), Ok(y)) if x.high < y.low => Some(true),
                (Ok(x), Ok(y)) if y.high < x.low => Some(false),
                (Ok(_), Err(NoPrice::Bias)) => Some(true),
                (Err(NoPrice::Bias), Ok(_)) => Some(false),
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

/// `a`, `a and b`, `a, b and c`.
fn and(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn two_digits(x: f64) -> String {
    per_cent(x / 100.0)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{self, image};
    use super::*;
    use crate::measure::RelativeError;

    /// Time that is known to a factor of 1.1.
    fn s(seconds: f64) -> Result<Cost, NoPrice> {
        Ok(Cost { seconds, low: seconds / 1.1, high: seconds * 1.1, kind: CostKind::Measured })
    }

    fn at_most(seconds: f64) -> Result<Cost, NoPrice> {
        Ok(Cost { seconds, low: 0.0, high: seconds, kind: CostKind::AtMost })
    }

    const NEVER: Result<Cost, NoPrice> = Err(NoPrice::Bias);

    fn method(name: &str, prices: [Result<Cost, NoPrice>; 4]) -> Method {
        Method { prices: prices.into(), ..synthetic::method(name) }
    }

    fn reference(effective_pixels: f64) -> Reference {
        let error = RelativeError { value: 0.02, spread: 0.1, effective_pixels };
        Reference { image: image(|_| 1.0, 0.0), origin: "r".into(), error: Some(error), attributes: vec![] }
    }

    fn commands() -> Commands {
        let [whole, scene, options, size, reference] = ["pt compare s.json", "s.json", "", "--size 8x8", "r.exr"].map(str::to_owned);
        Commands { whole, scene, options, size, reference }
    }

    fn said(methods: &[Method]) -> Vec<String> {
        conclusions(methods, &reference(1e4), 0.95, &commands()).into_iter().map(|conclusion| conclusion.text).collect()
    }

    /// The command renders with the cheapest, verifies what is biased, and lists what is left out.
    #[test]
    fn every_conclusion_has_its_command() {
        let biased = Method { bias: Some((0.05, 0.002)), lacks: "glass".into(), ..method("b", [s(0.5), NEVER, NEVER, NEVER]) };
        let all = [method("a", [s(1.0), s(10.0), Err(NoPrice::Spread), NEVER]), biased];
        let found: Vec<_> = conclusions(&all, &reference(1e4), 0.95, &commands()).into_iter().filter_map(|one| one.command).collect();
        let render = |name: &str, target: &str| format!("pt s.json --size 8x8 --integrator {name} --sampler sobol --target {target}");
        let [whole, verify, check] = ["pt compare s.json", "pt verify s.json b r.exr --size 8x8", "pt check s.json"].map(str::to_owned);
        assert_eq!(found, [render("b", "10%"), render("a", "3%"), whole.clone(), whole.clone(), whole, verify, check]);
    }

    /// What belongs to another scene has that scene in its commands, with the options of the first.
    #[test]
    fn commands_name_the_scene_of_their_method() {
        let other =
            Method { bias: Some((0.05, 0.002)), scene_file: Some("t.json".into()), ..method("b · t", [s(1.0), NEVER, NEVER, NEVER]) };
        let commands = Commands { options: "-D /a=1".into(), ..commands() };
        let found = conclusions(&[other], &reference(1e4), 0.95, &commands);
        let command = |k: usize| found[k].command.clone().expect("a command");
        assert_eq!(command(0), "pt t.json -D /a=1 --size 8x8 --integrator b · t --sampler sobol --target 10%");
        let last = found.len() - 1;
        assert_eq!(command(last), "pt verify t.json -D /a=1 b · t r.exr --size 8x8");
        assert_eq!(found[last].text, "b · t settles 5 ± 0.2 % away from the reference: so much the scenes differ, which no time removes.");
    }

    #[test]
    fn the_cheapest_is_named_and_how_much_longer_others_take() {
        let said = said(&[method("a", [s(1.0), s(10.0), s(100.0), s(1000.0)]), method("b", [s(4.0), s(10.5), NEVER, NEVER])]);
        // 4 times; the half widths of the logarithms add as squares: e^(√2 ln 1.1) = 1.144.
        assert_eq!(said[0], "For 10 %, a is the cheapest with 1 s; b takes 4 (3.5–4.6) times as long.");
        assert_eq!(said[1], "For 3 %, a is the cheapest with 10 s; b takes about as long (1.1 times, 0.92–1.2).");
        assert_eq!(said[2], "For 1 %, a is the cheapest with 100 s; b never gets there.");
        assert_eq!(said.len(), 3, "{said:?}");
    }

    /// `About as long` is within a factor of two. A time that may be longer or much longer is said as such, and an interval without end
    /// does not appear as a number.
    #[test]
    fn wide_intervals_are_not_called_about_as_long() {
        let wide = |seconds: f64, factor: f64| Ok(Cost { low: seconds / factor, high: seconds * factor, ..s(seconds).expect("a time") });
        let of = |other: Result<Cost, NoPrice>| said(&[method("a", [s(1.0); 4]), method("b", [other; 4])])[0].clone();
        // √(ln²1.1 + ln²8) = 2.0816: 4 · e^∓2.0816.
        assert_eq!(of(wide(4.0, 8.0)), "For 10 %, 3 % and 1 %, a is the cheapest with 1 s; b may take longer (4 times, 0.5–32).");
        let endless = of(wide(4.0, f64::INFINITY));
        assert_eq!(endless, "For 10 %, 3 % and 1 %, a is the cheapest with 1 s; b takes longer by a factor that cannot be established.");
    }

    /// A bound may be far above the true time, so that it is not ranked.
    #[test]
    fn bounds_are_listed_and_not_ranked() {
        let said = said(&[method("a", [at_most(2.0), s(3.0), s(9.0), s(9.0)]), method("b", [s(1.0), s(5.0), s(9.5), s(9.0)])]);
        assert_eq!(said[0], "For 10 %, b takes 1 s; a takes less than 2 s.");
    }

    #[test]
    fn methods_without_a_time_are_told_with_the_reason() {
        let [few, spread, lacks, coarse] = [NoPrice::FewPixels, NoPrice::Spread, NoPrice::Lacks, NoPrice::Reference].map(Err);
        let a = method("a", [s(1.0), few, few, few]);
        let said = said(&[a, method("b", [spread, spread, coarse, coarse]), method("c", [lacks; 4]), method("d", [NEVER; 4])]);
        let unestablished = "d never gets there; c is not known to get there; the time";
        assert_eq!(
            said[..3],
            [
                format!("For 10 %, a is the cheapest with 1 s; {unestablished} of b cannot be established."),
                format!("For 3 %, {unestablished}s of a and b cannot be established."),
                format!("For 1 %, {unestablished} of a cannot be established; the reference is too coarse to tell the time of b."),
            ]
        );
        assert_eq!(said[3], "No time is stated for errors below that of the reference itself, relative error 2 % (95 %: 1.6–2.4).");
        assert!(
            said[4].starts_with("A few pixels hold most of the error of a ") && said[5].starts_with("The renders of b differ"),
            "{said:?}"
        );
    }

    #[test]
    fn a_reference_of_unknown_error_is_told() {
        let said = conclusions(&[method("a", [Err(NoPrice::Reference); 4])], &reference(20.0), 0.95, &commands());
        let said: Vec<String> = said.into_iter().map(|conclusion| conclusion.text).collect();
        assert_eq!(said[0], "For 10 %, 3 % and 1 %, the reference is too coarse to tell the time of a.");
        assert!(said[1].starts_with("The reference's own error cannot be established"), "{said:?}");
    }

    #[test]
    fn methods_cross_where_the_cheaper_is_another() {
        let crossing = [method("a", [s(1.0), s(10.0), s(300.0), NEVER]), method("b", [s(3.0), s(11.0), s(50.0), s(90.0)])];
        assert_eq!(said(&crossing).last().map(String::as_str), Some("a and b cross between 10 % and 1 %."));
        // A time that is not known has no place in an order.
        let unknown = Err(NoPrice::Spread);
        let open = [method("a", [s(1.0), unknown, unknown, unknown]), method("b", [s(3.0), s(11.0), s(50.0), s(90.0)])];
        let turned = [open[1].clone(), open[0].clone()];
        assert!(!said(&open).iter().chain(&said(&turned)).any(|text| text.contains("cross")));
    }

    #[test]
    fn bias_and_what_is_left_out_are_told() {
        let biased = Method { bias: Some((0.05, 0.002)), lacks: "glass".into(), ..method("a", [s(1.0), NEVER, NEVER, NEVER]) };
        let said = said(&[biased]);
        assert!(said.contains(&"a settles 5 ± 0.2 % away from the reference: that is bias, which no time removes.".to_owned()), "{said:?}");
        assert!(said.contains(&"a does not simulate glass, which the scene calls for.".to_owned()), "{said:?}");
    }
}
