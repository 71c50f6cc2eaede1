//! A colour camera with its two streams.

use super::annotations::Annotations;
use super::behaviour::Behaviour;
use super::channel::{Channel, is_any_wanted};
use super::eye::{Eye, drawn_lens, report};
use super::moments::{Moments, capture, shutter};
use super::mount::Mount;
use super::outlet::Outlet;
use super::pictures::{Calibration, encoding};
use super::report::Say;
use super::sink::Frame;
use super::truth::TruthOutlets;
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, CameraPlugin, CameraSensor, Sensor};
use belvedere_bridge::payload::CameraInfo;
use belvedere_bridge::{Intrinsics, Kind, StreamSpec};
use belvedere_sensors::Shutter;
use belvedere_sensors::camera::Picture;
use std::time::Instant;

impl Behaviour for model::Camera {
    fn name(&self) -> &'static str {
        "camera"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(CameraChannel::open(sensor, &self.camera, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz).noise_of(&self.camera.noise, 1.0).with_exposure()
    }

    fn report(&self, gazebo_compat: bool, say: Say<'_>) {
        report::camera(&self.camera, self.plugin.as_ref(), gazebo_compat, say);
    }
}

/// A running camera.
pub(super) struct CameraChannel {
    eye: Eye,
    mount: Mount,
    image: Outlet,
    info: Outlet,
    info_message: CameraInfo,
    intrinsics: Intrinsics,
    truth: TruthOutlets,
    annotations: Annotations,
    moments: Moments,
    /// An image that is only used for exposure metering.
    unseen: Vec<u8>,
}

impl CameraChannel {
    pub(super) fn open(
        sensor: &Sensor,
        camera: &CameraSensor,
        plugin: &CameraPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let refused = |error: &dyn std::error::Error| RigError::sensor(sensor, error);
        let lens = drawn_lens(camera, plugin, opening.gazebo_compat);
        let eye = Eye::new(camera, &lens, opening).map_err(|error| refused(&*error))?;
        let frame_len = eye.camera().frame_len();
        let calibration = Calibration::of(camera, plugin, opening.gazebo_compat);
        let frame = opening.frame_id(sensor, &plugin.frame_name);
        let rate = opening.rate.hz();
        let image = StreamSpec::new(&plugin.image_topic, Kind::Image, encoding(camera.format), frame_len)
            .frame_id(&frame)
            .rate_hz(rate);
        let size = [camera.width, camera.height];
        Ok(Self {
            image: opening.open_rendered(image)?,
            info: opening.open_info(&plugin.camera_info_topic, &plugin.image_topic, &frame)?,
            info_message: calibration
                .camera_info(camera.width, camera.height)
                .map_err(|error| refused(&error))?,
            intrinsics: calibration.intrinsics(camera.near_m, camera.far_m),
            truth: TruthOutlets::open(&plugin.image_topic, &frame, size, opening)?,
            annotations: Annotations::open(&plugin.image_topic, &frame, size, opening)?,
            mount: Mount::of_picture(sensor, opening, &frame),
            moments: Moments::default(),
            unseen: Vec::new(),
            eye,
        })
    }
}

impl Channel for CameraChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        let own = [&self.image, &self.info].into_iter();
        own.chain(self.truth.outlets()).chain(self.annotations.outlets()).collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        let started = Instant::now();
        let world_from_sensor = self.mount.pose(context);
        let camera = self.eye.camera();
        let mut frame = self.image.loan(camera.frame_len());
        self.truth.look_at(context.scene);
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
        picture.colour = frame.as_mut().map(Frame::payload_mut);
        let is_annotated = self.annotations.is_wanted();
        picture.truth = truth.truth();
        self.annotations.ask(&mut picture.truth);
        if self.eye.is_automatic() && picture.colour.is_none() {
            self.unseen.resize(camera.frame_len(), 0);
            picture.colour = Some(&mut self.unseen);
        }
        let is_wanted = picture.colour.is_some() || picture.truth.is_some();
        let device = self.eye.shutter().filter(|_| is_wanted || is_annotated || self.truth.wants_flow());
        self.moments.fill(device, camera.size()[1], context, &self.mount);
        let slices = self.moments.slices();
        let at = shutter(&slices).unwrap_or(Shutter::Global(context.scene.moment(world_from_sensor)));
        let before = self.truth.before();
        let taken = is_wanted && context.take(&camera, &capture(frame_number, at, &before), picture);
        let picture = frame.as_ref().map_or(&self.unseen[..], Frame::payload);
        let seen = if taken { self.eye.meter(picture) } else { None };
        let outcome = self.image.send(frame.filter(|_| taken));
        let known = (taken, truth.instance());
        self.annotations.send(context, &camera, &at, &world_from_sensor, known);
        let truths = truth.send(&self.truth, taken);
        self.image.record(outcome, started.elapsed());
        self.truth.record(truths, started.elapsed());
        self.truth.send_forward(
            context,
            &camera,
            &at,
            |header| header.set_intrinsics(&self.intrinsics),
            |truth| Picture::new().truth(truth),
        );
        self.truth.keep(context, frame_number, &world_from_sensor, &at);
        self.eye.expose_next(seen);
        self.info.send_structs(context.stamp_ns, &[self.info_message]);
    }

    fn is_rendered(&self) -> bool {
        self.eye.is_automatic() || is_any_wanted(self.outlets())
    }

    fn window_ns(&self) -> u64 {
        self.eye.window_ns()
    }

    fn restart(&mut self) {
        self.eye.restart();
        self.truth.restart();
    }

    fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        self.eye.configure(settings)
    }
}
