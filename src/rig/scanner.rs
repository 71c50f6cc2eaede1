//! A lidar in which each beam has its own time. Its cloud has the layout of its ROS driver. The scan of a single beam
//! has the timestamp of its first ray, as specified for `sensor_msgs/LaserScan`.

mod cloud;
mod head;

use super::channel::{Channel, is_any_wanted};
use super::motion::Motion;
use super::mount::Mount;
use super::outlet::Outlet;
use super::packets::{PacketTarget, Packets};
use super::pictures::noise;
use super::sight::sight;
use super::sink::Frame;
use super::truth::TruthOutlets;
use super::{Opening, Rate, RigContext, RigError, Settings};
use crate::description::model::{self, CloudLayout, LaserPlugin, Sensor};
use belvedere_bridge::{Encoding, FrameHeader, Kind, ScanGeometry, StreamSpec};
use belvedere_sensors::scanner::{Echoes, Pattern, Scanner, ScannerConfig};
use belvedere_sensors::{Capture, Pose, Shutter};
use cloud::{CloudForm, Found, Scan};
use head::{Head, angles, config_of};
use lidar_packets::Column;
use lidar_packets::whole::rounded;
use std::f64::consts::TAU;
use std::io;
use std::time::Instant;

/// A running scanner.
pub(super) struct ScannerChannel {
    /// The configuration without its pattern.
    config: ScannerConfig<'static>,
    head: Head,
    /// Number of firings that belong together: one of each laser.
    lasers: usize,
    form: Form,
    /// Gazebo's lidars and flash lidars measure all beams at the timestamp.
    is_still: bool,
    mount: Mount,
    outlet: Outlet,
    /// Further streams, if the driver has one for each return.
    others: Vec<Outlet>,
    truth: TruthOutlets,
    motion: Motion,
    found: Found,
    /// Present for presets whose packets are supported.
    packets: Option<Packets>,
}

/// The form of its output.
enum Form {
    /// A cloud of points.
    Cloud(CloudLayout, Box<dyn CloudForm>),
    /// A scan of ranges; the geometry lacks the times.
    Scan(Box<ScanGeometry>),
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
        let config = lidar.physics.applied_to(config);
        let head = Head::of(lidar, frame_time_ns);
        let scanner = Scanner::new(config_of(&config, &head)).map_err(|error| refused(&error))?;
        let most = scanner.most_firings();
        let lasers = head.in_row();
        let size = [lasers as u32, (most / lasers) as u32];
        let frame = opening.frame_id(sensor, &plugin.frame_name);
        let (form, spec) = if let Some(layout) = plugin.cloud {
            let form = cloud::form_of(&head, config.intensity);
            let shared = scanner.returns() / form.streams(scanner.returns());
            let bytes = most * shared * form.encoding().elem_size().unwrap_or_default();
            let spec = StreamSpec::new(&plugin.topic, Kind::PointCloud, form.encoding(), bytes);
            (Form::Cloud(layout, form), spec)
        } else {
            let bytes = most * size_of::<f32>() * 2;
            let spec = StreamSpec::new(&plugin.topic, Kind::LaserScan, Encoding::RangesF32, bytes).layers(1);
            (Form::Scan(Box::new(angles(&head, ray))), StreamSpec { buffer: 16, ..spec })
        };
        let spec = spec.frame_id(&frame).rate_hz(opening.rate.hz());
        let streams = if let Form::Cloud(_, form) = &form { form.streams(scanner.returns()) } else { 1 };
        let more = (2..=streams).map(|number| {
            opening.open_rendered(StreamSpec { topic: format!("{}{number}", plugin.topic), ..spec.clone() })
        });
        Ok(Self {
            others: more.collect::<Result<_, _>>()?,
            outlet: opening.open_rendered(spec)?,
            truth: TruthOutlets::open_without_flow(&plugin.topic, &frame, size, opening)?,
            mount: Mount::new(sensor, opening),
            is_still: opening.gazebo_compat || head.is_flash(),
            motion: Motion::default(),
            found: Found::default(),
            packets: Packets::of(lidar),
            lasers,
            form,
            config,
            head,
        })
    }

    fn frame_time_s(&self) -> f64 {
        self.config.frame_time_ns as f64 * 1e-9
    }

    /// Writes the results to a frame of one of its streams.
    fn write(
        &self,
        (number, outlet): (usize, &Outlet),
        firings: usize,
        (world_from_sensor, stamp_ns): (&Pose, u64),
    ) -> Option<Frame> {
        let mut frame = match &self.form {
            Form::Cloud(layout, form) => {
                let taken_s = (!self.is_still).then(|| self.frame_time_s());
                let (found, returns) = (&self.found, self.config.returns.count());
                let scan = Scan { found, firings, returns, layout: *layout, stamp_ns, taken_s };
                form.write(&scan, number, outlet)?
            }
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
}

impl ScannerChannel {
    fn sends_packets(&self) -> bool {
        self.packets.as_ref().is_some_and(Packets::is_wanted)
    }

    /// Sends the results as packets, if there is a target. Columns before time 0 are skipped.
    fn send_columns(&mut self, firings: usize, frame: u64, stamp_ns: u64) {
        let Some(packets) = self.packets.as_mut().filter(|packets| packets.is_wanted()) else { return };
        let (period_ns, lasers, returns) =
            (self.config.frame_time_ns, self.lasers, self.config.returns.count());
        let Found { ranges, intensities, times, .. } = &self.found;
        for (number, first) in (0..firings).step_by(lasers).enumerate() {
            // Rounded as in clouds: half to even.
            let after_ns = rounded(times[first] * 1e9) as u64;
            let Some(time_ns) = (stamp_ns + after_ns).checked_sub(period_ns) else { continue };
            packets.push(&Column {
                frame,
                number,
                time_ns,
                turned: after_ns as f64 / period_ns as f64,
                ranges_m: &ranges[first * returns..(first + lasers) * returns],
                intensities: &intensities[first * returns..(first + lasers) * returns],
            });
        }
    }
}

impl Channel for ScannerChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        [&self.outlet].into_iter().chain(&self.others).chain(self.truth.outlets()).collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        let started = Instant::now();
        let world_from_sensor = self.mount.pose(context);
        let Ok(scanner) = Scanner::new(config_of(&self.config, &self.head)) else { return };
        let mut truth = self.truth.loan(context.stamp_ns, &world_from_sensor, |_| {});
        let mut output = Echoes::new();
        output.truth = truth.truth();
        let is_wanted =
            self.outlet.is_wanted() || self.others.iter().any(Outlet::is_wanted) || self.sends_packets();
        if is_wanted {
            self.found.resize(scanner.most_firings(), scanner.returns());
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
        let outcomes: Vec<_> = [&self.outlet]
            .into_iter()
            .chain(&self.others)
            .enumerate()
            .map(|stream| {
                let frame = self.write(stream, firings, (&world_from_sensor, context.stamp_ns));
                stream.1.send(frame.filter(|_| taken))
            })
            .collect();
        self.send_columns(firings, frame_number, context.stamp_ns);
        let truths = truth.send(&self.truth, taken);
        let outlets = [&mut self.outlet].into_iter().chain(&mut self.others);
        outlets.zip(outcomes).for_each(|(outlet, outcome)| outlet.record(outcome, started.elapsed()));
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

    fn check_packets(&self, target: &PacketTarget) -> io::Result<()> {
        self.packets.as_ref().ok_or_else(Packets::unknown)?.check(target)
    }

    fn send_packets(&mut self, target: &PacketTarget) -> io::Result<()> {
        self.packets.as_mut().map_or(Ok(()), |packets| packets.open(target))
    }

    fn window_ns(&self) -> u64 {
        if self.is_still { 0 } else { self.config.frame_time_ns }
    }

    fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        let rate_hz = settings.update_rate_hz();
        if let Head::Preset(preset) = &self.head {
            let columns = preset.columns();
            if preset.in_mode(columns, Some(rate_hz)).is_none() {
                let choices = model::choices(preset);
                let choices = match columns {
                    None => format!("a {} turns {choices} times a second", preset.name),
                    Some(columns) => {
                        format!("it has {columns} columns, and the modes of a {} are {choices}", preset.name)
                    }
                };
                return Err(format!("update_rate is {rate_hz}; {choices}").into());
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
