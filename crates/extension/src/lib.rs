//! `forcefeel._core`. Only this is linked, so what it is made of compiles beside the other crates and does not wait for them.

use pyo3::prelude::*;

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    forcefeel_python::fill(module)
}
