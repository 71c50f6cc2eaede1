//! Draws frames as pictures for people.
//!
//! Images stay unchanged. Depth is coloured from near (red) to far (blue), as on the page; missing depths are black,
//! those beyond the range dark grey. Scans and unorganised clouds are drawn as a plan seen from above: x (forward) up,
//! y (left) left, the sensor in the centre, with rings at a suitable distance.

use crate::colours::of_nearness;
use belvedere_bridge::{Encoding, FrameView, Kind};
use image::{Rgb, RgbImage};

/// The reason why a frame cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// A kind that cannot be drawn, such as odometry.
    #[error("a stream of kind {} has no picture; use echo", .0.map_or("unknown", Kind::as_str))]
    Kind(Option<Kind>),
    /// The frame has no pixels.
    #[error("the frame is empty")]
    Empty,
}

const NO_DATA: Rgb<u8> = Rgb([0, 0, 0]);
const BEYOND: Rgb<u8> = Rgb([48, 48, 48]);
/// Edge length of a plan in pixels.
const PLAN: u32 = 801;

/// Draws a frame of any kind that can be drawn.
///
/// # Errors
/// [`PictureError`] for other kinds.
pub fn draw(frame: &FrameView<'_>) -> Result<RgbImage, PictureError> {
    let header = frame.header();
    if header.width == 0 || header.height == 0 {
        return Err(PictureError::Empty);
    }
    match (header.kind(), header.encoding()) {
        (_, Some(Encoding::Rgb8)) => Ok(pixels(frame, |pixel: [u8; 3]| Rgb(pixel))),
        (_, Some(Encoding::Bgr8)) => Ok(pixels(frame, |[blue, green, red]: [u8; 3]| Rgb([red, green, blue]))),
        (_, Some(Encoding::Rgba8)) => {
            Ok(pixels(frame, |[red, green, blue, _]: [u8; 4]| Rgb([red, green, blue])))
        }
        (_, Some(Encoding::Mono8)) => Ok(pixels(frame, |grey: u8| Rgb([grey; 3]))),
        (_, Some(Encoding::Mono16)) => Ok(words(frame)),
        (_, Some(Encoding::BayerRggb8)) => {
            Ok(mosaic(&pixels(frame, |value: u8| Rgb([value; 3])), [0, 1, 1, 2]))
        }
        (_, Some(Encoding::BayerBggr8)) => {
            Ok(mosaic(&pixels(frame, |value: u8| Rgb([value; 3])), [2, 1, 1, 0]))
        }
        (_, Some(Encoding::BayerGbrg8)) => {
            Ok(mosaic(&pixels(frame, |value: u8| Rgb([value; 3])), [1, 2, 0, 1]))
        }
        (_, Some(Encoding::BayerGrbg8)) => {
            Ok(mosaic(&pixels(frame, |value: u8| Rgb([value; 3])), [1, 0, 2, 1]))
        }
        (_, Some(Encoding::BayerRggb16)) => Ok(mosaic(&words(frame), [0, 1, 1, 2])),
        (_, Some(Encoding::BayerBggr16)) => Ok(mosaic(&words(frame), [2, 1, 1, 0])),
        (_, Some(Encoding::BayerGbrg16)) => Ok(mosaic(&words(frame), [1, 2, 0, 1])),
        (_, Some(Encoding::BayerGrbg16)) => Ok(mosaic(&words(frame), [1, 0, 2, 1])),
        (_, Some(Encoding::F32C1 | Encoding::U16C1)) => Ok(depth(frame, &depths(frame).unwrap_or_default())),
        (_, Some(Encoding::F32C2)) => Ok(flow(frame)),
        (_, Some(Encoding::F32C3)) => Ok(pixels(frame, |normal: [f32; 3]| {
            Rgb(normal.map(|part| if normal == [0.0; 3] { 0 } else { ((part + 1.0) * 127.5) as u8 }))
        })),
        (_, Some(Encoding::I32C1)) => Ok(pixels(frame, |number: i32| number_colour(number))),
        (_, Some(Encoding::RangesF32)) => Ok(scan(frame)),
        (_, Some(Encoding::XyzRgbF32)) if header.height > 1 => {
            Ok(depth(frame, &depths(frame).unwrap_or_default()))
        }
        (_, Some(encoding)) if encoding.point().is_some() => {
            Ok(plan(frame.numbers(frame.rows()).map(|[x, y, _]: [f32; 3]| [x, y]), 0.0))
        }
        (kind, _) => Err(PictureError::Kind(kind)),
    }
}

/// Draws an image of the frame's size, with one value per pixel.
fn pixels<T: bytemuck::Pod>(frame: &FrameView<'_>, colour: impl Fn(T) -> Rgb<u8>) -> RgbImage {
    let mut picture = RgbImage::new(frame.header().width, frame.header().height);
    for (pixel, value) in picture.pixels_mut().zip(frame.numbers::<T>(frame.rows())) {
        *pixel = colour(value);
    }
    picture
}

/// Returns the colour of an instance or class: black for none, very different for consecutive numbers.
fn number_colour(number: i32) -> Rgb<u8> {
    if number < 0 {
        return Rgb([0; 3]);
    }
    // Steps of the golden ratio go round the circle of hues without coming close to earlier hues.
    let turn = f64::from(number) * 0.618_033_988_749_895;
    hue(turn.fract() as f32, 1.0)
}

/// Draws optical flow: its direction is the hue, red to the right; the longest vector in the image is the brightest.
fn flow(frame: &FrameView<'_>) -> RgbImage {
    let length = |[x, y]: [f32; 2]| libm::hypotf(x, y);
    let lengths = frame.numbers::<[f32; 2]>(frame.rows()).map(length);
    let longest = lengths.filter(|length| length.is_finite()).fold(f32::MIN_POSITIVE, f32::max);
    pixels(frame, |flow: [f32; 2]| {
        let turn = flow[1].atan2(flow[0]) / core::f32::consts::TAU;
        let share = length(flow) / longest;
        if share.is_finite() { hue(turn.rem_euclid(1.0), share) } else { Rgb([0; 3]) }
    })
}

/// Returns a pure hue, from 0 (red) over green and blue to 1 (red).
fn hue(turn: f32, brightness: f32) -> Rgb<u8> {
    let part = |offset: f32| {
        let distance = ((turn + offset).fract() * 6.0 - 3.0).abs() - 1.0;
        (distance.clamp(0.0, 1.0) * brightness * 255.0 + 0.5) as u8
    };
    Rgb([part(0.0), part(2.0 / 3.0), part(1.0 / 3.0)])
}

/// Draws 16-bit values as grey. The highest in the image is white, because a frame does not state the number of bits
/// used.
fn words(frame: &FrameView<'_>) -> RgbImage {
    let highest = frame.numbers::<u16>(frame.rows()).max().unwrap_or(0).max(1);
    pixels(frame, |value: u16| Rgb([(u32::from(value) * 255 / u32::from(highest)) as u8; 3]))
}

/// Converts a Bayer mosaic: each pixel gets the colours of the square of four that begins with it, or of its neighbour
/// at the far edges. `square` states which of red, green and blue the pixels of a square at even positions measure.
fn mosaic(seen: &RgbImage, square: [usize; 4]) -> RgbImage {
    let mut picture = RgbImage::new(seen.width(), seen.height());
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let (mut sum, mut count) = ([0_u16; 3], [0_u16; 3]);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let from = |at: u32, step: u32, size: u32| {
                if at + 1 < size { at + step } else { at.saturating_sub(step) }
            };
            let (x, y) = (from(x, dx, seen.width()), from(y, dy, seen.height()));
            let channel = square[(y % 2 * 2 + x % 2) as usize];
            sum[channel] += u16::from(seen[(x, y)][0]);
            count[channel] += 1;
        }
        *pixel = Rgb([0, 1, 2].map(|channel| (sum[channel] / count[channel].max(1)) as u8));
    }
    picture
}

/// Returns the distances in metres that are drawn as near and far for a depth image, or `None` for other frames.
#[must_use]
pub fn depth_range(frame: &FrameView<'_>) -> Option<[f32; 2]> {
    let is_depth = frame.header().kind() == Some(Kind::DepthImage);
    let range = depths(frame).filter(|_| is_depth).map(|depths| range(frame, &depths));
    range.filter(|[near, far]| near.is_finite() && far > near)
}

/// Returns the depths in metres of a frame that has depths.
fn depths(frame: &FrameView<'_>) -> Option<Vec<f32>> {
    match frame.header().encoding()? {
        Encoding::F32C1 => Some(frame.numbers(frame.rows()).collect()),
        Encoding::U16C1 => {
            let metres = |mm: u16| if mm == 0 { f32::NAN } else { f32::from(mm) / 1e3 };
            Some(frame.numbers(frame.rows()).map(metres).collect())
        }
        Encoding::XyzRgbF32 => Some(frame.numbers(frame.rows()).map(|[_, _, z]: [f32; 3]| z).collect()),
        _ => None,
    }
}

/// Returns the nearest and farthest depth that the frame's header allows, or that occur if the header states none.
fn range(frame: &FrameView<'_>, depths: &[f32]) -> [f32; 2] {
    let header = frame.header();
    let finite = || depths.iter().copied().filter(|depth| depth.is_finite());
    let (nearest, farthest) = (finite().fold(f32::INFINITY, f32::min), finite().fold(0.0, f32::max));
    let allowed = header.intrinsics().map(|intrinsics| [intrinsics.near, intrinsics.far.min(farthest)]);
    let is_range = |[near, far]: &[f32; 2]| near.is_finite() && *near > 0.0 && far > near;
    allowed.filter(is_range).unwrap_or([nearest, farthest])
}

/// Draws depths in metres as colours from near to far.
fn depth(frame: &FrameView<'_>, depths: &[f32]) -> RgbImage {
    let [near, far] = range(frame, depths);
    let span = (far - near).max(f32::MIN_POSITIVE);
    let mut picture = RgbImage::new(frame.header().width, frame.header().height);
    for (pixel, &depth) in picture.pixels_mut().zip(depths) {
        *pixel = if depth == f32::INFINITY {
            BEYOND
        } else if depth.is_finite() {
            Rgb(of_nearness(f64::from(1.0 - (depth - near) / span)))
        } else {
            NO_DATA
        };
    }
    picture
}

fn scan(frame: &FrameView<'_>) -> RgbImage {
    let header = frame.header();
    let geometry = header.scan_geometry().copied().unwrap_or_default();
    let width = (header.width as usize).max(1);
    let points = frame.numbers::<f32>(frame.rows()).enumerate().map(|(index, range_m)| {
        let angle = geometry.angle_min + (index % width) as f64 * geometry.angle_increment;
        let elevation =
            geometry.vertical_angle_min + (index / width) as f64 * geometry.vertical_angle_increment;
        let level_m = f64::from(range_m) * elevation.cos();
        [(level_m * angle.cos()) as f32, (level_m * angle.sin()) as f32]
    });
    plan(points, 1.0)
}

/// Draws points in metres (x forward, y left) seen from above. The scale shows the farthest point, and at least
/// `min_reach_m`.
fn plan(points: impl Iterator<Item = [f32; 2]>, min_reach_m: f32) -> RgbImage {
    const PAPER: Rgb<u8> = Rgb([255, 255, 255]);
    const RING: Rgb<u8> = Rgb([205, 212, 220]);
    const SENSOR: Rgb<u8> = Rgb([200, 40, 40]);
    let points: Vec<[f32; 2]> = points.filter(|[x, y]| libm::hypotf(*x, *y).is_finite()).collect();
    let farthest_m = points.iter().map(|[x, y]| libm::hypotf(*x, *y)).fold(min_reach_m.max(1e-3), f32::max);
    let middle = (PLAN / 2) as f32;
    let scale = (middle - 4.0) / farthest_m;
    let mut picture = RgbImage::from_pixel(PLAN, PLAN, PAPER);

    let ring_m = ring_distance(farthest_m);
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let radius = libm::hypotf(x as f32 - middle, y as f32 - middle);
        let ring = (radius / (ring_m * scale)).round();
        if ring >= 1.0 && (radius - ring * ring_m * scale).abs() < 0.6 {
            *pixel = RING;
        }
    }
    let mut dot = |x: f32, y: f32, reach: i32, colour: Rgb<u8>| {
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (x, y) = (x.round() as i32 + dx, y.round() as i32 + dy);
                if (0..PLAN as i32).contains(&x) && (0..PLAN as i32).contains(&y) {
                    picture.put_pixel(x as u32, y as u32, colour);
                }
            }
        }
    };
    for [forward, left] in &points {
        let nearness = 1.0 - libm::hypotf(*forward, *left) / farthest_m;
        dot(middle - left * scale, middle - forward * scale, 1, on_paper(of_nearness(f64::from(nearness))));
    }
    dot(middle, middle, 3, SENSOR);
    // A mark that points forward.
    for step in 4..12 {
        dot(middle, middle - step as f32, 0, SENSOR);
    }
    picture
}

/// Returns 1, 2 or 5 times a power of ten metres, at least 0.1 m, so that there are at most ten rings.
fn ring_distance(farthest_m: f32) -> f32 {
    let mut decade = 0.1;
    loop {
        for step in [1.0, 2.0, 5.0] {
            let ring_m: f32 = decade * step;
            if ring_m >= 1.0_f32.min(farthest_m) && farthest_m / ring_m <= 10.0 {
                return ring_m;
            }
        }
        decade *= 10.0;
    }
}

/// Darkens a colour, because the bright middle of the map would be invisible on white.
fn on_paper(colour: [u8; 3]) -> Rgb<u8> {
    Rgb(colour.map(|part| (f32::from(part) * 0.75) as u8))
}

#[cfg(test)]
mod tests {
    use belvedere_bridge::{FrameHeader, Intrinsics, ScanGeometry};

    use super::*;

    fn view<'a>(header: &'a mut FrameHeader, width: u32, height: u32, payload: &'a [u8]) -> FrameView<'a> {
        header.set_packed(width, height);
        header.payload_len = payload.len() as u64;
        FrameView::new(header, payload).unwrap()
    }

    #[test]
    fn images_keep_their_colours() {
        let payload = [1, 2, 3, 4, 5, 6];
        let mut header = FrameHeader::new(Kind::Image, Encoding::Rgb8);
        let picture = draw(&view(&mut header, 2, 1, &payload)).unwrap();
        assert_eq!((picture[(0, 0)], picture[(1, 0)]), (Rgb([1, 2, 3]), Rgb([4, 5, 6])));
        let mut header = FrameHeader::new(Kind::Image, Encoding::Bgr8);
        let picture = draw(&view(&mut header, 2, 1, &payload)).unwrap();
        assert_eq!(picture[(1, 0)], Rgb([6, 5, 4]));
        let mut header = FrameHeader::new(Kind::Image, Encoding::Mono8);
        let picture = draw(&view(&mut header, 3, 2, &payload)).unwrap();
        assert_eq!(picture[(2, 1)], Rgb([6, 6, 6]));
        // The highest 16-bit value is white.
        let mut header = FrameHeader::new(Kind::Image, Encoding::Mono16);
        let picture = draw(&view(&mut header, 3, 1, &payload)).unwrap();
        assert_eq!(picture[(2, 0)], Rgb([255; 3]));
        assert_eq!(picture[(0, 0)], Rgb([(0x0201 * 255 / 0x0605) as u8; 3]));
        // Blue and green over green and red: each pixel has the colours of its square.
        let mut header = FrameHeader::new(Kind::Image, Encoding::BayerBggr8);
        let picture = draw(&view(&mut header, 3, 2, &payload)).unwrap();
        assert_eq!((picture[(0, 0)], picture[(1, 0)]), (Rgb([5, 3, 1]), Rgb([5, 4, 3])));
        let mut header = FrameHeader::new(Kind::Image, Encoding::Rgba8);
        let picture = draw(&view(&mut header, 1, 1, &payload[..4])).unwrap();
        assert_eq!(picture[(0, 0)], Rgb([1, 2, 3]));
    }

    #[test]
    fn padded_rows_are_not_shown() {
        let header = FrameHeader {
            width: 2,
            height: 2,
            elem_stride: 1,
            row_stride: 4,
            payload_len: 8,
            ..FrameHeader::new(Kind::Image, Encoding::Mono8)
        };
        let picture = draw(&FrameView::new(&header, &[1, 2, 99, 99, 3, 4, 99, 99]).unwrap()).unwrap();
        assert_eq!(picture.pixels().map(|pixel| pixel[0]).collect::<Vec<_>>(), [1, 2, 3, 4]);
    }

    #[test]
    fn near_is_red_far_is_blue_and_nothing_is_black() {
        let depths = [1.0, 2.0, 4.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let mut header = FrameHeader::new(Kind::DepthImage, Encoding::F32C1);
        header.set_intrinsics(&Intrinsics { near: 0.4, far: 5.0, ..Intrinsics::default() });
        let frame = view(&mut header, 6, 1, bytemuck::cast_slice(&depths));
        assert_eq!(depth_range(&frame), Some([0.4, 4.0]));
        let picture = draw(&frame).unwrap();
        let warmth = |x| i32::from(picture[(x, 0)][0]) - i32::from(picture[(x, 0)][2]);
        assert!(warmth(0) > 150 && warmth(1) > warmth(2) && warmth(2) <= 0);
        assert_eq!((picture[(3, 0)], picture[(4, 0)], picture[(5, 0)]), (NO_DATA, BEYOND, NO_DATA));

        let millimetres: [u16; 3] = [1000, 4000, 0];
        let mut header = FrameHeader::new(Kind::DepthImage, Encoding::U16C1);
        let picture = draw(&view(&mut header, 3, 1, bytemuck::cast_slice(&millimetres))).unwrap();
        assert_eq!(picture[(2, 0)], NO_DATA);
        assert_ne!(picture[(0, 0)], picture[(1, 0)]);
    }

    #[test]
    fn a_scan_is_a_plan_with_forward_up() {
        // Forward at 2 m, left at 1 m, nothing behind, too near on the right.
        let ranges = [2.0, 1.0, f32::INFINITY, f32::NEG_INFINITY];
        let mut header = FrameHeader::new(Kind::LaserScan, Encoding::RangesF32);
        header.set_scan_geometry(&ScanGeometry {
            angle_increment: std::f64::consts::FRAC_PI_2,
            ..ScanGeometry::default()
        });
        let picture = draw(&view(&mut header, 4, 1, bytemuck::cast_slice(&ranges))).unwrap();
        let dark =
            |x: u32, y: u32| picture[(x, y)].0.iter().map(|&value| u32::from(value)).sum::<u32>() < 500;
        assert!(dark(400, 4), "2 m forward reaches the upper edge");
        assert!(dark(202, 400), "1 m to the left is half way");
        assert!(!dark(598, 400) && !dark(400, 796), "nothing else is there");
    }

    #[test]
    fn rings_stay_countable() {
        assert_eq!(ring_distance(3.5), 1.0);
        assert_eq!(ring_distance(0.5), 0.5);
        for farthest_m in [0.001, 0.3, 1.0, 9.0, 30.0, 100.0, 1e6] {
            assert!(farthest_m / ring_distance(farthest_m) <= 10.0);
        }
    }

    #[test]
    fn kinds_that_cannot_be_drawn_are_refused() {
        let payload = [0; 8];
        let mut header = FrameHeader::new(Kind::Clock, Encoding::Struct);
        let error = draw(&view(&mut header, 1, 1, &payload)).unwrap_err();
        assert!(error.to_string().contains("echo"), "{error}");
        let header = FrameHeader::new(Kind::Image, Encoding::Rgb8);
        assert_eq!(draw(&FrameView::new(&header, &[]).unwrap()), Err(PictureError::Empty));
    }
}
