//! Parts of a render: some samples of a picture, which are added in any order to the picture of all of them.

use std::path::PathBuf;
use std::sync::Arc;

use pt::Error;
use pt::film::{MomentFilm, SampleSet};
use pt::load::Settings;
use pt::measure::{ErrorHistory, ErrorObserver as _, StopCondition};
use pt::output::{self, attributes::of_camera};
use pt::part::{self, About, Job, Stored};
use pt::render::{self, Render, RenderReport, SHORT_WAVE};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{detached, usage};
use crate::picture::{Picture, Rendered, share};
use crate::scene::{Scene, thread_count};
use crate::watch::{Watched, watched};

/// Sums over some samples of every pixel of a picture. It never changes.
///
/// Parts of one picture that have different samples are added by `merge`, in any order and any grouping, with the same bits. They can be sent
/// between machines: pickle keeps the bytes of a .ptc file, which `pt merge` reads too.
#[pyclass(frozen, module = "pt_renderer")]
pub struct Part {
    /// Content of a .ptc file.
    bytes: Arc<Vec<u8>>,
    /// Ranges of samples without gaps.
    samples: Vec<(u64, u64)>,
    /// "samples", or "rounds" of a file of `pt --adaptive`.
    unit: &'static str,
    scene_hash: String,
    size: [u32; 2],
    seconds: f64,
    invalid: u64,
    /// What it is called in messages.
    name: String,
}

#[pymethods]
impl Part {
    /// Reads a part from a .ptc file, such as `pt --shard` and `pt --samples` write.
    ///
    /// Raises pt_renderer.Error for a file that is missing, damaged or no part.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Part> {
        let (stored, bytes) = detached(py, || {
            // Says what is wrong before a large file of another kind is read.
            Stored::open(&path)?;
            let bytes = std::fs::read(&path).map_err(|failure| Error::io(&path, failure))?;
            // Another process may have replaced it since.
            let bytes = Arc::new(bytes);
            Ok((Stored::of_bytes(&bytes, &path.display().to_string())?, bytes))
        })?;
        Ok(Part { name: path.display().to_string(), ..Part::new(&stored, bytes) })
    }

    /// Writes the part to a file whose name ends in .ptc. The file is replaced when it is complete.
    ///
    /// Raises pt_renderer.Error if it cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let bytes = &self.bytes;
        if path.extension().is_none_or(|extension| extension != "ptc") {
            return Err(usage(py, format!("{}: expected a name that ends in .ptc", path.display())));
        }
        detached(py, || output::replace_with(&path, |mut file| std::io::Write::write_all(&mut file, bytes)))
    }

    /// The samples of every pixel that the part has: pairs (first, end) in ascending order, with first <= sample < end. For a file of
    /// `pt --adaptive` they are rounds, in which pixels have different numbers of samples.
    #[getter]
    fn samples(&self) -> Vec<(u64, u64)> {
        self.samples.clone()
    }

    /// Width of the rendered pixels, those of the crop if there is one.
    #[getter]
    fn width(&self) -> u32 {
        self.size[0]
    }

    /// Height of the rendered pixels, those of the crop if there is one.
    #[getter]
    fn height(&self) -> u32 {
        self.size[1]
    }

    /// Hash of everything that decides the picture: scene, files and settings.
    #[getter]
    fn scene_hash(&self) -> &str {
        &self.scene_hash
    }

    /// Time of rendering in seconds; for a sum of parts, that of all of them together.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Number of samples that were not finite or were negative, and count as black; a sound scene has none.
    #[getter]
    fn invalid(&self) -> u64 {
        self.invalid
    }

    /// The picture of the samples, with its error, a Picture.
    ///
    /// - partial: make the picture although samples before the last one are missing
    /// - confidence: of the interval of the error
    ///
    /// The picture of the samples 0, ..., n - 1 has the bits of a render with n samples per pixel. With the sampler `stratified`, all samples
    /// of its `spp` belong to the picture.
    ///
    /// Raises pt_renderer.Error if samples are missing.
    #[pyo3(signature = (*, partial = false, confidence = 0.95))]
    fn picture(&self, py: Python<'_>, partial: bool, confidence: f64) -> PyResult<Picture> {
        let confidence = share(py, "confidence", confidence)?;
        let part = detached(py, || part::merge(vec![Stored::of_bytes(&self.bytes, &self.name)?]))?;
        if let (Err(gap), false) = (part.whole(), partial) {
            let (unit, start, end) = (part.about.allocation.unit(), gap.start, gap.end);
            return Err(usage(py, format!("picture: {unit} {start}..{end} are missing; partial=True makes a picture of the others")));
        }
        let rendered = detached(py, || {
            let history = part.error_history();
            let part::Part { about, film, report, .. } = part;
            let image = film.image();
            let (hash, integrator) = (output::hash(&image).to_string(), about.identity.fact("/integrator/type").unwrap_or_default());
            let until = StopCondition::new(None, film.samples(), None, None);
            Ok(Rendered { film, image, hash, report, history, about, integrator, confidence, until })
        })?;
        rendered.picture(py)
    }

    /// The bytes of the part as a .ptc file.
    fn __bytes__<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes)
    }

    /// Whether both are the same part, to the last bit and the time of rendering.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Part>().is_ok_and(|other| other.get().bytes == self.bytes)
    }

    /// The checksum at the end of the file.
    fn __hash__(&self) -> u64 {
        self.bytes.last_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }

    fn __repr__(&self) -> String {
        let [width, height] = self.size;
        let samples = SampleSet::of(self.samples.iter().map(|(first, end)| *first..*end));
        format!("<pt_renderer.Part {width}×{height}, {} {samples}>", self.unit)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let new = PyModule::import(py, "pt_renderer._native")?.getattr("_part")?;
        Ok((new, (PyBytes::new(py, &self.bytes),)))
    }
}

impl Part {
    fn new(stored: &Stored, bytes: Arc<Vec<u8>>) -> Part {
        let samples: Vec<(u64, u64)> = stored.ranges().into_iter().map(|range| (range.start, range.end)).collect();
        let name = match &samples[..] {
            [] => "<empty part>".into(),
            [(first, end)] => format!("<part {first}..{end}>"),
            [(first, _), .., (_, end)] => format!("<part {first}..{end} with gaps>"),
        };
        let About { identity, crop, allocation, .. } = &stored.about;
        let (scene_hash, size) = (identity.hash().to_string(), crop.size().to_array());
        let (seconds, invalid) = (stored.report.elapsed.as_secs_f64(), stored.report.invalid);
        let unit = allocation.unit();
        Part { bytes, samples, unit, scene_hash, size, seconds, invalid, name }
    }
}

/// A part from the bytes of a .ptc file.
#[pyfunction]
#[pyo3(name = "_part")]
pub fn of_bytes(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Part> {
    let bytes = Arc::new(bytes);
    let stored = detached(py, || Stored::of_bytes(&bytes, "<bytes>"))?;
    Ok(Part::new(&stored, bytes))
}

/// Adds parts of one picture, in any order, and returns their sum, a Part. A part that is given twice counts once.
///
/// - parts: a list of parts, or anything that gives one after the other
///
/// Raises pt_renderer.Error for parts of different pictures, and for parts that share samples, such as a sum and a part that is in it.
#[pyfunction]
pub fn merge(py: Python<'_>, parts: &Bound<'_, PyAny>) -> PyResult<Part> {
    let parts: Vec<Py<Part>> = parts.try_iter()?.map(|part| Ok(part?.cast_into::<Part>()?.unbind())).collect::<PyResult<_>>()?;
    let given: Vec<&Part> = parts.iter().map(Py::get).collect();
    let bytes = detached(py, || {
        let mut stored: Vec<Stored> = vec![];
        for part in given {
            let mut part = Stored::of_bytes(&part.bytes, &part.name)?;
            if let Some(first) = stored.first() {
                part.share_allocation(first);
            }
            stored.push(part);
        }
        let part::Part { about, film, report, history, .. } = part::merge(stored)?;
        bytes_of(&about, &film, &report, &history)
    })?;
    of_bytes(py, bytes)
}

fn bytes_of(about: &About, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) -> pt::Result<Vec<u8>> {
    let mut bytes = vec![];
    part::write_to(&mut bytes, "<part>", about, film, report, history)?;
    Ok(bytes)
}

/// Renders the samples first, ..., end - 1 of every pixel.
pub fn render(
    py: Python<'_>,
    scene: &Scene,
    [first, end]: [i128; 2],
    settings: &Settings,
    integrator: Option<&str>,
    threads: Option<i128>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Part> {
    let threads = threads.map(|threads| thread_count(py, threads)).transpose()?;
    let loaded = detached(py, || scene.changed(settings, integrator))?;
    let (most, name) = (loaded.sampler.end(), loaded.sampler.kind.name());
    let range = match [first, end].map(u64::try_from) {
        [Ok(first), Ok(end)] if first < end && end <= most => first..end,
        _ => {
            let found = format!("found {first} and {end}; {most} is the number of samples that {name} has");
            return Err(usage(py, format!("part: expected samples with 0 <= first < end <= {most}, {found}")));
        }
    };
    let Watched { result, interrupt } = watched(py, progress, threads, vec![], |watch| {
        let spec = &loaded.film;
        let view = of_camera(&*loaded.world, spec);
        let about = About::new(loaded.identity()?, spec, loaded.sampler.error_estimator(), view);
        let about = About { job: Job { command: vec![], samples: loaded.sampler.spp }, ..about };
        let settings = render::Settings { wave_time: Some(SHORT_WAVE), ..render::Settings::new(loaded.sampler) };
        let mut film = MomentFilm::new(spec.clone());
        let render = Render::new(loaded.world.clone(), &*loaded.integrator, spec, &settings);
        let mut render = render.resumed(range.start, RenderReport::default());
        let none = ErrorHistory::default();
        while render.step(range.end, None, &mut film, watch) {
            watch.wave_finished(render.report(), &film, &none);
        }
        // The samples of a cancelled part are discarded.
        if render.report().cancelled { Ok(vec![]) } else { bytes_of(&about, &film, render.report(), &none) }
    })?;
    interrupt.map_or_else(|| of_bytes(py, result), Err)
}
