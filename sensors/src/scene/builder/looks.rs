//! Textures, materials and lamps of a builder.

use super::{SceneBuilder, room, unused};
use crate::scene::texture::{TextureId, fill_mip_levels, mip_texels};
use crate::scene::{
    Light, LightConfig, LightId, LightKind, Material, MaterialConfig, MaterialId, NO_TEXTURE, SceneError,
    Texture, limits,
};
use alloc::vec;

impl SceneBuilder {
    /// Takes in a picture of `width` × `height` RGBA texels, top row first, and makes its mip levels.
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
        let texture = self.store_texture(width, height, rgba8)?;
        Ok(TextureId(self.textures.add(texture)))
    }

    /// Puts another picture, of any size, in the place of one. Materials that wear it wear the new one.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`], and those of [`SceneBuilder::add_texture`]; the old one is there then.
    pub fn set_texture(
        &mut self,
        texture: TextureId,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
    ) -> Result<(), SceneError> {
        let old = *self.textures.get(texture.0).ok_or(SceneError::NoSuchTexture)?;
        let new = self.store_texture(width, height, rgba8)?;
        self.texels.release(old.first_texel, mip_texels(old.width, old.height));
        if let Some(place) = self.textures.get_mut(texture.0) {
            *place = new;
        }
        Ok(())
    }

    /// Takes a picture out.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`], [`SceneError::InUse`] by a material.
    pub fn remove_texture(&mut self, texture: TextureId) -> Result<(), SceneError> {
        let old = unused(&self.textures, texture.0, SceneError::NoSuchTexture, || {
            let mut users = self.materials.items().iter().enumerate();
            let user = users.position(|(index, material)| {
                material.texture == texture.0 && self.materials.get(index as u32).is_some()
            });
            SceneError::InUse { user: "material", index: user.unwrap_or(0) as u32 }
        })?;
        self.texels.release(old.first_texel, mip_texels(old.width, old.height));
        self.textures.remove(texture.0, Texture { first_texel: 0, width: 0, height: 0, levels: 0 });
        Ok(())
    }

    fn store_texture(&mut self, width: u32, height: u32, rgba8: &[[u8; 4]]) -> Result<Texture, SceneError> {
        if width == 0 || height == 0 || rgba8.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(SceneError::BadTexture);
        }
        let start = self.texels.place(mip_texels(width, height), 32)?;
        let mut texels = vec![[0; 4]; mip_texels(width, height)];
        texels[..rgba8.len()].copy_from_slice(rgba8);
        fill_mip_levels(width, height, &mut texels);
        self.texels.put(start, &texels);
        Ok(Texture::new(width, height, start as u32))
    }

    /// Takes in a material.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`], [`SceneError::BadTextureRepeat`], [`SceneError::TooMany`].
    pub fn add_material(&mut self, config: &MaterialConfig) -> Result<MaterialId, SceneError> {
        room(&self.materials)?;
        let material = self.check_material(config)?;
        self.textures.use_one(material.texture);
        Ok(MaterialId(self.materials.add(material)))
    }

    /// Changes a material, and the look of all instances that have it.
    ///
    /// # Errors
    /// [`SceneError::NoSuchMaterial`], and those of [`SceneBuilder::add_material`].
    pub fn set_material(&mut self, material: MaterialId, config: &MaterialConfig) -> Result<(), SceneError> {
        let new = self.check_material(config)?;
        let place = self.materials.get_mut(material.0).ok_or(SceneError::NoSuchMaterial)?;
        let old = core::mem::replace(place, new);
        self.textures.use_one(new.texture);
        self.textures.leave_one(old.texture);
        Ok(())
    }

    /// Takes a material out.
    ///
    /// # Errors
    /// [`SceneError::NoSuchMaterial`], [`SceneError::InUse`] by an instance.
    pub fn remove_material(&mut self, material: MaterialId) -> Result<(), SceneError> {
        let old = unused(&self.materials, material.0, SceneError::NoSuchMaterial, || {
            self.used_by_instance(|instance| instance.material == material.0)
        })?;
        self.textures.leave_one(old.texture);
        self.materials.remove(material.0, Material::new(&MaterialConfig::default()));
        Ok(())
    }

    fn check_material(&self, config: &MaterialConfig) -> Result<Material, SceneError> {
        let material = Material::new(config);
        limits::material(&material)?;
        if material.texture != NO_TEXTURE && self.textures.get(material.texture).is_none() {
            return Err(SceneError::NoSuchTexture);
        }
        Ok(material)
    }

    /// Takes in a lamp.
    ///
    /// # Errors
    /// [`SceneError::BadLight`], [`SceneError::TooMany`].
    pub fn add_light(&mut self, config: &LightConfig) -> Result<LightId, SceneError> {
        room(&self.lights)?;
        Ok(LightId(self.lights.add(check_light(config)?)))
    }

    /// Changes a lamp.
    ///
    /// # Errors
    /// [`SceneError::NoSuchLight`], [`SceneError::BadLight`].
    pub fn set_light(&mut self, light: LightId, config: &LightConfig) -> Result<(), SceneError> {
        *self.lights.get_mut(light.0).ok_or(SceneError::NoSuchLight)? = check_light(config)?;
        Ok(())
    }

    /// Takes a lamp out. In its place there is one that gives no light, until another comes.
    ///
    /// # Errors
    /// [`SceneError::NoSuchLight`].
    pub fn remove_light(&mut self, light: LightId) -> Result<(), SceneError> {
        self.lights.get(light.0).ok_or(SceneError::NoSuchLight)?;
        let dark = LightConfig {
            kind: LightKind::Point { position: [0.0; 3] },
            diffuse: [0.0; 3],
            range_m: 0.0,
            attenuation: [1.0, 0.0, 0.0],
            cast_shadows: false,
        };
        self.lights.remove(light.0, Light::new(&dark));
        Ok(())
    }
}

fn check_light(config: &LightConfig) -> Result<Light, SceneError> {
    let light = Light::new(config);
    limits::light(&light)?;
    Ok(light)
}
