//! Shapes that are not made of triangles.
use super::projection::Projection;
use super::target::Target;
use super::triangles::Rules;
use crate::trace::view::View;
use fearless_simd::Simd;

#[allow(clippy::too_many_arguments)]
#[inline(always)]
pub(super) fn draw<S: Simd, P: Projection>(
    _simd: S,
    _view: &View<'_>,
    _projection: P,
    _target: &mut Target<'_>,
    _rules: Rules,
    _placed: u32,
    _columns: [i32; 2],
    _rows: [i32; 2],
    _nearest: f32,
) {
}
