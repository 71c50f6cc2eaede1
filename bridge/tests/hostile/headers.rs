//! Headers that no correct publisher writes, and their validity by WIRE.md.

use std::{collections::BTreeMap, sync::OnceLock};

use belvedere_bridge::{Encoding, FrameHeader, Kind, Text};
use bytemuck::Zeroable as _;

use crate::processes_kit::Random;

/// The largest payload that accompanies them.
pub(crate) const PAYLOAD_LEN: usize = 4096;

const KINDS: [u16; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, u16::MAX];
const ENCODINGS: [u16; 11] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, u16::MAX];
const WORDS: [u64; 8] = [0, 1, 2, 0x7fff_ffff_ffff_ffff, 1 << 63, u64::MAX - 1, u64::MAX, u64::MAX / 3];
const SIZES: [u32; 20] = [
    0,
    1,
    2,
    3,
    4,
    5,
    7,
    8,
    31,
    32,
    33,
    64,
    744,
    4095,
    4096,
    65_536,
    0x7fff_ffff,
    0x8000_0000,
    u32::MAX - 1,
    u32::MAX,
];
const LENGTHS: [u64; 12] =
    [0, 1, 63, 64, 4095, 4096, 4097, 1 << 31, 1 << 32, 1 << 63, u64::MAX - 1, u64::MAX];
/// Payload sizes that the transport delivers.
const AVAILABLE: [usize; 6] = [0, 1, 64, 1000, 4095, PAYLOAD_LEN];
/// Bytes that are not valid text.
const BYTES: [u8; 4] = [0, 0x80, 0xc3, 0xff];

/// A header, and the number of payload bytes that accompany it.
pub(crate) struct Case {
    pub(crate) header: FrameHeader,
    pub(crate) available: usize,
}

/// Returns a valid header of 4 × 3 elements.
fn honest(kind: u16, encoding: u16) -> FrameHeader {
    let mut header = FrameHeader { kind, encoding, ..FrameHeader::default() };
    let structs = header.encoding() == Some(Encoding::Struct);
    header.payload_len = header.set_packed(if structs { 1 } else { 4 }, 3) as u64;
    header.session = 77;
    header
}

/// Returns headers in which one field takes its boundary values, for every kind in every encoding.
pub(crate) fn one_field_wrong() -> Vec<Case> {
    let mut cases = Vec::new();
    for (kind, encoding) in KINDS.into_iter().flat_map(|kind| ENCODINGS.map(|encoding| (kind, encoding))) {
        let honest = honest(kind, encoding);
        let mut add = |header| cases.push(Case { header, available: PAYLOAD_LEN });
        add(honest);
        for magic in [0, !FrameHeader::MAGIC, FrameHeader::MAGIC.swap_bytes(), FrameHeader::MAGIC + 1] {
            add(FrameHeader { magic, ..honest });
        }
        for header_len in [0, 256, 383, 385, u16::MAX] {
            add(FrameHeader { header_len, ..honest });
        }
        for schema in [0, 1, 3, u16::MAX] {
            add(FrameHeader { schema, ..honest });
        }
        for flags in [1, 2, 3, u32::MAX] {
            add(FrameHeader { flags, ..honest });
        }
        for word in WORDS {
            add(FrameHeader { seq: word, ..honest });
            add(FrameHeader { session: word, ..honest });
            add(FrameHeader { stamp_ns: word, ..honest });
            add(FrameHeader { publish_mono_ns: word, ..honest });
            add(FrameHeader { block: [word; 26], ..honest });
            add(FrameHeader { position: [f64::from_bits(word); 3], ..honest });
            add(FrameHeader { orientation: [f32::from_bits(word as u32); 4], ..honest });
        }
        for size in SIZES {
            add(FrameHeader { width: size, ..honest });
            add(FrameHeader { height: size, ..honest });
            add(FrameHeader { row_stride: size, ..honest });
            add(FrameHeader { elem_stride: size, ..honest });
        }
        let len = honest.payload_len;
        for payload_len in LENGTHS.into_iter().chain([len.wrapping_sub(1), len + 1]) {
            add(FrameHeader { payload_len, ..honest });
        }
        for byte in BYTES {
            add(FrameHeader { frame_id: text_of(byte), ..honest });
        }
        // Narrow rows of wide elements: more structs than fit into the payload.
        add(FrameHeader {
            width: 1,
            height: 4000,
            row_stride: 1,
            elem_stride: 744,
            payload_len: PAYLOAD_LEN as u64,
            ..honest
        });
        for available in AVAILABLE {
            cases.push(Case { header: honest, available });
        }
    }
    cases
}

/// Returns a header with several wrong fields, most of which nearly fit.
pub(crate) fn at_random(random: &mut Random) -> Case {
    let mut header = honest(random.one_of(&KINDS), random.one_of(&ENCODINGS));
    let available = random.one_of(&AVAILABLE);
    header.payload_len = match random.below(4) {
        0 => random.one_of(&LENGTHS),
        1 => random.next(),
        _ => available as u64,
    };
    let mut size = |usual: u64| match random.below(8) {
        0 => random.one_of(&SIZES),
        1 => random.next() as u32,
        _ => random.below(usual) as u32,
    };
    header.width = size(24);
    header.height = size(24);
    header.elem_stride = size(48);
    header.row_stride = size(400);
    header.flags = random.one_of(&[0, 0, 1, u32::MAX]);
    header.seq = random.one_of(&WORDS);
    header.session = random.one_of(&[77, 77, 1, u64::MAX]);
    header.stamp_ns = random.one_of(&WORDS);
    header.publish_mono_ns = random.one_of(&WORDS);
    header.frame_id = text_of(random.one_of(&BYTES));
    header.block = [random.next(); 26];
    match random.below(40) {
        0 => header.magic = random.next() as u32,
        1 => header.schema = random.next() as u16,
        2 => header.header_len = random.next() as u16,
        _ => {}
    }
    Case { header, available }
}

/// Returns a text of 64 times this byte, valid or not.
fn text_of(byte: u8) -> Text<64> {
    let mut header = FrameHeader::zeroed();
    bytemuck::bytes_of_mut(&mut header)[72..136].fill(byte);
    header.frame_id
}

/// Returns the size of the struct of each kind, out of the tables of WIRE.md.
fn struct_sizes() -> &'static BTreeMap<u16, u128> {
    static SIZES: OnceLock<BTreeMap<u16, u128>> = OnceLock::new();
    SIZES.get_or_init(|| {
        let text = include_str!("../../WIRE.md");
        let sizes: BTreeMap<&str, u128> = text
            .lines()
            .filter_map(|line| line.strip_prefix("**")?.split_once("**, "))
            .map(|(name, rest)| (name, rest.split_once(" bytes: ").unwrap().0.parse().unwrap()))
            .collect();
        let (_, kinds) = text.split_once("## Kinds\n").unwrap();
        let (kinds, _) = kinds.split_once("## Encodings\n").unwrap();
        let of_kind = |row: &str| {
            let [number, _, payload] = row.split('|').skip(1).collect::<Vec<_>>()[..3] else {
                unreachable!()
            };
            // "one Imu", "Transform[], valid at stamp_ns"
            let payload = payload.trim().trim_start_matches("one ");
            let name = payload.split(|letter: char| !letter.is_alphanumeric()).next()?;
            Some((number.trim().parse().ok()?, *sizes.get(name)?))
        };
        let of_kinds: BTreeMap<u16, u128> =
            kinds.lines().filter(|line| line.starts_with('|')).filter_map(of_kind).collect();
        let without = Kind::ALL.iter().filter(|kind| !of_kinds.contains_key(&kind.to_wire()));
        assert_eq!(
            without.copied().collect::<Vec<_>>(),
            [Kind::Image, Kind::DepthImage, Kind::LaserScan, Kind::PointCloud],
            "kinds without a struct in WIRE.md"
        );
        of_kinds
    })
}

/// Returns true if a reader may use the header: the rules of WIRE.md, in numbers that cannot overflow.
pub(crate) fn is_acceptable(case: &Case) -> bool {
    let header = &case.header;
    let element: u128 = match header.encoding {
        1 | 2 => 3,
        4 | 7 | 9 | 21 => 4,
        5 | 10 | 15..=18 => 2,
        6 => 32,
        19 => 8,
        20 => 12,
        8 => struct_sizes().get(&header.kind).copied().unwrap_or(1),
        _ => 1,
    };
    if (header.magic, header.schema, header.header_len) != (0x4456_4C42, 2, 384)
        || u128::from(header.payload_len) > case.available as u128
    {
        return false;
    }
    let [width, height, row_stride, elem_stride] =
        [header.width, header.height, header.row_stride, header.elem_stride].map(u128::from);
    if width == 0 || height == 0 {
        return true;
    }
    let planes = if header.flags & 1 == 0 { 1 } else { 2 };
    let row = (width - 1) * elem_stride + element;
    let end = (planes - 1) * height * row_stride + (height - 1) * row_stride + row;
    elem_stride >= element && (height == 1 || row_stride >= row) && end <= u128::from(header.payload_len)
}
