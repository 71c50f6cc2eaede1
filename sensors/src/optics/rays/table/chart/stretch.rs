//! The radial stretch of a chart, with which the columns and rows of a lens become straight.
//!
//! The image of a lens is a chart of its directions too, but one on which boxes and triangles are hard to bound. Around
//! the axis of the lens, nearly all of its difference from a perspective or stereographic chart is a factor g(ρ²) by
//! which a point's distance ρ from the axis is multiplied. So bounds are computed on the chart and then stretched.
//! Columns then depend on one coordinate and rows on the other, except for asymmetries of the lens.

use super::{MARGIN, Windows};
use crate::optics::rays::projection::{max, min, outside};
use fearless_simd::{Select, Simd, SimdBase, f32x16};

/// Degree of the polynomial.
const DEGREE: usize = 8;
/// Number of unknowns: the coefficients of the polynomial, and the centre of the numbers.
const UNKNOWN: usize = DEGREE + 2;
/// Approximate number of rays to which the polynomial is fitted.
const SAMPLES: i32 = 16_384;
/// Number of steps at which a stretch is evaluated.
const STEPS: usize = 512;
/// Safety factor for values between these steps.
const BETWEEN: f64 = 1.02;

/// A factor that depends on the square of the distance from the axis: a polynomial in `square` · `scale` − 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Stretch {
    scale: f32,
    factor: [f32; DEGREE + 1],
    /// Derivative of the factor with respect to the square.
    slope: [f32; DEGREE],
    /// The greatest square of a ray.
    rays: f32,
    /// The greatest square for which the stretch is valid.
    known: f32,
    /// The least and the greatest factor of a ray.
    factors: [f32; 2],
    /// Half of the greatest second derivative of the factor with respect to the square.
    half_second: f32,
    /// Upper bound on the rounding error of stretched coordinates.
    rounding: f32,
    /// The greatest factor by which a length may grow.
    longest: f32,
    /// Greatest distance of the image of a straight line from the image of its chord, per square of its length.
    bulge: f32,
}

impl Stretch {
    /// Fits the stretch that makes the numbers of columns (or rows) as proportional as possible to the coordinate that
    /// runs with them, up to an offset. `samples` calls its argument for each of the `count` rays with a pair of
    /// coordinates, first the one that runs with the numbers, and with the number.
    pub(in super::super) fn fit(count: i32, samples: impl Fn(&mut dyn FnMut([f64; 2], f64))) -> Option<Self> {
        let square = |[u, v]: [f64; 2]| u * u + v * v;
        let mut rays = 0.0_f64;
        samples(&mut |at, _| rays = rays.max(square(at)));
        // Narrower charts are straight enough.
        if rays < 1e-3 {
            return None;
        }
        // Single precision may have moved a ray outwards.
        rays *= 1.000_01;
        let scale = f64::from((2.0 / rays) as f32);
        let stride = (count / SAMPLES).max(1);
        let mut equations = [[0.0; UNKNOWN + 1]; UNKNOWN];
        let mut number_of_sample = 0;
        samples(&mut |at, number| {
            number_of_sample += 1;
            if number_of_sample % stride != 0 {
                return;
            }
            let argument = square(at) * scale - 1.0;
            let mut terms = [1.0; UNKNOWN + 1];
            let mut power = at[0];
            for term in &mut terms[1..UNKNOWN] {
                *term = power;
                power *= argument;
            }
            terms[UNKNOWN] = number;
            for (equation, term) in equations.iter_mut().zip(terms) {
                for (sum, other) in equation.iter_mut().zip(terms) {
                    *sum += term * other;
                }
            }
        });
        let solution = solve(equations)?;
        let factor: [f64; DEGREE + 1] = core::array::from_fn(|power| solution[power + 1]);
        // Normalise to 1 on the axis.
        let at_axis = polynomial(&factor, -1.0);
        let factor = factor.map(|coefficient| (coefficient / at_axis) as f32);
        if !factor.iter().all(|coefficient| coefficient.is_finite()) {
            return None;
        }
        let stretch = Self::of(factor, scale, rays, rays)?;
        // Triangles extend beyond the rays, so extend the stretch as far as that costs little elsewhere.
        let farther = [1.3, 1.15, 1.05].into_iter().find_map(|beyond| {
            let other = Self::of(factor, scale, rays, rays * beyond)?;
            let is_close =
                other.bulge < 1.25 * stretch.bulge && other.half_second < 1.25 * stretch.half_second;
            is_close.then_some(other)
        });
        Some(farther.unwrap_or(stretch))
    }

    /// Creates a stretch, or `None` if directions would overlap.
    fn of(factor: [f32; DEGREE + 1], scale: f64, rays: f64, known: f64) -> Option<Self> {
        let exact = factor.map(f64::from);
        let by_square: [f64; DEGREE] =
            core::array::from_fn(|power| exact[power + 1] * (power + 1) as f64 * scale);
        let second: [f64; DEGREE - 1] =
            core::array::from_fn(|power| by_square[power + 1] * (power + 1) as f64 * scale);
        let mut factors = [f64::INFINITY, f64::NEG_INFINITY];
        let (mut most_second, mut longest, mut bend) = (0.0_f64, 0.0_f64, 0.0_f64);
        for step in 0..=STEPS {
            let square = known * step as f64 / STEPS as f64;
            let argument = square * scale - 1.0;
            let [factor, slope, second] = [
                polynomial(&exact, argument),
                polynomial(&by_square, argument),
                polynomial(&second, argument),
            ];
            // Derivative of the stretched distance with respect to the distance.
            let radial = factor + 2.0 * square * slope;
            if !(factor > 0.02 && radial > 0.02) {
                return None;
            }
            let distance = crate::simd::sqrt(square);
            factors = [factors[0].min(factor), factors[1].max(factor)];
            most_second = most_second.max(second.abs());
            longest = longest.max(factor).max(radial);
            bend = bend.max(6.0 * distance * slope.abs() + 4.0 * distance * square * second.abs());
        }
        // The rounding error grows with this sum, in which all terms of factor and slope have the same sign.
        let farthest = known * scale - 1.0;
        let terms: [f64; DEGREE + 1] = core::array::from_fn(|power| exact[power].abs() * (power + 1) as f64);
        let sum = polynomial(&terms, farthest.max(1.0));
        Some(Self {
            scale: scale as f32,
            factor,
            slope: by_square.map(|coefficient| coefficient as f32),
            rays: rays as f32,
            known: known as f32,
            factors: [factors[0] / BETWEEN, factors[1] * BETWEEN].map(|factor| factor as f32),
            half_second: (most_second * 0.5 * BETWEEN) as f32,
            rounding: (f64::from(MARGIN) * (1.0 + known) * (longest + sum)) as f32,
            longest: (longest * BETWEEN) as f32,
            // An eighth, with a margin since a chord is slightly shorter than its arc.
            bulge: (bend * 0.13 * BETWEEN) as f32,
        })
    }

    /// The stretched coordinates of a point of the chart.
    pub(super) fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let argument = (u * u + v * v) * f64::from(self.scale) - 1.0;
        let factor = polynomial(&self.factor.map(f64::from), argument);
        [u * factor, v * factor]
    }

    /// Vector form for sixteen points, with a mask of the points for which the stretch is valid.
    #[inline(always)]
    pub(super) fn points<S: Simd>(
        &self,
        [u, v]: [f32x16<S>; 2],
    ) -> ([f32x16<S>; 2], fearless_simd::mask32x16<S>) {
        let square = u * u + v * v;
        let known = square.simd_le(f32x16::splat(u.simd, self.known));
        let factor =
            evaluate(&self.factor, min(square, f32x16::splat(u.simd, self.known)) * self.scale - 1.0);
        ([u * factor, v * factor], known)
    }

    /// The margin around the stretched corners of a triangle, given the square of its greatest extent on the chart, and
    /// the bulge of its edges there per the same square.
    #[inline(always)]
    pub(super) fn margin<S: Simd>(&self, square: f32x16<S>, bulge: f32) -> f32x16<S> {
        square * (self.bulge + self.longest * bulge) + self.rounding
    }

    /// Windows that contain the stretched windows, limited to the extent of the rays.
    #[inline(always)]
    pub(super) fn windows<S: Simd>(&self, simd: S, windows: &Windows<S>) -> Windows<S> {
        let reach = f32x16::splat(simd, crate::simd::sqrt_f32(self.rays) * 1.000_01);
        let some = windows.u[0].simd_le(reach)
            & windows.v[0].simd_le(reach)
            & windows.u[1].simd_ge(-reach)
            & windows.v[1].simd_ge(-reach)
            & windows.some;
        let (u, v) = (within(windows.u, reach), within(windows.v, reach));
        Windows { u: self.interval(simd, u, v), v: self.interval(simd, v, u), some }
    }

    /// The interval of stretched coordinates, given the interval of the other coordinate.
    #[inline(always)]
    fn interval<S: Simd>(
        &self,
        simd: S,
        [least, most]: [f32x16<S>; 2],
        across: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        let (near, far) = (outside(across[0], across[1]), max(-across[0], across[1]));
        let squares = [near * near, far * far];
        [-self.most(simd, -least, squares), self.most(simd, most, squares)]
    }

    /// An upper bound of a stretched coordinate, given the interval of the square of the other coordinate. It increases
    /// with the coordinate itself, so the greatest coordinate gives the greatest bound.
    #[inline(always)]
    fn most<S: Simd>(&self, simd: S, coordinate: f32x16<S>, others: [f32x16<S>; 2]) -> f32x16<S> {
        let own = coordinate * coordinate;
        let rays = f32x16::splat(simd, self.rays);
        let (near, far) = (min(own + others[0], rays), min(own + others[1], rays));
        let (middle, half) = ((near + far) * 0.5, (far - near) * 0.5);
        let argument = middle * self.scale - 1.0;
        let factor = evaluate(&self.factor, argument);
        let spread = (evaluate(&self.slope, argument).abs() + half * self.half_second) * half;
        let least = max(factor - spread, f32x16::splat(simd, self.factors[0]));
        let most = min(factor + spread, f32x16::splat(simd, self.factors[1]));
        let zero = f32x16::splat(simd, 0.0);
        coordinate * coordinate.simd_gt(zero).select(most, least) + self.rounding
    }
}

/// Clamps intervals to ±`reach`.
#[inline(always)]
fn within<S: Simd>([least, most]: [f32x16<S>; 2], reach: f32x16<S>) -> [f32x16<S>; 2] {
    [max(min(least, reach), -reach), max(min(most, reach), -reach)]
}

fn polynomial(coefficients: &[f64], argument: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * argument + coefficient)
}

#[inline(always)]
fn evaluate<S: Simd, const N: usize>(coefficients: &[f32; N], argument: f32x16<S>) -> f32x16<S> {
    let mut sum = f32x16::splat(argument.simd, coefficients[N - 1]);
    for power in (0..N - 1).rev() {
        sum = sum * argument + coefficients[power];
    }
    sum
}

/// Solves a system of linear equations, whose right-hand sides are the last column, by elimination.
fn solve(mut equations: [[f64; UNKNOWN + 1]; UNKNOWN]) -> Option<[f64; UNKNOWN]> {
    for column in 0..UNKNOWN {
        let pivot = (column..UNKNOWN)
            .max_by(|&a, &b| equations[a][column].abs().total_cmp(&equations[b][column].abs()))?;
        equations.swap(column, pivot);
        let first = equations[column];
        if first[column].abs() < 1e-12 {
            return None;
        }
        for equation in &mut equations[column + 1..] {
            let share = equation[column] / first[column];
            for (value, pivot) in equation.iter_mut().zip(first) {
                *value -= share * pivot;
            }
        }
    }
    let mut solution = [0.0; UNKNOWN];
    for row in (0..UNKNOWN).rev() {
        let equation = &equations[row];
        let known: f64 = (row + 1..UNKNOWN).map(|column| equation[column] * solution[column]).sum();
        solution[row] = (equation[UNKNOWN] - known) / equation[row];
    }
    Some(solution)
}
