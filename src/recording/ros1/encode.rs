//! Converts frames to ROS messages as the ROS node does, with one function per type of message.

use super::Payload;
use super::bytes::Bytes;
use belvedere_bridge::payload::{
    Altimeter, CameraInfo, Clock, CoreSensors, FluidPressure, Imu, JointState, MagneticField, ModelState,
    MotorPower, NavSatFix, Odometry, Range, RobotEvent, Transform, Vector3, VelocityCommand,
};
use belvedere_bridge::{Encoding, FrameHeader, FrameView};

/// Writes a frame's message. Returns `None` if the message cannot represent the frame.
pub(super) type Encode = fn(&FrameView<'_>, &mut Bytes<'_>) -> Option<Payload>;

/// `datatype` of a `sensor_msgs/PointField`.
const UINT8: u8 = 2;
const UINT16: u8 = 4;
const UINT32: u8 = 6;
const FLOAT32: u8 = 7;
const FLOAT64: u8 = 8;

/// Numbers of motors and analogue inputs of a Kobuki, which are not simulated.
const MOTORS: usize = 2;
const ANALOG_INPUTS: usize = 4;

fn header(header: &FrameHeader, out: &mut Bytes<'_>) {
    stamped(header, header.frame_id.as_str(), out);
}

fn stamped(header: &FrameHeader, frame_id: &str, out: &mut Bytes<'_>) {
    out.u32(header.seq as u32);
    out.time(header.stamp_ns);
    out.text(frame_id);
}

/// Returns name and size of a pixel.
fn pixel(encoding: Encoding) -> Option<(&'static str, u32)> {
    let name = match encoding {
        Encoding::Rgb8
        | Encoding::Bgr8
        | Encoding::Mono8
        | Encoding::Rgba8
        | Encoding::Mono16
        | Encoding::BayerRggb8
        | Encoding::BayerBggr8
        | Encoding::BayerGbrg8
        | Encoding::BayerGrbg8
        | Encoding::BayerRggb16
        | Encoding::BayerBggr16
        | Encoding::BayerGbrg16
        | Encoding::BayerGrbg16 => encoding.as_str(),
        Encoding::F32C1 => "32FC1",
        Encoding::U16C1 => "16UC1",
        Encoding::F32C2 => "32FC2",
        Encoding::F32C3 => "32FC3",
        Encoding::I32C1 => "32SC1",
        _ => return None,
    };
    Some((name, encoding.elem_size()? as u32))
}

/// Writes rows without gaps as a `uint8[]`.
fn rows(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Payload {
    let FrameHeader { width, height, elem_stride, row_stride, .. } = *frame.header();
    let row_len = width as usize * elem_stride as usize;
    let packed = row_stride as usize == row_len && frame.payload().len() == row_len * height as usize;
    if packed {
        out.bytes(frame.payload());
        return Payload::Within(out.0.len() - frame.payload().len());
    }
    out.count(row_len * height as usize);
    for row in frame.rows() {
        out.0.extend_from_slice(row);
        // Padding between the last element and the end of its stride.
        out.0.resize(out.0.len() + row_len - row.len(), 0);
    }
    Payload::Elsewhere
}

pub(super) fn image(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let (name, size) = pixel(head.encoding()?)?;
    if head.elem_stride != size {
        return None;
    }
    header(head, out);
    out.u32(head.height);
    out.u32(head.width);
    out.text(name);
    out.u8(0);
    out.u32(head.width * size);
    Some(rows(frame, out))
}

pub(super) fn camera_info(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let info: CameraInfo = frame.message().ok()?;
    header(frame.header(), out);
    out.u32(info.height);
    out.u32(info.width);
    out.text(info.distortion_model.as_str());
    let parameters = &info.d[..(info.d_len as usize).min(info.d.len())];
    out.count(parameters.len());
    out.f64s(parameters);
    out.f64s(&info.k);
    out.f64s(&info.r);
    out.f64s(&info.p);
    // Default binning, and no region of interest.
    (0..6).for_each(|_| out.u32(0));
    out.u8(0);
    Some(Payload::Elsewhere)
}

pub(super) fn laser_scan(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let geometry = head.scan_geometry()?;
    if head.height > 1 || head.encoding() != Some(Encoding::RangesF32) {
        return None;
    }
    header(head, out);
    out.f32(geometry.angle_min as f32);
    out.f32(geometry.angle_max(head.width) as f32);
    out.f32(geometry.angle_increment as f32);
    out.f32(geometry.time_increment as f32);
    out.f32(geometry.scan_time as f32);
    out.f32(geometry.range_min);
    out.f32(geometry.range_max);
    out.count(frame.rows().len() * head.width as usize);
    frame.numbers(frame.rows()).for_each(|range| out.f32(range));
    out.count(frame.intensity_rows().len() * head.width as usize);
    frame.numbers(frame.intensity_rows()).for_each(|intensity| out.f32(intensity));
    Some(Payload::Elsewhere)
}

/// Writes the fields of a cloud: names, offsets, types.
fn fields(fields: &[(&str, u32, u8)], out: &mut Bytes<'_>) {
    out.count(fields.len());
    for &(name, offset, datatype) in fields {
        out.text(name);
        out.u32(offset);
        out.u8(datatype);
        out.u32(1);
    }
}

/// Writes a scan of several layers as a cloud, as drivers send it: points without gaps, with ring and time.
pub(super) fn scan_cloud(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let geometry = head.scan_geometry()?;
    if head.encoding() != Some(Encoding::RangesF32) || head.height > u32::from(u16::MAX) {
        return None;
    }
    let has_intensities = head.has_intensities();
    header(head, out);
    out.u32(head.height);
    out.u32(head.width);
    let point_step = if has_intensities {
        let all = [("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32), ("intensity", 12, FLOAT32)];
        fields(&[&all[..], &[("ring", 16, UINT16), ("time", 18, FLOAT32)]].concat(), out);
        22
    } else {
        let all = [("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32)];
        fields(&[&all[..], &[("ring", 12, UINT16), ("time", 14, FLOAT32)]].concat(), out);
        18
    };
    out.u8(0);
    out.u32(point_step);
    out.u32(point_step * head.width);
    let rows = frame.rows().len();
    out.count(rows * head.width as usize * point_step as usize);
    let turns: Vec<(f64, f64)> = (0..head.width)
        .map(|ray| libm::sincos(geometry.angle_min + f64::from(ray) * geometry.angle_increment))
        .collect();
    let mut intensities = frame.numbers::<f32>(frame.intensity_rows());
    let mut is_dense = true;
    for (layer, row) in frame.rows().enumerate() {
        let elevation = geometry.vertical_angle_min + layer as f64 * geometry.vertical_angle_increment;
        let (up, along) = libm::sincos(elevation);
        for (ray, range) in frame.numbers::<f32>(std::iter::once(row)).enumerate() {
            let range = if range.is_finite() { f64::from(range) } else { f64::NAN };
            is_dense &= !range.is_nan();
            let (sin, cos) = turns[ray];
            out.f32((range * along * cos) as f32);
            out.f32((range * along * sin) as f32);
            out.f32((range * up) as f32);
            if has_intensities {
                out.f32(intensities.next().unwrap_or(0.0));
            }
            out.u16(layer as u16);
            out.f32((ray as f64 * geometry.time_increment) as f32);
        }
    }
    out.u8(is_dense.into());
    Some(Payload::Elsewhere)
}

pub(super) fn point_cloud(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let (own, is_dense) = match head.encoding()? {
        Encoding::XyzRgbF32 => (&[("rgb", 16, FLOAT32)][..], false),
        Encoding::XyzIrtF32 => {
            (&[("intensity", 12, FLOAT32), ("ring", 16, UINT16), ("time", 18, FLOAT32)][..], head.height <= 1)
        }
        Encoding::OusterPoint => (
            &[
                ("intensity", 16, FLOAT32),
                ("t", 20, UINT32),
                ("reflectivity", 24, UINT16),
                ("ring", 26, UINT16),
                ("ambient", 28, UINT16),
                ("range", 32, UINT32),
            ][..],
            false,
        ),
        Encoding::LivoxPoint => (
            &[
                ("intensity", 12, FLOAT32),
                ("tag", 16, UINT8),
                ("line", 17, UINT8),
                ("timestamp", 18, FLOAT64),
            ][..],
            head.height <= 1,
        ),
        _ => return None,
    };
    header(head, out);
    out.u32(head.height);
    out.u32(head.width);
    fields(&[&[("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32)], own].concat(), out);
    out.u8(0);
    out.u32(head.elem_stride);
    out.u32(head.elem_stride * head.width);
    let payload = rows(frame, out);
    out.u8(is_dense.into());
    Some(payload)
}

pub(super) fn odometry(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let odometry: Odometry = frame.message().ok()?;
    header(frame.header(), out);
    out.text(odometry.child_frame_id.as_str());
    out.f64s(&odometry.position);
    out.f64s(&odometry.orientation);
    out.f64s(&odometry.pose_covariance);
    out.f64s(&odometry.linear);
    out.f64s(&odometry.angular);
    out.f64s(&odometry.twist_covariance);
    Some(Payload::Elsewhere)
}

pub(super) fn transforms(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let transforms = frame.structs::<Transform>().ok()?;
    out.count(transforms.len());
    for transform in transforms {
        stamped(frame.header(), transform.parent.as_str(), out);
        out.text(transform.child.as_str());
        out.f64s(&transform.translation);
        out.f64s(&transform.rotation);
    }
    Some(Payload::Elsewhere)
}

pub(super) fn joint_states(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let joints: Vec<JointState> = frame.structs().ok()?.collect();
    header(frame.header(), out);
    out.count(joints.len());
    for joint in &joints {
        out.text(joint.name.as_str());
    }
    for number in [
        |joint: &JointState| joint.position,
        |joint: &JointState| joint.velocity,
        |joint: &JointState| joint.effort,
    ] {
        out.count(joints.len());
        for joint in &joints {
            out.f64s(&[number(joint)]);
        }
    }
    Some(Payload::Elsewhere)
}

pub(super) fn clock(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    out.time(frame.message::<Clock>().ok()?.now_ns);
    Some(Payload::Elsewhere)
}

pub(super) fn velocity_command(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let command: VelocityCommand = frame.message().ok()?;
    out.f64s(&command.linear);
    out.f64s(&command.angular);
    Some(Payload::Elsewhere)
}

pub(super) fn imu(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let imu: Imu = frame.message().ok()?;
    header(frame.header(), out);
    out.f64s(&imu.orientation);
    out.f64s(&imu.orientation_covariance);
    out.f64s(&imu.angular_velocity);
    out.f64s(&imu.angular_velocity_covariance);
    out.f64s(&imu.linear_acceleration);
    out.f64s(&imu.linear_acceleration_covariance);
    Some(Payload::Elsewhere)
}

pub(super) fn range(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let range: Range = frame.message().ok()?;
    header(frame.header(), out);
    out.u8(u8::from(range.radiation_type != Range::ULTRASOUND));
    out.f32(range.field_of_view);
    out.f32(range.min_range);
    out.f32(range.max_range);
    out.f32(range.range);
    Some(Payload::Elsewhere)
}

/// Writes a fix without the velocity, for which the message has no field.
pub(super) fn nav_sat_fix(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    /// `SERVICE_GPS`.
    const GPS: u16 = 1;
    let fix: NavSatFix = frame.message().ok()?;
    header(frame.header(), out);
    // `STATUS_FIX`.
    out.u8(0);
    out.u16(GPS);
    out.f64s(&[fix.latitude, fix.longitude, fix.altitude]);
    out.f64s(&fix.position_covariance);
    // The covariance is known along the diagonal, unless all of it is 0.
    let is_known = fix.position_covariance.iter().any(|part| *part != 0.0);
    out.u8(if is_known { 2 } else { 0 });
    Some(Payload::Elsewhere)
}

pub(super) fn magnetic_field(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let field: MagneticField = frame.message().ok()?;
    header(frame.header(), out);
    out.f64s(&field.magnetic_field);
    out.f64s(&field.covariance);
    Some(Payload::Elsewhere)
}

pub(super) fn fluid_pressure(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let pressure: FluidPressure = frame.message().ok()?;
    header(frame.header(), out);
    out.f64s(&[pressure.fluid_pressure, pressure.variance]);
    Some(Payload::Elsewhere)
}

/// Writes an altimeter's height as a point above the origin of its frame.
pub(super) fn height(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let altimeter: Altimeter = frame.message().ok()?;
    header(frame.header(), out);
    out.f64s(&[0.0, 0.0, altimeter.vertical_position]);
    Some(Payload::Elsewhere)
}

pub(super) fn vector(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let vector: Vector3 = frame.message().ok()?;
    header(frame.header(), out);
    out.f64s(&vector.vector);
    Some(Payload::Elsewhere)
}

/// Writes states of models or links: the two types differ only in their names.
pub(super) fn model_states(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let states: Vec<ModelState> = frame.structs().ok()?.collect();
    out.count(states.len());
    for state in &states {
        out.text(state.name.as_str());
    }
    out.count(states.len());
    for state in &states {
        out.f64s(&state.position);
        out.f64s(&state.orientation);
    }
    out.count(states.len());
    for state in &states {
        out.f64s(&state.linear);
        out.f64s(&state.angular);
    }
    Some(Payload::Elsewhere)
}

pub(super) fn core_sensors(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let state: CoreSensors = frame.message().ok()?;
    header(frame.header(), out);
    out.u16(state.time_stamp);
    out.u8(state.bumper);
    out.u8(state.wheel_drop);
    out.u8(state.cliff);
    out.u16(state.left_encoder);
    out.u16(state.right_encoder);
    out.u8(state.left_pwm.cast_unsigned());
    out.u8(state.right_pwm.cast_unsigned());
    out.u8(state.buttons);
    out.u8(state.charger);
    out.u8(state.battery);
    out.count(state.bottom.len());
    state.bottom.iter().for_each(|&reading| out.u16(reading));
    out.bytes(&[0; MOTORS]);
    out.u8(0);
    out.u16(0);
    out.count(ANALOG_INPUTS);
    (0..ANALOG_INPUTS).for_each(|_| out.u16(0));
    Some(Payload::Elsewhere)
}

/// Reads an event of one source. `places` are the numbers of left, centre and right in its message, or −1 if the
/// message has none.
fn event(frame: &FrameView<'_>, source: u32, places: [i8; 3]) -> Option<(u8, RobotEvent)> {
    let event: RobotEvent = frame.message().ok()?;
    let place = u8::try_from(*places.get(event.index as usize)?).ok()?;
    (event.source == source && event.state <= 1).then_some((place, event))
}

pub(super) fn bumper(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let (place, event) = event(frame, RobotEvent::BUMPER, [0, 1, 2])?;
    out.u8(place);
    out.u8(event.state as u8);
    Some(Payload::Elsewhere)
}

pub(super) fn cliff(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let (place, event) = event(frame, RobotEvent::CLIFF, [0, 1, 2])?;
    out.u8(place);
    out.u8(event.state as u8);
    out.u16(event.value as u16);
    Some(Payload::Elsewhere)
}

pub(super) fn wheel_drop(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    let (place, event) = event(frame, RobotEvent::WHEEL_DROP, [0, -1, 1])?;
    out.u8(place);
    out.u8(event.state as u8);
    Some(Payload::Elsewhere)
}

#[allow(clippy::unnecessary_wraps, reason = "one of many of this type")]
pub(super) fn empty(_: &FrameView<'_>, _: &mut Bytes<'_>) -> Option<Payload> {
    Some(Payload::Elsewhere)
}

pub(super) fn motor_power(frame: &FrameView<'_>, out: &mut Bytes<'_>) -> Option<Payload> {
    out.u8(frame.message::<MotorPower>().ok()?.state as u8);
    Some(Payload::Elsewhere)
}
