//! Meters of a scene.

use pt::load::Settings;
use pt::measure::meters::{CONFIDENCE, MeterLimits, NamedReading, check_meters, measure_meters};
use pyo3::prelude::*;

use crate::error::{detached, raised, usage, value};
use crate::picture::share;
use crate::scene::{Scene, duration, thread_count};
use crate::watch::{Watched, watched};

/// Measures all meters of a scene and returns a list of `Reading`.
pub fn measure<'py>(
    py: Python<'py>,
    scene: &Scene,
    integrator: Option<&str>,
    (target, samples, time): (Option<f64>, Option<i128>, Option<f64>),
    threads: Option<i128>,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let count = |samples: i128| {
        let given = u64::try_from(samples).ok().filter(|samples| *samples > 0);
        given.ok_or_else(|| usage(py, format!("samples: expected a whole number above 0, found {samples}")))
    };
    let limits = MeterLimits {
        target: target.map(|target| share(py, "target", target)).transpose()?,
        samples: samples.map(count).transpose()?,
        time: time.map(|seconds| duration(py, seconds)).transpose()?,
    };
    let threads = threads.map(|threads| thread_count(py, threads)).transpose()?;
    let loaded = detached(py, || {
        let loaded = scene.changed(&Settings::default(), integrator)?;
        check_meters(&loaded, &limits).map(|()| loaded)
    })?;
    let Watched { result, interrupt } =
        watched(py, None, threads, vec![], |watch| measure_meters(&loaded, &limits, &|| watch.is_cancelled()))?;
    match (interrupt, result) {
        (Some(interrupt), _) => Err(interrupt),
        (None, Some(readings)) => readings.iter().map(|reading| told(py, reading, &limits)).collect(),
        (None, None) => Err(raised(py, &pt::Error::Internal("the measurement was cancelled".into()))),
    }
}

fn told<'py>(py: Python<'py>, row: &NamedReading, limits: &MeterLimits) -> PyResult<Bound<'py, PyAny>> {
    let NamedReading { name, reading, time, .. } = row;
    let ((quantity, unit), refusal) = (row.unit(), row.refusal());
    let value_of = |channel: usize| reading.values[channel].value;
    let half = |channel: usize| refusal.is_none().then(|| reading.half_width(channel, CONFIDENCE));
    let target_met = limits.target.map(|_| !limits.is_missed(reading));
    value(py, "_reading")?.call1((
        (name, quantity, unit),
        ([0, 1, 2].map(value_of), [0, 1, 2].map(half)),
        (value_of(3), half(3), CONFIDENCE),
        (reading.samples, reading.invalid, time.as_secs_f64()),
        (refusal, target_met),
    ))
}
