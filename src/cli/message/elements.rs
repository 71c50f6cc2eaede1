//! Prints images, scans and clouds, whose payloads are not structs.

use super::tree::Tree::{self, Flag, List, Map, Number, Text, Whole};
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
    let points = match header.encoding()? {
        Encoding::XyzRgbF32 => frame.numbers::<[f32; 5]>(frame.rows()).take(limit).map(coloured).collect(),
        Encoding::XyzIrtF32 => frame.numbers::<[u8; 22]>(frame.rows()).take(limit).map(timed).collect(),
        Encoding::OusterPoint => frame.numbers::<[u8; 48]>(frame.rows()).take(limit).map(ouster).collect(),
        Encoding::LivoxPoint => frame.numbers::<[u8; 26]>(frame.rows()).take(limit).map(livox).collect(),
        _ => return None,
    };
    Some(vec![
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("point_step", Whole(header.elem_stride.into())),
        ("row_step", Whole(header.row_stride.into())),
        ("points", List(points, pixels(header).saturating_sub(limit))),
    ])
}

fn xyz_of(point: [f32; 3]) -> Tree {
    List(point.map(|value| Number(value.into())).to_vec(), 0)
}

/// Converts a point of `Encoding::XyzRgbF32`.
fn coloured([x, y, z, _, rgb]: [f32; 5]) -> Tree {
    let [blue, green, red, _] = rgb.to_bits().to_le_bytes();
    Map(vec![
        ("xyz", xyz_of([x, y, z])),
        ("rgb", List([red, green, blue].map(|value| Whole(value.into())).to_vec(), 0)),
    ])
}

/// Reads a number in a point at a byte offset.
fn at<T: bytemuck::AnyBitPattern>(point: &[u8], at: usize) -> T {
    bytemuck::pod_read_unaligned(&point[at..at + size_of::<T>()])
}

/// Converts a point of `Encoding::XyzIrtF32`.
fn timed(point: [u8; 22]) -> Tree {
    Map(vec![
        ("xyz", xyz_of(at(&point, 0))),
        ("intensity", Number(at::<f32>(&point, 12).into())),
        ("ring", Whole(at::<u16>(&point, 16).into())),
        ("time", Number(at::<f32>(&point, 18).into())),
    ])
}

/// Converts a point of `Encoding::OusterPoint`.
fn ouster(point: [u8; 48]) -> Tree {
    Map(vec![
        ("xyz", xyz_of(at(&point, 0))),
        ("intensity", Number(at::<f32>(&point, 16).into())),
        ("t", Whole(at::<u32>(&point, 20).into())),
        ("reflectivity", Whole(at::<u16>(&point, 24).into())),
        ("ring", Whole(at::<u16>(&point, 26).into())),
        ("ambient", Whole(at::<u16>(&point, 28).into())),
        ("range", Whole(at::<u32>(&point, 32).into())),
    ])
}

/// Converts a point of `Encoding::LivoxPoint`.
fn livox(point: [u8; 26]) -> Tree {
    Map(vec![
        ("xyz", xyz_of(at(&point, 0))),
        ("intensity", Number(at::<f32>(&point, 12).into())),
        ("tag", Whole(point[16].into())),
        ("line", Whole(point[17].into())),
        ("timestamp", Number(at::<f64>(&point, 18))),
    ])
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
