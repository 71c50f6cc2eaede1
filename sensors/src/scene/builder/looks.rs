//! Textures, materials and lamps of a builder.

use super::{SceneBuilder, room, unused};
use crate::scene::texture::{COLOURS, DATA, TextureId};
use crate::scene::{
    ColourSpace, Light, LightConfig, LightId, Material, MaterialConfig, MaterialId, SceneError, Sky, Texture,
    fill_cube, limits,
};
use alloc::vec;

impl SceneBuilder {
    /// Adds a texture of `width` × `height` RGBA texels, top row first, and computes its mip levels.
    ///
    /// # Errors
    /// [`SceneError::BadTexture`], [`SceneError::TooMany`].
    pub fn add_texture(
        &mut self,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
    ) -> Result<TextureId, SceneError> {
        room(&self.textures)?;
        let texture = self.store_texture(width, height, rgba8, COLOURS)?;
        Ok(TextureId(self.textures.add(texture)))
    }

    /// Adds a normal map. Red, green and blue are the components of the normal along u, along v and outwards; 0 to 255
    /// represent −1 to 1. Unlike a colour texture it is averaged linearly, whatever the [`ColourSpace`].
    ///
    /// # Errors
    /// The errors of [`SceneBuilder::add_texture`].
    pub fn add_normal_map(
        &mut self,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
    ) -> Result<TextureId, SceneError> {
        self.add_data(width, height, rgba8)
    }

    /// Adds a map of roughness (green) and metalness (blue), 0 to 255 for 0 to 1. Like a
    /// [normal map](SceneBuilder::add_normal_map) it is averaged linearly, whatever the [`ColourSpace`].
    ///
    /// # Errors
    /// The errors of [`SceneBuilder::add_texture`].
    pub fn add_pbr_map(
        &mut self,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
    ) -> Result<TextureId, SceneError> {
        self.add_data(width, height, rgba8)
    }

    /// Adds a cube texture from its six faces of `size` × `size` RGBA texels, one after the other, and computes its mip
    /// levels. Each face is as in OpenGL; these are the directions to the right and up in its image:
    ///
    /// | face | right | up |
    /// |---|---|---|
    /// | +x | −z | +y |
    /// | −x | +z | +y |
    /// | +y | +x | −z |
    /// | −y | +x | +z |
    /// | +z | +x | +y |
    /// | −z | −x | +y |
    ///
    /// It is the texture of a [sky](Sky::Cube) or a [`CubeTexture`](crate::scene::CubeTexture) of materials.
    ///
    /// # Errors
    /// [`SceneError::BadCube`], [`SceneError::TooMany`].
    pub fn add_cube_texture(&mut self, size: u32, rgba8: &[[u8; 4]]) -> Result<TextureId, SceneError> {
        room(&self.textures)?;
        let texels = u64::from(size).checked_mul(u64::from(size)).and_then(|face| face.checked_mul(6));
        if size == 0 || texels != Some(rgba8.len() as u64) {
            return Err(SceneError::BadCube);
        }
        let texture = Texture::cube(size, 0);
        let start = self.texels.place(texture.texels(), 32)?;
        let mut texels = vec![[0; 4]; texture.texels()];
        fill_cube(size, rgba8, &mut texels, self.colour_space);
        self.texels.put(start, &texels);
        Ok(TextureId(self.textures.add(Texture { first_texel: start as u32, ..texture })))
    }

    /// Adds a texture whose values are not colours.
    fn add_data(&mut self, width: u32, height: u32, rgba8: &[[u8; 4]]) -> Result<TextureId, SceneError> {
        room(&self.textures)?;
        let texture = self.store_texture(width, height, rgba8, DATA)?;
        Ok(TextureId(self.textures.add(texture)))
    }

    /// Replaces a texture that is not a cube by another of any size. Materials that use it show the new one.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`], [`SceneError::WrongTexture`], and those of [`SceneBuilder::add_texture`]; the
    /// old texture is then kept.
    pub fn set_texture(
        &mut self,
        texture: TextureId,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
    ) -> Result<(), SceneError> {
        let old = *self.textures.get(texture.0).ok_or(SceneError::NoSuchTexture(texture.0))?;
        if old.is_cube() {
            return Err(SceneError::WrongTexture(texture.0));
        }
        let new = self.store_texture(width, height, rgba8, old.kind)?;
        self.texels.release(old.first_texel, old.texels());
        if let Some(place) = self.textures.get_mut(texture.0) {
            *place = new;
        }
        Ok(())
    }

    /// Removes a texture.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`], [`SceneError::InUse`] by a material or the sky.
    pub fn remove_texture(&mut self, texture: TextureId) -> Result<(), SceneError> {
        let old = unused(&self.textures, texture.0, SceneError::NoSuchTexture(texture.0), || {
            if self.air.sky == Some(Sky::Cube(texture)) {
                return SceneError::InUse { user: "sky", index: 0 };
            }
            let mut users = self.materials.items().iter().enumerate();
            let user = users.position(|(index, material)| {
                material.textures().iter().any(|&(_, of_material)| of_material == texture.0)
                    && self.materials.get(index as u32).is_some()
            });
            SceneError::InUse { user: "material", index: user.unwrap_or(0) as u32 }
        })?;
        self.texels.release(old.first_texel, old.texels());
        self.textures
            .remove(texture.0, Texture { first_texel: 0, width: 0, height: 0, levels: 0, kind: COLOURS });
        Ok(())
    }

    fn store_texture(
        &mut self,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
        kind: u32,
    ) -> Result<Texture, SceneError> {
        if width == 0 || height == 0 || rgba8.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(SceneError::BadTexture);
        }
        let texture = Texture { kind, ..Texture::new(width, height, 0) };
        let start = self.texels.place(texture.texels(), 32)?;
        let mut texels = vec![[0; 4]; texture.texels()];
        texels[..rgba8.len()].copy_from_slice(rgba8);
        texture.fill(&mut texels, if kind == DATA { ColourSpace::AsGiven } else { self.colour_space });
        self.texels.put(start, &texels);
        Ok(Texture { first_texel: start as u32, ..texture })
    }

    /// Sets the colour space of the background and of all materials and textures, present and future.
    ///
    /// ```
    /// use belvedere_sensors::{camera::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose, Sensor};
    /// let mut builder = SceneBuilder::new();
    /// builder.set_environment(Environment { ambient: [0.5; 3], ..Default::default() });
    /// let grey = builder.add_material(&MaterialConfig { ambient: [0.8; 3], ..Default::default() })?;
    /// builder.add_instance(&InstanceConfig {
    ///     world_from_instance: Pose::from_translation(belvedere_sensors::glam::DVec3::X * 2.0),
    ///     material: grey,
    ///     ..Default::default()
    /// })?;
    /// let camera = Camera::new(CameraConfig::new(PinholeGrid::from_fov(5, 5, 0.1)?))?;
    /// let grey_in = |builder: &SceneBuilder| {
    ///     let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(Pose::IDENTITY)));
    ///     let mut pixels = [0; 75];
    ///     let mut memory = WorkspaceBuf::default();
    ///     camera.sense_in(&mut memory, &scene, &capture, Picture::new().colour(&mut pixels)).unwrap();
    ///     pixels[36]
    /// };
    /// assert_eq!(grey_in(&builder), 102); // half of 0.8
    /// builder.set_colour_space(ColourSpace::Srgb);
    /// assert_eq!(grey_in(&builder), 149); // half the light of 0.8 in sRGB
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_colour_space(&mut self, colour_space: ColourSpace) {
        if core::mem::replace(&mut self.colour_space, colour_space) == colour_space {
            return;
        }
        for texture in self.textures.items() {
            // Removed textures have no size.
            if texture.width > 0 && texture.kind != DATA {
                texture.fill(self.texels.slice_mut(texture.first_texel, texture.texels()), colour_space);
            }
        }
    }

    /// Adds a material.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`], [`SceneError::WrongTexture`], [`SceneError::BadTextureRepeat`],
    /// [`SceneError::BadShininess`], [`SceneError::BadPbr`], [`SceneError::BadAlpha`], [`SceneError::BadShares`],
    /// [`SceneError::TooMany`].
    pub fn add_material(&mut self, config: &MaterialConfig) -> Result<MaterialId, SceneError> {
        room(&self.materials)?;
        let material = self.check_material(config)?;
        for (_, texture) in material.textures() {
            self.textures.use_one(texture);
        }
        Ok(MaterialId(self.materials.add(material)))
    }

    /// Replaces a material. All instances that use it show the new one.
    ///
    /// # Errors
    /// [`SceneError::NoSuchMaterial`], and those of [`SceneBuilder::add_material`].
    pub fn set_material(&mut self, material: MaterialId, config: &MaterialConfig) -> Result<(), SceneError> {
        let new = self.check_material(config)?;
        let place = self.materials.get_mut(material.0).ok_or(SceneError::NoSuchMaterial(material.0))?;
        let old = core::mem::replace(place, new);
        for ((_, new), (_, old)) in new.textures().into_iter().zip(old.textures()) {
            self.textures.use_one(new);
            self.textures.leave_one(old);
        }
        Ok(())
    }

    /// Removes a material.
    ///
    /// # Errors
    /// [`SceneError::NoSuchMaterial`], [`SceneError::InUse`] by an instance.
    pub fn remove_material(&mut self, material: MaterialId) -> Result<(), SceneError> {
        let old = unused(&self.materials, material.0, SceneError::NoSuchMaterial(material.0), || {
            self.used_by_instance(|instance| instance.material == material.0)
        })?;
        for (_, texture) in old.textures() {
            self.textures.leave_one(texture);
        }
        self.materials.remove(material.0, Material::new(&MaterialConfig::default()));
        Ok(())
    }

    fn check_material(&self, config: &MaterialConfig) -> Result<Material, SceneError> {
        let material = Material::new(config);
        limits::material(&material)?;
        limits::textures_of(&material, |texture| self.textures.get(texture))?;
        Ok(material)
    }

    /// Adds a lamp.
    ///
    /// # Errors
    /// [`SceneError::BadLight`], [`SceneError::BadFalloff`], [`SceneError::TooMany`].
    pub fn add_light(&mut self, config: &LightConfig) -> Result<LightId, SceneError> {
        room(&self.lights)?;
        Ok(LightId(self.lights.add(check_light(config)?)))
    }

    /// Replaces a lamp.
    ///
    /// # Errors
    /// [`SceneError::NoSuchLight`], and those of [`SceneBuilder::add_light`].
    pub fn set_light(&mut self, light: LightId, config: &LightConfig) -> Result<(), SceneError> {
        *self.lights.get_mut(light.0).ok_or(SceneError::NoSuchLight(light.0))? = check_light(config)?;
        Ok(())
    }

    /// Removes a lamp. Until its index is reused, a lamp that gives no light takes its place.
    ///
    /// # Errors
    /// [`SceneError::NoSuchLight`].
    pub fn remove_light(&mut self, light: LightId) -> Result<(), SceneError> {
        self.lights.get(light.0).ok_or(SceneError::NoSuchLight(light.0))?;
        let dark = LightConfig { diffuse: [0.0; 3], range_m: 0.0, ..LightConfig::default() };
        self.lights.remove(light.0, Light::new(&dark));
        Ok(())
    }
}

fn check_light(config: &LightConfig) -> Result<Light, SceneError> {
    let light = Light::new(config);
    limits::light(&light)?;
    Ok(light)
}
