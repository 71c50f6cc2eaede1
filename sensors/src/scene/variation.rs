//! A scene in other looks: other materials, lamps and light from everywhere, beside the same shapes.

use super::{
    Environment, Instance, Light, LightConfig, LightKind, Material, MaterialId, NO_TEXTURE, Scene,
    SceneError, limits,
};

impl<'a> Scene<'a> {
    /// The materials, by their indices.
    pub fn materials(&self) -> &'a [Material] {
        self.materials
    }

    /// Whether lidars and depth cameras see anything by way of a material.
    pub(crate) fn has_mirrors_or_panes(&self) -> bool {
        self.materials.iter().any(Material::is_mirror_or_pane)
    }

    /// The same shapes in other materials, one in the place of each.
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
    /// [`SceneError::NoSuchMaterial`] if there are not as many; what
    /// [`SceneBuilder::add_material`](super::SceneBuilder::add_material) refuses.
    pub fn with_materials(self, materials: &'a [Material]) -> Result<Self, SceneError> {
        if materials.len() != self.materials.len() {
            return Err(SceneError::NoSuchMaterial);
        }
        for material in materials {
            limits::material(material)?;
            let is_there = |texture: u32| texture == NO_TEXTURE || (texture as usize) < self.textures.len();
            if !(is_there(material.texture) && is_there(material.normal_map)) {
                return Err(SceneError::NoSuchTexture);
            }
        }
        Ok(Self { materials, ..self })
    }

    /// The same shapes in the light of other lamps.
    ///
    /// # Errors
    /// What [`SceneBuilder::add_light`](super::SceneBuilder::add_light) refuses.
    pub fn with_lights(self, lights: &'a [Light]) -> Result<Self, SceneError> {
        lights.iter().try_for_each(limits::light)?;
        Ok(Self { lights, ..self })
    }

    /// The same shapes in other light from everywhere.
    #[must_use]
    pub fn with_environment(self, environment: Environment) -> Self {
        Self { environment, ..self }
    }

    /// Light from everywhere, and what is seen where nothing is.
    pub fn environment(&self) -> Environment {
        self.environment
    }
}

impl Material {
    /// The same in another colour of reflected light.
    #[must_use]
    pub const fn with_colour(mut self, colour: [f32; 3]) -> Self {
        (self.diffuse, self.ambient) = (colour, colour);
        self
    }
}

impl Material {
    /// The same with its colours of reflected light, of lamps and from everywhere, made into others one by one.
    #[must_use]
    pub fn recoloured(mut self, of: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        (self.diffuse, self.ambient) = (of(self.diffuse), of(self.ambient));
        self
    }

    /// The same without its picture. One whose alpha says where the surface is stays: the shape would be another one.
    #[must_use]
    pub fn without_texture(mut self) -> Self {
        if !self.has_texture_alpha() {
            self.texture = NO_TEXTURE;
        }
        self
    }

    /// Colour of the reflected light of lamps, which a texture is multiplied by.
    pub const fn colour(&self) -> [f32; 3] {
        self.diffuse
    }

    /// Whether it has a picture.
    pub const fn is_textured(&self) -> bool {
        self.texture != NO_TEXTURE
    }
}

impl Light {
    /// The same lamp with its light, that of highlights as well, times a factor in each of red, green and blue.
    #[must_use]
    pub fn times(mut self, factor: [f32; 3]) -> Self {
        for (channel, factor) in factor.into_iter().enumerate() {
            self.diffuse[channel] *= factor;
            self.specular[channel] *= factor;
        }
        self
    }

    /// Unit vector along which the light of a directional lamp or a spot travels, in the world.
    pub fn direction(&self) -> Option<[f64; 3]> {
        (self.form() != super::Form::Point).then_some(self.direction)
    }

    /// Where a point of light or a spot is, in the world, in metres.
    pub fn position(&self) -> Option<[f64; 3]> {
        (self.form() != super::Form::Directional).then_some(self.position)
    }

    /// A directional lamp or spot that shines along another vector of any length but 0; others as they are.
    #[must_use]
    pub fn with_direction(mut self, direction: [f64; 3]) -> Self {
        if self.form() != super::Form::Point {
            let kind = LightKind::Directional { direction };
            self.direction = Self::new(&LightConfig { kind, ..LightConfig::default() }).direction;
        }
        self
    }

    /// The same lamp of another colour.
    #[must_use]
    pub const fn with_diffuse(mut self, diffuse: [f32; 3]) -> Self {
        self.diffuse = diffuse;
        self
    }

    /// The same lamp elsewhere: a position in the world, or of parallel light the direction in which it travels.
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

    /// What [`Light::with_vector`] changes, and its colour.
    pub fn vector_and_diffuse(&self) -> ([f64; 3], [f32; 3]) {
        let is_parallel = self.form() == super::Form::Directional;
        (if is_parallel { self.direction } else { self.position }, self.diffuse)
    }
}

impl Instance {
    /// How it looks.
    pub const fn material_id(&self) -> MaterialId {
        MaterialId(self.material)
    }
}
