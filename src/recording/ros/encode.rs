//! Converts images, scans and clouds to ROS messages as the node for ROS 1 does, with one function per type of message.

use super::Payload;
use belvedere_bridge::{Encoding, FrameHeader, FrameView, RosBytes};

/// Writes a frame's message. Returns `None` if the message cannot represent the frame.
pub(super) type Encode = fn(&FrameView<'_>, &mut RosBytes<'_>) -> Option<Payload>;

/// `datatype` of a `sensor_msgs/PointField`.
pub(super) const UINT8: u8 = 2;
pub(super) const UINT16: u8 = 4;
pub(super) const UINT32: u8 = 6;
pub(super) const FLOAT32: u8 = 7;
pub(super) const FLOAT64: u8 = 8;

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
fn rows(frame: &FrameView<'_>, out: &mut RosBytes<'_>) -> Payload {
    let FrameHeader { width, height, elem_stride, row_stride, .. } = *frame.header();
    let row_len = width as usize * elem_stride as usize;
    let packed = row_stride as usize == row_len && frame.payload().len() == row_len * height as usize;
    if packed {
        out.bytes(frame.payload());
        return Payload::Within(out.place() - frame.payload().len());
    }
    out.count(row_len * height as usize);
    for row in frame.rows() {
        out.raw(row);
        // Padding between the last element and the end of its stride.
        for _ in row.len()..row_len {
            out.raw(&[0]);
        }
    }
    Payload::Elsewhere
}

pub(super) fn image(frame: &FrameView<'_>, out: &mut RosBytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let (name, size) = pixel(head.encoding()?)?;
    if head.elem_stride != size {
        return None;
    }
    out.header(head, None);
    out.u32(head.height);
    out.u32(head.width);
    out.text(name);
    out.u8(0);
    out.u32(head.width * size);
    Some(rows(frame, out))
}

pub(super) fn laser_scan(frame: &FrameView<'_>, out: &mut RosBytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let geometry = head.scan_geometry()?;
    if head.height > 1 || head.encoding() != Some(Encoding::RangesF32) {
        return None;
    }
    out.header(head, None);
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
fn fields(fields: &[(&str, u32, u8)], out: &mut RosBytes<'_>) {
    out.count(fields.len());
    for &(name, offset, datatype) in fields {
        out.text(name);
        out.u32(offset);
        out.u8(datatype);
        out.u32(1);
    }
}

/// Writes a scan of several layers as a cloud, as drivers send it: points without gaps, with ring and time.
pub(super) fn scan_cloud(frame: &FrameView<'_>, out: &mut RosBytes<'_>) -> Option<Payload> {
    let head = frame.header();
    let geometry = head.scan_geometry()?;
    if head.encoding() != Some(Encoding::RangesF32) || head.height > u32::from(u16::MAX) {
        return None;
    }
    let has_intensities = head.has_intensities();
    out.header(head, None);
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
            for value in [range * along * cos, range * along * sin, range * up] {
                out.raw(&(value as f32).to_le_bytes());
            }
            if has_intensities {
                out.raw(&intensities.next().unwrap_or(0.0).to_le_bytes());
            }
            out.raw(&(layer as u16).to_le_bytes());
            out.raw(&((ray as f64 * geometry.time_increment) as f32).to_le_bytes());
        }
    }
    out.u8(is_dense.into());
    Some(Payload::Elsewhere)
}

pub(super) fn point_cloud(frame: &FrameView<'_>, out: &mut RosBytes<'_>) -> Option<Payload> {
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
    out.header(head, None);
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
