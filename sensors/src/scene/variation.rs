//! Variations of a scene: the same shapes with other materials, lamps and ambient light.

use super::{
    Air, Environment, Instance, Light, LightConfig, LightKind, Material, MaterialId, NO_TEXTURE, Scene,
    SceneError, limits,
};

impl<'a> Scene<'a> {
    /// The materials, in the order of their indices.
    pub fn materials(&self) -> &'a [Material] {
        self.materials
    }

    /// Returns true if any material shows something to lidars and depth cameras by reflection or transmission.
    pub(crate) fn has_mirrors_or_panes(&self) -> bool {
        self.materials.iter().any(Material::is_mirror_or_pane)
    }

    /// Returns the scene with each material replaced by the one with the same index.
    ///
    /// ```
    /// use belvedere_sensors::scene::*;
    /// let mut builder = SceneBuilder::new();
    /// let grey = builder.add_material(&MaterialConfig::default())?;
    /// let red = [builder.scene().materials()[grey.0 as usize].with_colour([1.0, 0.0, 0.0])];
    /// assert_eq!(builder.scene().with_materials(&red)?.materials().len(), 1);
    /// assert!(builder.scene().with_materials(&[]).is_err());
    /// # Ok::<(), SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Count`] if the number of materials differs, and the errors of
    /// [`SceneBuilder::add_material`](super::SceneBuilder::add_material).
    pub fn with_materials(self, materials: &'a [Material]) -> Result<Self, SceneError> {
        if materials.len() != self.materials.len() {
            let (have, need) = (materials.len(), self.materials.len());
            return Err(SceneError::Count { elements: "materials", have, need });
        }
        for material in materials {
            limits::material(material)?;
            limits::textures_of(material, |texture| self.textures.get(texture as usize))?;
        }
        Ok(Self { materials, ..self })
    }

    /// Returns the scene with other lamps.
    ///
    /// # Errors
    /// The errors of [`SceneBuilder::add_light`](super::SceneBuilder::add_light).
    pub fn with_lights(self, lights: &'a [Light]) -> Result<Self, SceneError> {
        lights.iter().try_for_each(limits::light)?;
        Ok(Self { lights, ..self })
    }

    /// Returns the scene with another environment.
    #[must_use]
    pub fn with_environment(self, environment: Environment) -> Self {
        Self { environment, ..self }
    }

    /// Fog and sky.
    pub fn air(&self) -> Air {
        self.air
    }

    /// The ambient light and the background.
    pub fn environment(&self) -> Environment {
        self.environment
    }
}

impl Material {
    /// Returns the material with another colour of reflected light, diffuse and ambient.
    #[must_use]
    pub const fn with_colour(mut self, colour: [f32; 3]) -> Self {
        (self.diffuse, self.ambient) = (colour, colour);
        self
    }
}

impl Material {
    /// Returns the material with `of` applied to its diffuse and to its ambient colour.
    #[must_use]
    pub fn recoloured(mut self, of: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        (self.diffuse, self.ambient) = (of(self.diffuse), of(self.ambient));
        self
    }

    /// Returns the material without its texture and its cube texture. A texture whose alpha is used is kept, since the
    /// shape depends on it.
    #[must_use]
    pub fn without_texture(mut self) -> Self {
        self.cube_texture = NO_TEXTURE;
        if !self.has_texture_alpha() {
            (self.texture, self.light_texture) = (NO_TEXTURE, NO_TEXTURE);
        }
        self
    }

    /// The diffuse colour, which is multiplied by the texture.
    pub const fn colour(&self) -> [f32; 3] {
        self.diffuse
    }
}

impl Light {
    /// Returns the lamp with its diffuse and specular light multiplied by a factor for red, green and blue.
    #[must_use]
    pub fn times(mut self, factor: [f32; 3]) -> Self {
        for (channel, factor) in factor.into_iter().enumerate() {
            self.diffuse[channel] *= factor;
            self.specular[channel] *= factor;
        }
        self
    }

    /// Unit vector along which the light of a directional lamp or a spot travels, in the world; `None` for a point
    /// light.
    pub fn direction(&self) -> Option<[f64; 3]> {
        (self.form() != super::Form::Point).then_some(self.direction)
    }

    /// Position of a point light or a spot in the world, in metres; `None` for directional light.
    pub fn position(&self) -> Option<[f64; 3]> {
        (self.form() != super::Form::Directional).then_some(self.position)
    }

    /// Returns a directional lamp or spot with another direction, of any length but 0. Point lights are returned
    /// unchanged.
    #[must_use]
    pub fn with_direction(mut self, direction: [f64; 3]) -> Self {
        if self.form() != super::Form::Point {
            let kind = LightKind::Directional { direction };
            self.direction = Self::new(&LightConfig { kind, ..LightConfig::default() }).direction;
        }
        self
    }

    /// Returns the lamp with another diffuse colour.
    #[must_use]
    pub const fn with_diffuse(mut self, diffuse: [f32; 3]) -> Self {
        self.diffuse = diffuse;
        self
    }

    /// Returns the lamp moved to another position in the world, or, if it is directional, with another direction of
    /// travel.
    #[must_use]
    pub fn with_vector(self, vector: [f64; 3]) -> Self {
        let is_parallel = self.form() == super::Form::Directional;
        let kind = if is_parallel {
            LightKind::Directional { direction: vector }
        } else {
            LightKind::Point { position: vector }
        };
        let moved = Self::new(&LightConfig { kind, ..LightConfig::default() });
        if is_parallel {
            Self { direction: moved.direction, ..self }
        } else {
            Self { position: moved.position, ..self }
        }
    }

    /// The position, or the direction of a directional lamp, as set by [`Light::with_vector`], and the diffuse colour.
    pub fn vector_and_diffuse(&self) -> ([f64; 3], [f32; 3]) {
        let is_parallel = self.form() == super::Form::Directional;
        (if is_parallel { self.direction } else { self.position }, self.diffuse)
    }
}

impl Instance {
    /// The index of the material.
    pub const fn material_id(&self) -> MaterialId {
        MaterialId(self.material)
    }
}
