//! A depth camera that owns the ray table that its configuration borrows.

use super::{DepthCamera, DepthFrame};
use crate::moment::Capture;
use crate::optics::RayTableBuf;
use crate::scene::Scene;
use crate::sensor::Sensor;
use crate::sensor::camera::{lend_optics, own_optics};
use crate::trace::{SenseError, Workspace};

/// A [`DepthCamera`] that owns its ray table, created by [`DepthCamera::to_buf`].
#[derive(Debug, Clone)]
pub struct DepthCameraBuf {
    /// Its optics are a placeholder if they have a table, so that nothing is borrowed.
    camera: DepthCamera<'static>,
    table: Option<RayTableBuf>,
}

impl DepthCamera<'_> {
    /// Returns the same camera with its own copy of the ray table.
    pub fn to_buf(&self) -> DepthCameraBuf {
        let (optics, table) = own_optics(&self.camera().config().optics);
        DepthCameraBuf { camera: self.with_optics(&optics), table }
    }
}

impl DepthCameraBuf {
    /// Returns the camera. This copies some hundred bytes, but checks and allocates nothing.
    pub fn camera(&self) -> DepthCamera<'_> {
        self.camera.with_optics(&lend_optics(&self.camera.camera().config().optics, self.table.as_ref()))
    }
}

impl Sensor for DepthCameraBuf {
    type Output<'a> = DepthFrame<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        self.camera().workspace_len(scene, capture)
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: DepthFrame<'_>,
    ) -> Result<(), SenseError> {
        self.camera().sense(scene, capture, workspace, output)
    }
}
