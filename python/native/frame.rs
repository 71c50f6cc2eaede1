//! A received frame, which numpy accesses in place.

use crate::own::Own;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// A frame in shared memory. A numpy array of the frame refers to it, so that the memory does not change as long as the
/// array exists.
#[pyclass(frozen, weakref, module = "belvedere._native")]
pub(crate) struct Frame {
    held: Own<belvedere_bridge::Frame>,
    /// The bytes of its checked header.
    #[pyo3(get)]
    header: Py<PyBytes>,
    /// Address and length of its payload, which does not move.
    payload: (usize, usize),
    #[pyo3(get)]
    missed: u64,
    #[pyo3(get)]
    restarted: bool,
    #[pyo3(get)]
    is_from_history: bool,
}

impl Frame {
    pub(crate) fn new(py: Python<'_>, frame: belvedere_bridge::Frame) -> Self {
        let payload = frame.payload();
        Self {
            header: PyBytes::new(py, bytemuck::bytes_of(frame.header())).unbind(),
            payload: (payload.as_ptr().addr(), payload.len()),
            missed: frame.missed(),
            restarted: frame.restarted(),
            is_from_history: frame.is_from_history(),
            held: Own::new(frame),
        }
    }
}

#[pymethods]
impl Frame {
    /// Returns the interface by which numpy reads the object's memory, without writing.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.held.check()?;
        let (address, len) = self.payload;
        let is_read_only = true;
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", "|u1")?;
        interface.set_item("shape", (len,))?;
        interface.set_item("data", (if len == 0 { 0 } else { address }, is_read_only))?;
        Ok(interface)
    }
}
