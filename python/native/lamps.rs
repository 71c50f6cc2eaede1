//! The lamps of a model of MuJoCo in its states.

use crate::data::Data;
use crate::errors::{of, value_error};
use numpy::ndarray::Array3;
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::PyResult;

/// The largest distance of a lamp in metres.
const FARTHEST: f64 = 1e12;

/// Returns the position or direction of each lamp of the world, (states, lamps, 3). The first lamps are these lights of
/// the model, `true` for those with a direction; `placed` has their positions and directions, (states, lights, 3), or
/// none for those that they have in the world. One more lamp shines where a camera looks: number of the lamp, matrices of
/// cameras (states, cameras, 9), number of the camera.
pub(crate) fn place(
    world: &Data,
    lights: &[(usize, bool)],
    placed: [Option<PyReadonlyArrayDyn<'_, f64>>; 2],
    camera: Option<(usize, PyReadonlyArrayDyn<'_, f64>, usize)>,
    states: usize,
) -> PyResult<Array3<f64>> {
    let lamps = world.builder.scene().lights();
    let own: Vec<f64> = lamps.iter().flat_map(|lamp| lamp.vector_and_diffuse().0).collect();
    let mut vectors =
        Array3::from_shape_vec((states, lamps.len(), 3), own.repeat(states)).map_err(value_error)?;
    let mut put = |state, lamp, vector: [f64; 3]| -> PyResult<()> {
        for (axis, number) in vector.into_iter().enumerate() {
            *vectors
                .get_mut((state, lamp, axis))
                .ok_or_else(|| of("lights", "the world has fewer lamps"))? = number;
        }
        Ok(())
    };
    let [places, ways] = placed.each_ref().map(|array| array.as_ref().map(|array| rows::<3>(array, states)));
    let (places, ways) = (places.transpose()?, ways.transpose()?);
    for (lamp, &(light, is_way)) in lights.iter().enumerate() {
        let (name, rows) = if is_way { ("light_xdir", ways) } else { ("light_xpos", places) };
        let Some((rows, count)) = rows else { continue };
        for state in 0..states {
            let vector = of_object(rows, count, state, light)?;
            let is_within = vector.iter().all(|number| number.abs() <= FARTHEST);
            if !is_within || (is_way && vector == [0.0; 3]) {
                let expected = if is_way { "a direction" } else { "a position within 1e12 m" };
                let found = format_args!(
                    "{expected} is expected, not {vector:?}, which light {light} has in state {state}"
                );
                return Err(of(&format!("states['{name}']"), found));
            }
            put(state, lamp, vector)?;
        }
    }
    if let Some((lamp, matrices, number)) = camera {
        let (matrices, count) = rows::<9>(&matrices, states)?;
        for state in 0..states {
            let [_, _, x, _, _, y, _, _, z] = of_object(matrices, count, state, number)?;
            put(state, lamp, [x, y, z].map(|part| 0.0 - part))?;
        }
    }
    Ok(vectors)
}

/// Rows of an array (states, objects, N), and the number of objects.
type Rows<'a, const N: usize> = (&'a [[f64; N]], usize);

fn rows<'a, const N: usize>(array: &'a PyReadonlyArrayDyn<'_, f64>, states: usize) -> PyResult<Rows<'a, N>> {
    let (shape, slice) = (array.shape(), array.as_slice().map_err(|error| of("states", error))?);
    match *shape {
        [have, count, numbers] if have == states && numbers == N => Ok((slice.as_chunks::<N>().0, count)),
        _ => Err(of("states", format_args!("shape {shape:?}; ({states}, …, {N}) is expected"))),
    }
}

fn of_object<const N: usize>(
    rows: &[[f64; N]],
    count: usize,
    state: usize,
    object: usize,
) -> PyResult<[f64; N]> {
    if object >= count {
        return Err(of("states", format_args!("there is no object {object}; there are {count}")));
    }
    Ok(rows[state * count + object])
}
