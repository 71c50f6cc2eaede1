//! A lidar with its stream.

mod points;
pub(super) mod report;

use super::behaviour::Behaviour;
use super::channel::{Channel, is_any_wanted};
use super::moments::capture;
use super::mount::Mount;
use super::outlet::Outlet;
use super::pictures::noise;
use super::report::Say;
use super::scanner::ScannerChannel;
use super::sight::sight;
use super::truth::TruthOutlets;
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, LaserPlugin, RaySensor, ScanAxis, Sensor};
use belvedere_bridge::{Encoding, FrameHeader, Kind, ScanGeometry, StreamSpec};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan, TooNear};
use belvedere_sensors::{ParameterError, Shutter};
use points::{Cloud, Points};
use std::time::Instant;

impl Behaviour for model::Lidar {
    fn name(&self) -> &'static str {
        "lidar"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(if self.is_scanner() {
            Box::new(ScannerChannel::open(sensor, self, plugin, opening)?)
        } else {
            Box::new(LidarChannel::open(sensor, &self.ray, plugin, opening)?)
        }))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz).noise_of_ranges(&self.ray)
    }

    fn report(&self, gazebo_compat: bool, say: Say<'_>) {
        report::lidar(self, gazebo_compat, say);
    }
}

/// A running lidar.
pub(super) struct LidarChannel {
    lidar: Lidar,
    mount: Mount,
    scan: Outlet,
    points: Option<Points>,
    geometry: ScanGeometry,
    size: [u32; 2],
    truth: TruthOutlets,
}

impl LidarChannel {
    pub(super) fn open(
        sensor: &Sensor,
        ray: &RaySensor,
        plugin: &LaserPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let refused = |error: &dyn std::error::Error| RigError::sensor(sensor, error);
        let config = lidar_config(ray, opening).map_err(|error| refused(&error))?;
        let LidarConfig { horizontal, vertical, .. } = config;
        let lidar = Lidar::new(config).map_err(|error| refused(&error))?;
        let frame = opening.frame_id(sensor, &plugin.frame_name);
        let rate = opening.rate.hz();
        // Ranges, followed by a plane of intensities.
        let bytes = lidar.beams() * size_of::<f32>() * 2;
        let spec = StreamSpec::new(&plugin.topic, Kind::LaserScan, Encoding::RangesF32, bytes)
            .frame_id(&frame)
            .layers(vertical.samples)
            .rate_hz(rate);
        // As deep as for messages: scans are small, come at up to 40 Hz, and mapping needs each of them.
        let spec = StreamSpec { buffer: 16, ..spec };
        let size = [horizontal.samples, vertical.samples];
        let points = plugin.points_topic.as_ref();
        Ok(Self {
            scan: opening.open_rendered(spec)?,
            points: points.map(|topic| Points::open(topic, &frame, size, opening)).transpose()?,
            geometry: ScanGeometry {
                angle_min: horizontal.min_angle_rad,
                angle_increment: horizontal.increment(),
                // All beams are measured at the timestamp. Gazebo's plugin reports 0 for the time of a scan as well.
                time_increment: 0.0,
                scan_time: if opening.gazebo_compat { 0.0 } else { 1.0 / rate },
                range_min: ray.range_min_m as f32,
                range_max: ray.range_max_m as f32,
                vertical_angle_min: vertical.min_angle_rad,
                vertical_angle_increment: vertical.increment(),
                reserved: [0; 19],
            },
            size,
            truth: TruthOutlets::open(&plugin.topic, &frame, size, opening)?,
            mount: Mount::new(sensor, opening),
            lidar,
        })
    }
}

impl Channel for LidarChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        let points = self.points.as_ref().map(Points::outlet);
        [&self.scan].into_iter().chain(points).chain(self.truth.outlets()).collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        let started = Instant::now();
        let world_from_sensor = self.mount.pose(context);
        let beams = self.lidar.beams();
        let mut frame = self.scan.loan(beams * size_of::<f32>() * 2);
        let points = self.points.as_mut();
        let mut cloud = points.and_then(|points| points.loan(context.stamp_ns, &world_from_sensor));
        self.truth.look_at(context.scene);
        let mut truth = self.truth.loan(context.stamp_ns, &world_from_sensor, |_| {});
        let mut output = Scan::new();
        output.truth = truth.truth();
        if let Some(frame) = &mut frame {
            let header = frame.header_mut();
            header.set_packed(self.size[0], self.size[1]);
            header.flags |= FrameHeader::HAS_INTENSITIES;
            header.stamp_ns = context.stamp_ns;
            header.set_scan_geometry(&self.geometry);
            Mount::write(&world_from_sensor, header);
            let planes: &mut [f32] = bytemuck::cast_slice_mut(frame.payload_mut());
            let (ranges, intensities) = planes.split_at_mut(beams);
            output = output.ranges(ranges).intensities(intensities);
        }
        if let Some(Cloud { points, intensities, .. }) = &mut cloud {
            output = output.points(points);
            output.intensities.get_or_insert(intensities);
        }
        let is_wanted = output.ranges.is_some() || output.points.is_some() || output.truth.is_some();
        let at = Shutter::Global(context.scene.moment(world_from_sensor));
        let before = self.truth.before();
        let taken = is_wanted && context.take(&self.lidar, &capture(frame_number, at, &before), output);
        let cloud = cloud.filter(|_| taken).map(|cloud| {
            let planes = frame.as_ref().map(|frame| bytemuck::cast_slice(frame.payload()));
            cloud.into_frame(planes.map(|planes| &planes[beams..]))
        });
        let outcome = self.scan.send(frame.filter(|_| taken));
        let truths = truth.send(&self.truth, taken);
        self.scan.record(outcome, started.elapsed());
        if let Some(points) = &mut self.points {
            points.send(cloud, started.elapsed());
        }
        self.truth.record(truths, started.elapsed());
        self.truth.send_forward(context, &self.lidar, &at, |_| {}, |truth| Scan::new().truth(truth));
        self.truth.keep(context, frame_number, &world_from_sensor, &at);
    }

    fn is_rendered(&self) -> bool {
        is_any_wanted(self.outlets())
    }

    fn restart(&mut self) {
        self.truth.restart();
    }

    fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        let config = self.lidar.config();
        self.lidar = Lidar::new(config.noise(settings.noise(&config.noise)?))?;
        // Gazebo's plugin reports 0 at any rate.
        if self.geometry.scan_time != 0.0 {
            self.geometry.scan_time = 1.0 / settings.update_rate_hz();
        }
        Ok(())
    }
}

/// Returns the configuration of a described lidar.
pub(super) fn lidar_config(ray: &RaySensor, opening: &Opening<'_>) -> Result<LidarConfig, ParameterError> {
    let (sees, faces) = sight(ray);
    Ok(LidarConfig::new(beams(&ray.horizontal))
        .vertical(beams(&ray.vertical))
        .range_min_m(ray.range_min_m)
        .range_max_m(ray.range_max_m)
        .too_near(if opening.gazebo_compat { TooNear::SeenThrough } else { TooNear::Blocks })
        .visibility(sees)
        .faces(faces)
        .noise(noise(&ray.noise)?)
        .seed(opening.seed)
        .sensor(opening.sensor))
}

/// Returns the beams of an axis.
pub(super) fn beams(axis: &ScanAxis) -> Beams {
    Beams { samples: axis.samples, min_angle_rad: axis.min_angle_rad, max_angle_rad: axis.max_angle_rad }
}
