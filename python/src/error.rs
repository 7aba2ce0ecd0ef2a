//! Errors of pt as the exception of the package.

use std::panic::{AssertUnwindSafe, catch_unwind};

use pt::{Error, Fault};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// A class or function of the module `pt_renderer._values`, which is imported once.
pub fn value<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    static VALUES: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module = VALUES.get_or_try_init(py, || PyModule::import(py, "pt_renderer._values").map(Bound::unbind))?;
    module.bind(py).getattr(name)
}

/// The exception for an error of pt.
pub fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let kind = match error {
        Error::Usage(_) => "usage",
        Error::Invalid(_) => "invalid",
        Error::Limit(_) => "limit",
        Error::Io { .. } => "io",
        Error::Interrupted(_) => "interrupted",
        _ => "internal",
    };
    let fault = |fault: Fault| (fault.file, fault.line, fault.column, fault.pointer, fault.message);
    let faults: Vec<_> = error.faults().into_iter().map(fault).collect();
    let made = value(py, "_error").and_then(|new| new.call1((error.to_string(), faults, kind)));
    made.map_or_else(|failure| failure, PyErr::from_value)
}

/// The exception for a wrong argument.
pub fn usage(py: Python<'_>, message: impl Into<String>) -> PyErr {
    raised(py, &Error::Usage(message.into()))
}

/// Runs work without the interpreter lock. An error, or a panic, which is a bug of pt, becomes an exception.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> pt::Result<T> + Send) -> PyResult<T> {
    py.detach(|| caught(work)).map_err(|error| raised(py, &error))
}

/// Runs work and returns a panic as an error.
pub fn caught<T>(work: impl FnOnce() -> pt::Result<T>) -> pt::Result<T> {
    // Unwind safety: the state that `work` leaves behind is not used after a panic.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        Err(Error::Internal(text.unwrap_or("a panic without words").to_owned()))
    })
}
