//! Film for `--display-server`, which shows the picture in a viewer.

use super::note;
use crate::film::{Film, FilmSpec, MomentFilm, PixelSums, Wave};
use crate::measure::render_until::HasMoments;
use crate::output::tev::Viewer;

/// Film that offers the picture to the viewer after every wave.
pub struct DisplayedFilm {
    /// The film.
    pub film: MomentFilm,
    viewer: Option<Viewer>,
}

impl DisplayedFilm {
    /// Connects a film to a viewer.
    ///
    /// - `address`: address of a viewer, if there is one
    /// - `name`: name of the picture
    pub fn new(film: MomentFilm, address: Option<&str>, name: &str) -> DisplayedFilm {
        let warn = |text: &str| note(&format!("warning: {text}"));
        DisplayedFilm { film, viewer: address.map(|address| Viewer::start(address, name, warn)) }
    }

    /// Shows the last picture and ends the connection.
    pub fn finish(&mut self) {
        if let Some(viewer) = self.viewer.take() {
            viewer.show(self.film.image());
            viewer.finish();
        }
    }
}

impl Film for DisplayedFilm {
    fn spec(&self) -> &FilmSpec {
        self.film.spec()
    }

    fn add(&mut self, wave: Wave, block: PixelSums) {
        self.film.add(wave, block);
        if let Some(viewer) = &self.viewer {
            viewer.offer(|| self.film.image());
        }
    }
}

impl HasMoments for DisplayedFilm {
    fn moments(&self) -> &MomentFilm {
        &self.film
    }
}
