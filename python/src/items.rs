//! Sequences from Python.

use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::error::usage;

/// Greatest number of items. The limit ends iterables that never end.
const MOST: usize = 10_000;

/// The items of an iterable, at most 10,000.
///
/// They are taken one by one. PyO3's conversion to `Vec` first reserves room for as many items as `len` states, so that `range(2**40)` would
/// end the process for lack of memory.
pub struct Items<T>(pub Vec<T>);

impl<'a, 'py, T: FromPyObjectOwned<'py>> FromPyObject<'a, 'py> for Items<T> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Items<T>> {
        if object.is_instance_of::<PyString>() {
            return Err(usage(object.py(), "expected several names or numbers, such as a list, found a string"));
        }
        let mut items = vec![];
        for item in object.try_iter()? {
            if items.len() == MOST {
                return Err(usage(object.py(), format!("expected at most {MOST} items")));
            }
            items.push(item?.extract().map_err(Into::into)?);
        }
        Ok(Items(items))
    }
}
