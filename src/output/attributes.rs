//! Facts about a picture that its file carries. They are functions of scene and settings, never of clock or host.

use std::fmt;

use glam::DMat4;
use serde::{Deserialize, Serialize};

use crate::film::FilmSpec;
use crate::scene::Scene;

/// Attributes by name: `pt/…` are pt's own, the others OpenEXR's or pbrt's.
pub type Attributes = Vec<(String, Value)>;

/// Name of the attribute with the reason why no error of the whole picture is stated.
pub const REFUSED: &str = "pt/relativeErrorRefused";

/// Name of the attribute with the ranges of samples of a picture that lacks some: `0..16, 32..64`.
pub const SAMPLES: &str = "pt/samples";

/// Value of an attribute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// Text.
    Text(String),
    /// Whole number.
    Integer(i32),
    /// Number.
    Number(f32),
    /// Point of a plane.
    Point([f32; 2]),
    /// Matrix in OpenEXR's convention: row by row, and points are rows that stand on the left.
    Matrix([f32; 16]),
}

impl Value {
    /// Converts a matrix that is multiplied with columns.
    pub fn matrix(matrix: &DMat4) -> Value {
        Value::Matrix(matrix.to_cols_array().map(|x| x as f32))
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Value {
        Value::Text(text.into())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Value {
        Value::Text(text)
    }
}

impl fmt::Display for Value {
    /// Text of a value; a point is written as `0.5 -1`, a matrix as `1 0 0 0 | 0 1 0 0 | 0 0 1 0 | 0 0 -5 1`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Value::Text(text) => f.write_str(text),
            Value::Integer(number) => number.fmt(f),
            Value::Number(number) => number.fmt(f),
            Value::Point([x, y]) => write!(f, "{x} {y}"),
            Value::Matrix(numbers) => {
                // −0 is written as 0.
                let row = |row: &[f32]| row.iter().map(|x| (x + 0.0).to_string()).collect::<Vec<_>>().join(" ");
                f.write_str(&numbers.chunks(4).map(row).collect::<Vec<_>>().join(" | "))
            }
        }
    }
}

/// View of the picture, as OpenEXR's attributes describe it.
///
/// - `worldToCamera`: to x right, y up, −z ahead (m)
/// - `worldToNDC`: to the display window, x and y from 0 at the upper left to 1, to be divided by w; panoramas have none
/// - `screenWindowWidth`: width that a perspective shows of the plane at distance 1
/// - `screenWindowCenter`: place of its middle on that plane, if the film is shifted
/// - `pixelAspectRatio`: width of a pixel over its height, if they differ
///
/// Source: OpenEXR, *Standard Optional Attributes*. Tests: matrices_find_the_pixel.
pub fn of_camera(scene: &dyn Scene, film: &FilmSpec) -> Attributes {
    let (camera, aspect) = (scene.camera(), f64::from(film.aspect()));
    let to_camera = camera.world_to_camera() * DMat4::from_translation(-scene.origin());
    let to_film = camera.to_film(aspect).map(|to_film| Value::matrix(&(to_film * to_camera)));
    let width = camera.screen_width(aspect).map(|width| Value::Number(width as f32));
    let center = camera.screen_center(aspect).map(|center| Value::Point(center.map(|x| x as f32)));
    let pixel = Some(camera.pixel_aspect(film.aspect())).filter(|pixel| *pixel != 1.0).map(Value::Number);
    let to_camera = Some(Value::matrix(&to_camera));
    let all = [
        ("worldToCamera", to_camera),
        ("worldToNDC", to_film),
        ("screenWindowWidth", width),
        ("screenWindowCenter", center),
        ("pixelAspectRatio", pixel),
    ];
    all.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect()
}
