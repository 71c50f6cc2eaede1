//! Prints images, scans and clouds, whose payloads are not structs.

use super::tree::Tree::{self, Flag, List, Map, Number, Text, Whole};
use belvedere_bridge::point::{Number as Of, PointField, PointLayout};
use belvedere_bridge::{Encoding, FrameHeader, FrameView};

type Entries = Vec<(&'static str, Tree)>;

pub(super) fn image(frame: &FrameView<'_>, limit: usize) -> Option<Entries> {
    let header = frame.header();
    let encoding = header.encoding()?;
    let data = match encoding {
        Encoding::F32C1 => numbers::<f32>(frame, frame.rows(), limit),
        Encoding::U16C1 => List(
            frame.numbers::<u16>(frame.rows()).take(limit).map(|value| Whole(value.into())).collect(),
            pixels(header).saturating_sub(limit),
        ),
        Encoding::F32C2 => vectors::<2>(frame, limit),
        Encoding::F32C3 => vectors::<3>(frame, limit),
        Encoding::I32C1 => numbers::<i32>(frame, frame.rows(), limit),
        _ => bytes(frame, limit),
    };
    Some(vec![
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("encoding", ros_encoding(encoding)),
        ("is_bigendian", Flag(false)),
        ("step", Whole(header.row_stride.into())),
        ("data", data),
    ])
}

/// Returns the name of the encoding in `sensor_msgs`: `32FC1` for `32fc1`, `rgb8` for `rgb8`.
fn ros_encoding(encoding: Encoding) -> Tree {
    let name = encoding.as_str();
    Text(if name.starts_with(|first: char| first.is_ascii_digit()) {
        name.to_uppercase()
    } else {
        name.to_owned()
    })
}

pub(super) fn scan(frame: &FrameView<'_>, limit: usize) -> Option<Entries> {
    let header = frame.header();
    let geometry = header.scan_geometry()?;
    let mut entries = vec![
        ("angle_min", Number(geometry.angle_min)),
        ("angle_max", Number(geometry.angle_max(header.width))),
        ("angle_increment", Number(geometry.angle_increment)),
        ("time_increment", Number(geometry.time_increment)),
        ("scan_time", Number(geometry.scan_time)),
        ("range_min", Number(geometry.range_min.into())),
        ("range_max", Number(geometry.range_max.into())),
    ];
    if header.height > 1 {
        entries.push(("layers", Whole(header.height.into())));
        entries.push(("vertical_angle_min", Number(geometry.vertical_angle_min)));
        entries.push(("vertical_angle_increment", Number(geometry.vertical_angle_increment)));
    }
    let intensities = if header.has_intensities() {
        numbers::<f32>(frame, frame.intensity_rows(), limit)
    } else {
        List(Vec::new(), 0)
    };
    entries.push(("ranges", numbers::<f32>(frame, frame.rows(), limit)));
    entries.push(("intensities", intensities));
    Some(entries)
}

pub(super) fn cloud(frame: &FrameView<'_>, limit: usize) -> Option<Entries> {
    let header = frame.header();
    let layout = header.encoding()?.point()?;
    let stride = (header.elem_stride as usize).max(1);
    let points = frame.rows().flat_map(|row| row.chunks(stride));
    let points = points.filter(|point| point.len() >= layout.size).take(limit);
    let points = points.map(|bytes| point(layout, bytes)).collect();
    Some(vec![
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("point_step", Whole(header.elem_stride.into())),
        ("row_step", Whole(header.row_stride.into())),
        ("points", List(points, pixels(header).saturating_sub(limit))),
    ])
}

/// Shows a point: its place as one list, and its other fields by name.
fn point(layout: &PointLayout, bytes: &[u8]) -> Tree {
    let (place, others) = layout.fields.split_at(3);
    let values = |fields: &[PointField]| fields.iter().map(|field| value(field, bytes)).collect();
    let xyz = List(values(place), 0);
    let others = others.iter().map(|field| (field.name, value(field, bytes)));
    Map(std::iter::once(("xyz", xyz)).chain(others).collect())
}

/// Shows a field of a point.
fn value(field: &PointField, point: &[u8]) -> Tree {
    let bytes = &point[field.offset..][..field.number.size()];
    match field.number {
        Of::U8 => Whole(bytes[0].into()),
        Of::U16 => Whole(bytemuck::pod_read_unaligned::<u16>(bytes).into()),
        Of::U32 => Whole(bytemuck::pod_read_unaligned::<u32>(bytes).into()),
        Of::F32 => Number(bytemuck::pod_read_unaligned::<f32>(bytes).into()),
        Of::F64 => Number(bytemuck::pod_read_unaligned(bytes)),
        // Red first.
        Of::Colour => List(bytes[..3].iter().rev().map(|&value| Whole(value.into())).collect(), 0),
    }
}

fn pixels(header: &FrameHeader) -> usize {
    header.width as usize * header.height as usize
}

/// Shows the payload as bytes.
pub(super) fn bytes(frame: &FrameView<'_>, limit: usize) -> Tree {
    let payload = frame.payload();
    let shown = payload.iter().take(limit).map(|&byte| Whole(byte.into())).collect();
    List(shown, payload.len().saturating_sub(limit))
}

/// Shows an array of vectors, each as a list.
fn vectors<const N: usize>(frame: &FrameView<'_>, limit: usize) -> Tree
where
    [f32; N]: bytemuck::Pod,
{
    let list = |vector: [f32; N]| List(vector.into_iter().map(|part| Number(part.into())).collect(), 0);
    let shown = frame.numbers::<[f32; N]>(frame.rows()).take(limit).map(list).collect();
    List(shown, pixels(frame.header()).saturating_sub(limit))
}

fn numbers<'a, T: bytemuck::Pod + Into<f64>>(
    frame: &FrameView<'a>,
    rows: impl Iterator<Item = &'a [u8]>,
    limit: usize,
) -> Tree {
    let shown = frame.numbers::<T>(rows).take(limit).map(|value| Number(value.into())).collect();
    List(shown, pixels(frame.header()).saturating_sub(limit))
}
