//! `--display-server`: a film that a viewer looks at.

use super::note;
use crate::film::{Block, Film, FilmSpec, MomentFilm, Wave};
use crate::measure::follow::Followed;
use crate::output::tev::Viewer;

/// Keeps what the film keeps, and offers the picture so far to the viewer after every wave.
pub struct Displayed {
    pub film: MomentFilm,
    viewer: Option<Viewer>,
}

impl Displayed {
    /// - `address`: of a viewer, where there is to be one
    /// - `name`: of the picture
    pub fn new(film: MomentFilm, address: Option<&str>, name: &str) -> Displayed {
        let warn = |text: &str| note(&format!("warning: {text}"));
        Displayed { film, viewer: address.map(|address| Viewer::start(address, name, warn)) }
    }

    /// Shows the last picture and ends the connection.
    pub fn finish(&mut self) {
        if let Some(viewer) = self.viewer.take() {
            viewer.show(self.film.image());
            viewer.finish();
        }
    }
}

impl Film for Displayed {
    fn spec(&self) -> &FilmSpec {
        self.film.spec()
    }

    fn add(&mut self, wave: Wave, block: Block) {
        self.film.add(wave, block);
        if let Some(viewer) = &self.viewer {
            viewer.offer(|| self.film.image());
        }
    }
}

impl Followed for Displayed {
    fn moments(&self) -> &MomentFilm {
        &self.film
    }
}
