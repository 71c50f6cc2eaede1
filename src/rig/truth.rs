//! What is true of each pixel of a camera and of each beam of a lidar, in streams beside the sensor's own.

use super::mount::Mount;
use super::outlet::{Outcome, Outlet};
use super::{RigError, Setting};
use belvedere_bridge::{Encoding, FrameHeader, Kind, LoanedFrame, StreamSpec};
use belvedere_sensors::Pose;
use belvedere_sensors::trace::Truth;
use std::time::Duration;

/// A channel of truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    Depth,
    Range,
    Normal,
    Instance,
    Class,
    Incidence,
    /// To the sensor's frame before.
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

    /// The last part of its topic, and what it is on the wire.
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

/// The streams of a sensor's truth; none unless truth is asked for.
pub(super) struct TruthOutlets {
    outlets: Vec<Outlet>,
    size: [u32; 2],
    /// Where the sensor and all instances were in the frame before, while somebody follows the flow.
    before: Option<(Pose, Vec<Pose>)>,
}

impl TruthOutlets {
    /// Opens `<topic>/truth/…` for a sensor of so many rays across and down.
    pub(super) fn open(
        topic: &str,
        frame_id: &str,
        size: [u32; 2],
        setting: &Setting<'_>,
    ) -> Result<Self, RigError> {
        let channels = if setting.truth { &Channel::ALL[..] } else { &[] };
        let open = |channel: &Channel| {
            let (name, kind, encoding) = channel.stream();
            let element = encoding.elem_size().unwrap_or_default();
            let bytes = size[0] as usize * size[1] as usize * element;
            let spec = StreamSpec::new(format!("{topic}/truth/{name}"), kind, encoding, bytes);
            setting.open_rendered(spec.frame_id(frame_id).rate_hz(setting.rate.hz()))
        };
        Ok(Self { outlets: channels.iter().map(open).collect::<Result<_, _>>()?, size, before: None })
    }

    /// All of them.
    pub(super) fn outlets(&self) -> impl Iterator<Item = &Outlet> {
        self.outlets.iter()
    }

    /// Where the truth of a frame at `world_from_sensor` goes, as far as somebody follows it.
    pub(super) fn loan(
        &self,
        stamp_ns: u64,
        world_from_sensor: &Pose,
        write: impl Fn(&mut FrameHeader),
    ) -> TruthFrames {
        let [width, height] = self.size;
        let loans = self.outlets.iter().zip(Channel::ALL).map(|(outlet, channel)| {
            let element = channel.stream().2.elem_size().unwrap_or_default();
            // There is no flow without a frame before.
            let is_ready = channel != Channel::FlowBack || self.before.is_some();
            let mut frame = outlet.loan(width as usize * height as usize * element).filter(|_| is_ready);
            if let Some(frame) = &mut frame {
                let header = frame.header_mut();
                header.set_packed(width, height);
                header.stamp_ns = stamp_ns;
                write(header);
                Mount::write(world_from_sensor, header);
            }
            frame
        });
        TruthFrames(loans.collect())
    }

    /// Poses of the frame before, if its flow is wanted.
    pub(super) fn before(&self) -> Option<&(Pose, Vec<Pose>)> {
        self.before.as_ref()
    }

    /// Keeps the poses of this frame for the next, if its flow is wanted then.
    pub(super) fn keep(&mut self, world_from_sensor: &Pose, world_from_instance: &[Pose]) {
        let is_wanted = self.outlets.get(Channel::FlowBack as usize).is_some_and(Outlet::is_wanted);
        self.before = is_wanted.then(|| (*world_from_sensor, world_from_instance.to_vec()));
    }

    /// Counts what became of the frames.
    pub(super) fn record(&mut self, outcomes: Vec<Outcome>, busy: Duration) {
        for (outlet, outcome) in self.outlets.iter_mut().zip(outcomes) {
            outlet.record(outcome, busy);
        }
    }
}

/// Frames on loan, in the order of the channels.
pub(super) struct TruthFrames(Vec<Option<LoanedFrame>>);

impl TruthFrames {
    /// The memory of the frames that are wanted; none if none is.
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
                // As signed numbers nothing, u32::MAX, is −1.
                Channel::Instance => truth.instance = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::Class => truth.class = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::Incidence => truth.incidence = Some(bytemuck::cast_slice_mut(bytes)),
                Channel::FlowBack => truth.flow_back = Some(bytemuck::cast_slice_mut(bytes)),
            }
        }
        Some(truth)
    }

    /// Sends them, if they were taken.
    pub(super) fn send(self, outlets: &TruthOutlets, taken: bool) -> Vec<Outcome> {
        let frames = self.0.into_iter().zip(&outlets.outlets);
        frames.map(|(frame, outlet)| outlet.send(frame.filter(|_| taken))).collect()
    }
}
