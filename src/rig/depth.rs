//! A depth camera such as a Kinect: depth, colour and cloud rendered together, and their camera infos.

use super::annotations::Annotations;
use super::behaviour::Behaviour;
use super::channel::{Channel, is_any_wanted};
use super::eye::{Eye, drawn_lens, is_pinhole, report};
use super::moments::{Moments, capture, shutter};
use super::mount::Mount;
use super::outlet::Outlet;
use super::pictures::{Calibration, encoding};
use super::report::Say;
use super::sink::Frame;
use super::truth::TruthOutlets;
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, CameraSensor, DepthCameraPlugin, Lens, Sensor};
use crate::description::text::number;
use belvedere_bridge::payload::CameraInfo;
use belvedere_bridge::point::XyzRgbPoint;
use belvedere_bridge::{Encoding, Intrinsics, Kind, StreamSpec};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, OutOfRange, POINT_STEP, TooNear};
use belvedere_sensors::device::depth_model::{DepthModel, DepthNoise};
use belvedere_sensors::trace::Faces;
use belvedere_sensors::{ParameterError, Shutter};
use std::time::Instant;

// The sensors write the points of this encoding by themselves, without the bridge.
const _: () = assert!(POINT_STEP == XyzRgbPoint::SIZE);

impl Behaviour for model::DepthCamera {
    fn name(&self) -> &'static str {
        "depth camera"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(DepthChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz).noise_of(&self.camera.noise, 1.0).with_exposure()
    }

    fn report(&self, gazebo_compat: bool, say: Say<'_>) {
        let pictures = self.plugin.as_ref().map(|plugin| &plugin.camera);
        report::camera(&self.camera, pictures, gazebo_compat, say);
        let Some(depth) = &self.plugin else { return };
        let coding = if depth.depth_16uc1 { "16UC1 in millimetres" } else { "32FC1 in metres" };
        let range = self.range_m();
        let [from, to] = range.map(number);
        say("depth", format!("{coding}, valid from {from} to {to} m"));
        let Some(preset) = self.preset else { return say("depth noise", "none".into()) };
        let lens = drawn_lens(&self.camera, &depth.camera, gazebo_compat);
        let model = device_model(self, focal_px(&self.camera, &lens));
        say("depth noise", depth_noise(&model.noise, range));
        say("device", format!("{}: {}", preset.name, preset.source));
        if !self.has_projector_on {
            say("", "its projector is off".into());
        }
    }
}

/// Describes the noise of depths at both ends of their range.
fn depth_noise(noise: &DepthNoise, range_m: [f64; 2]) -> String {
    let stddev_m = |depth_m: f64| match noise {
        DepthNoise::Gaussian(noise) => Some(f64::from(noise.stddev())),
        DepthNoise::Axial(noise) => Some(noise.stddev_m(depth_m, 0.0)),
        DepthNoise::Disparity(noise) => Some(noise.stddev_m(depth_m)),
        _ => None,
    };
    let parts = range_m.map(|depth_m| {
        let stddev_m = stddev_m(depth_m)?;
        Some(format!("{:.2} mm at {} m", stddev_m * 1000.0, number(depth_m)))
    });
    let [Some(near), Some(far)] = parts else { return "as the device's".into() };
    format!("stddev {near}, {far}, of surfaces that face it")
}

/// Widest angle for which a focal length is computed. Wider images have no single focal length; their disparities are
/// computed as for this angle.
const WIDEST_RAD: f64 = 2.0;

/// A running depth camera.
pub(super) struct DepthChannel {
    eye: Eye,
    limits: Limits,
    mount: Mount,
    in_millimetres: bool,
    colour: Outlet,
    colour_info: Outlet,
    depth: Outlet,
    depth_info: Outlet,
    points: Outlet,
    info_message: CameraInfo,
    colour_intrinsics: Intrinsics,
    depth_intrinsics: Intrinsics,
    truth: TruthOutlets,
    annotations: Annotations,
    moments: Moments,
    /// An image that is only used for exposure metering.
    unseen: Vec<u8>,
}

impl DepthChannel {
    pub(super) fn open(
        sensor: &Sensor,
        described: &model::DepthCamera,
        plugin: &DepthCameraPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let camera = &described.camera;
        let refused = |error: &dyn std::error::Error| RigError::sensor(sensor, error);
        let lens = drawn_lens(camera, &plugin.camera, opening.gazebo_compat);
        let eye = Eye::new(camera, &lens, opening).map_err(|error| refused(&*error))?;
        let limits = Limits {
            range_m: described.range_m(),
            model: device_model(described, focal_px(camera, &lens)),
            out_of_range: if opening.gazebo_compat { OutOfRange::Nan } else { OutOfRange::Infinite },
            too_near: if opening.gazebo_compat { TooNear::SeenThrough } else { TooNear::Blocks },
        };
        let made = depth_camera(&eye, &limits).map_err(|error| refused(&error))?;
        let (pixels, colour_len) = (made.pixels(), made.camera().frame_len());
        let calibration = Calibration::of(camera, &plugin.camera, opening.gazebo_compat);
        let frame = opening.frame_id(sensor, &plugin.camera.frame_name);
        let rate = opening.rate.hz();
        let open = |spec: StreamSpec| opening.open_rendered(spec.frame_id(&frame).rate_hz(rate));
        let (depth_encoding, depth_bytes) =
            if plugin.depth_16uc1 { (Encoding::U16C1, 2) } else { (Encoding::F32C1, 4) };
        let names = &plugin.camera;
        let [near, far] = described.range_m();
        let size = [camera.width, camera.height];
        Ok(Self {
            colour: open(StreamSpec::new(
                &names.image_topic,
                Kind::Image,
                encoding(camera.format),
                colour_len,
            ))?,
            colour_info: opening.open_info(&names.camera_info_topic, &names.image_topic, &frame)?,
            depth: open(StreamSpec::new(
                &plugin.depth_image_topic,
                Kind::DepthImage,
                depth_encoding,
                pixels * depth_bytes,
            ))?,
            depth_info: opening.open_info(
                &plugin.depth_camera_info_topic,
                &plugin.depth_image_topic,
                &frame,
            )?,
            points: open(StreamSpec::new(
                &plugin.point_cloud_topic,
                Kind::PointCloud,
                Encoding::XyzRgbF32,
                pixels * POINT_STEP,
            ))?,
            in_millimetres: plugin.depth_16uc1,
            info_message: calibration
                .camera_info(camera.width, camera.height)
                .map_err(|error| refused(&error))?,
            colour_intrinsics: calibration.intrinsics(camera.near_m, camera.far_m),
            depth_intrinsics: calibration.intrinsics(near, far),
            truth: TruthOutlets::open(&names.image_topic, &frame, size, opening)?,
            annotations: Annotations::open(&names.image_topic, &frame, size, opening)?,
            mount: Mount::of_picture(sensor, opening, &frame),
            moments: Moments::default(),
            unseen: Vec::new(),
            eye,
            limits,
        })
    }
}

impl Channel for DepthChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        let own = [&self.colour, &self.colour_info, &self.depth, &self.depth_info, &self.points];
        own.into_iter().chain(self.truth.outlets()).chain(self.annotations.outlets()).collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        let started = Instant::now();
        let world_from_sensor = self.mount.pose(context);
        let Ok(camera) = depth_camera(&self.eye, &self.limits) else { return };
        let pixels = camera.pixels();
        let mut colour = self.colour.loan(camera.camera().frame_len());
        let mut depth = self.depth.loan(pixels * if self.in_millimetres { 2 } else { 4 });
        let mut points = self.points.loan(pixels * POINT_STEP);
        let parts = [
            (&mut colour, &self.colour_intrinsics),
            (&mut depth, &self.depth_intrinsics),
            (&mut points, &self.depth_intrinsics),
        ];
        for (frame, intrinsics) in parts {
            let Some(frame) = frame else { continue };
            let header = frame.header_mut();
            header.set_packed(self.info_message.width, self.info_message.height);
            header.stamp_ns = context.stamp_ns;
            header.set_intrinsics(intrinsics);
            Mount::write(&world_from_sensor, header);
        }
        self.truth.look_at(context.scene);
        let mut truth = self.truth.loan(context.stamp_ns, &world_from_sensor, |header| {
            header.set_intrinsics(&self.colour_intrinsics);
        });
        let is_annotated = self.annotations.is_wanted();
        let mut known = truth.truth();
        self.annotations.ask(&mut known);
        let is_wanted = colour.is_some() || depth.is_some() || points.is_some() || known.is_some();
        let is_metered = self.eye.is_automatic();
        let is_timed = is_wanted || is_metered || is_annotated || self.truth.wants_flow();
        let device = self.eye.shutter().filter(|_| is_timed);
        self.moments.fill(device, camera.camera().size()[1], context, &self.mount);
        let slices = self.moments.slices();
        let at = shutter(&slices).unwrap_or(Shutter::Global(context.scene.moment(world_from_sensor)));
        let (mut taken, mut seen) = (false, None);
        if is_wanted || is_metered {
            let mut output = DepthFrame::new();
            output.truth = known;
            output.colour = colour.as_mut().map(Frame::payload_mut);
            output.points = points.as_mut().map(Frame::payload_mut);
            if is_metered && output.colour.is_none() {
                self.unseen.resize(camera.camera().frame_len(), 0);
                output.colour = Some(&mut self.unseen);
            }
            let depths = depth.as_mut().map(Frame::payload_mut);
            if self.in_millimetres {
                output.depth_16uc1 = depths.map(bytemuck::cast_slice_mut);
            } else {
                output.depth_32fc1 = depths.map(bytemuck::cast_slice_mut);
            }
            let before = self.truth.before();
            taken = context.take(&camera, &capture(frame_number, at, &before), output);
            if taken {
                let picture = colour.as_ref().map_or(&self.unseen[..], Frame::payload);
                seen = self.eye.meter(picture);
            } else {
                (colour, depth, points) = (None, None, None);
            }
        }
        let known = (taken, truth.instance());
        self.annotations.send(context, camera.camera(), &at, &world_from_sensor, known);
        let truths = truth.send(&self.truth, taken);
        let outcomes = [self.colour.send(colour), self.depth.send(depth), self.points.send(points)];
        let busy = started.elapsed();
        for (outlet, outcome) in
            [&mut self.colour, &mut self.depth, &mut self.points].into_iter().zip(outcomes)
        {
            outlet.record(outcome, busy);
        }
        self.truth.record(truths, busy);
        self.truth.send_forward(
            context,
            &camera,
            &at,
            |header| header.set_intrinsics(&self.colour_intrinsics),
            |truth| DepthFrame::new().truth(truth),
        );
        self.truth.keep(context, frame_number, &world_from_sensor, &at);
        self.eye.expose_next(seen);
        self.colour_info.send_structs(context.stamp_ns, &[self.info_message]);
        self.depth_info.send_structs(context.stamp_ns, &[self.info_message]);
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

/// The range of depths, the model of the device, and the values for depths out of range.
struct Limits {
    range_m: [f64; 2],
    model: DepthModel,
    out_of_range: OutOfRange,
    too_near: TooNear,
}

/// Returns the model of a depth camera's device, with a lens of this focal length in pixels.
fn device_model(described: &model::DepthCamera, focal_px: f64) -> DepthModel {
    described.preset.map_or(DepthModel::new(), |preset| {
        let model = preset.model(focal_px);
        model.without_projector().filter(|_| !described.has_projector_on).unwrap_or(model)
    })
}

/// Returns the focal length of an image in pixels. For lenses other than pinholes it is computed from the angle of
/// view.
fn focal_px(camera: &CameraSensor, lens: &Lens) -> f64 {
    if is_pinhole(lens) {
        lens.intrinsics.fx
    } else {
        0.5 * f64::from(camera.width) / libm::tan(0.5 * camera.horizontal_fov_rad.min(WIDEST_RAD))
    }
}

/// Returns the depth camera. SDF's `<noise>` applies to the colour image; Gazebo classic has none for depth. Back faces
/// are invisible, as in Gazebo.
fn depth_camera<'a>(eye: &'a Eye, limits: &Limits) -> Result<DepthCamera<'a>, ParameterError> {
    let [min_m, max_m] = limits.range_m;
    let config = DepthCameraConfig::new(eye.config()).min_depth_m(min_m).max_depth_m(max_m);
    let config = config.model(limits.model).faces(Faces::Front);
    DepthCamera::new(config.out_of_range(limits.out_of_range).too_near(limits.too_near))
}
