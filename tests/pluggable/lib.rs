//! Nothing: all there is to this package is its test.
