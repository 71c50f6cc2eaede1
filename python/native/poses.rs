//! Arrays of poses: x y z, then the quaternion x y z w, in the order of ROS.

use crate::errors::of;
use belvedere_sensors::Pose;
use glam::{DMat3, DQuat, DVec3};
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;

/// The number of values of a pose.
const NUMBERS: usize = 7;
/// The largest deviation of a quaternion's length from 1, for single precision and files with few digits.
const TOLERANCE: f64 = 1e-2;

/// Reads and checks the poses of a contiguous array (…, 7).
pub(crate) fn read(argument: &str, array: &PyReadonlyArrayDyn<'_, f64>) -> PyResult<Vec<Pose>> {
    let numbers = array.as_slice().map_err(|error| of(argument, error))?;
    numbers
        .chunks_exact(NUMBERS)
        .enumerate()
        .map(|(index, pose)| {
            one(pose).map_err(|why| of(argument, format_args!("pose {index} {why}: {pose:?}")))
        })
        .collect()
}

/// Reads a pose of seven numbers.
pub(crate) fn one(numbers: &[f64]) -> Result<Pose, &'static str> {
    let &[x, y, z, qx, qy, qz, qw] = numbers else { return Err("is not of 7 numbers (x y z, qx qy qz qw)") };
    let (translation, rotation) = (DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw));
    if !(translation.is_finite() && rotation.is_finite()) {
        return Err("is not finite");
    }
    if (rotation.length() - 1.0).abs() > TOLERANCE {
        return Err("has a quaternion (qx qy qz qw) whose length is not 1");
    }
    Ok(Pose::new(translation, rotation))
}

/// Returns the seven numbers of a pose.
pub(crate) fn numbers(pose: &Pose) -> [f64; NUMBERS] {
    let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation().to_array(), pose.rotation().to_array());
    [x, y, z, qx, qy, qz, qw]
}

/// The index of an invalid pose, with the reason.
type Bad = (usize, &'static str);

/// Returns the first invalid pose of a contiguous array (N, 7), with the reason.
#[pyfunction]
pub(crate) fn bad_pose(poses: PyReadonlyArrayDyn<'_, f64>) -> PyResult<Option<Bad>> {
    let all = poses.as_slice().map_err(|error| of("poses", error))?;
    Ok(all.chunks_exact(NUMBERS).enumerate().find_map(|(index, pose)| Some((index, one(pose).err()?))))
}

/// Converts contiguous matrices (N, 4, 4) to poses of seven numbers, up to the first invalid one, which is returned
/// with the reason.
#[pyfunction]
pub(crate) fn poses_of_matrices<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArrayDyn<'py, f64>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Option<Bad>)> {
    let all = matrices.as_slice().map_err(|error| of("poses", error))?;
    let mut poses = Vec::with_capacity(all.len() / 16 * NUMBERS);
    let mut bad = None;
    for (index, matrix) in all.chunks_exact(16).enumerate() {
        match of_matrix(matrix) {
            Ok(pose) => poses.extend(numbers(&pose)),
            Err(why) => {
                bad = Some((index, why));
                break;
            }
        }
    }
    Ok((PyArray1::from_vec(py, poses), bad))
}

fn of_matrix(matrix: &[f64]) -> Result<Pose, &'static str> {
    let &[xx, yx, zx, tx, xy, yy, zy, ty, xz, yz, zz, tz, a, b, c, d] = matrix else {
        return Err("is not of 4 × 4 numbers");
    };
    if !matrix.iter().all(|number| number.is_finite()) {
        return Err("is not finite");
    }
    if [a, b, c, d] != [0.0, 0.0, 0.0, 1.0] {
        return Err("does not end in the row 0 0 0 1");
    }
    of_axes(DVec3::new(tx, ty, tz), DMat3::from_cols_array(&[xx, xy, xz, yx, yy, yz, zx, zy, zz]))
}

/// Returns the pose of a frame by its place and its axes, the columns of the matrix.
pub(crate) fn of_axes(place: DVec3, axes: DMat3) -> Result<Pose, &'static str> {
    if !(place.is_finite() && axes.is_finite()) {
        return Err("is not finite");
    }
    let is_rotation =
        (axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, TOLERANCE) && axes.determinant() > 0.0;
    if !is_rotation {
        return Err("has no rotation in its upper left 3 × 3 numbers");
    }
    Ok(Pose::new(place, DQuat::from_mat3(&axes)))
}
