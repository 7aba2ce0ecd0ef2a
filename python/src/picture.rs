//! Pictures as numpy arrays, with their errors.

use std::path::PathBuf;

use glam::UVec2;
use numpy::ndarray::{Array, IxDyn};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pt::film::{Channel, Film as _, FilmSpec, Image, Layer, MomentFilm};
use pt::measure::verify::Side;
use pt::measure::{Checkpoint, ErrorHistory, Outcome, RelativeError, Scope, StopCondition};
use pt::output::{self, Attributes, Curve, Tonemap, exposure, png};
use pt::part::About;
use pt::render::RenderReport;
use pt::sampler::ErrorEstimator;
use pt::summary::{self, Accuracy};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde::{Deserialize, Serialize};

use crate::error::{detached, raised, usage, value};
use crate::items::Items;

/// Greatest size of a picture in a notebook (bytes).
const NOTEBOOK: usize = 1_000_000;

/// A picture of linear colours, in numpy arrays that are shared and never change.
///
/// All arrays have a row for each row of the picture, from the top, and a column for each pixel. Colours are radiances
/// (W·m⁻²·sr⁻¹) in linear sRGB.
#[pyclass(frozen, module = "pt_renderer")]
pub struct Picture {
    facts: Facts,
    /// One array for each group of channels, in the order of the picture.
    arrays: Vec<Py<PyArrayDyn<f32>>>,
}

/// Everything about a picture except its numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Facts {
    full_size: [u32; 2],
    origin: [u32; 2],
    size: [u32; 2],
    groups: Vec<Group>,
    attributes: Attributes,
    hash: String,
    summary: String,
    integrator: String,
    scene_hash: String,
    spp: f64,
    seconds: f64,
    invalid: u64,
    interrupted: bool,
    /// Whether a target is met; `None` without a target.
    target_met: Option<bool>,
    confidence: f64,
    error: StatedError,
    checkpoints: Vec<StoredCheckpoint>,
    sampler: String,
}

/// Channels that make one array.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Group {
    kind: Kind,
    /// Names of the channels in files.
    channels: Vec<String>,
}

/// What the array of a group is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Kind {
    Rgb,
    StandardError,
    Samples,
    Layer(String),
}

/// Error with its interval, or the reason why none is stated.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum StatedError {
    Stated([f64; 3]),
    Refused(String),
}

/// Samples, seconds and the numbers of the error at one checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StoredCheckpoint(u64, f64, Option<StoredError>);

/// The fields of an error. JSON has no infinite numbers, so that they are kept as bits.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StoredError([u64; 3]);

/// A render that is done, from which a picture is made.
pub struct Rendered {
    /// Film with all samples.
    pub film: MomentFilm,
    /// Its picture.
    pub image: Image,
    /// Hash of the picture.
    pub hash: String,
    /// Report of the render.
    pub report: RenderReport,
    /// History of the error.
    pub history: ErrorHistory,
    /// Facts about the picture.
    pub about: About,
    /// Name of the integrator.
    pub integrator: String,
    /// Confidence of the stated error.
    pub confidence: f64,
    /// Condition at which the render was to stop.
    pub until: StopCondition,
}

impl Rendered {
    /// The picture, whose arrays take the numbers over.
    pub fn picture(self, py: Python<'_>) -> PyResult<Picture> {
        let Rendered { film, image, hash, report, history, about, integrator, confidence, until } = self;
        let target_met = until.target.map(|target| target.outcome(&history) == Outcome::Met);
        // What is stated is the error of the whole picture, whatever part of it the target was for.
        let history = match until.scope() {
            Scope::Picture => history,
            _ => ErrorHistory { checkpoints: vec![], ..history }.and_now(&film, report.elapsed),
        };
        let accuracy = Accuracy::of(&film, &history, confidence);
        let attributes = summary::attributes(&about, &film, &accuracy, confidence, None);
        let line = summary::rendered(&about, &summary::samples(&film), &report) + &summary::accuracy(&accuracy, &history, confidence);
        let error = match &accuracy {
            Accuracy::Stated(error) => StatedError::Stated([error.value, error.low, error.high]),
            Accuracy::Refused(refusal, _) => StatedError::Refused(refusal.to_string()),
            Accuracy::Untold(why) => StatedError::Refused(format!("no error is told: {why}")),
            Accuracy::Unknown => StatedError::Refused("no error is told: the picture is black".into()),
        };
        let groups = groups(film.spec(), &image);
        let arrays = arrays(py, &groups, &image)?;
        let facts = Facts {
            full_size: image.full_size.to_array(),
            origin: image.origin.to_array(),
            size: image.size.to_array(),
            groups,
            attributes,
            hash,
            summary: line,
            integrator,
            scene_hash: about.identity.hash().to_string(),
            spp: film.mean_samples(),
            seconds: report.elapsed.as_secs_f64(),
            invalid: report.invalid,
            interrupted: report.cancelled,
            target_met,
            confidence,
            error,
            checkpoints: history.checkpoints.iter().map(stored).collect(),
            sampler: history.sampler.name().to_owned(),
        };
        Ok(Picture { facts, arrays })
    }
}

#[pymethods]
impl Picture {
    /// Colours: float32 of shape (height, width, 3), red, green and blue, linear (W·m⁻²·sr⁻¹).
    #[getter]
    fn rgb(&self, py: Python<'_>) -> Option<Py<PyArrayDyn<f32>>> {
        self.array(py, &Kind::Rgb)
    }

    /// Standard errors of the colours: float32 of shape (height, width, 3), or None where the samples tell none.
    #[getter]
    fn stderr(&self, py: Python<'_>) -> Option<Py<PyArrayDyn<f32>>> {
        self.array(py, &Kind::StandardError)
    }

    /// Samples of each pixel: float32 of shape (height, width).
    #[getter]
    fn samples(&self, py: Python<'_>) -> Option<Py<PyArrayDyn<f32>>> {
        self.array(py, &Kind::Samples)
    }

    /// The layers that were asked for, by name: float32 of shape (height, width, channels), or (height, width) for one channel. A layer of
    /// light by lights is "lights.NAME".
    #[getter]
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let layers = PyDict::new(py);
        for (group, array) in self.facts.groups.iter().zip(&self.arrays) {
            if let Kind::Layer(name) = &group.kind {
                layers.set_item(name, array)?;
            }
        }
        Ok(layers)
    }

    /// Width of the picture in pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.facts.size[0]
    }

    /// Height of the picture in pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.facts.size[1]
    }

    /// Pixels of the whole picture that these are: (x0, x1, y0, y1), with x0 <= x < x1 and y0 <= y < y1.
    #[getter]
    fn crop(&self) -> [u32; 4] {
        let ([x, y], [width, height]) = (self.facts.origin, self.facts.size);
        [x, x + width, y, y + height]
    }

    /// Relative error of the whole picture, an ErrorEstimate: with the interval that holds it, or with the reason why none is stated.
    #[getter]
    fn error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let confidence = self.facts.confidence;
        let (numbers, refusal) = match &self.facts.error {
            StatedError::Stated(numbers) => (numbers.map(Some), None),
            StatedError::Refused(why) => ([None; 3], Some(why)),
        };
        value(py, "ErrorEstimate")?.call1((numbers[0], numbers[1], numbers[2], confidence, refusal))
    }

    /// What smaller relative errors take: a Price for each of `errors` (at most 10000), or None where no price can be stated.
    ///
    /// Times are those of the whole render, in seconds, on this machine, with the interval that holds them with `confidence`.
    #[pyo3(signature = (errors = Items(vec![0.1, 0.03, 0.01, 0.003]), *, confidence = None))]
    fn price<'py>(&self, py: Python<'py>, errors: Items<f64>, confidence: Option<f64>) -> PyResult<Vec<Option<Bound<'py, PyAny>>>> {
        let confidence = share(py, "confidence", confidence.unwrap_or(self.facts.confidence))?;
        let (history, class) = (self.history(), value(py, "Price")?);
        let price = |error: f64| {
            let error = share(py, "errors", error)?;
            let price = history.price(error, confidence).map(|price| class.call1((error, price.value, price.low, price.high)));
            price.transpose()
        };
        errors.0.into_iter().map(price).collect()
    }

    /// Hash of the picture, as `pt image hash` prints it: the same for the same scene, settings and version of pt.
    #[getter]
    fn hash(&self) -> &str {
        &self.facts.hash
    }

    /// Hash of everything that decides the picture: scene, files and settings.
    #[getter]
    fn scene_hash(&self) -> &str {
        &self.facts.scene_hash
    }

    /// Name of the integrator.
    #[getter]
    fn integrator(&self) -> &str {
        &self.facts.integrator
    }

    /// Samples per pixel.
    #[getter]
    fn spp(&self) -> f64 {
        self.facts.spp
    }

    /// Time of rendering in seconds, without loading.
    #[getter]
    fn seconds(&self) -> f64 {
        self.facts.seconds
    }

    /// Number of samples that were not finite or were negative, and count as black; a sound scene has none.
    #[getter]
    fn invalid(&self) -> u64 {
        self.facts.invalid
    }

    /// Whether Ctrl-C ended the render before its time. The picture has the samples until then.
    #[getter]
    fn interrupted(&self) -> bool {
        self.facts.interrupted
    }

    /// Whether the target was reached; None for a render without a target.
    #[getter]
    fn target_met(&self) -> Option<bool> {
        self.facts.target_met
    }

    /// Facts about the picture that files of it carry, by name.
    #[getter]
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let attributes = PyDict::new(py);
        for (name, value) in &self.facts.attributes {
            attributes.set_item(name, value.to_string())?;
        }
        Ok(attributes)
    }

    /// Writes the picture to a file: .exr (linear, all layers), .hdr, .png, .ppm or .pfm. The file is replaced when it is complete.
    ///
    /// `exposure` (stops, or "auto") and `tonemap` ("none", "filmic", "agx", "normalize" or "postcard") are for 8-bit files only.
    #[pyo3(signature = (path, *, exposure = None, tonemap = "none"))]
    fn save(&self, py: Python<'_>, path: PathBuf, exposure: Option<Bound<'_, PyAny>>, tonemap: &str) -> PyResult<()> {
        let image = self.image(py)?;
        let tonemap = Tonemap { exposure: stops(py, exposure, &image)?, curve: curve(py, tonemap)? };
        detached(py, || output::write(&path, &image, &self.facts.attributes, &tonemap))
    }

    /// The picture as notebooks show it: a PNG of at most a megabyte, with an exposure that shows it.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let image = self.image(py)?;
        let bytes = detached(py, || notebook_png(image))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The closing line that the program prints for a render.
    fn __str__(&self) -> &str {
        &self.facts.summary
    }

    fn __repr__(&self) -> String {
        format!("<pt_renderer.Picture {}>", self.facts.summary)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Picture>().is_ok_and(|other| other.get().facts.hash == self.facts.hash)
    }

    fn __hash__(&self) -> u64 {
        u64::from_str_radix(self.facts.hash.get(..16).unwrap_or("0"), 16).unwrap_or(0)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let new = PyModule::import(py, "pt_renderer._native")?.getattr("_unpickled")?;
        let facts = serde_json::to_string(&self.facts).map_err(|failure| internal(py, &failure))?;
        Ok((new, (facts, self.arrays.iter().map(|array| array.clone_ref(py)).collect())))
    }
}

/// Facts of a picture as JSON, and its arrays.
type Pickled = (String, Vec<Py<PyArrayDyn<f32>>>);

/// A picture from its pickled parts.
#[pyfunction]
#[pyo3(name = "_unpickled")]
pub fn unpickled(py: Python<'_>, facts: &str, arrays: Vec<Py<PyArrayDyn<f32>>>) -> PyResult<Picture> {
    let facts: Facts =
        serde_json::from_str(facts).map_err(|failure| usage(py, format!("the pickle of a picture is damaged: {failure}")))?;
    let count = facts.size[0] as usize * facts.size[1] as usize;
    let fits =
        |(group, array): (&Group, &Py<PyArrayDyn<f32>>)| array.bind(py).shape().iter().product::<usize>() == count * group.channels.len();
    if facts.groups.len() != arrays.len() || !facts.groups.iter().zip(&arrays).all(fits) {
        return Err(usage(py, "the pickle of a picture is damaged: its arrays do not fit"));
    }
    let frozen = |array: Py<PyArrayDyn<f32>>| frozen(array.into_bound(py));
    Ok(Picture { facts, arrays: arrays.into_iter().map(frozen).collect() })
}

impl Picture {
    fn array(&self, py: Python<'_>, kind: &Kind) -> Option<Py<PyArrayDyn<f32>>> {
        let mut groups = self.facts.groups.iter().zip(&self.arrays);
        groups.find(|(group, _)| group.kind == *kind).map(|(_, array)| array.clone_ref(py))
    }

    /// The picture as the library has it.
    pub fn image(&self, py: Python<'_>) -> PyResult<Image> {
        let Facts { full_size, origin, size, .. } = self.facts;
        let mut channels = vec![];
        for (group, array) in self.facts.groups.iter().zip(&self.arrays) {
            let array = array.bind(py).readonly();
            let values = array.as_slice()?;
            let count = group.channels.len();
            channels.extend(
                group
                    .channels
                    .iter()
                    .enumerate()
                    .map(|(c, name)| Channel { name: name.clone(), values: values.iter().skip(c).step_by(count).copied().collect() }),
            );
        }
        Ok(Image { full_size: full_size.into(), origin: origin.into(), size: UVec2::from(size), channels })
    }

    /// The picture as a side of a test.
    pub fn side(&self, py: Python<'_>, name: &str) -> PyResult<Side> {
        Side::new(name.to_owned(), self.image(py)?, &self.facts.attributes).map_err(|why| usage(py, format!("{name}: {why}")))
    }

    /// Seed of the random numbers, as the picture's attributes state it.
    pub fn seed(&self) -> Option<String> {
        self.facts.attributes.iter().find(|(name, _)| name == "pt/seed").map(|(_, value)| value.to_string())
    }

    /// Relative error and attributes, for a reference.
    pub fn attributes_of(&self) -> &Attributes {
        &self.facts.attributes
    }

    fn history(&self) -> ErrorHistory {
        let checkpoints = self.facts.checkpoints.iter().map(|StoredCheckpoint(samples, seconds, error)| Checkpoint {
            samples: *samples,
            seconds: *seconds,
            error: error.as_ref().map(|StoredError(bits)| {
                let [value, spread, effective_pixels] = bits.map(f64::from_bits);
                RelativeError { value, spread, effective_pixels }
            }),
        });
        let sampler = pt::sampler::Kind::named(&self.facts.sampler).unwrap_or_default();
        ErrorHistory { checkpoints: checkpoints.collect(), sampler }
    }
}

fn stored(checkpoint: &Checkpoint) -> StoredCheckpoint {
    let bits = |error: RelativeError| StoredError([error.value, error.spread, error.effective_pixels].map(f64::to_bits));
    StoredCheckpoint(checkpoint.samples, checkpoint.seconds, checkpoint.error.map(bits))
}

/// Groups of the channels of a picture of a film.
fn groups(film: &FilmSpec, image: &Image) -> Vec<Group> {
    let names = |names: [&str; 3]| names.map(str::to_owned).to_vec();
    let mut groups = vec![
        Group { kind: Kind::Rgb, channels: names(["R", "G", "B"]) },
        Group { kind: Kind::StandardError, channels: names(["StdErr.R", "StdErr.G", "StdErr.B"]) },
        Group { kind: Kind::Samples, channels: vec!["SampleCount.Y".into()] },
    ];
    groups.extend(film.layers.iter().map(|layer| {
        let name = match layer {
            Layer::Light(i) => format!("{}.{}", layer.name(), film.lights.names.get(*i as usize).map_or("?", String::as_str)),
            other => other.name().to_owned(),
        };
        Group { kind: Kind::Layer(name), channels: layer.channels(&film.lights) }
    }));
    groups.retain(|group| group.channels.iter().all(|name| image.channel(name).is_some()));
    groups
}

/// One array for each group.
fn arrays(py: Python<'_>, groups: &[Group], image: &Image) -> PyResult<Vec<Py<PyArrayDyn<f32>>>> {
    let [width, height] = image.size.to_array().map(|side| side as usize);
    let interleaved = |group: &Group| -> Vec<f32> {
        let channels: Vec<&[f32]> = group.channels.iter().filter_map(|name| image.channel(name)).collect();
        (0..width * height).flat_map(|i| channels.iter().map(move |values| values[i])).collect()
    };
    let all: Vec<Vec<f32>> = py.detach(|| groups.iter().map(interleaved).collect());
    let array = |(group, values): (&Group, Vec<f32>)| {
        let count = group.channels.len();
        let shape = if count == 1 { vec![height, width] } else { vec![height, width, count] };
        let array = Array::from_shape_vec(IxDyn(&shape), values).map_err(|failure| internal(py, &failure))?;
        // The array takes the numbers over: nothing is copied.
        Ok(frozen(array.into_pyarray(py)))
    };
    groups.iter().zip(all).map(array).collect()
}

/// The array, which can no longer be written to.
fn frozen(array: Bound<'_, PyArrayDyn<f32>>) -> Py<PyArrayDyn<f32>> {
    if let Ok(writable) = array.try_readwrite() {
        drop(writable.make_nonwriteable());
    }
    array.unbind()
}

/// PNG with the exposure that pt's files have, or one that shows the picture if that one does not; halved until it is small enough.
fn notebook_png(mut image: Image) -> pt::Result<Vec<u8>> {
    let mut tonemap = Tonemap::default();
    if exposure::fault(&image, &tonemap).is_some() {
        tonemap.exposure = exposure::automatic(&image);
    }
    image.channels.truncate(3);
    loop {
        let bytes = png::encode(&image, &tonemap)?;
        if bytes.len() <= NOTEBOOK || image.size.min_element() < 2 {
            return Ok(bytes);
        }
        image = halved(&image);
    }
}

/// The picture with a quarter of its pixels, each the mean of four.
fn halved(image: &Image) -> Image {
    let (size, width) = (image.size / 2, image.size.x as usize);
    let mean = |values: &[f32], x: usize, y: usize| {
        let at = |dx: usize, dy: usize| values[(2 * y + dy) * width + 2 * x + dx];
        0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
    };
    let channel = |channel: &Channel| {
        let places = (0..size.y as usize).flat_map(|y| (0..size.x as usize).map(move |x| (x, y)));
        Channel { name: channel.name.clone(), values: places.map(|(x, y)| mean(&channel.values, x, y)).collect() }
    };
    Image { full_size: size, origin: UVec2::ZERO, size, channels: image.channels.iter().map(channel).collect() }
}

fn stops(py: Python<'_>, exposure: Option<Bound<'_, PyAny>>, image: &Image) -> PyResult<f32> {
    let Some(given) = exposure else { return Ok(0.0) };
    if given.extract::<String>().is_ok_and(|text| text == "auto") {
        return Ok(exposure::automatic(image));
    }
    let stops = given.extract::<f32>().ok().filter(|stops| stops.is_finite());
    stops.ok_or_else(|| usage(py, "exposure: expected a number of stops, or \"auto\""))
}

fn curve(py: Python<'_>, name: &str) -> PyResult<Curve> {
    const CURVES: [(&str, Curve); 5] = [
        ("none", Curve::None),
        ("filmic", Curve::Filmic),
        ("agx", Curve::Agx),
        ("normalize", Curve::Normalize),
        ("postcard", Curve::Postcard),
    ];
    let found = CURVES.iter().find(|(known, _)| *known == name).map(|(_, curve)| *curve);
    found.ok_or_else(|| usage(py, pt::reader::unknown("tonemap", name, &CURVES.map(|(known, _)| known))))
}

/// A number above 0 and below 1.
pub fn share(py: Python<'_>, name: &str, value: f64) -> PyResult<f64> {
    let given = Some(value).filter(|value| *value > 0.0 && *value < 1.0);
    given.ok_or_else(|| usage(py, format!("{name}: expected a share above 0 and below 1, such as 0.01, found {value}")))
}

fn internal(py: Python<'_>, failure: &dyn std::fmt::Display) -> PyErr {
    raised(py, &pt::Error::Internal(failure.to_string()))
}

/// Estimator of the error, for a picture that needs one.
pub fn tells_error(estimator: ErrorEstimator) -> bool {
    estimator != ErrorEstimator::Scramblings(1)
}
