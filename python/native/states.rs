//! Poses of a sensor and of all bodies in states of MuJoCo, from places and matrices as they are in `MjData`.

use crate::errors::of;
use crate::poses;
use crate::shots::{Moves, Places};
use belvedere_sensors::Pose;
use glam::{DMat3, DVec3};
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use std::sync::Arc;

/// Checked poses of a sensor and of all bodies, state by state, which sensors and casts accept. Reading them from the
/// arrays of MuJoCo in one call is most of what a frame with few rays costs in Python.
#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct States(Arc<Places>);

/// Places (N, objects, 3) and row-major matrices (N, objects, 9).
type Frames<'py> = (PyReadonlyArrayDyn<'py, f64>, PyReadonlyArrayDyn<'py, f64>);

/// The axes of an object.
#[derive(Clone, Copy)]
enum Axes {
    Own,
    /// Those of a sensor (x forward, y left, z up), from those of a camera of MuJoCo (x right, y up, z backward).
    OfCamera,
}

#[pymethods]
impl States {
    /// Reads the poses of the bodies, which are these geoms, and those of the sensor, which is object `number` of its
    /// kind, or has none.
    #[new]
    fn new(
        sensor: Frames<'_>,
        number: Option<usize>,
        is_camera: bool,
        geom: Frames<'_>,
        geoms: PyReadonlyArrayDyn<'_, i64>,
    ) -> PyResult<Self> {
        let axes = if is_camera { Axes::OfCamera } else { Axes::Own };
        let sensors: Vec<_> = number.into_iter().collect();
        let world_from_sensor = read(&sensor, &sensors, axes)?;
        let geoms = geoms.as_slice().map_err(|error| of("geoms", error))?;
        let geoms: Vec<_> = geoms.iter().map(|geom| usize::try_from(*geom).unwrap_or(usize::MAX)).collect();
        let world_from_body = read(&geom, &geoms, Axes::Own)?;
        let moves = Moves::new((0..geoms.len()).collect(), world_from_body);
        Ok(Self(Arc::new(Places::new(world_from_sensor, moves))))
    }
}

impl States {
    pub(crate) fn places(&self) -> &Arc<Places> {
        &self.0
    }
}

/// Reads the poses of these objects, state by state.
fn read((places, matrices): &Frames<'_>, objects: &[usize], axes: Axes) -> PyResult<Vec<Pose>> {
    let &[states, count, 3] = places.shape() else {
        return Err(of("states", format_args!("places of shape {:?}", places.shape())));
    };
    if *matrices.shape() != [states, count, 9] {
        return Err(of("states", format_args!("matrices of shape {:?}", matrices.shape())));
    }
    if let Some(object) = objects.iter().find(|object| **object >= count) {
        return Err(of("states", format_args!("there is no object {object}; there are {count}")));
    }
    let (places, _) = places.as_slice().map_err(|error| of("states", error))?.as_chunks::<3>();
    let (matrices, _) = matrices.as_slice().map_err(|error| of("states", error))?.as_chunks::<9>();
    let mut poses = Vec::with_capacity(states * objects.len());
    for first in (0..states).map(|state| state * count) {
        for object in objects {
            let (place, matrix) = (places[first + object], matrices[first + object]);
            let pose = one(place, matrix, axes)
                .map_err(|why| of("states", format_args!("pose number {}: {why}", poses.len())))?;
            poses.push(pose);
        }
    }
    Ok(poses)
}

fn one(place: [f64; 3], matrix: [f64; 9], axes: Axes) -> Result<Pose, &'static str> {
    let own = DMat3::from_cols_array(&matrix).transpose();
    let axes = match axes {
        Axes::Own => own,
        // Adding 0 turns −0 into 0, so that signs of zeros do not depend on how a matrix was multiplied.
        Axes::OfCamera => {
            DMat3::from_cols(DVec3::ZERO - own.z_axis, DVec3::ZERO - own.x_axis, DVec3::ZERO + own.y_axis)
        }
    };
    let pose = poses::of_axes(DVec3::from_array(place), axes)?;
    // A quaternion of single rounding errors is not exactly 1 long. Poses in arrays are normalised again when they are
    // read; here, too, so that both give the same bits.
    Ok(Pose::new(pose.translation(), pose.rotation()))
}
