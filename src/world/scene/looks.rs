//! [`Looks`]: materials and lights that replace those in the files.

use belvedere_sensors::scene::{Environment, Light, Material, Scene, SceneError};

/// Materials, lights and environment that replace a scene's own.
#[derive(Debug, Clone)]
pub struct Looks {
    /// The replacement of each material.
    pub materials: Vec<Material>,
    /// The replacement of each light.
    pub lights: Vec<Light>,
    /// Ambient light and background.
    pub environment: Environment,
}

impl Looks {
    /// Returns the looks of a scene.
    pub fn of(scene: &Scene<'_>) -> Self {
        Self {
            materials: scene.materials().to_vec(),
            lights: scene.lights().to_vec(),
            environment: scene.environment(),
        }
    }

    /// Returns a scene with these looks.
    pub(super) fn on<'a>(&'a self, scene: &Scene<'a>) -> Result<Scene<'a>, SceneError> {
        if self.lights.len() != scene.lights().len() {
            let (have, need) = (self.lights.len(), scene.lights().len());
            return Err(SceneError::Count { elements: "lights", have, need });
        }
        let scene = scene.with_materials(&self.materials)?.with_lights(&self.lights)?;
        Ok(scene.with_environment(self.environment))
    }
}
