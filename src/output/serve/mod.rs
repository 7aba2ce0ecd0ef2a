//! Pages for browsers that show work while it goes on: a picture while it renders ([`Server`]), and a report that grows
//! ([`ReportServer`]).
//!
//! The page of a render:
//!
//! | request | answer |
//! |---|---|
//! | `GET /` | the page |
//! | `GET /events` | server-sent events: the [`Status`] of the render whenever it changes |
//! | `GET /picture?since=N` | the picture as half floats (`picture.rs`), or nothing (204) if picture N is the latest |
//! | `GET /pixel?x=X&y=Y` | how the noise of a pixel came about, as text |
//! | `POST /stop` | ends the render |
//!
//! Each request needs the token of the address, and a name of the server that is not another site's (`guard.rs`).
//!
//! A thread of its own serves all browsers. It holds the latest state and the latest picture or report and nothing else, so that the work
//! never waits, and a browser that is slow, stuck or gone costs it nothing.
//!
//! The servers are there with the feature `serve`. Without it, they cannot be started.

#[cfg(feature = "serve")]
mod connections;
#[cfg(feature = "serve")]
mod events;
#[cfg(feature = "serve")]
mod guard;
#[cfg(feature = "serve")]
mod host;
#[cfg(not(feature = "serve"))]
mod missing;
#[cfg(feature = "serve")]
mod page;
#[cfg(feature = "serve")]
mod picture;
#[cfg(feature = "serve")]
mod report;
#[cfg(feature = "serve")]
mod routes;
#[cfg(feature = "serve")]
mod server;
#[cfg(feature = "serve")]
mod shared;
mod status;

#[cfg(not(feature = "serve"))]
pub use missing::{ReportServer, Server};
#[cfg(feature = "serve")]
pub use report::ReportServer;
#[cfg(feature = "serve")]
pub use server::Server;
pub use status::{Accuracy, PictureVersion, Progress, ReportStatus, Status, WorstPixel};

use crate::film::Image;

/// Whether pages can be served: the feature `serve`.
pub const IS_BUILT: bool = cfg!(feature = "serve");

/// A picture with the errors of its pixels.
pub struct Snapshot {
    /// Samples per pixel.
    pub samples: f64,
    /// The picture, with standard errors if they are known.
    pub image: Image,
    /// The pixels that add most to the noise, the noisiest first.
    pub worst: Vec<WorstPixel>,
}

/// A render, as its page sees it.
pub trait Watched: Send + Sync {
    /// Ends the render soon. It returns at once.
    fn stop(&self);

    /// Tells how the noise of a pixel came about; `None` for a pixel outside of the picture. It may take seconds.
    fn explain(&self, pixel: [u32; 2]) -> Option<String>;
}
