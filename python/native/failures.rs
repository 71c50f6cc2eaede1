//! Failures of the bridge, as the exceptions of `belvedere._errors`.

use belvedere_bridge::Error;
use pyo3::prelude::*;

pyo3::import_exception!(belvedere._errors, BadFrameError);
pyo3::import_exception!(belvedere._errors, BridgeError);
pyo3::import_exception!(belvedere._errors, IncompatibleError);
pyo3::import_exception!(belvedere._errors, InvalidNameError);
pyo3::import_exception!(belvedere._errors, LimitError);

/// Returns the Python exception for this failure, with the bridge's message if it fits Python.
pub(crate) fn raised(error: Error) -> PyErr {
    let words = error.to_string();
    match error {
        Error::InvalidDomain(_) | Error::InvalidTopic { .. } => InvalidNameError::new_err(words),
        Error::Incompatible { .. } => IncompatibleError::new_err(words),
        Error::TooManySubscribers { .. } => LimitError::new_err(words),
        // In Python a frame is released when the last variable that refers to it is gone.
        Error::TooManyHeld { topic, max } => LimitError::new_err(format!(
            "{max} frames of {topic} are held: release one, or copy() what is needed"
        )),
        Error::Frame { .. } => BadFrameError::new_err(words),
        _ => BridgeError::new_err(words),
    }
}
