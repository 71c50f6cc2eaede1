//! A sample that comes in fragments.

use crate::numbers::NumberSet;

/// The fragments of a sample that have come so far.
#[derive(Debug)]
pub(crate) struct Assembly {
    size: usize,
    data: Vec<u8>,
    has: Vec<bool>,
    missing: usize,
}

impl Assembly {
    /// For a sample of `total` bytes in fragments of `size`. The caller bounds `total`.
    pub(crate) fn new(size: u16, total: u32) -> Assembly {
        let size = usize::from(size).max(1);
        let count = (total as usize).div_ceil(size);
        Assembly { size, data: vec![0; total as usize], has: vec![false; count], missing: count }
    }

    /// Takes fragments; the number of the first one counts from 1. What does not fit the sample is left out.
    pub(crate) fn add(&mut self, first: u32, size: u16, total: u32, payload: &[u8]) {
        if usize::from(size) != self.size || total as usize != self.data.len() || first == 0 {
            return;
        }
        for (number, fragment) in (first as usize - 1..).zip(payload.chunks(self.size)) {
            let start = number * self.size;
            let end = (start + self.size).min(self.data.len());
            let Some(has) = self.has.get_mut(number) else { return };
            if !*has && fragment.len() == end - start {
                self.data[start..end].copy_from_slice(fragment);
                *has = true;
                self.missing -= 1;
            }
        }
    }

    /// The bytes of the whole sample.
    pub(crate) fn len(&self) -> usize {
        self.data.len()
    }

    pub(crate) fn is_whole(&self) -> bool {
        self.missing == 0
    }

    pub(crate) fn into_data(self) -> Vec<u8> {
        self.data
    }

    /// The first 256 numbers of fragments that are missing, from the first one on.
    pub(crate) fn missing(&self) -> NumberSet {
        let numbers = || (1..).zip(&self.has).filter(|(_, has)| !**has).map(|(number, _)| number);
        NumberSet::of(numbers().next().unwrap_or(1), numbers().take(256))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fragments_in_any_order_make_the_sample() {
        let sample: Vec<u8> = (0..=255).cycle().take(1003).collect();
        let mut assembly = Assembly::new(100, 1003);
        let fragment = |number: usize| &sample[number * 100..sample.len().min(number * 100 + 100)];
        for number in [10, 3, 0, 3, 1, 2, 9, 8] {
            assembly.add(number as u32 + 1, 100, 1003, fragment(number));
        }
        assert_eq!(assembly.missing().iter().collect::<Vec<_>>(), [5, 6, 7, 8]);
        assembly.add(5, 100, 1003, &sample[400..800]);
        assert!(assembly.is_whole());
        assert_eq!(assembly.into_data(), sample);
    }

    #[test]
    fn what_does_not_fit_is_left_out() {
        let mut assembly = Assembly::new(100, 150);
        assembly.add(2, 100, 150, &[1; 100]);
        assembly.add(3, 100, 150, &[1; 100]);
        assembly.add(0, 100, 150, &[1; 100]);
        assembly.add(1, 50, 150, &[1; 50]);
        assembly.add(u32::MAX, 100, 150, &[1; 100]);
        assert_eq!(assembly.missing().iter().collect::<Vec<_>>(), [1, 2]);
    }
}
