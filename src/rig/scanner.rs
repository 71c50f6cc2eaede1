//! A lidar whose beams each have a time of their own. Its cloud is as a driver of ROS sends it, stamped with the end of the
//! scan; the scan of a single beam is stamped with its first ray, as `sensor_msgs/LaserScan` has it.

use super::channel::{Channel, is_any_wanted};
use super::lidar::{beams, sight};
use super::motion::Motion;
use super::mount::Mount;
use super::outlet::Outlet;
use super::packets::{Column, PacketTarget, Packets};
use super::pictures::noise;
use super::sink::Frame;
use super::truth::TruthOutlets;
use super::{Opening, Rate, RigContext, RigError, Settings};
use crate::description::model::{self, CloudLayout, LaserPlugin, RaySensor, Sensor};
use belvedere_bridge::{Encoding, FrameHeader, Kind, ScanGeometry, StreamSpec};
use belvedere_sensors::lidar::Beams;
use belvedere_sensors::scanner::presets::Preset;
use belvedere_sensors::scanner::{Columns, Echoes, Firing, Pattern, Scanner, ScannerConfig};
use belvedere_sensors::{Capture, Pose, Shutter};
use glam::DVec3;
use std::f64::consts::TAU;
use std::io;
use std::time::Instant;

/// Bytes of a point: x, y, z, intensity, ring, time.
const POINT_STEP: usize = 22;

/// A running scanner.
pub(super) struct ScannerChannel {
    /// All but its pattern.
    config: ScannerConfig<'static>,
    head: Head,
    /// The rank of each laser, from the lowest up.
    rings: Vec<u16>,
    form: Form,
    /// Gazebo's take all beams at one moment.
    is_still: bool,
    mount: Mount,
    outlet: Outlet,
    truth: TruthOutlets,
    motion: Motion,
    found: Found,
    /// Of a preset whose packets are known.
    packets: Option<Packets>,
}

/// What it sends.
enum Form {
    /// Points.
    Cloud(CloudLayout),
    /// Ranges, all but the times of its angles.
    Scan(Box<ScanGeometry>),
}

/// Which way it fires, and when.
enum Head {
    /// As a maker's scanner does.
    Preset(Preset),
    /// By the angles of a `<ray>`, horizontal and vertical.
    Grid { angles: [Beams; 2], firings: Vec<Firing> },
}

impl Head {
    fn of(lidar: &model::Lidar, frame_time_ns: u64) -> Self {
        match lidar.preset {
            Some(preset) => Self::Preset(preset),
            None => Self::grid([beams(&lidar.ray.horizontal), beams(&lidar.ray.vertical)], frame_time_ns),
        }
    }

    fn grid(angles: [Beams; 2], frame_time_ns: u64) -> Self {
        Self::Grid { angles, firings: firings(&angles, frame_time_ns) }
    }

    fn pattern(&self) -> Pattern<'_> {
        match self {
            Self::Preset(preset) => preset.pattern,
            Self::Grid { firings, .. } => Pattern::Table(firings),
        }
    }

    /// The elevation of each laser.
    fn elevations(&self) -> Vec<f64> {
        match self {
            Self::Preset(Preset { pattern: Pattern::Spinning(head), .. }) => {
                head.lasers.iter().map(|laser| laser.elevation_rad).collect()
            }
            Self::Preset(_) => vec![0.0],
            Self::Grid { angles: [_, vertical], .. } => {
                (0..vertical.samples).map(|row| vertical.angle(row)).collect()
            }
        }
    }
}

/// The firings of a grid of beams on a head that turns once a frame, clockwise as Velodyne's do: columns one after the
/// other, the beams of each at once.
fn firings([horizontal, vertical]: &[Beams; 2], frame_time_ns: u64) -> Vec<Firing> {
    // Both ends of a whole circle have a time of their own.
    let turn = TAU.max(horizontal.max_angle_rad - horizontal.min_angle_rad + horizontal.increment());
    let mut firings = Vec::with_capacity(horizontal.samples as usize * vertical.samples as usize);
    for column in (0..horizontal.samples).rev() {
        let azimuth = horizontal.angle(column);
        let (sin, cos) = libm::sincos(azimuth);
        let begun = (horizontal.max_angle_rad - azimuth).max(0.0) / turn;
        let time_s = frame_time_ns as f64 * 1e-9 * begun;
        for row in 0..vertical.samples {
            let (up, along) = libm::sincos(vertical.angle(row));
            let direction = DVec3::new(along * cos, along * sin, up);
            firings.push(Firing { time_s, origin: DVec3::ZERO, direction, laser: row });
        }
    }
    firings
}

/// What a frame has found, a value a firing.
#[derive(Default)]
struct Found {
    ranges: Vec<f32>,
    points: Vec<[f32; 3]>,
    intensities: Vec<f32>,
    times: Vec<f64>,
    lasers: Vec<u32>,
}

impl Found {
    fn resize(&mut self, firings: usize) {
        self.ranges.resize(firings, 0.0);
        self.points.resize(firings, [0.0; 3]);
        self.intensities.resize(firings, 0.0);
        self.times.resize(firings, 0.0);
        self.lasers.resize(firings, 0);
    }
}

impl ScannerChannel {
    pub(super) fn open(
        sensor: &Sensor,
        lidar: &model::Lidar,
        plugin: &LaserPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let refused = |error: &dyn std::error::Error| RigError::sensor(sensor, error);
        let ray = &lidar.ray;
        let frame_time_ns = opening.rate.stamp_ns(1);
        let (sees, faces) = sight(ray);
        let config = ScannerConfig::new(Pattern::Table(&[]))
            .frame_time_ns(frame_time_ns)
            .range_min_m(ray.range_min_m)
            .range_max_m(ray.range_max_m)
            .visibility(sees)
            .faces(faces)
            .noise(noise(&ray.noise).map_err(|error| refused(&error))?)
            .spreads(lidar.preset.map_or(&[], |preset| preset.spreads))
            .seed(opening.seed)
            .sensor(opening.sensor);
        let head = Head::of(lidar, frame_time_ns);
        let scanner = Scanner::new(config_of(&config, &head)).map_err(|error| refused(&error))?;
        let most = scanner.most_firings();
        let elevations = head.elevations();
        let rank = |elevation: &f64| elevations.iter().filter(|other| *other < elevation).count() as u16;
        let rings = elevations.iter().map(rank).collect();
        let size = [elevations.len() as u32, (most / elevations.len()) as u32];
        let frame = opening.frame_id(sensor, &plugin.frame_name);
        let (form, spec) = if let Some(layout) = plugin.cloud {
            let bytes = most * POINT_STEP;
            let spec = StreamSpec::new(&plugin.topic, Kind::PointCloud, Encoding::XyzIrtF32, bytes);
            (Form::Cloud(layout), spec)
        } else {
            let bytes = most * size_of::<f32>() * 2;
            let spec = StreamSpec::new(&plugin.topic, Kind::LaserScan, Encoding::RangesF32, bytes).layers(1);
            (Form::Scan(Box::new(angles(&head, ray))), StreamSpec { buffer: 16, ..spec })
        };
        Ok(Self {
            outlet: opening.open_rendered(spec.frame_id(&frame).rate_hz(opening.rate.hz()))?,
            truth: TruthOutlets::open_without_flow(&plugin.topic, &frame, size, opening)?,
            mount: Mount::new(sensor, opening),
            is_still: opening.gazebo_compat,
            motion: Motion::default(),
            found: Found::default(),
            packets: lidar.preset.as_ref().and_then(Packets::of),
            rings,
            form,
            config,
            head,
        })
    }

    fn frame_time_s(&self) -> f64 {
        self.config.frame_time_ns as f64 * 1e-9
    }

    /// Puts what was found into a frame.
    fn write(&self, firings: usize, world_from_sensor: &Pose, stamp_ns: u64) -> Option<Frame> {
        let mut frame = match &self.form {
            Form::Cloud(layout) => self.write_cloud(layout, firings, stamp_ns)?,
            Form::Scan(geometry) => self.write_scan(geometry, firings, stamp_ns)?,
        };
        Mount::write(world_from_sensor, frame.header_mut());
        Some(frame)
    }

    fn write_scan(&self, geometry: &ScanGeometry, firings: usize, stamp_ns: u64) -> Option<Frame> {
        let mut frame = self.outlet.loan(firings * size_of::<f32>() * 2)?;
        let header = frame.header_mut();
        header.set_packed(firings as u32, 1);
        header.flags |= FrameHeader::HAS_INTENSITIES;
        header.stamp_ns = stamp_ns;
        let mut geometry = *geometry;
        if !self.is_still {
            let before_s = self.frame_time_s() - self.found.times.first().copied().unwrap_or(0.0);
            header.stamp_ns = stamp_ns.saturating_sub((before_s * 1e9).round() as u64);
            geometry.time_increment = self.frame_time_s() * geometry.angle_increment / TAU;
            geometry.scan_time = self.frame_time_s();
        }
        header.set_scan_geometry(&geometry);
        let planes: &mut [f32] = bytemuck::cast_slice_mut(frame.payload_mut());
        let (ranges, intensities) = planes.split_at_mut(firings);
        ranges.copy_from_slice(&self.found.ranges[..firings]);
        intensities.copy_from_slice(&self.found.intensities[..firings]);
        Some(frame)
    }

    /// What goes into the cloud.
    fn write_cloud(&self, layout: &CloudLayout, firings: usize, stamp_ns: u64) -> Option<Frame> {
        let Found { points, intensities, times, lasers, .. } = &self.found;
        let CloudLayout { is_organized, min_intensity } = *layout;
        let is_point =
            |firing: usize| !points[firing][0].is_nan() && f64::from(intensities[firing]) >= min_intensity;
        let shown =
            if is_organized { firings } else { (0..firings).filter(|&firing| is_point(firing)).count() };
        let mut frame = self.outlet.loan(shown * POINT_STEP)?;
        let lasers_in_all = self.rings.len();
        let header = frame.header_mut();
        if is_organized {
            header.set_packed(lasers_in_all as u32, (firings / lasers_in_all) as u32);
        } else {
            header.set_packed(shown as u32, 1);
        }
        header.stamp_ns = stamp_ns;
        let end_s = (!self.is_still).then(|| self.frame_time_s());
        let mut places = frame.payload_mut().chunks_exact_mut(POINT_STEP);
        for firing in 0..firings {
            let is_point = is_point(firing);
            if !is_point && !is_organized {
                continue;
            }
            let Some(place) = places.next() else { break };
            let point = if is_point { points[firing] } else { [f32::NAN; 3] };
            let time_s = end_s.map_or(0.0, |end_s| times[firing] - end_s);
            let ring = self.rings[lasers[firing] as usize];
            let [x, y, z] = point.map(f32::to_le_bytes);
            place[..4].copy_from_slice(&x);
            place[4..8].copy_from_slice(&y);
            place[8..12].copy_from_slice(&z);
            place[12..16].copy_from_slice(&intensities[firing].to_le_bytes());
            place[16..18].copy_from_slice(&ring.to_le_bytes());
            place[18..].copy_from_slice(&(time_s as f32).to_le_bytes());
        }
        Some(frame)
    }
}

impl ScannerChannel {
    fn sends_packets(&self) -> bool {
        self.packets.as_ref().is_some_and(Packets::is_wanted)
    }

    /// Sends what was found in packets, if somebody wants them; what would have been before time 0 is left out.
    fn send_columns(&mut self, firings: usize, stamp_ns: u64) {
        let Some(packets) = self.packets.as_mut().filter(|packets| packets.is_wanted()) else { return };
        let (period_ns, lasers) = (self.config.frame_time_ns, self.rings.len());
        let Found { ranges, intensities, times, .. } = &self.found;
        for first in (0..firings).step_by(lasers) {
            let after_ns = (times[first] * 1e9).round() as u64;
            let Some(time_ns) = (stamp_ns + after_ns).checked_sub(period_ns) else { continue };
            packets.push(&Column {
                time_ns,
                turned: after_ns as f64 / period_ns as f64,
                ranges: &ranges[first..first + lasers],
                intensities: &intensities[first..first + lasers],
            });
        }
    }
}

/// The angles of a single beam that is measured at even steps; its times are those of the head.
fn angles(head: &Head, ray: &RaySensor) -> ScanGeometry {
    let (mut angle_min, mut angle_increment) = (ray.horizontal.min_angle_rad, 0.0);
    if let Head::Preset(Preset { pattern: Pattern::Spinning(head), .. }) = head
        && let Columns::Turn { per_turn, first, .. } = head.columns
    {
        angle_increment = TAU / f64::from(per_turn);
        angle_min = head.first_azimuth_rad + f64::from(first) * angle_increment;
    }
    ScanGeometry {
        angle_min,
        angle_increment,
        time_increment: 0.0,
        scan_time: 0.0,
        range_min: ray.range_min_m as f32,
        range_max: ray.range_max_m as f32,
        vertical_angle_min: 0.0,
        vertical_angle_increment: 0.0,
        reserved: [0; 19],
    }
}

/// The scanner's, with its pattern.
fn config_of<'a>(config: &ScannerConfig<'a>, head: &'a Head) -> ScannerConfig<'a> {
    config.pattern(head.pattern())
}

impl Channel for ScannerChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        [&self.outlet].into_iter().chain(self.truth.outlets()).collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        let started = Instant::now();
        let world_from_sensor = self.mount.pose(context);
        let Ok(scanner) = Scanner::new(config_of(&self.config, &self.head)) else { return };
        let mut truth = self.truth.loan(context.stamp_ns, &world_from_sensor, |_| {});
        let mut output = Echoes::new();
        output.truth = truth.truth();
        let is_wanted = self.outlet.is_wanted() || self.sends_packets();
        if is_wanted {
            self.found.resize(scanner.most_firings());
            let Found { ranges, points, intensities, times, lasers } = &mut self.found;
            output = output.ranges(ranges).points(points).intensities(intensities);
            output = output.times(times).lasers(lasers);
        }
        let mut taken = false;
        if is_wanted || output.truth.is_some() {
            let keyframes;
            let shutter = if self.is_still {
                Shutter::Global(context.scene.moment(world_from_sensor))
            } else {
                self.motion.fill(context, &self.mount, self.config.frame_time_ns);
                keyframes = self.motion.keyframes();
                Shutter::Moving(&keyframes)
            };
            taken = context.take(&scanner, &Capture::new(frame_number, shutter), output);
        }
        let firings = if taken && is_wanted { scanner.firings(frame_number) } else { 0 };
        let frame = self.write(firings, &world_from_sensor, context.stamp_ns);
        self.send_columns(firings, context.stamp_ns);
        let outcome = self.outlet.send(frame.filter(|_| taken));
        let truths = truth.send(&self.truth, taken);
        self.outlet.record(outcome, started.elapsed());
        self.truth.record(truths, started.elapsed());
    }

    fn is_rendered(&self) -> bool {
        self.sends_packets() || is_any_wanted(self.outlets())
    }

    fn restart(&mut self) {
        if let Some(packets) = &mut self.packets {
            packets.restart();
        }
    }

    fn send_packets(&mut self, target: &PacketTarget) -> io::Result<()> {
        match &mut self.packets {
            Some(packets) => packets.open(target),
            None => Err(io::Error::other("packets are known of the presets vlp16 and hdl32e alone")),
        }
    }

    fn window_ns(&self) -> u64 {
        if self.is_still { 0 } else { self.config.frame_time_ns }
    }

    fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        let rate_hz = settings.update_rate_hz();
        if let Head::Preset(preset) = &self.head {
            let [slowest, fastest] = preset.rates_hz;
            if !(slowest..=fastest).contains(&rate_hz) {
                return Err(format!(
                    "update_rate is {rate_hz}; a {} turns {slowest} to {fastest} times a second",
                    preset.name
                )
                .into());
            }
        }
        let frame_time_ns = Rate::from_hz(rate_hz).map_or(self.config.frame_time_ns, |rate| rate.stamp_ns(1));
        let config = self.config.frame_time_ns(frame_time_ns).noise(settings.noise(&self.config.noise)?);
        if let Head::Grid { angles, .. } = self.head
            && frame_time_ns != self.config.frame_time_ns
        {
            self.head = Head::grid(angles, frame_time_ns);
        }
        Scanner::new(config_of(&config, &self.head))?;
        self.config = config;
        Ok(())
    }
}
