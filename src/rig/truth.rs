//! Ground truth for each pixel of a camera and each beam of a lidar, in streams in addition to the sensor's own.

use super::moments::{Moments, shutter};
use super::mount::Mount;
use super::outlet::{Outcome, Outlet};
use super::sink::Frame;
use super::{Opening, RigContext, RigError};
use crate::world::scene::WorldScene;
use belvedere_bridge::{Encoding, FrameHeader, Kind, StreamSpec};
use belvedere_sensors::trace::Truth;
use belvedere_sensors::{Capture, Pose, Sensor, Shutter, Slice};
use std::time::{Duration, Instant};

/// A truth channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    Depth,
    Range,
    Normal,
    Instance,
    Class,
    Incidence,
    /// Optical flow to the sensor's previous frame.
    FlowBack,
}

impl Channel {
    const ALL: [Self; 7] = [
        Self::Depth,
        Self::Range,
        Self::Normal,
        Self::Instance,
        Self::Class,
        Self::Incidence,
        Self::FlowBack,
    ];

    /// Returns the last part of its topic, and its kind and encoding.
    const fn stream(self) -> (&'static str, Kind, Encoding) {
        match self {
            Self::Depth => ("depth", Kind::DepthImage, Encoding::F32C1),
            Self::Range => ("range", Kind::DepthImage, Encoding::F32C1),
            Self::Normal => ("normal", Kind::Image, Encoding::F32C3),
            Self::Instance => ("instance", Kind::Image, Encoding::I32C1),
            Self::Class => ("class", Kind::Image, Encoding::I32C1),
            Self::Incidence => ("incidence", Kind::Image, Encoding::F32C1),
            Self::FlowBack => ("flow_back", Kind::Image, Encoding::F32C2),
        }
    }
}

/// Optical flow to the sensor's next frame.
const FLOW_FORWARD: (&str, Kind, Encoding) = ("flow_forward", Kind::Image, Encoding::F32C2);

/// The streams of a sensor's ground truth; not opened unless ground truth is requested.
pub(super) struct TruthOutlets {
    outlets: Vec<Outlet>,
    /// Optical flow to the next frame, which is known when that frame is rendered.
    forward: Option<Outlet>,
    size: [u32; 2],
    /// The previous frame, while optical flow has subscribers.
    before: Option<Before>,
}

/// The data of a frame that are kept until the next.
struct Before {
    moments: Moments,
    frame: u64,
    stamp_ns: u64,
    world_from_sensor: Pose,
    /// The scene's edition.
    edition: u64,
}

impl TruthOutlets {
    /// Opens `<topic>/truth/…` for a sensor with this number of rays across and down.
    pub(super) fn open(
        topic: &str,
        frame_id: &str,
        size: [u32; 2],
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let made = Self::open_without_flow(topic, frame_id, size, opening)?;
        if !opening.truth {
            return Ok(made);
        }
        let open = |stream| Self::open_stream(topic, frame_id, size, opening, stream);
        let mut outlets = made.outlets;
        outlets.push(open(Channel::FlowBack.stream())?);
        Ok(Self { outlets, forward: Some(open(FLOW_FORWARD)?), ..made })
    }

    /// Like `open`, for a sensor without optical flow.
    pub(super) fn open_without_flow(
        topic: &str,
        frame_id: &str,
        size: [u32; 2],
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let open = |channel: &Channel| Self::open_stream(topic, frame_id, size, opening, channel.stream());
        let channels = if opening.truth { &Channel::ALL[..Channel::FlowBack as usize] } else { &[] };
        let outlets = channels.iter().map(open).collect::<Result<_, _>>()?;
        Ok(Self { outlets, forward: None, size, before: None })
    }

    fn open_stream(
        topic: &str,
        frame_id: &str,
        size: [u32; 2],
        opening: &Opening<'_>,
        (name, kind, encoding): (&str, Kind, Encoding),
    ) -> Result<Outlet, RigError> {
        let bytes = size[0] as usize * size[1] as usize * encoding.elem_size().unwrap_or_default();
        let spec = StreamSpec::new(format!("{topic}/truth/{name}"), kind, encoding, bytes);
        opening.open_rendered(spec.frame_id(frame_id).rate_hz(opening.rate.hz()))
    }

    /// Returns all streams.
    pub(super) fn outlets(&self) -> impl Iterator<Item = &Outlet> {
        self.outlets.iter().chain(&self.forward)
    }

    /// Forgets the previous frame if the scene's instances have changed since.
    pub(super) fn look_at(&mut self, scene: &WorldScene) {
        self.before.take_if(|before| before.edition != scene.edition());
    }

    /// Returns memory for the ground truth of a frame at `world_from_sensor`, for the channels with subscribers.
    pub(super) fn loan(
        &self,
        stamp_ns: u64,
        world_from_sensor: &Pose,
        write: impl Fn(&mut FrameHeader),
    ) -> TruthFrames {
        let loans = self.outlets.iter().zip(Channel::ALL).map(|(outlet, channel)| {
            // There is no optical flow without a previous frame.
            let is_ready = channel != Channel::FlowBack || self.before.is_some();
            let mut frame = outlet.loan(self.bytes(channel.stream().2)).filter(|_| is_ready);
            if let Some(frame) = &mut frame {
                self.write(frame.header_mut(), stamp_ns, world_from_sensor, &write);
            }
            frame
        });
        TruthFrames(loans.collect())
    }

    fn bytes(&self, encoding: Encoding) -> usize {
        self.size[0] as usize * self.size[1] as usize * encoding.elem_size().unwrap_or_default()
    }

    fn write(
        &self,
        header: &mut FrameHeader,
        stamp_ns: u64,
        world_from_sensor: &Pose,
        write: &impl Fn(&mut FrameHeader),
    ) {
        header.set_packed(self.size[0], self.size[1]);
        header.stamp_ns = stamp_ns;
        write(header);
        Mount::write(world_from_sensor, header);
    }

    /// Returns true if optical flow has subscribers, so that a frame's moments are needed for the next frame.
    pub(super) fn wants_flow(&self) -> bool {
        let back = self.outlets.get(Channel::FlowBack as usize);
        back.into_iter().chain(&self.forward).any(Outlet::is_wanted)
    }

    /// Returns the moments of the previous frame, if optical flow back to it is needed; empty if there was none.
    pub(super) fn before(&self) -> Vec<Slice<'_>> {
        self.before.as_ref().map(|before| before.moments.slices()).unwrap_or_default()
    }

    /// Sends the optical flow from the previous frame to this one, which is taken `at` these moments. For that, the
    /// previous frame's ground truth is traced again. It has the previous frame's timestamp. `output` creates the
    /// sensor's output with ground truth only.
    pub(super) fn send_forward<T: Sensor>(
        &mut self,
        context: &mut RigContext<'_>,
        sensor: &T,
        at: &Shutter<'_>,
        write: impl Fn(&mut FrameHeader),
        output: impl for<'a> FnOnce(Truth<'a>) -> T::Output<'a>,
    ) {
        let started = Instant::now();
        let (Some(outlet), Some(before)) = (&self.forward, &self.before) else { return };
        let Some(mut frame) = outlet.loan(self.bytes(FLOW_FORWARD.2)) else { return };
        self.write(frame.header_mut(), before.stamp_ns, &before.world_from_sensor, &write);
        let slices = before.moments.slices();
        let Some(then) = shutter(&slices) else { return };
        let capture = Capture::new(before.frame, then).after(*at);
        let flow = bytemuck::cast_slice_mut(frame.payload_mut());
        let taken = context.take(sensor, &capture, output(Truth::new().flow(flow)));
        let outcome = outlet.send(Some(frame).filter(|_| taken));
        if let Some(outlet) = &mut self.forward {
            outlet.record(outcome, started.elapsed());
        }
    }

    /// Keeps the moments of this frame for the next, if optical flow has subscribers.
    pub(super) fn keep(
        &mut self,
        context: &RigContext<'_>,
        frame: u64,
        world_from_sensor: &Pose,
        at: &Shutter<'_>,
    ) {
        self.before = self.wants_flow().then(|| Before {
            moments: Moments::of_truth(at),
            frame,
            stamp_ns: context.stamp_ns,
            world_from_sensor: *world_from_sensor,
            edition: context.scene.edition(),
        });
    }

    /// Restarts, as if there had been no previous frame.
    pub(super) fn restart(&mut self) {
        self.before = None;
    }

    /// Counts the outcomes of the frames.
    pub(super) fn record(&mut self, outcomes: Vec<Outcome>, busy: Duration) {
        for (outlet, outcome) in self.outlets.iter_mut().zip(outcomes) {
            outlet.record(outcome, busy);
        }
    }
}

/// Frames on loan, in the order of the channels.
pub(super) struct TruthFrames(Vec<Option<Frame>>);

impl TruthFrames {
    /// Returns the memory of the frames that are needed, or `None` if there are none.
    pub(super) fn truth(&mut self) -> Option<Truth<'_>> {
        if self.0.iter().all(Option::is_none) {
            return None;
        }
        let mut truth = Truth::new();
        for (frame, channel) in self.0.iter_mut().zip(Channel::ALL) {
            let Some(frame) = frame else { continue };
            let bytes = frame.payload_mut();
            match channel {
                Channel::Depth => truth.depth = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::Range => truth.range = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::Normal => truth.normal = Some(bytemuck::cast_slice_mut(bytes)),
                // As a signed number, u32::MAX (nothing) is −1.
                Channel::Instance => truth.instance = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::Class => truth.class = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::Incidence => truth.incidence = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::FlowBack => truth.flow_back = Some(bytemuck::cast_slice_mut(bytes)),
            }
        }
        Some(truth)
    }

    /// Returns the instance image, if it has subscribers.
    pub(super) fn instance(&self) -> Option<&[u32]> {
        let frame = self.0.get(Channel::Instance as usize)?.as_ref()?;
        Some(bytemuck::cast_slice(frame.payload()))
    }

    /// Sends the frames, if they were rendered.
    pub(super) fn send(self, outlets: &TruthOutlets, taken: bool) -> Vec<Outcome> {
        let frames = self.0.into_iter().zip(&outlets.outlets);
        frames.map(|(frame, outlet)| outlet.send(frame.filter(|_| taken))).collect()
    }
}
