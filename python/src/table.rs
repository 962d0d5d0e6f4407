//! Numbers as numpy arrays.

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::{
    prelude::*,
    types::{PyDict, PyString},
};

/// A column: its name, and its value in a row.
pub type Column<R, V> = (&'static str, fn(&R) -> V);

/// A dict that is filled with arrays of 64-bit numbers.
pub struct Arrays<'py> {
    dict: Bound<'py, PyDict>,
}

impl<'py> Arrays<'py> {
    /// An empty dict.
    pub fn new(py: Python<'py>) -> Self {
        Self { dict: PyDict::new(py) }
    }

    /// Puts in anything else.
    pub fn put(&self, name: &str, value: impl IntoPyObject<'py>) -> PyResult<()> {
        self.dict.set_item(PyString::new(self.dict.py(), name), value)
    }

    /// Puts in an array of one dimension.
    pub fn vector(&self, name: &str, values: impl IntoIterator<Item = f64>) -> PyResult<()> {
        let values: Vec<f64> = values.into_iter().collect();
        self.put(name, values.into_pyarray(self.dict.py()))
    }

    /// Puts in an array of these dimensions, row by row.
    pub fn array<const N: usize>(
        &self,
        name: &str,
        dimensions: [usize; N],
        values: impl IntoIterator<Item = f64>,
    ) -> PyResult<()> {
        let values: Vec<f64> = values.into_iter().collect();
        self.put(name, values.into_pyarray(self.dict.py()).reshape(dimensions.to_vec())?)
    }

    /// The dict.
    pub fn into_dict(self) -> Bound<'py, PyDict> {
        self.dict
    }
}
