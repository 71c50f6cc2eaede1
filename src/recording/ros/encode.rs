//! Converts images, scans and clouds to ROS messages as the node for ROS 1 does, with one function per type of message.

use super::Payload;
use super::types::datatype;
use belvedere_bridge::point::{PointField, XyzIrtPoint};
use belvedere_bridge::{Encoding, FrameHeader, FrameView, RosBytes};

/// Writes a frame's message. Returns `None` if the message cannot represent the frame.
pub(super) type Encode = fn(&FrameView<'_>, &mut RosBytes<'_>) -> Option<Payload>;

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
fn fields(fields: &[PointField], out: &mut RosBytes<'_>) {
    out.count(fields.len());
    for field in fields {
        out.text(field.name);
        out.u32(field.offset as u32);
        out.u8(datatype(field.number));
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
    // The points of Velodyne's driver, without intensities if the scan has none.
    let mut point_step = 0;
    let own = XyzIrtPoint::LAYOUT.fields.iter().filter(|field| has_intensities || field.name != "intensity");
    let own: Vec<PointField> = own
        .map(|field| {
            let offset = point_step;
            point_step += field.number.size();
            PointField { offset, ..*field }
        })
        .collect();
    let point_step = point_step as u32;
    fields(&own, out);
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
    let point = head.encoding()?.point()?;
    out.header(head, None);
    out.u32(head.height);
    out.u32(head.width);
    fields(point.fields, out);
    out.u8(0);
    out.u32(head.elem_stride);
    out.u32(head.elem_stride * head.width);
    let payload = rows(frame, out);
    out.u8((point.row_is_dense && head.height <= 1).into());
    Some(payload)
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::{Kind, Ros};

    type Field = (&'static str, u32, u8);

    const FLOAT32: u8 = 7;
    const XYZ: [Field; 3] = [("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32)];

    /// A message of ROS 1 without its header: the shape, fields, the size of a point and of a row, and 0s for `count`
    /// points.
    fn message([width, height]: [u32; 2], own: &[Field], point_step: u32, is_dense: bool) -> Vec<u8> {
        let fields = [&XYZ, own].concat();
        let mut bytes = [height, width, fields.len() as u32].map(u32::to_le_bytes).concat();
        for (name, offset, datatype) in fields {
            bytes.extend((name.len() as u32).to_le_bytes());
            bytes.extend(name.as_bytes());
            bytes.extend(offset.to_le_bytes());
            bytes.push(datatype);
            bytes.extend(1_u32.to_le_bytes());
        }
        bytes.push(0);
        let data_len = width * height * point_step;
        bytes.extend([point_step, point_step * width, data_len].map(u32::to_le_bytes).concat());
        bytes.resize(bytes.len() + data_len as usize, 0);
        bytes.push(is_dense.into());
        bytes
    }

    fn written(encode: Encode, header: &FrameHeader, payload: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut bytes = RosBytes::begin(Ros::One, &mut out);
        encode(&FrameView::new(header, payload).unwrap(), &mut bytes).unwrap();
        bytes.end().unwrap();
        // Sequence number, stamp, and a frame id without a letter.
        out.split_off(16)
    }

    /// The fields are those of the drivers, also in recordings that exist.
    #[test]
    fn clouds_have_the_fields_of_the_drivers() {
        for (encoding, point_step, row_is_dense, own) in [
            (Encoding::XyzRgbF32, 32, false, &[("rgb", 16, FLOAT32)][..]),
            (
                Encoding::XyzIrtF32,
                22,
                true,
                &[("intensity", 12, FLOAT32), ("ring", 16, 4), ("time", 18, FLOAT32)][..],
            ),
            (Encoding::XyzIrF32, 18, false, &[("intensity", 12, FLOAT32), ("ring", 16, 4)][..]),
            (
                Encoding::OusterPoint,
                48,
                false,
                &[
                    ("intensity", 16, FLOAT32),
                    ("t", 20, 6),
                    ("reflectivity", 24, 4),
                    ("ring", 26, 4),
                    ("ambient", 28, 4),
                    ("range", 32, 6),
                ][..],
            ),
            (
                Encoding::LivoxPoint,
                26,
                true,
                &[("intensity", 12, FLOAT32), ("tag", 16, 2), ("line", 17, 2), ("timestamp", 18, 8)][..],
            ),
        ] {
            for size in [[3, 1], [3, 2]] {
                let mut header = FrameHeader::new(Kind::PointCloud, encoding);
                let payload = vec![0; header.set_packed(size[0], size[1])];
                header.payload_len = payload.len() as u64;
                let expected = message(size, own, point_step, row_is_dense && size[1] == 1);
                assert_eq!(written(point_cloud, &header, &payload), expected, "{encoding}");
            }
        }
    }

    #[test]
    fn a_scan_of_several_layers_has_velodynes_fields_without_gaps() {
        for (flags, planes, point_step, own) in [
            (0, 1, 18, &[("ring", 12, 4), ("time", 14, FLOAT32)][..]),
            (
                FrameHeader::HAS_INTENSITIES,
                2,
                22,
                &[("intensity", 12, FLOAT32), ("ring", 16, 4), ("time", 18, FLOAT32)][..],
            ),
        ] {
            let mut header = FrameHeader::new(Kind::LaserScan, Encoding::RangesF32);
            header.flags = flags;
            let payload = vec![0; planes * header.set_packed(2, 1)];
            header.payload_len = payload.len() as u64;
            assert_eq!(written(scan_cloud, &header, &payload), message([2, 1], own, point_step, true));
        }
    }
}
