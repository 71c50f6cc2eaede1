//! The points of a scan on a topic of their own, as gz-sim publishes them.

use super::super::mount::Mount;
use super::super::outlet::Outlet;
use super::super::sink::Frame;
use super::super::{Opening, RigError};
use belvedere_bridge::point::XyzIrPoint;
use belvedere_bridge::{Encoding, Kind, StreamSpec};
use belvedere_sensors::Pose;
use std::time::Duration;

/// The stream of a scan's points. A row is a layer of the scan, from the first vertical angle on; beams without a range
/// have NaN coordinates.
pub(super) struct Points {
    outlet: Outlet,
    /// Beams of a layer, and layers.
    size: [u32; 2],
    measured: Vec<[f32; 3]>,
    /// Intensities for scans that nobody has subscribed to.
    intensities: Vec<f32>,
}

/// A place for the points of one scan.
pub(super) struct Cloud<'a> {
    frame: Frame,
    pub(super) points: &'a mut [[f32; 3]],
    /// A place for the intensities, if the scan has no subscribers.
    pub(super) intensities: &'a mut [f32],
}

impl Cloud<'_> {
    /// Returns the frame with the points that were measured. `intensities` are those of the scan; without them, they lie
    /// in this place.
    pub(super) fn into_frame(self, intensities: Option<&[f32]>) -> Frame {
        let Self { mut frame, points, intensities: own } = self;
        let in_layer = frame.header().width as usize;
        let intensities = intensities.unwrap_or(own);
        let places = frame.payload_mut().as_chunks_mut().0.iter_mut();
        let beams = points.iter().zip(intensities).enumerate();
        for (place, (beam, (&[x, y, z], &intensity))) in places.zip(beams) {
            *place = XyzIrPoint { x, y, z, intensity, ring: (beam / in_layer) as u16 }.to_bytes();
        }
        frame
    }
}

impl Points {
    /// Opens the stream for scans with this number of beams and layers.
    pub(super) fn open(
        topic: &str,
        frame_id: &str,
        size: [u32; 2],
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let bytes = size[0] as usize * size[1] as usize * XyzIrPoint::SIZE;
        let spec = StreamSpec::new(topic, Kind::PointCloud, Encoding::XyzIrF32, bytes);
        let outlet = opening.open_rendered(spec.frame_id(frame_id).rate_hz(opening.rate.hz()))?;
        Ok(Self { outlet, size, measured: Vec::new(), intensities: Vec::new() })
    }

    pub(super) fn outlet(&self) -> &Outlet {
        &self.outlet
    }

    /// Returns a place for the points of a scan, if the stream has subscribers.
    pub(super) fn loan(&mut self, stamp_ns: u64, world_from_sensor: &Pose) -> Option<Cloud<'_>> {
        let beams = self.size[0] as usize * self.size[1] as usize;
        let mut frame = self.outlet.loan(beams * XyzIrPoint::SIZE)?;
        let header = frame.header_mut();
        header.set_packed(self.size[0], self.size[1]);
        header.stamp_ns = stamp_ns;
        Mount::write(world_from_sensor, header);
        self.measured.resize(beams, [0.0; 3]);
        self.intensities.resize(beams, 0.0);
        Some(Cloud { frame, points: &mut self.measured, intensities: &mut self.intensities })
    }

    /// Sends the points of a scan, if it was taken.
    pub(super) fn send(&mut self, frame: Option<Frame>, busy: Duration) {
        let outcome = self.outlet.send(frame);
        self.outlet.record(outcome, busy);
    }
}
