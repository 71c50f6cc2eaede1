//! Sets of sequence numbers and of fragment numbers: a base, and up to 256 bits (9.4.2.6, 9.4.2.8).

use crate::bytes::{Append, Bytes};

/// Numbers from a base on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NumberSet {
    base: i64,
    count: u32,
    words: [u32; 8],
}

impl NumberSet {
    /// No number; all below `base` are settled.
    pub(crate) fn empty(base: i64) -> NumberSet {
        NumberSet { base, count: 0, words: [0; 8] }
    }

    /// The numbers among `numbers` that lie in the 256 from `base` on. They may come in any order.
    pub(crate) fn of(base: i64, numbers: impl IntoIterator<Item = i64>) -> NumberSet {
        let mut set = NumberSet::empty(base);
        for number in numbers {
            let Some(bit) = number.checked_sub(base).filter(|bit| (0..256).contains(bit)) else { continue };
            set.words[bit as usize / 32] |= 1 << (31 - bit % 32);
            set.count = set.count.max(bit as u32 + 1);
        }
        set
    }

    pub(crate) fn base(&self) -> i64 {
        self.base
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words == [0; 8]
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = i64> + '_ {
        (0..self.count)
            .filter(|&bit| self.words[bit as usize / 32] >> (31 - bit % 32) & 1 == 1)
            .map(|bit| self.base + i64::from(bit))
    }

    /// Reads a set of sequence numbers. A set that the standard does not allow is `None`.
    pub(crate) fn sequences(bytes: &mut Bytes<'_>) -> Option<NumberSet> {
        let base = bytes.sequence()?;
        NumberSet::bits(base, bytes)
    }

    /// Reads a set of fragment numbers.
    pub(crate) fn fragments(bytes: &mut Bytes<'_>) -> Option<NumberSet> {
        let base = i64::from(bytes.u32()?);
        NumberSet::bits(base, bytes)
    }

    fn bits(base: i64, bytes: &mut Bytes<'_>) -> Option<NumberSet> {
        let count = bytes.u32()?;
        if count > 256 || !(0..1 << 62).contains(&base) {
            return None;
        }
        let mut words = [0; 8];
        for word in words.iter_mut().take(count.div_ceil(32) as usize) {
            *word = bytes.u32()?;
        }
        Some(NumberSet { base, count, words })
    }

    /// Appends the set, as one of sequence numbers.
    pub(crate) fn put_sequences(&self, to: &mut Vec<u8>) {
        to.put_sequence(self.base);
        self.put_bits(to);
    }

    /// Appends the set, as one of fragment numbers.
    pub(crate) fn put_fragments(&self, to: &mut Vec<u8>) {
        to.put_u32(self.base as u32);
        self.put_bits(to);
    }

    fn put_bits(&self, to: &mut Vec<u8>) {
        to.put_u32(self.count);
        for word in &self.words[..self.count.div_ceil(32) as usize] {
            to.put_u32(*word);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_comes_back_from_its_bytes() {
        for numbers in [vec![], vec![7], vec![7, 8, 38, 39, 262], vec![300, 6, 9]] {
            let set = NumberSet::of(7, numbers.iter().copied());
            let inside: Vec<i64> = numbers.iter().copied().filter(|n| (7..263).contains(n)).collect();
            assert_eq!(set.iter().collect::<Vec<_>>(), inside);
            let mut bytes = Vec::new();
            set.put_sequences(&mut bytes);
            assert_eq!(NumberSet::sequences(&mut Bytes::new(&bytes, true)), Some(set));
            let mut bytes = Vec::new();
            set.put_fragments(&mut bytes);
            assert_eq!(NumberSet::fragments(&mut Bytes::new(&bytes, true)), Some(set));
        }
    }

    #[test]
    fn the_bits_are_those_of_the_standard() {
        // The example of DDSI-RTPS 2.3, 9.4.2.6: 1234:/12:00110 and so on, as bits from the most significant one.
        let mut bytes = Vec::new();
        NumberSet::of(1234, [1236, 1237, 1245]).put_sequences(&mut bytes);
        let words: Vec<u32> =
            bytes.chunks(4).map(|word| u32::from_le_bytes(word.try_into().expect("four bytes"))).collect();
        assert_eq!(words, [0, 1234, 12, 0x3010_0000]);
    }

    #[test]
    fn a_set_of_more_than_256_is_refused() {
        let mut bytes = Vec::new();
        bytes.put_sequence(1);
        bytes.put_u32(257);
        bytes.resize(100, 0xFF);
        assert_eq!(NumberSet::sequences(&mut Bytes::new(&bytes, true)), None);
    }
}
