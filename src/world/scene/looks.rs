//! How everything looks, beside what the files say.

use belvedere_sensors::scene::{Environment, Light, Material, Scene, SceneError};

/// Materials, lamps and light from everywhere, in the place of a scene's own.
#[derive(Debug, Clone)]
pub struct Looks {
    /// One in the place of each.
    pub materials: Vec<Material>,
    /// One in the place of each.
    pub lights: Vec<Light>,
    /// Light from everywhere, and what is seen where nothing is.
    pub environment: Environment,
}

impl Looks {
    /// Those of a scene.
    pub fn of(scene: &Scene<'_>) -> Self {
        Self {
            materials: scene.materials().to_vec(),
            lights: scene.lights().to_vec(),
            environment: scene.environment(),
        }
    }

    /// The same shapes in these looks.
    pub(super) fn on<'a>(&'a self, scene: Scene<'a>) -> Result<Scene<'a>, SceneError> {
        if self.lights.len() != scene.lights().len() {
            let (have, need) = (self.lights.len(), scene.lights().len());
            return Err(SceneError::Count { elements: "lights", have, need });
        }
        let scene = scene.with_materials(&self.materials)?.with_lights(&self.lights)?;
        Ok(scene.with_environment(self.environment))
    }
}
