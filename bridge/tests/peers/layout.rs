//! The header as bytes, as readers in other languages see it.

use belvedere_bridge::{Encoding, FrameError, FrameHeader, Intrinsics, Kind, ScanGeometry, Text};

fn image(width: u32, height: u32) -> (FrameHeader, usize) {
    let mut header = FrameHeader::new(Kind::Image, Encoding::Rgb8);
    let len = header.set_packed(width, height);
    header.payload_len = len as u64;
    (header, len)
}

/// Sets every field to its own value and finds it at its offset.
#[test]
fn every_field_lies_where_the_wire_format_says() {
    let mut header = FrameHeader {
        flags: 0x0102_0304,
        seq: 0x1112_1314_1516_1718,
        session: 0x2122_2324_2526_2728,
        stamp_ns: 0x3132_3334_3536_3738,
        publish_mono_ns: 0x4142_4344_4546_4748,
        width: 0x5152_5354,
        height: 0x6162_6364,
        row_stride: 0x7172_7374,
        elem_stride: 0x8182_8384,
        payload_len: 0x9192_9394_9596_9798,
        frame_id: Text::new("odom").unwrap(),
        position: [1.5, -2.5, 3.5],
        orientation: [0.25, 0.5, 0.75, 1.0],
        ..FrameHeader::new(Kind::DepthImage, Encoding::U16C1)
    };
    header.set_intrinsics(&Intrinsics {
        fx: 1.0,
        fy: 2.0,
        cx: 3.0,
        cy: 4.0,
        skew: 8.0,
        distortion: std::array::from_fn(|index| 0.1 * index as f64),
        near: 5.0,
        far: 6.0,
        tx: 7.0,
        distortion_model: 0xA1A2,
        distortion_len: 0xB1B2,
        reserved: [0xC1C2_C3C4_C5C6_C7C8; 5],
    });
    let mut expected = Vec::new();
    expected.extend(b"BLVD");
    expected.extend(384_u16.to_le_bytes());
    expected.extend(2_u16.to_le_bytes());
    expected.extend(2_u16.to_le_bytes());
    expected.extend(5_u16.to_le_bytes());
    expected.extend(0x0102_0304_u32.to_le_bytes());
    for value in
        [0x1112_1314_1516_1718_u64, 0x2122_2324_2526_2728, 0x3132_3334_3536_3738, 0x4142_4344_4546_4748]
    {
        expected.extend(value.to_le_bytes());
    }
    for value in [0x5152_5354_u32, 0x6162_6364, 0x7172_7374, 0x8182_8384] {
        expected.extend(value.to_le_bytes());
    }
    expected.extend(0x9192_9394_9596_9798_u64.to_le_bytes());
    expected.extend(b"odom");
    expected.resize(136, 0);
    expected.extend([1.5_f64, -2.5, 3.5].iter().flat_map(|value| value.to_le_bytes()));
    expected.extend([0.25_f32, 0.5, 0.75, 1.0].iter().flat_map(|value| value.to_le_bytes()));
    assert_eq!(expected.len(), 176);
    expected.extend([1.0_f64, 2.0, 3.0, 4.0, 8.0].iter().flat_map(|value| value.to_le_bytes()));
    expected.extend((0..14).flat_map(|index| (0.1 * f64::from(index)).to_le_bytes()));
    expected.extend([5.0_f32, 6.0, 7.0].iter().flat_map(|value| value.to_le_bytes()));
    expected.extend([0xA1A2_u16, 0xB1B2].iter().flat_map(|value| value.to_le_bytes()));
    expected.extend([0xC1C2_C3C4_C5C6_C7C8_u64; 5].iter().flat_map(|value| value.to_le_bytes()));
    assert_eq!(bytemuck::bytes_of(&header), expected);
}

#[test]
fn blocks_belong_to_their_kinds() {
    let geometry = ScanGeometry {
        angle_min: -1.0,
        angle_increment: 0.5,
        range_max: 9.0,
        vertical_angle_increment: 0.25,
        ..ScanGeometry::default()
    };
    let mut scan = FrameHeader::new(Kind::LaserScan, Encoding::RangesF32);
    scan.set_scan_geometry(&geometry);
    assert_eq!(scan.scan_geometry(), Some(&geometry));
    assert_eq!(scan.intrinsics(), None);
    assert_eq!(geometry.angle_max(5), 1.0);
    let (image, _) = image(4, 3);
    assert!(image.intrinsics().is_some());
    assert!(image.scan_geometry().is_none());
}

#[test]
fn good_geometry_passes() {
    let (header, len) = image(640, 480);
    assert_eq!(header.check(len), Ok(()));
    // The last row may be unpadded.
    let padded = FrameHeader { row_stride: 2048, payload_len: 479 * 2048 + 1920, ..header };
    assert_eq!(padded.check(479 * 2048 + 1920), Ok(()));
    // An empty frame is valid: an empty list of transforms.
    assert_eq!(FrameHeader::new(Kind::Transforms, Encoding::Struct).check(0), Ok(()));
    // An unknown kind or encoding of a later version is not an error.
    assert_eq!(FrameHeader { kind: 999, encoding: 999, ..header }.check(len), Ok(()));
}

#[test]
fn bad_headers_are_refused() {
    let (good, len) = image(640, 480);
    let scan = {
        let mut scan = FrameHeader::new(Kind::LaserScan, Encoding::RangesF32);
        scan.payload_len = scan.set_packed(360, 1) as u64;
        scan
    };
    for (bad, available) in [
        (FrameHeader { magic: 0, ..good }, len),
        (FrameHeader { schema: 1, ..good }, len),
        (FrameHeader { header_len: 128, ..good }, len),
        (good, len - 1),
        (FrameHeader { payload_len: u64::MAX, ..good }, len),
        (FrameHeader { height: 481, ..good }, len),
        (FrameHeader { width: u32::MAX, ..good }, len),
        (FrameHeader { elem_stride: 2, ..good }, len),
        (FrameHeader { elem_stride: 0, row_stride: 0, ..good }, len),
        (FrameHeader { row_stride: 1919, ..good }, len),
        (FrameHeader { flags: FrameHeader::HAS_INTENSITIES, ..good }, len),
        (FrameHeader { flags: FrameHeader::HAS_INTENSITIES, ..scan }, 1440),
        (FrameHeader { kind: Kind::Odometry.to_wire(), encoding: Encoding::Struct.to_wire(), ..good }, len),
        (
            FrameHeader {
                width: u32::MAX,
                height: u32::MAX,
                row_stride: u32::MAX,
                elem_stride: u32::MAX,
                flags: FrameHeader::HAS_INTENSITIES,
                ..good
            },
            len,
        ),
    ] {
        assert!(bad.check(available).is_err(), "{bad:?}");
    }
    assert_eq!(
        good.check(len - 1).unwrap_err(),
        FrameError::PayloadLen { claimed: len as u64, available: len as u64 - 1 }
    );
}
