//! A synthetic comparison by formulas, with known pictures, errors and costs.
//!
//! ```text
//! relmse(n) = variance · n^−order + bias²,   seconds(n) = cost · n
//! ```

use glam::UVec2;
use pt::compare::{
    CheckpointStats, Comparison, Conclusion, Cost, CostKind, Measurement, Method, NoPrice, Provenance, Reference, Snapshot, TARGETS,
    error_spectrum,
};
use pt::film::{Channel, Image};
use pt::measure::{Metric, RelativeError};

pub const SIZE: UVec2 = UVec2::new(96, 64);
/// The picture is a part of a larger one.
pub const ORIGIN: UVec2 = UVec2::new(10, 20);
const REPLICATES: u32 = 8;
const CHECKPOINTS: u32 = 9;

/// Makes the comparison of four methods, one of which is biased, and one is faster than the others with many samples.
pub fn comparison() -> Comparison {
    let methods = vec![
        method(1, "path", "independent", ErrorModel { variance: 4.0, order: 1.0, bias: 0.0, cost: 0.004 }),
        method(2, "nee", "independent", ErrorModel { variance: 0.35, order: 1.0, bias: 0.0, cost: 0.006 }),
        method(3, "nee · sobol", "sobol", ErrorModel { variance: 0.45, order: 1.3, bias: 0.0, cost: 0.007 }),
        method(4, "whitted", "independent", ErrorModel { variance: 0.02, order: 1.0, bias: 0.11, cost: 0.0045 }),
    ];
    Comparison {
        scene: "cornell-box".into(),
        reference: Reference {
            image: reference(),
            origin: "nee, 65 536 samples per pixel".into(),
            error: Some(RelativeError { value: 0.0007, spread: 0.02, effective_pixels: 5000.0 }),
            attributes: vec![],
        },
        methods,
        metrics: ["mape:eps=0.5,robust", "flip"].map(|name| Metric::parse(name).expect("a metric")).into(),
        confidence: 0.95,
        conclusions: vec![
            Conclusion {
                text: "For 3 % and less nee · sobol is the cheapest: 1 % takes about 0.33 s, where path takes 2 min 40 s.".into(),
                command: Some("pt cornell-box.json -D '/camera/fov=40' --integrator nee --sampler sobol --target 3%".into()),
            },
            "For 10 % nee is as good; path is 11 times slower at every error.".into(),
            "whitted stops at 11 %: it leaves out diffuse interreflection, and no time helps.".into(),
        ],
        provenance: Provenance {
            version: "0.1.0 (0123456789ab)".into(),
            command: "pt compare cornell-box.json -D '/camera/fov=40'".into(),
            arguments: ["compare", "cornell-box.json", "-D", "/camera/fov=40"].map(str::to_owned).into(),
            folder: "/home".into(),
            cpu: "A Processor <64 cores>".into(),
            threads: 16,
            seeds: (1..=u64::from(REPLICATES)).collect(),
            scene_hash: "00112233445566778899aabbccddeeff".into(),
            reference_hash: "ffeeddccbbaa99887766554433221100".into(),
        },
    }
}

#[derive(Clone, Copy)]
struct ErrorModel {
    variance: f64,
    order: f64,
    bias: f64,
    cost: f64,
}

impl ErrorModel {
    fn relmse(&self, samples: f64) -> f64 {
        self.variance * samples.powf(-self.order) + self.bias * self.bias
    }

    fn price(&self, error: f64) -> Result<Cost, NoPrice> {
        let left = error * error - self.bias * self.bias;
        let seconds = self.cost * (self.variance / left).powf(1.0 / self.order);
        let last = self.cost * f64::from(1u32 << (CHECKPOINTS - 1));
        let kind = if seconds > last { CostKind::Extrapolated } else { CostKind::Measured };
        let cost = Cost { seconds, low: 0.85 * seconds, high: 1.2 * seconds, kind };
        if left > 0.0 { Ok(cost) } else { Err(NoPrice::Bias) }
    }
}

fn method(seed: u32, name: &str, sampler: &str, model: ErrorModel) -> Method {
    let measure = |checkpoint: u32, replicate: u32| {
        let samples = 1u64 << checkpoint;
        let noise = 1.0 + 0.2 * normal(seed, 1000 * checkpoint + replicate);
        let relmse = model.relmse(samples as f64) * noise;
        let seconds = model.cost * samples as f64 * (1.0 + 0.01 * normal(seed + 50, 1000 * checkpoint + replicate));
        let others = vec![2.0 * relmse, relmse.sqrt()];
        Measurement { replicate, samples, seconds, mse: 0.3 * relmse, relmse, trimmed: 0.8 * relmse, others }
    };
    let measurements: Vec<Measurement> = (0..CHECKPOINTS).flat_map(|c| (0..REPLICATES).map(move |r| measure(c, r))).collect();
    let curve = measurements.chunks(REPLICATES as usize).map(point).collect();
    let variance = |checkpoint: u32| model.relmse(f64::from(1u32 << checkpoint)) - model.bias * model.bias;
    let last = variance(CHECKPOINTS - 1);
    let sample = picture(seed, model.bias, last.sqrt());
    // The first checkpoint has lost its picture.
    let snapshot = |checkpoint: u32| {
        let Measurement { samples, seconds, relmse, .. } = measure(checkpoint, 0);
        let other = || picture(seed + 1000 * (CHECKPOINTS - checkpoint), model.bias, variance(checkpoint).sqrt());
        let image = if checkpoint == CHECKPOINTS - 1 { sample.clone() } else { other() };
        Snapshot::new(samples, seconds, relmse, image)
    };
    let snapshots = (1..CHECKPOINTS).map(snapshot).collect();
    Method {
        name: name.into(),
        integrator: name.split(' ').next().unwrap_or(name).into(),
        sampler: sampler.into(),
        measurements,
        curve,
        image: picture(seed + 100, model.bias, (last / f64::from(REPLICATES)).sqrt()),
        sample,
        snapshots,
        spectrum: error_spectrum(&[picture(seed, model.bias, last.sqrt()), picture(seed + 100, model.bias, last.sqrt())], &reference()),
        scene_file: None,
        slope: Some((if model.bias > 0.0 { -0.02 } else { -0.5 * model.order }, 0.01)),
        bias: Some((model.bias, 0.002)).filter(|(bias, _)| *bias > 0.0),
        bias_bound: Some(model.bias + 0.008),
        prices: TARGETS.into_iter().map(|target| model.price(target)).collect(),
        lacks: if model.bias > 0.0 { "diffuse interreflection".into() } else { String::new() },
        files: vec![],
    }
}

/// Mean and its standard error.
fn point(replicates: &[Measurement]) -> CheckpointStats {
    let count = replicates.len() as f64;
    let mean = |value: fn(&Measurement) -> f64| replicates.iter().map(value).sum::<f64>() / count;
    let estimate = |value: fn(&Measurement) -> f64| {
        let mean = mean(value);
        let square = replicates.iter().map(|m| (value(m) - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (square / count).sqrt())
    };
    CheckpointStats {
        samples: replicates[0].samples,
        seconds: mean(|m| m.seconds),
        mse: estimate(|m| m.mse),
        relmse: estimate(|m| m.relmse),
        trimmed: estimate(|m| m.trimmed),
        others: vec![estimate(|m| m.others[0]), estimate(|m| m.others[1])],
    }
}

/// Radiance of three spheres in front of a wall. One of them is brighter than a screen can show.
fn radiance(x: u32, y: u32) -> [f64; 3] {
    let [x, y] = [f64::from(x), f64::from(y)];
    let wall = 0.15 + 0.5 * y / f64::from(SIZE.y);
    let mut color = [wall * (1.2 - x / 96.0), wall * 0.8, wall * (0.3 + x / 96.0)];
    for (center, radius, glow) in
        [([22.0, 40.0], 14.0, [0.7, 0.15, 0.1]), ([52.0, 44.0], 12.0, [0.1, 0.5, 0.2]), ([74.0, 16.0], 7.0, [40.0, 34.0, 22.0])]
    {
        let distance = (x + 0.5 - center[0]).hypot(y + 0.5 - center[1]) / radius;
        if distance < 1.0 {
            color = glow.map(|g: f64| g * (1.0 - 0.8 * distance * distance));
        }
    }
    color
}

fn reference() -> Image {
    with_errors(|x, y| radiance(x, y).map(|v| (v, 0.0007 * v)))
}

/// The reference, darker by a relative bias, with relative noise.
fn picture(seed: u32, bias: f64, noise: f64) -> Image {
    with_errors(|x, y| {
        let pixel = 3 * (y * SIZE.x + x);
        let color = radiance(x, y);
        std::array::from_fn(|c| {
            let error = noise * color[c];
            ((color[c] * (1.0 - bias) + error * normal(seed, pixel + c as u32)).max(0.0), error)
        })
    })
}

/// Value and standard error of each colour of a pixel.
type Estimates = [(f64, f64); 3];

fn with_errors(pixel: impl Fn(u32, u32) -> Estimates) -> Image {
    let pixels: Vec<Estimates> = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    let channel = |name: &str, value: &dyn Fn(&Estimates) -> f64| Channel {
        name: name.into(),
        values: pixels.iter().map(|pixel| value(pixel) as f32).collect(),
    };
    let colors = ["R", "G", "B"].iter().enumerate();
    let mut channels: Vec<Channel> = colors.clone().map(|(c, name)| channel(name, &|pixel| pixel[c].0)).collect();
    channels.extend(colors.map(|(c, name)| channel(&format!("StdErr.{name}"), &|pixel| pixel[c].1)));
    Image { full_size: UVec2::new(200, 100), origin: ORIGIN, size: SIZE, channels }
}

/// An approximately normal number: the sum of twelve uniform numbers from a hash.
fn normal(seed: u32, index: u32) -> f64 {
    let mut state = u64::from(seed) << 32 | u64::from(index);
    let mut uniform = || {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    };
    (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}
