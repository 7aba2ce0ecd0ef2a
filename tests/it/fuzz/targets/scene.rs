//! Scenes: pt's own and those of other programs, read, built and rendered small.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use pt::build::{Source, build};
use pt::describe::{Identity, read_with};
use pt::film::MomentFilm;
use pt::import::{ImportOptions, Imported, import_with};
use pt::integrators::ALL;
use pt::reader::Node;
use pt::render::{Observer, Settings};

use super::judged;

/// Values that keep a picture small, whatever the scene says.
const SMALL: [(&str, &str); 4] = [("/film/width", "4"), ("/film/height", "4"), ("/sampler/spp", "1"), ("/sampler/scramblings", "1")];

/// Cancels a render that takes long: a scene may ask for much work.
struct Deadline(Instant);

impl Observer for Deadline {
    fn cancelled(&self) -> bool {
        self.0.elapsed() > Duration::from_secs(1)
    }
}

/// Reads a scene of any dialect and renders it.
pub fn render(at: &Path, bytes: &[u8]) -> Result<bool, String> {
    let path = at.join("scene.json");
    std::fs::write(&path, bytes).expect("write");
    render_file(&path)
}

/// Renders a scene as `pt` does, and returns whether it could be rendered. No number of the picture may be infinite or NaN, unless samples were reported as invalid.
pub fn render_file(path: &Path) -> Result<bool, String> {
    let small = |root: &mut Node, _: &str| {
        // Fails where the scene is no object, which is found next.
        SMALL.iter().for_each(|(pointer, value)| drop(root.set(pointer, value)));
        // A model without light would get a sky, which takes long to compute.
        if root.child("background").is_none() {
            let _ = root.set("/background", r#"{"radiance": 0.5}"#);
        }
        Ok(())
    };
    let imported = judged(import_with(path, &ImportOptions { exposure: Some([0.0, 0.5]), ..ImportOptions::default() }, small))?;
    let Some(Imported { root, file, files, .. }) = imported else { return Ok(false) };
    let Some(scene) = judged(read_with(&root, &file, &files))? else { return Ok(false) };
    let Some((entry, integrator)) = judged(pt::integrator::choose(&[ALL], root.child("integrator"), None, &file))? else {
        return Ok(false);
    };
    let Some(built) = judged(build(&scene, Source { root: &root, file: &file, files: &files }))? else { return Ok(false) };
    judged(Identity::new(&scene, &built.contents, &entry))?;
    let mut film = MomentFilm::new(built.film);
    let deadline = Deadline(Instant::now());
    let report = pt::render::render(Arc::new(built.world), &*integrator, &mut film, &Settings::new(built.sampler), &deadline);
    let picture = film.image();
    let odd = picture.channels.iter().find(|channel| channel.values.iter().any(|x| !x.is_finite()));
    match odd.filter(|_| report.invalid == 0 && film.samples() > 0) {
        Some(channel) => Err(format!("channel {} holds {:?}, and no sample was counted as invalid", channel.name, channel.values)),
        None => Ok(true),
    }
}

/// Reads the sampler tests of a course.
pub fn exercises(at: &Path, bytes: &[u8]) -> Result<bool, String> {
    let path = at.join("tests.json");
    std::fs::write(&path, bytes).expect("write");
    judged(pt::import::darts::coursework::read(&path, false)).map(|tests| tests.is_some())
}
