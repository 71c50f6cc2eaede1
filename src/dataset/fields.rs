//! Converts frames to files that training code reads: images as PNG, everything else as numpy's npy.

use super::plan::FLOW;
use belvedere_bridge::point::{Number, PointLayout};
use belvedere_bridge::{Encoding, FrameHeader, FrameView};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};

/// A file of a sample.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    /// The part of the file name after the sample's number and a dot.
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
}

/// Returns the files of a stream's frame, or `None` for kinds that have no files, such as messages.
pub(super) fn of_stream(name: &str, frame: &FrameView<'_>) -> Option<Vec<Field>> {
    let header = frame.header();
    let [rows, columns] = [header.height, header.width];
    let png = |colour, bytes: Vec<u8>| Field {
        name: format!("{name}.png"),
        bytes: png(columns, rows, colour, &bytes),
    };
    let packed = || frame.rows().flatten().copied().collect::<Vec<u8>>();
    let field = match header.encoding()? {
        Encoding::Rgb8 => png(ExtendedColorType::Rgb8, packed()),
        Encoding::Bgr8 => {
            let mut bytes = packed();
            bytes.as_chunks_mut::<3>().0.iter_mut().for_each(|pixel| pixel.swap(0, 2));
            png(ExtendedColorType::Rgb8, bytes)
        }
        Encoding::Rgba8 => png(ExtendedColorType::Rgba8, packed()),
        Encoding::Mono8
        | Encoding::BayerRggb8
        | Encoding::BayerBggr8
        | Encoding::BayerGbrg8
        | Encoding::BayerGrbg8 => png(ExtendedColorType::L8, packed()),
        // The encoder converts from the machine's byte order, which is the wire's, to PNG's.
        Encoding::Mono16
        | Encoding::BayerRggb16
        | Encoding::BayerBggr16
        | Encoding::BayerGbrg16
        | Encoding::BayerGrbg16 => png(ExtendedColorType::L16, packed()),
        encoding => {
            let kind = numbers(encoding)?;
            let npy = |name, bytes: &[u8]| Field { name, bytes: npy(&kind, [rows, columns], bytes) };
            let mut fields = vec![npy(format!("{name}.npy"), &packed())];
            if header.has_intensities() {
                let bytes: Vec<u8> = frame.intensity_rows().flatten().copied().collect();
                fields.push(npy(format!("{name}.intensity.npy"), &bytes));
            }
            return Some(fields);
        }
    };
    Some(vec![field])
}

/// Returns the file of a truth channel. A missing frame is optical flow without a previous frame, which has no values.
pub(super) fn of_truth(
    name: &str,
    channel: &str,
    frame: Option<&FrameView<'_>>,
    size: [u32; 2],
) -> Option<Field> {
    let name = format!("{name}.{channel}.npy");
    if let Some(frame) = frame {
        let header = frame.header();
        let bytes: Vec<u8> = frame.rows().flatten().copied().collect();
        let kind = numbers(header.encoding()?)?;
        return Some(Field { name, bytes: npy(&kind, [header.height, header.width], &bytes) });
    }
    let [columns, rows] = size;
    let nothing = f32::NAN.to_le_bytes().repeat(2 * columns as usize * rows as usize);
    let kind = numbers(Encoding::F32C2)?;
    (channel == FLOW).then(|| Field { name, bytes: npy(&kind, [rows, columns], &nothing) })
}

/// Returns width and height.
pub(super) fn size(header: &FrameHeader) -> [u32; 2] {
    [header.width, header.height]
}

fn png(width: u32, height: u32, colour: ExtendedColorType, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Fixed settings and no metadata, so that the same pixels give the same bytes.
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive);
    if let Err(error) = encoder.write_image(pixels, width, height, colour) {
        // This does not happen: it is written to memory, and the size matches the pixels.
        tracing::error!(%error, width, height, "an image cannot be encoded");
    }
    bytes
}

/// numpy's type of an element, and the axes after rows and columns.
struct Numbers {
    descr: String,
    axes: &'static [u32],
}

/// Returns numpy's type of an element, or `None` if it is not numeric.
fn numbers(encoding: Encoding) -> Option<Numbers> {
    let plain = |descr: &str, axes| Some(Numbers { descr: format!("'{descr}'"), axes });
    match encoding {
        Encoding::F32C1 | Encoding::RangesF32 => plain("<f4", &[]),
        Encoding::U16C1 => plain("<u2", &[]),
        Encoding::F32C2 => plain("<f4", &[2]),
        Encoding::F32C3 => plain("<f4", &[3]),
        Encoding::I32C1 => plain("<i4", &[]),
        _ => encoding.point().map(|point| Numbers { descr: structured(point), axes: &[] }),
    }
}

/// Returns numpy's type of a point.
fn structured(point: &PointLayout) -> String {
    let mut fields = Vec::new();
    let mut end = 0;
    // A field without a name is padding.
    let pad = |fields: &mut Vec<String>, from: usize, to: usize| {
        if from < to {
            fields.push(format!("('', '|V{}')", to - from));
        }
    };
    for field in point.fields {
        pad(&mut fields, end, field.offset);
        let descr = match field.number {
            Number::U8 => "|u1",
            Number::U16 => "<u2",
            Number::U32 => "<u4",
            Number::F32 | Number::Colour => "<f4",
            Number::F64 => "<f8",
        };
        fields.push(format!("('{}', '{descr}')", field.name));
        end = field.offset + field.number.size();
    }
    pad(&mut fields, end, point.size);
    format!("[{}]", fields.join(", "))
}

/// Returns an array in npy format 1.0: magic, length of the header, the header as a Python literal, rows one after the
/// other.
fn npy(kind: &Numbers, [rows, columns]: [u32; 2], bytes: &[u8]) -> Vec<u8> {
    let axes: Vec<String> = [rows, columns].iter().chain(kind.axes).map(u32::to_string).collect();
    let mut header =
        format!("{{'descr': {}, 'fortran_order': False, 'shape': ({}), }}", kind.descr, axes.join(", "));
    // The data start at a multiple of 64 bytes, and the header ends with a newline.
    let begin = (10 + header.len() + 1).next_multiple_of(64);
    header.push_str(&" ".repeat(begin - 10 - header.len() - 1));
    header.push('\n');
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend((header.len() as u16).to_le_bytes());
    array.extend(header.as_bytes());
    array.extend(bytes);
    array
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The types are those of data sets that exist.
    #[test]
    fn points_have_numpys_types() {
        let xyz = "('x', '<f4'), ('y', '<f4'), ('z', '<f4')";
        for (encoding, own) in [
            (Encoding::XyzRgbF32, "('', '|V4'), ('rgb', '<f4'), ('', '|V12')"),
            (Encoding::XyzIrF32, "('intensity', '<f4'), ('ring', '<u2')"),
            (Encoding::XyzIrtF32, "('intensity', '<f4'), ('ring', '<u2'), ('time', '<f4')"),
            (
                Encoding::OusterPoint,
                "('', '|V4'), ('intensity', '<f4'), ('t', '<u4'), ('reflectivity', '<u2'), ('ring', '<u2'), \
                 ('ambient', '<u2'), ('', '|V2'), ('range', '<u4'), ('', '|V12')",
            ),
            (
                Encoding::LivoxPoint,
                "('intensity', '<f4'), ('tag', '|u1'), ('line', '|u1'), ('timestamp', '<f8')",
            ),
        ] {
            assert_eq!(numbers(encoding).unwrap().descr, format!("[{xyz}, {own}]"), "{encoding}");
        }
    }
}
