//! Appearance of each world of a batch: colours and textures of bodies, lamps, ambient light.

use crate::data::Data;
use crate::errors::of;
use belvedere_sensors::scene::{Environment, Light, Material, Scene, SceneError};
use numpy::{Element, PyReadonlyArrayDyn};
use pyo3::PyResult;

/// Optional arrays from Python: colours of bodies (N, bodies, 3), colours of lamps (N, lamps, 3), positions or
/// directions of lamps (N, lamps, 3), ambient light (N, 3), whether bodies are textured (N, bodies), and directions of
/// spotlights (N, lamps, 3), whose rows of other lamps are not used.
pub(crate) type GivenLooks<'py> = (
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f64>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, bool>>,
    Option<PyReadonlyArrayDyn<'py, f64>>,
);

/// Checked appearances. Missing arrays, and NaN as the colour of a body, mean the world's own values.
pub(crate) struct Looks {
    colors: Option<Vec<[f32; 3]>>,
    light_colors: Option<Vec<[f32; 3]>>,
    light_vectors: Option<Vec<[f64; 3]>>,
    ambient: Option<Vec<[f32; 3]>>,
    textured: Option<Vec<bool>>,
    spot_directions: Option<Vec<[f64; 3]>>,
}

impl Looks {
    pub(crate) fn read(world: &Data, frames: usize, given: GivenLooks<'_>) -> PyResult<Self> {
        let (colors, light_colors, light_vectors, ambient, textured, spot_directions) = given;
        let (bodies, lamps) = (frames * world.bodies.len(), frames * world.builder.scene().lights().len());
        Ok(Self {
            colors: colors.map(|array| rows("colors", &array, bodies)).transpose()?,
            light_colors: light_colors.map(|array| rows("light_colors", &array, lamps)).transpose()?,
            light_vectors: light_vectors.map(|array| rows("light_vectors", &array, lamps)).transpose()?,
            ambient: ambient.map(|array| rows("ambient", &array, frames)).transpose()?,
            textured: textured.map(|array| flags("textured", &array, bodies)).transpose()?,
            spot_directions: spot_directions
                .map(|array| rows("spot_directions", &array, lamps))
                .transpose()?,
        })
    }

    /// Returns the scene of a frame.
    pub(crate) fn of_frame<'a>(
        &self,
        world: &'a Data,
        frame: usize,
        materials: &'a mut Vec<Material>,
        lights: &'a mut Vec<Light>,
    ) -> Result<Scene<'a>, SceneError> {
        let mut scene = world.builder.scene();
        if self.colors.is_some() || self.textured.is_some() {
            materials.clear();
            materials.extend_from_slice(scene.materials());
            let first = frame * world.bodies.len();
            for (number, body) in world.bodies.iter().enumerate() {
                let color = self.colors.as_ref().map(|colors| colors[first + number]);
                let color = color.filter(|color| color.iter().all(|part| part.is_finite()));
                let is_bare = self.textured.as_ref().is_some_and(|textured| !textured[first + number]);
                if color.is_none() && !is_bare {
                    continue;
                }
                for (instance, _) in &body.parts {
                    let material = scene.instances()[instance.0 as usize].material_id().0 as usize;
                    let own = materials[material];
                    let own = if is_bare { own.without_texture() } else { own };
                    materials[material] = color.map_or(own, |color| own.with_colour(color));
                }
            }
            scene = scene.with_materials(materials)?;
        }
        if let Some(lights) = self.lights_of_frame(scene.lights(), frame, lights) {
            scene = scene.with_lights(lights)?;
        }
        if let Some(ambient) = &self.ambient {
            scene = scene.with_environment(Environment { ambient: ambient[frame], ..scene.environment() });
        }
        Ok(scene)
    }

    /// Returns the lamps of a frame, if they are not those of the world.
    fn lights_of_frame<'a>(
        &self,
        own: &[Light],
        frame: usize,
        lights: &'a mut Vec<Light>,
    ) -> Option<&'a [Light]> {
        let Self { light_colors, light_vectors, spot_directions, .. } = self;
        if light_colors.is_none() && light_vectors.is_none() && spot_directions.is_none() {
            return None;
        }
        lights.clear();
        lights.extend_from_slice(own);
        let first = frame * lights.len();
        for (index, light) in lights.iter_mut().enumerate() {
            if let Some(colors) = light_colors {
                *light = light.with_diffuse(colors[first + index]);
            }
            if let Some(vectors) = light_vectors {
                *light = light.with_vector(vectors[first + index]);
            }
            if let Some(directions) = spot_directions
                && light.position().is_some()
            {
                *light = light.with_direction(directions[first + index]);
            }
        }
        Some(lights)
    }
}

/// Returns an array of `need` flags.
fn flags(argument: &str, array: &PyReadonlyArrayDyn<'_, bool>, need: usize) -> PyResult<Vec<bool>> {
    let flags = array.as_slice().map_err(|error| of(argument, error))?;
    if flags.len() != need {
        return Err(of(argument, format_args!("{} of them, and {need} are expected", flags.len())));
    }
    Ok(flags.to_vec())
}

/// Returns an array of `need` rows of three numbers.
fn rows<T: Element + bytemuck::Pod>(
    argument: &str,
    array: &PyReadonlyArrayDyn<'_, T>,
    need: usize,
) -> PyResult<Vec<[T; 3]>> {
    let (rows, rest) = array.as_slice().map_err(|error| of(argument, error))?.as_chunks::<3>();
    if rows.len() != need || !rest.is_empty() {
        return Err(of(argument, format_args!("{} rows, and {need} are expected", rows.len())));
    }
    Ok(rows.to_vec())
}
