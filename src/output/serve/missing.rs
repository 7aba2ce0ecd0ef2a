//! What stands for the servers where they are not built.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use super::{Accuracy, Progress, Snapshot, Watched};
use crate::film::Image;

/// A server that cannot be started.
#[derive(Debug)]
pub enum Server {}

#[allow(missing_docs, reason = "they are those of the server, and none can be called but the first")]
impl Server {
    /// Starts nothing.
    ///
    /// # Errors
    /// `Unsupported`.
    pub fn start(_: SocketAddr, _: &str, _: &str, _: f64, _: Arc<dyn Watched>) -> io::Result<Server> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "built without the feature serve"))
    }

    pub fn url(&self) -> String {
        match *self {}
    }

    pub fn tell(&self, _: Progress) {
        match *self {}
    }

    pub fn tell_accuracy(&self, _: Accuracy) {
        match *self {}
    }

    pub fn offer(&self, _: f64, _: impl FnOnce() -> Image, _: Option<impl FnOnce() -> Snapshot>) {
        match *self {}
    }

    pub fn finish(self, _: Option<Snapshot>, _: String) {
        match self {}
    }
}

/// A server that cannot be started.
#[derive(Debug)]
pub enum ReportServer {}

#[allow(missing_docs, reason = "they are those of the server, and none can be called but the first")]
impl ReportServer {
    /// Starts nothing.
    ///
    /// # Errors
    /// `Unsupported`.
    pub fn start(_: SocketAddr, _: &str, _: String, _: Box<dyn Fn() + Send + Sync>) -> io::Result<ReportServer> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "built without the feature serve"))
    }

    pub fn url(&self) -> String {
        match *self {}
    }

    pub fn tell(&self, _: &str, _: f64, _: f64, _: Option<f64>) {
        match *self {}
    }

    pub fn offer(&self, _: impl FnOnce(u64) -> Option<String>) {
        match *self {}
    }

    pub fn finish(self, _: impl FnOnce(u64) -> Option<String>, _: String) {
        match self {}
    }
}
