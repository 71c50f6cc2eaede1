//! The lamps of a model of MuJoCo in its states.

use crate::data::Data;
use crate::errors::{of, value_error};
use belvedere_sensors::scene::Light;
use numpy::ndarray::Array3;
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::PyResult;

/// The largest distance of a lamp in metres.
const FARTHEST: f64 = 1e12;

/// Lamps in states, (states, lamps, 3) each: positions, or directions of directional lamps; and the directions of
/// spotlights, if there are any and the states have them. Their rows of other lamps are not used.
pub(crate) type Placed = (Array3<f64>, Option<Array3<f64>>);

/// Returns the lamps of the world in each state. The first lamps are these lights of the model; `placed` has their
/// positions and directions, (states, lights, 3), or none for those that they have in the world. One more lamp shines
/// where a camera looks: number of the lamp, matrices of cameras (states, cameras, 9), number of the camera.
pub(crate) fn place(
    world: &Data,
    lights: &[usize],
    placed: [Option<PyReadonlyArrayDyn<'_, f64>>; 2],
    camera: Option<(usize, PyReadonlyArrayDyn<'_, f64>, usize)>,
    states: usize,
) -> PyResult<Placed> {
    let lamps = world.builder.scene().lights();
    let [places, ways] = placed.each_ref().map(|array| array.as_ref().map(|array| rows::<3>(array, states)));
    let (places, ways) = (places.transpose()?, ways.transpose()?);
    let mut vectors = of_world(lamps, states, |lamp| lamp.vector_and_diffuse().0)?;
    let mut spots = if ways.is_some() && lamps.iter().any(is_spot) {
        Some(of_world(lamps, states, |lamp| lamp.direction().unwrap_or_default())?)
    } else {
        None
    };
    for (lamp, &light) in lights.iter().enumerate() {
        let own = lamps.get(lamp).ok_or_else(|| of("lights", "the world has fewer lamps"))?;
        if let (Some(places), Some(_)) = (places, own.position()) {
            put(&mut vectors, lamp, places, light, "light_xpos")?;
        }
        if let (Some(ways), Some(_)) = (ways, own.direction()) {
            let into = if is_spot(own) { spots.as_mut() } else { Some(&mut vectors) };
            into.map_or(Ok(()), |into| put(into, lamp, ways, light, "light_xdir"))?;
        }
    }
    if let Some((lamp, matrices, number)) = camera {
        let (matrices, count) = rows::<9>(&matrices, states)?;
        for state in 0..states {
            let [_, _, x, _, _, y, _, _, z] = of_object(matrices, count, state, number)?;
            set(&mut vectors, state, lamp, [x, y, z].map(|part| 0.0 - part))?;
        }
    }
    Ok((vectors, spots))
}

fn is_spot(lamp: &Light) -> bool {
    lamp.position().is_some() && lamp.direction().is_some()
}

/// Returns the same vectors in each state.
fn of_world(lamps: &[Light], states: usize, vector: impl Fn(&Light) -> [f64; 3]) -> PyResult<Array3<f64>> {
    let own: Vec<f64> = lamps.iter().flat_map(vector).collect();
    Array3::from_shape_vec((states, lamps.len(), 3), own.repeat(states)).map_err(value_error)
}

/// Copies the positions or directions of a light in all states to a lamp.
fn put(
    vectors: &mut Array3<f64>,
    lamp: usize,
    (rows, count): Rows<'_, 3>,
    light: usize,
    name: &str,
) -> PyResult<()> {
    let is_way = name == "light_xdir";
    for state in 0..vectors.dim().0 {
        let vector = of_object(rows, count, state, light)?;
        let is_within = vector.iter().all(|number| number.abs() <= FARTHEST);
        if !is_within || (is_way && vector == [0.0; 3]) {
            let expected = if is_way { "a direction" } else { "a position within 1e12 m" };
            let found = format_args!(
                "{expected} is expected, not {vector:?}, which light {light} has in state {state}"
            );
            return Err(of(&format!("states['{name}']"), found));
        }
        set(vectors, state, lamp, vector)?;
    }
    Ok(())
}

fn set(vectors: &mut Array3<f64>, state: usize, lamp: usize, vector: [f64; 3]) -> PyResult<()> {
    for (axis, number) in vector.into_iter().enumerate() {
        *vectors.get_mut((state, lamp, axis)).ok_or_else(|| of("lights", "the world has fewer lamps"))? =
            number;
    }
    Ok(())
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
