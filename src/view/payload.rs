//! The page's format of frames: a length, a JSON object that describes the frame, and bytes.
//!
//! | bytes | are |
//! |---|---|
//! | 4 | length of the JSON, little-endian; spaces at its end let the payload begin at a multiple of 8 |
//! | length | `topic`, `kind`, `encoding`, `stamp` in ns, `sentMs` since 1970, `width`, `height`, `rowStride`, `elemStride`, the pose `position`, `orientation` of the sensor's own axes in the world, and the fields of the kind |
//! | the rest | the payload as in shared memory, except for depths in metres and points |
//!
//! Depths in metres become 16-bit millimetres, 0 for none and 65535 for beyond the range. This halves the data, in
//! steps that are finer than any sensor's noise. `streamEncoding` is then the stream's original encoding. Points become
//! 16 bytes each: x, y, z as f32, and either red, green, blue, 255 or the intensity as f32. Invalid points are omitted.

use belvedere_bridge::point::{Number, PointField};
use belvedere_bridge::{Encoding, FrameHeader, FrameView, Kind, clock};
use serde_json::{Map, Value, json};
use std::time::{SystemTime, UNIX_EPOCH};

/// Encodes a frame for the page.
pub(super) fn encode(topic: &str, frame: &FrameView<'_>, restarted: bool) -> Vec<u8> {
    let header = frame.header();
    let mut object = describe(topic, header);
    if restarted {
        object.insert("restarted".into(), true.into());
    }
    let mut out = Vec::new();
    match (header.kind(), header.encoding()) {
        (Some(Kind::DepthImage), Some(Encoding::F32C1)) => {
            if let Some(encoding) = object.insert("encoding".into(), "16uc1".into()) {
                object.insert("streamEncoding".into(), encoding);
            }
            object.insert("elemStride".into(), 2.into());
            object.insert("rowStride".into(), (2 * header.width).into());
            begin(&object, &mut out, 2 * header.width as usize * header.height as usize);
            for row in frame.rows() {
                out.extend(row.as_chunks::<4>().0.iter().flat_map(|depth| {
                    let millimetres = f32::from_le_bytes(*depth) * 1000.0;
                    // The cast converts NaN to 0, and infinities to the ends of the range.
                    ((millimetres + 0.5) as u16).to_le_bytes()
                }));
            }
        }
        (Some(Kind::PointCloud), Some(encoding)) => {
            let colour = colour_field(encoding);
            let points = colour.map_or_else(Vec::new, |colour| points(frame, colour));
            object.insert("colour".into(), colour.map_or("intensity", |colour| colour.name).into());
            object.insert("points".into(), (points.len() / 16).into());
            begin(&object, &mut out, points.len());
            out.extend_from_slice(&points);
        }
        _ => {
            begin(&object, &mut out, frame.payload().len());
            out.extend_from_slice(frame.payload());
        }
    }
    out
}

fn begin(object: &Map<String, Value>, out: &mut Vec<u8>, payload_len: usize) {
    let mut text = serde_json::to_vec(object).unwrap_or_default();
    text.resize((text.len() + 4).next_multiple_of(8) - 4, b' ');
    out.reserve(4 + text.len() + payload_len);
    out.extend_from_slice(&(text.len() as u32).to_le_bytes());
    out.extend_from_slice(&text);
}

fn describe(topic: &str, header: &FrameHeader) -> Map<String, Value> {
    let mut object = Map::from_iter([
        ("topic".to_owned(), topic.into()),
        ("kind".to_owned(), header.kind().map(|kind| kind.to_string()).into()),
        ("encoding".to_owned(), header.encoding().map(|encoding| encoding.to_string()).into()),
        ("stamp".to_owned(), header.stamp_ns.into()),
        ("sentMs".to_owned(), sent_ms(header).into()),
        ("seq".to_owned(), header.seq.into()),
        ("width".to_owned(), header.width.into()),
        ("height".to_owned(), header.height.into()),
        ("rowStride".to_owned(), header.row_stride.into()),
        ("elemStride".to_owned(), header.elem_stride.into()),
        ("frameId".to_owned(), header.frame_id.as_str().into()),
        ("position".to_owned(), json!(header.position)),
        ("orientation".to_owned(), json!(header.orientation)),
    ]);
    // Clouds of lidars have no intrinsics.
    if let Some(lens) = header.intrinsics().filter(|lens| lens.fx != 0.0) {
        let model = lens.model().map(|model| model.to_string());
        object.insert(
            "intrinsics".into(),
            json!({
                "fx": lens.fx, "fy": lens.fy, "cx": lens.cx, "cy": lens.cy, "skew": lens.skew,
                "near": lens.near, "far": finite(lens.far), "model": model, "distortion": lens.parameters(),
            }),
        );
    }
    if let Some(scan) = header.scan_geometry() {
        object.insert(
            "scan".into(),
            json!({
                "angleMin": scan.angle_min, "angleIncrement": scan.angle_increment,
                "rangeMin": scan.range_min, "rangeMax": finite(scan.range_max),
                "verticalAngleMin": scan.vertical_angle_min,
                "verticalAngleIncrement": scan.vertical_angle_increment,
                "intensities": header.has_intensities(),
            }),
        );
    }
    object
}

/// Returns the time at which a frame was sent, on a clock that the page can read as well: milliseconds since 1970.
fn sent_ms(header: &FrameHeader) -> f64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let age_ns = clock::mono_ns().saturating_sub(header.publish_mono_ns);
    now.as_secs_f64() * 1e3 - age_ns as f64 * 1e-6
}

/// Returns `None` for infinities, which JSON does not have.
fn finite(value: f32) -> Option<f32> {
    value.is_finite().then_some(value)
}

/// Returns the field that colours a point: its colour, or else its intensity.
fn colour_field(encoding: Encoding) -> Option<&'static PointField> {
    let point = encoding.point()?;
    point.field("rgb").or_else(|| point.field("intensity"))
}

fn points(frame: &FrameView<'_>, colour: &PointField) -> Vec<u8> {
    let stride = (frame.header().elem_stride as usize).max(1);
    let mut points = Vec::new();
    for point in frame.rows().flat_map(|row| row.chunks(stride)) {
        let (Some(place), Some(&[first, second, third, fourth])) = (point.get(..12), colour.bytes(point))
        else {
            continue;
        };
        let (axes, _) = place.as_chunks::<4>();
        if axes.iter().any(|axis| !f32::from_le_bytes(*axis).is_finite()) {
            continue;
        }
        points.extend_from_slice(place);
        points.extend(match colour.number {
            // Blue, green, red and 0.
            Number::Colour => [third, second, first, 255],
            _ => [first, second, third, fourth],
        });
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(message: &[u8]) -> (Value, &[u8]) {
        let len = u32::from_le_bytes(message[..4].try_into().unwrap()) as usize;
        assert_eq!((4 + len) % 8, 0);
        (serde_json::from_slice(&message[4..4 + len]).unwrap(), &message[4 + len..])
    }

    #[test]
    fn depths_become_millimetres() {
        let mut header = FrameHeader::new(Kind::DepthImage, Encoding::F32C1);
        header.set_packed(5, 1);
        let depths = [1.2345_f32, f32::NAN, f32::NEG_INFINITY, f32::INFINITY, 70.0];
        header.payload_len = 20;
        let message =
            encode("depth", &FrameView::new(&header, bytemuck::cast_slice(&depths)).unwrap(), false);
        let (object, payload) = parts(&message);
        assert_eq!((object["encoding"].as_str(), object["rowStride"].as_u64()), (Some("16uc1"), Some(10)));
        assert_eq!(object["streamEncoding"], "32fc1");
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, u16>(payload), [1235, 0, 0, 65535, 65535]);
    }

    #[test]
    fn invalid_points_are_omitted() {
        let mut header = FrameHeader::new(Kind::PointCloud, Encoding::XyzRgbF32);
        header.set_packed(2, 1);
        header.payload_len = 64;
        let mut payload = [0_u8; 64];
        payload[..12].copy_from_slice(bytemuck::cast_slice(&[1.0_f32, 2.0, 3.0]));
        payload[16..20].copy_from_slice(&0x0010_2030_u32.to_le_bytes());
        payload[32..36].copy_from_slice(&f32::NAN.to_le_bytes());
        let message = encode("points", &FrameView::new(&header, &payload).unwrap(), false);
        let (object, points) = parts(&message);
        assert_eq!((object["points"].as_u64(), object["colour"].as_str()), (Some(1), Some("rgb")));
        assert_eq!(&points[12..], [0x10, 0x20, 0x30, 255]);
        assert_eq!(points.len(), 16);
    }
}
