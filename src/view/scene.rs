//! The scene that the page fetches.

use std::sync::{Arc, Mutex, PoisonError};

/// A binary glTF file, with an edition that increases when it is replaced.
#[derive(Debug, Default)]
pub(super) struct Scene(Mutex<(u64, Arc<Vec<u8>>)>);

impl Scene {
    pub(super) fn set(&self, glb: Vec<u8>) {
        let mut now = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *now = (now.0 + 1, Arc::new(glb));
    }

    /// Returns the edition, 0 before there is a file.
    pub(super) fn edition(&self) -> u64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).0
    }

    pub(super) fn bytes(&self) -> Arc<Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.clone()
    }
}
