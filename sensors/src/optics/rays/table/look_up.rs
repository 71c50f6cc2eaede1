//! The look-up from a coordinate of a chart to the columns or rows that have rays there.

use super::chart::TURN;
use crate::simd::WIDTH;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, i32x16};

/// For each of the cells into which a coordinate is divided: the least column (or row) from the cell on, and the
/// greatest before it.
///
/// If columns increase with the coordinate, these two describe them completely. Otherwise bounds are loose but still
/// valid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LookUp<'a> {
    pub(super) scale: Scale,
    /// The least number in this cell and the later ones, with one more entry for coordinates past the last cell.
    pub(super) first: &'a [i16],
    /// The greatest number in the cells before this one, also with one more entry.
    pub(super) last: &'a [i16],
}

/// The division of a coordinate into cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Start of the first cell.
    start: f32,
    cells_per_unit: f32,
}

/// Number of cells for a grid of `count` columns (or rows).
pub(super) const fn cells(count: usize) -> usize {
    4 * count + 252
}

/// A [`LookUp`] that is being filled.
pub(super) struct Filling<'a> {
    scale: Scale,
    first: &'a mut [i16],
    last: &'a mut [i16],
}

impl<'a> Filling<'a> {
    /// Creates an empty look-up for coordinates in the interval.
    pub(super) fn new([least, most]: [f32; 2], first: &'a mut [i16], last: &'a mut [i16]) -> Self {
        // Keeps the ends apart if there is only one coordinate.
        const PAD: f32 = 1e-4;
        first.fill(i16::MAX);
        last.fill(i16::MIN);
        let cells = (first.len() - 1) as f32;
        let cells_per_unit = (cells - 0.5) / ((most - least) + 2.0 * PAD);
        Self { scale: Scale { start: least - PAD, cells_per_unit }, first, last }
    }

    /// Adds a ray of the column (or row) `number`.
    pub(super) fn add(&mut self, coordinate: f32, number: i32) {
        let cell = ((coordinate - self.scale.start) * self.scale.cells_per_unit) as usize;
        let cell = cell.min(self.first.len() - 2);
        let number = number as i16;
        self.first[cell] = self.first[cell].min(number);
        self.last[cell + 1] = self.last[cell + 1].max(number);
    }

    /// Completes the look-up after all rays have been added.
    pub(super) fn finish(self) -> LookUp<'a> {
        for cell in (1..self.first.len()).rev() {
            self.first[cell - 1] = self.first[cell - 1].min(self.first[cell]);
            let cell = self.last.len() - cell;
            self.last[cell] = self.last[cell].max(self.last[cell - 1]);
        }
        let Self { scale, first, last } = self;
        LookUp { scale, first, last }
    }
}

impl LookUp<'_> {
    /// Average number of columns or rows per cell.
    pub(super) fn looseness(&self) -> f64 {
        let cells = self.first.len() - 1;
        let width = |cell: usize| (i32::from(self.last[cell + 1]) - i32::from(self.first[cell]) + 1).max(0);
        (0..cells).map(|cell| f64::from(width(cell))).sum::<f64>() / cells as f64
    }

    #[inline(always)]
    fn cells<S: Simd>(&self, simd: S, coordinates: f32x16<S>, least: f32) -> [i32; WIDTH] {
        let (least, most) =
            (f32x16::splat(simd, least), f32x16::splat(simd, least + (self.first.len() - 1) as f32));
        let cells = simd.floor_f32x16((coordinates - self.scale.start) * self.scale.cells_per_unit);
        let cells = cells.simd_gt(least).select(cells, least);
        let cells = cells.simd_lt(most).select(cells, most);
        let mut array = [0; WIDTH];
        simd.cvt_i32_f32x16(cells).store_array(&mut array);
        array
    }

    /// The first number of sixteen intervals that start at `from`.
    #[inline(always)]
    fn first_from<S: Simd>(&self, simd: S, from: f32x16<S>) -> i32x16<S> {
        let cells = self.cells(simd, from, 0.0);
        let mut numbers = [0; WIDTH];
        for lane in 0..WIDTH {
            numbers[lane] = i32::from(self.first[cells[lane] as usize]);
        }
        i32x16::load_array_ref(simd, &numbers)
    }

    /// The last number of sixteen intervals that end at `to`.
    #[inline(always)]
    fn last_to<S: Simd>(&self, simd: S, to: f32x16<S>) -> i32x16<S> {
        let cells = self.cells(simd, to, -1.0);
        let mut numbers = [0; WIDTH];
        for lane in 0..WIDTH {
            numbers[lane] = i32::from(self.last[(cells[lane] + 1) as usize]);
        }
        i32x16::load_array_ref(simd, &numbers)
    }

    /// The first and the last column (or row) in sixteen intervals; first > last if there is none.
    #[inline(always)]
    pub(super) fn look_up<S: Simd>(&self, simd: S, [from, to]: [f32x16<S>; 2]) -> [i32x16<S>; 2] {
        [self.first_from(simd, from), self.last_to(simd, to)]
    }

    /// The same look-up for intervals of azimuth, which may continue past the seam. There, columns continue from
    /// `width` if they close to a ring, and from 0 otherwise.
    #[inline(always)]
    pub(super) fn look_up_round<S: Simd>(
        &self,
        simd: S,
        [from, to]: [f32x16<S>; 2],
        width: i32,
        ring: bool,
    ) -> [i32x16<S>; 2] {
        let [mut first, mut last] = self.look_up(simd, [from, to]);
        let over_seam = to.simd_gt(f32x16::splat(simd, TURN * 0.5));
        if over_seam.any_true() {
            let on = if ring { width } else { 0 };
            let least = f32x16::splat(simd, -TURN);
            let [again_first, again_last] = self.look_up(simd, [least, to - TURN]);
            let least = over_seam & (again_first + on).simd_lt(first);
            first = least.select(again_first + on, first);
            let most = over_seam & (again_last + on).simd_gt(last);
            last = most.select(again_last + on, last);
        }
        if !ring {
            return [first, last];
        }
        // The numbers of a ring's columns run from −width to 3 × width: shift them until the first is a column.
        let width = i32x16::splat(simd, width);
        let all = (last - first + 1).simd_ge(width);
        for _ in 0..2 {
            let over = first.simd_ge(width) & first.simd_le(last);
            first = over.select(first - width, first);
            last = over.select(last - width, last);
        }
        let zero = i32x16::splat(simd, 0);
        let under = first.simd_lt(zero);
        first = under.select(first + width, first);
        last = under.select(last + width, last);
        [all.select(zero, first), all.select(width - 1, last)]
    }
}
