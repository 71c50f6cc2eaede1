//! Independent detectors, the AprilTag library and zbar, and the list of the codes that they should find.
#![allow(dead_code, reason = "each test binary uses its own part of this")]

use glam::DVec3;
use image::GrayImage;
use std::path::Path;

/// A code of `tag_ceiling.tags.json`.
pub(crate) struct Listed {
    pub(crate) name: String,
    /// The id of an AprilTag, such as `7`, or the text of a QR code, such as `BV-007`.
    pub(crate) says: String,
    pub(crate) is_qr: bool,
    /// The edge of the black border in metres.
    pub(crate) edge_m: f64,
    /// The corners of the black border in the world, in the order of [`Seen::corners`].
    pub(crate) corners: [DVec3; 4],
}

impl Listed {
    /// The corners of the plate: the code with its white margin, 1 module around 8 or 4 around 21.
    pub(crate) fn plate(&self) -> [DVec3; 4] {
        let grow = if self.is_qr { 29.0 / 21.0 } else { 10.0 / 8.0 };
        let centre = self.corners.iter().sum::<DVec3>() / 4.0;
        self.corners.map(|corner| centre + (corner - centre) * grow)
    }
}

/// The codes on the ceiling of the tag room.
pub(crate) fn listed() -> Vec<Listed> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/worlds/tag_ceiling.tags.json");
    let json: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let code = |code: &serde_json::Value| {
        let corners: [[f64; 3]; 4] = serde_json::from_value(code["corners_m"].clone()).unwrap();
        let is_qr = code["family"] == "qr";
        Listed {
            name: code["name"].as_str().unwrap().into(),
            says: if is_qr { code["text"].as_str().unwrap().into() } else { code["id"].to_string() },
            is_qr,
            edge_m: code["edge_m"].as_f64().unwrap(),
            corners: corners.map(DVec3::from_array),
        }
    };
    json["codes"].as_array().unwrap().iter().map(code).collect()
}

/// A detection: the content of the code and its four corners in pixels, with pixel centres at integers, in the order
/// bottom left, bottom right, top right, top left.
pub(crate) struct Seen {
    pub(crate) says: String,
    pub(crate) corners: [[f64; 2]; 4],
}

/// Detects tags of family 36h11 with the AprilTag library.
pub(crate) fn april_tags(picture: &GrayImage) -> Vec<Seen> {
    let (width, height) = picture.dimensions();
    let mut image = apriltag::Image::zeros_with_alignment(width as usize, height as usize, 96).unwrap();
    for (x, y, pixel) in picture.enumerate_pixels() {
        image[(x as usize, y as usize)] = pixel.0[0];
    }
    let mut detector =
        apriltag::Detector::builder().add_family_bits(apriltag::Family::tag_36h11(), 1).build().unwrap();
    detector.set_decimation(1.0);
    let seen = |found: &apriltag::Detection| Seen {
        says: found.id().to_string(),
        // The library counts from the edge of the first pixel.
        corners: found.corners().map(|corner| corner.map(|value| value - 0.5)),
    };
    detector.detect(&image).iter().map(seen).collect()
}

/// Reads QR codes with the Rust port of zbar, in the whole picture and in overlapping parts of it: with many codes in
/// view, it combines marks of different codes. Its corners are whole pixels.
pub(crate) fn qr_codes(picture: &GrayImage) -> Vec<Seen> {
    let (width, height) = picture.dimensions();
    // Parts of half the picture's size at thirds of its width and height: each code in the picture is inside one of
    // them.
    let places =
        (0..16).map(|place| (place % 4 * (width / 6), place / 4 * (height / 6), width / 2, height / 2));
    let windows = std::iter::once((0, 0, width, height)).chain(places);
    let mut all: Vec<Seen> = Vec::new();
    for (left, top, width, height) in windows {
        let part = image::imageops::crop_imm(picture, left, top, width, height).to_image();
        let mut image = zedbar::Image::from_gray(part.as_raw(), width, height).unwrap();
        let config = zedbar::DecoderConfig::new().enable(zedbar::config::QrCode);
        for symbol in zedbar::Scanner::with_config(config).scan(&mut image).symbols() {
            let says = symbol.data_string().unwrap_or("").to_owned();
            // Counter-clockwise from the top left.
            let corner = |index: usize| {
                let point = symbol.points()[index];
                [f64::from(point.x) + f64::from(left), f64::from(point.y) + f64::from(top)]
            };
            if all.iter().all(|seen| seen.says != says) {
                all.push(Seen { says, corners: [1, 2, 3, 0].map(corner) });
            }
        }
    }
    all
}
