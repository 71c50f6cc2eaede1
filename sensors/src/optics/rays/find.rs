//! Finds the pixel of a direction by searching among the rays, for rules that only define the direction of each pixel.

use super::Rays;
use glam::{DVec2, DVec3};

/// Newton's method takes two or three steps from a neighbouring pixel, and a few more across an image.
const MOST_STEPS: usize = 24;
/// The search ends with a step shorter than this, in pixels.
const SETTLED: f64 = 1e-6;
/// Pixels extend this far beyond the centres of the outermost ones.
const HALF: f64 = 0.5;

impl Rays<'_> {
    /// Fractional column and row of the ray through a point, searched from a guess. `None` if there is no such ray:
    /// behind a pinhole camera, and outside the image for other rules.
    pub(crate) fn project(&self, point: DVec3, guess: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            Self::Pinhole(rule) => {
                let lens = rule.intrinsics();
                let at = [lens.cx - lens.fx * (point.y / point.x), lens.cy - lens.fy * (point.z / point.x)];
                (point.x > 0.0).then_some(at)
            }
            Self::Spherical(_) | Self::Table(_) => pixel(self, point, guess),
        }
    }
}

/// Fractional column and row, by Newton's method on the directions of four neighbouring rays, interpolated linearly.
/// The error is at most an eighth of the square of the angle between two rays.
fn pixel(rays: &Rays<'_>, point: DVec3, guess: [f64; 2]) -> Option<[f64; 2]> {
    let ray_grid = rays.ray_grid();
    let last = DVec2::new(f64::from(ray_grid.width - 1), f64::from(ray_grid.height - 1));
    let target = point.try_normalize()?;
    if last.min_element() < 1.0 {
        return None;
    }
    let (right, up) = target.any_orthonormal_pair();
    let mut at = DVec2::from_array(guess);
    for _ in 0..MOST_STEPS {
        at = at.clamp(DVec2::splat(-HALF), last + HALF);
        let cell = at.floor().clamp(DVec2::ZERO, last - 1.0);
        let [column, row] = [cell.x as i32, cell.y as i32];
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| (column + x, row + y));
        if !corners.iter().all(|&(column, row)| rays.has(column, row)) {
            return None;
        }
        let [a, b, c, d] = corners.map(|(column, row)| rays.direction(column, row).normalize());
        let share = at - cell;
        let direction = a.lerp(b, share.x).lerp(c.lerp(d, share.x), share.y);
        let (across, down) = ((b - a).lerp(d - c, share.y), (c - a).lerp(d - b, share.x));
        // The error as seen along the target, and the change of it per step.
        let off = DVec2::new(direction.dot(right), direction.dot(up));
        let step_x = DVec2::new(across.dot(right), across.dot(up));
        let step_y = DVec2::new(down.dot(right), down.dot(up));
        let per_area = 1.0 / step_x.perp_dot(step_y);
        let step = DVec2::new(step_y.perp_dot(off), off.perp_dot(step_x)) * per_area;
        if !step.is_finite() {
            return None;
        }
        at += step.clamp_length_max(0.25 * last.max_element());
        if step.length_squared() < SETTLED * SETTLED {
            let inside = at.cmpge(DVec2::splat(-HALF)).all() && at.cmple(last + HALF).all();
            return (inside && direction.dot(target) > 0.0).then_some(at.to_array());
        }
    }
    None
}
