//! Checks whether a body can have an inertia tensor, and finds the nearest one that it can have.
//!
//! The second moments of a body's mass around its centre are Σ = ½ tr(I)·1 − I. None of them is negative, so no principal
//! moment of inertia exceeds the sum of the other two. Guessed values in files, such as (0.002, 0, 0), violate this. Such a
//! body would spin itself up: gyroscopic torques would act on next to no inertia.

use super::diagnostics::{Diagnostics, Source};
use glam::{DMat3, DVec3};

/// Negative second moments down to this share of their sum are attributed to rounding.
const ROUNDING: f64 = 0.01;
/// Iterations of Jacobi's method; three converge to full precision for a 3×3 matrix.
const ROUNDS: usize = 6;

/// Reports what is wrong with the inertia ixx, iyy, izz, ixy, ixz, iyz in kg·m² of a link; false if it is rejected.
pub(super) fn check(inertia: [f64; 6], link: &str, source: &Source, diagnostics: &mut Diagnostics) -> bool {
    let [xx, yy, zz, xy, xz, yz] = inertia;
    if [xx, yy, zz].iter().any(|moment| *moment < 0.0) {
        diagnostics.error(
            source,
            format!("the moments of inertia of the link '{link}' are {xx} {yy} {zz} kg·m²"),
            "write ixx, iyy and izz of 0 or more",
        );
        return false;
    }
    let (_, moments) = principal(tensor(inertia));
    if moments.min_element() < -ROUNDING * moments.element_sum() {
        diagnostics.warning(
            source,
            format!(
                "no body has the inertia of the link '{link}': its products {xy} {xz} {yz} kg·m² are too large for its \
                 moments {xx} {yy} {zz}, so that it is not positive definite"
            ),
            "the nearest one that a body can have is used; write that of the centre of mass",
        );
    } else if !is_of_a_body(moments) {
        diagnostics.note(
            source,
            format!(
                "no body has the inertia of the link '{link}': of its principal moments {} {} {} kg·m² one is above the \
                 sum of the others",
                moments.x, moments.y, moments.z
            ),
            "the nearest one that a body can have is used",
        );
    }
    true
}

/// Returns the six numbers as a matrix.
pub fn tensor([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> DMat3 {
    DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}

/// Returns the inertia itself if a body can have it, or else the nearest one: negative second moments become 0.
pub fn of_a_body(inertia: DMat3) -> DMat3 {
    let (axes, moments) = principal(inertia);
    if is_of_a_body(moments) {
        return inertia;
    }
    let seconds = (DVec3::splat(0.5 * moments.element_sum()) - moments).max(DVec3::ZERO);
    let moments = DVec3::splat(seconds.element_sum()) - seconds;
    axes * DMat3::from_diagonal(moments) * axes.transpose()
}

/// Returns true if all principal moments of a symmetric matrix are above 0: by its leading minors (Sylvester).
pub fn is_positive_definite(matrix: DMat3) -> bool {
    let (x, y) = (matrix.x_axis, matrix.y_axis);
    x.x > 0.0 && x.x * y.y - x.y * x.y > 0.0 && matrix.determinant() > 0.0
}

fn is_of_a_body(moments: DVec3) -> bool {
    let sum = moments.element_sum();
    0.5 * sum - moments.max_element() >= -ROUNDING * sum
}

/// Returns the principal axes, as columns, and moments of a symmetric matrix, by Jacobi's rotations.
fn principal(matrix: DMat3) -> (DMat3, DVec3) {
    let (mut axes, mut turned) = (DMat3::IDENTITY, matrix);
    for _ in 0..ROUNDS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let product = turned.col(q)[p];
            if product == 0.0 {
                continue;
            }
            let half = (turned.col(q)[q] - turned.col(p)[p]) / (2.0 * product);
            let tan = half.signum() / (half.abs() + libm::sqrt(half * half + 1.0));
            let cos = 1.0 / libm::sqrt(tan * tan + 1.0);
            let mut turn = DMat3::IDENTITY;
            (turn.col_mut(p)[p], turn.col_mut(q)[q]) = (cos, cos);
            (turn.col_mut(q)[p], turn.col_mut(p)[q]) = (tan * cos, -tan * cos);
            turned = turn.transpose() * turned * turn;
            axes *= turn;
        }
    }
    (axes, DVec3::new(turned.x_axis.x, turned.y_axis.y, turned.z_axis.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_inertia_of_a_body() {
        let plate = DVec3::new(0.3, 0.1, 0.2);
        let turn = DMat3::from_euler(glam::EulerRot::ZYX, 0.3, -0.8, 1.1);
        let turned = |moments: DVec3| turn * DMat3::from_diagonal(moments) * turn.transpose();
        // A valid inertia is returned unchanged, to the bit.
        assert_eq!(of_a_body(turned(plate)), turned(plate));
        for (given, expected) in [
            (DVec3::new(0.002, 0.0, 0.0), DVec3::new(0.002, 0.001, 0.001)),
            (DVec3::new(0.3, -0.1, 0.1), DVec3::new(0.3, 0.05, 0.25)),
        ] {
            let found = of_a_body(turned(given));
            assert!(found.abs_diff_eq(turned(expected), 1e-12), "{found} instead of {}", turned(expected));
        }
    }
}
