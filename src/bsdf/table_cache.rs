//! Tables that are computed once for each set of parameters.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// A cache of tables, which are computed once for each key and kept for the life of the process (up to 160 kB each). So a model at a
/// hit can refer to them and stay plain data.
///
/// - `K`: the parameters of a table, as the bits of its numbers
pub struct TableCache<K, T: 'static>(Mutex<BTreeMap<K, &'static T>>);

impl<K: Ord, T> TableCache<K, T> {
    pub const fn new() -> TableCache<K, T> {
        TableCache(Mutex::new(BTreeMap::new()))
    }

    pub fn get(&self, key: K, make: impl FnOnce() -> T) -> &'static T {
        // A panic elsewhere leaves no partial table, so that a poisoned lock can be used.
        let tables = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = tables().get(&key).copied();
        // The lock is free while a table is made, because that may run on several threads, which may come to make another table.
        known.unwrap_or_else(|| {
            let made = make();
            tables().entry(key).or_insert_with(|| Box::leak(Box::new(made)))
        })
    }
}
