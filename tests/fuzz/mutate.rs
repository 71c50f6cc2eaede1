//! Mutations of files: of their bytes, of the words and elements of texts, and of the numbers of binary files.

use crate::formats::Format;
use crate::random::Random;

/// The longest input, bytes.
pub(crate) const LARGEST: usize = 1 << 16;

/// Numbers at the limits of types, and beyond.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "7",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "1e9",
    "1e18",
    "1e-40",
    "1e38",
    "1e308",
    "1e999",
    "nan",
    "-inf",
];
/// Integers at the limits of types.
const INTEGERS: [u64; 14] =
    [0, 1, 2, 3, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x1_0000, 0x7fff_ffff, 0xffff_ffff, 1 << 40, u64::MAX];
/// Floating-point numbers as bits.
const FLOATS: [f32; 8] = [0.0, -1.0, 1e-40, 1e38, f32::MAX, f32::INFINITY, f32::NAN, 0.5];

/// Returns a mutation of one of the inputs of `pool`.
pub(crate) fn mutate(random: &mut Random, pool: &[Vec<u8>], format: &Format) -> Vec<u8> {
    let mut input = pick(random, pool).clone();
    for _ in 0..=random.below(6) {
        let donor = pick(random, pool);
        let kind = random.below(10);
        if format.is_xml && kind < 4 {
            elements(random, &mut input, donor);
        } else if !format.is_binary && kind < 8 {
            words(random, &mut input, donor, format);
        } else if format.is_binary && kind < 5 {
            integers(random, &mut input);
        } else {
            bytes(random, &mut input, donor, format);
        }
    }
    input.truncate(LARGEST);
    if let Some(repair) = format.repair {
        repair(&mut input);
    }
    input
}

fn pick<'p>(random: &mut Random, pool: &'p [Vec<u8>]) -> &'p Vec<u8> {
    &pool[random.below(pool.len() as u64) as usize]
}

fn place(random: &mut Random, bytes: &[u8]) -> usize {
    random.below(bytes.len() as u64 + 1) as usize
}

/// A range of `bytes` that is usually short.
fn range(random: &mut Random, bytes: &[u8]) -> std::ops::Range<usize> {
    let start = place(random, bytes);
    let most = random.one_of(&[1, 4, 16, 64, 1024]);
    start..bytes.len().min(start + random.below(most + 1) as usize)
}

fn replace(input: &mut Vec<u8>, range: std::ops::Range<usize>, new: &[u8]) {
    if input.len() - range.len() + new.len() <= LARGEST {
        input.splice(range, new.iter().copied());
    }
}

fn bytes(random: &mut Random, input: &mut Vec<u8>, donor: &[u8], format: &Format) {
    let target = range(random, input);
    match random.below(7) {
        0 | 1 if !input.is_empty() => {
            let at = random.below(input.len() as u64) as usize;
            input[at] ^= 1 << random.below(8);
        }
        2 => replace(
            input,
            target.start..target.start,
            &random.next().to_le_bytes()[..=(target.len() % 8).min(7)],
        ),
        3 => replace(input, target, &[]),
        4 => {
            let count = random.one_of(&[2, 3, 50, 400]);
            let repeated = input[target.clone()].repeat(count);
            replace(input, target, &repeated);
        }
        5 if !format.tokens.is_empty() => {
            let token = random.one_of(format.tokens);
            replace(input, target.start..target.start, token.as_bytes());
        }
        _ => {
            let source = range(random, donor);
            replace(input, target, &donor[source]);
        }
    }
}

/// Replaces a number of one to eight bytes.
fn integers(random: &mut Random, input: &mut [u8]) {
    let width = random.one_of(&[1, 2, 4, 4, 8]);
    if input.len() < width {
        return;
    }
    // Headers are short.
    let most = if random.below(2) == 0 { input.len().min(128).max(width) } else { input.len() };
    let at = random.below((most - width + 1) as u64) as usize;
    let number = if width == 4 && random.below(3) == 0 {
        u64::from(random.one_of(&FLOATS).to_bits())
    } else {
        random.one_of(&INTEGERS)
    };
    if random.below(2) == 0 {
        input[at..at + width].copy_from_slice(&number.to_le_bytes()[..width]);
    } else {
        input[at..at + width].copy_from_slice(&number.to_be_bytes()[8 - width..]);
    }
}

/// The word at a random place: a range without separators.
fn word(random: &mut Random, text: &[u8], separators: &[u8]) -> std::ops::Range<usize> {
    let at = place(random, text);
    let is_separator = |byte: &u8| separators.contains(byte);
    let start = text[..at].iter().rposition(is_separator).map_or(0, |before| before + 1);
    let end = text[at..].iter().position(is_separator).map_or(text.len(), |after| at + after);
    start..end
}

fn words(random: &mut Random, input: &mut Vec<u8>, donor: &[u8], format: &Format) {
    const FINE: &[u8] = b" \n\t<>\"'=/,;:{}[]()$";
    const COARSE: &[u8] = b"<>\n{}[]\"";
    let separators = random.one_of(&[FINE, COARSE]);
    let target = word(random, input, separators);
    match random.below(8) {
        0 | 1 => {
            let source = word(random, donor, separators);
            replace(input, target, &donor[source]);
        }
        2 | 3 => {
            // A word that contains digits, if there is one near.
            let target = (0..8)
                .map(|_| word(random, input, FINE))
                .find(|range| input[range.clone()].iter().any(u8::is_ascii_digit))
                .unwrap_or(target);
            replace(input, target, random.one_of(&NUMBERS).as_bytes());
        }
        4 | 5 if !format.tokens.is_empty() => replace(input, target, random.one_of(format.tokens).as_bytes()),
        6 => {
            // A line moves, or is repeated.
            let line = word(random, input, b"\n");
            let moved = input[line.clone()].to_vec();
            if random.below(2) == 0 {
                replace(input, line, &[]);
            }
            let at = word(random, input, b"\n").start;
            replace(input, at..at, &[&moved[..], b"\n"].concat());
        }
        _ => replace(input, target, &[]),
    }
}

/// The range of a random element of an XML text, from its `<` to the end of its closing tag.
fn element(random: &mut Random, text: &[u8]) -> Option<std::ops::Range<usize>> {
    let starts: Vec<usize> = (0..text.len().saturating_sub(1))
        .filter(|&at| text[at] == b'<' && text[at + 1].is_ascii_alphabetic())
        .collect();
    let start = *starts.get(random.below(starts.len().max(1) as u64) as usize)?;
    let (mut depth, mut at) = (0, start);
    while let Some(open) = text[at..].iter().position(|&byte| byte == b'<').map(|next| at + next) {
        let end = open + text[open..].iter().position(|&byte| byte == b'>')? + 1;
        match (text.get(open + 1)?, text[end - 2]) {
            (b'/', _) => depth -= 1,
            (b'!' | b'?', _) | (_, b'/') => {}
            _ => depth += 1,
        }
        if depth <= 0 {
            return Some(start..end);
        }
        at = end;
    }
    None
}

fn elements(random: &mut Random, input: &mut Vec<u8>, donor: &[u8]) {
    let (Some(target), Some(source)) = (element(random, input), element(random, donor)) else { return };
    match random.below(6) {
        0 => replace(input, target, &[]),
        1 => {
            let twice = input[target.clone()].repeat(2);
            replace(input, target, &twice);
        }
        2 | 3 => replace(input, target, &donor[source]),
        4 => {
            // One element moves into another, at its beginning.
            let inside = target.start
                + input[target.clone()].iter().position(|&byte| byte == b'>').map_or(0, |end| end + 1);
            replace(input, inside..inside, &donor[source]);
        }
        _ => replace(input, target.start..target.start, &donor[source]),
    }
}
