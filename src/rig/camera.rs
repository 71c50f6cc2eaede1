//! A colour camera and its two streams.

use super::eye::{Eye, drawn_lens};
use super::mount::Mount;
use super::outlet::Outlet;
use super::pictures::{Told, encoding};
use super::truth::TruthOutlets;
use super::{RigContext, RigError, Setting, Settings};
use crate::description::model::{CameraPlugin, CameraSensor, Sensor};
use belvedere_bridge::payload::CameraInfo;
use belvedere_bridge::{Intrinsics, Kind, LoanedFrame, StreamSpec};
use belvedere_sensors::camera::Picture;
use std::time::Instant;

/// A running camera.
pub(super) struct CameraChannel {
    eye: Eye,
    mount: Mount,
    image: Outlet,
    info: Outlet,
    info_message: CameraInfo,
    intrinsics: Intrinsics,
    truth: TruthOutlets,
}

impl CameraChannel {
    pub(super) fn open(
        sensor: &Sensor,
        camera: &CameraSensor,
        plugin: &CameraPlugin,
        setting: &Setting<'_>,
    ) -> Result<Self, RigError> {
        let refused = |error: &dyn std::error::Error| RigError::sensor(sensor, error);
        let lens = drawn_lens(camera, plugin, setting.gazebo_compat);
        let eye = Eye::new(camera, &lens, setting).map_err(|error| refused(&*error))?;
        let frame_len = eye.camera().frame_len();
        let told = Told::of(camera, plugin, setting.gazebo_compat);
        let frame = setting.frame_id(sensor, &plugin.frame_name);
        let rate = setting.rate.hz();
        let image = StreamSpec::new(&plugin.image_topic, Kind::Image, encoding(camera.format), frame_len)
            .frame_id(&frame)
            .rate_hz(rate);
        let info = StreamSpec::structs(&plugin.camera_info_topic, Kind::CameraInfo, 1)
            .frame_id(&frame)
            .rate_hz(rate);
        Ok(Self {
            image: setting.open_rendered(image)?,
            info: setting.open(&info)?,
            info_message: told.camera_info(camera.width, camera.height).map_err(|error| refused(&error))?,
            intrinsics: told.intrinsics(camera.near_m, camera.far_m),
            truth: TruthOutlets::open(&plugin.image_topic, &frame, [camera.width, camera.height], setting)?,
            mount: Mount::new(sensor, setting, &frame),
            eye,
        })
    }

    pub(super) fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        let started = Instant::now();
        let world_from_sensor = self.mount.pose(context);
        let camera = self.eye.camera();
        let mut frame = self.image.loan(camera.frame_len());
        let mut truth = self.truth.loan(context.stamp_ns, &world_from_sensor, |header| {
            header.set_intrinsics(&self.intrinsics);
        });
        if let Some(frame) = &mut frame {
            let header = frame.header_mut();
            header.set_packed(self.info_message.width, self.info_message.height);
            header.stamp_ns = context.stamp_ns;
            header.set_intrinsics(&self.intrinsics);
            Mount::write(&world_from_sensor, header);
        }
        let mut picture = Picture::new();
        picture.colour = frame.as_mut().map(LoanedFrame::payload_mut);
        picture.truth = truth.truth();
        let is_wanted = picture.colour.is_some() || picture.truth.is_some();
        let before = self.truth.before();
        let taken = is_wanted && context.take(&camera, &world_from_sensor, frame_number, before, picture);
        let outcome = self.image.send(frame.filter(|_| taken));
        let truths = truth.send(&self.truth, taken);
        self.image.record(outcome, started.elapsed());
        self.truth.record(truths, started.elapsed());
        self.truth.keep(&world_from_sensor, context.scene.poses());
        self.info.send_structs(context.stamp_ns, &[self.info_message]);
    }

    /// Takes other settings from its next frame on.
    pub(super) fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        self.eye.configure(settings)
    }

    pub(super) fn outlets(&self) -> impl Iterator<Item = &Outlet> {
        [&self.image, &self.info].into_iter().chain(self.truth.outlets())
    }
}
