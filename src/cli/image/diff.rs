//! `pt image diff A B`: how far a picture is from its reference.

use std::path::Path;
use std::process::ExitCode;

use super::args::Diff;
use super::falsecolor::{Scale, painted};
use super::{number, picked};
use crate::cli::outputs::{Takes, check_outputs};
use crate::cli::say;
use crate::error::Result;
use crate::film::{Channel, Image};
use crate::measure::Metric;
use crate::measure::metric::{Measured, Named, Pair};
use crate::output::{self, Colormap, Format, Tonemap};

/// Every measure with its formula; 1 where one is larger than tolerated.
pub fn diff(args: &Diff) -> Result<ExitCode> {
    let metrics: Vec<Metric> = args.metric.iter().map(|name| Metric::parse(name)).collect::<Result<_>>()?;
    check_outputs(args.output.as_slice(), Takes::Pictures, &[&args.first, &args.second], "is one of the pictures")?;
    let pick = args.layer.pick();
    let (a, r) = (picked(&args.first, &pick)?, picked(&args.second, &pick)?);
    let names = [&args.first, &args.second].map(|path| path.display().to_string());
    let pair = Pair::new(Named { name: &names[0], image: &a }, Named { name: &names[1], image: &r }, args.tone.map())?;

    let measured: Vec<(Metric, Measured)> = metrics.into_iter().map(|metric| (metric, metric.measure(&pair))).collect();
    let mut text = format!("a = {}, r = {}\n", names[0], names[1]);
    let width = measured.iter().map(|(metric, _)| metric.name().len()).max().unwrap_or(0);
    let mut is_worse = false;
    for (metric, Measured { value, .. }) in &measured {
        let tolerated = args.tolerance.is_none_or(|tolerance| *value <= tolerance);
        is_worse |= !tolerated;
        let verdict = if tolerated { String::new() } else { format!("  ABOVE {}", number(args.tolerance.unwrap_or_default())) };
        text += &format!("{:width$}  {}{verdict}  {}\n", metric.name(), number(*value), sentence(metric));
    }
    if let Some(path) = &args.output {
        text += &write(path, &a, &measured)?;
    }
    say(&text)?;
    Ok(ExitCode::from(u8::from(is_worse)))
}

/// The formula, and what the two pictures are where it matters.
fn sentence(metric: &Metric) -> String {
    let kind = metric.kind();
    let roles = if kind.first == kind.second { String::new() } else { format!("; a is the {}, r the {}", kind.first, kind.second) };
    format!("{}{roles}", metric.formula())
}

/// The errors of all pixels to a file; returns what is to be said of it.
fn write(path: &Path, window: &Image, measured: &[(Metric, Measured)]) -> Result<String> {
    let values = |measured: &Measured| measured.map.iter().map(|&v| v as f32).collect::<Vec<f32>>();
    let (metric, first) = &measured[0];
    let about = vec![("pt/metric".to_owned(), metric.formula().into())];
    match Format::of(path) {
        Some(Format::Exr) => {
            // A single map is a single channel, which every viewer shows by itself.
            let name = |metric: &Metric| if measured.len() == 1 { "Y".to_owned() } else { format!("{}.Y", metric.name()) };
            let channels = measured.iter().map(|(metric, m)| Channel { name: name(metric), values: values(m) }).collect();
            output::write(path, &Image { channels, ..*window }, &about, &Tonemap::default()).map(|()| String::new())
        }
        Some(Format::Pfm) => {
            let channels = ["R", "G", "B"].map(|name| Channel { name: name.into(), values: values(first) }).into();
            output::write(path, &Image { channels, ..*window }, &about, &Tonemap::default()).map(|()| String::new())
        }
        _ => {
            let scale = Scale::around(&first.map, None, false, Colormap::default());
            output::write(path, &painted(&first.map, window.size, &scale), &about, &Tonemap::default())?;
            Ok(format!("{}: {}, {}\n", path.display(), metric.name(), scale.sentence(&first.map)))
        }
    }
}
