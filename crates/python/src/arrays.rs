//! NumPy arrays to nalgebra matrices and back.

use crate::errors::refused;
use nalgebra::{DMatrix, DVector};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// A NumPy matrix.
pub type Matrix<'py> = Bound<'py, PyArray2<f64>>;

/// A matrix of the given shape, or a `ArgumentError` that names it.
pub fn matrix(name: &str, array: &PyReadonlyArray2<'_, f64>, shape: (usize, usize)) -> PyResult<DMatrix<f64>> {
    let view = array.as_array();
    if view.dim() != shape {
        return Err(refused(format!("{name}: expected shape {shape:?}, got {:?}", view.dim())));
    }
    Ok(DMatrix::from_row_iterator(shape.0, shape.1, view.iter().copied()))
}

/// A fixed number of values, or a `ArgumentError` that names them.
pub fn vector<const N: usize>(name: &str, array: &PyReadonlyArray1<'_, f64>) -> PyResult<[f64; N]> {
    let values: Vec<f64> = array.as_array().iter().copied().collect();
    let came = values.len();
    values.try_into().map_err(|_| refused(format!("{name}: expected {N} values, got {came}")))
}

/// So many values, one at least, or a `ArgumentError` that names them.
pub fn values(name: &str, array: &PyReadonlyArray1<'_, f64>, count: usize) -> PyResult<DVector<f64>> {
    let values: Vec<f64> = array.as_array().iter().copied().collect();
    if count == 0 || values.len() != count {
        return Err(refused(format!("{name}: expected {count} values, one at least, got {}", values.len())));
    }
    Ok(DVector::from_vec(values))
}

/// Rows of a fixed number of values, one at least, or a `ArgumentError` that names them.
pub fn rows<const N: usize>(name: &str, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<[f64; N]>> {
    let array = array.as_array();
    if array.ncols() != N || array.nrows() == 0 {
        return Err(refused(format!("{name}: expected rows of {N} values, got {:?}", array.dim())));
    }
    Ok(array.outer_iter().map(|row| core::array::from_fn(|k| row[k])).collect())
}

/// A NumPy array with the entries of `matrix`.
pub fn to_numpy<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> PyResult<Matrix<'py>> {
    let rows: Vec<f64> = matrix.transpose().iter().copied().collect();
    PyArray1::from_vec(py, rows).reshape([matrix.nrows(), matrix.ncols()])
}
