//! Instances of a builder, and their poses.

use super::{SceneBuilder, room};
use crate::pose::Pose;
use crate::scene::{
    Instance, InstanceConfig, InstanceId, Kind, MaterialConfig, MaterialId, SceneError, Shape, Triangles,
    limits,
};

impl SceneBuilder {
    /// Adds an instance. If no material was added, as in scenes for lidars only, the material may be left at its
    /// default: the scene then gets a material of [`MaterialConfig::default`], which is its first.
    ///
    /// # Errors
    /// The errors of [`Instance::new`], [`SceneError::NoSuchMesh`], [`SceneError::NoSuchHeightField`],
    /// [`SceneError::NoSuchMaterial`], [`SceneError::TooMany`].
    pub fn add_instance(&mut self, config: &InstanceConfig) -> Result<InstanceId, SceneError> {
        room(&self.instances)?;
        let mut instance = self.check_instance(config, None)?;
        if self.materials.is_empty() {
            instance.material = self.add_material(&MaterialConfig::default())?.0;
        }
        self.enter(&instance);
        let index = self.instances.add(instance);
        if index as usize == self.poses.len() {
            self.poses.push(config.world_from_instance);
        } else {
            self.poses[index as usize] = config.world_from_instance;
        }
        Ok(InstanceId(index))
    }

    /// Replaces an instance, including its pose; its id stays the same.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`], and those of [`SceneBuilder::add_instance`]; the old instance is then kept.
    pub fn set_instance(&mut self, instance: InstanceId, config: &InstanceConfig) -> Result<(), SceneError> {
        let old = *self.instances.get(instance.0).ok_or(SceneError::NoSuchInstance(instance.0))?;
        let new = self.check_instance(config, Some(&old))?;
        self.leave(&old);
        self.enter(&new);
        if let Some(place) = self.instances.get_mut(instance.0) {
            *place = new;
        }
        self.poses[instance.0 as usize] = config.world_from_instance;
        Ok(())
    }

    /// Removes an instance: no sensor sees it any more, and its index is reused by the next one added.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`].
    pub fn remove_instance(&mut self, instance: InstanceId) -> Result<(), SceneError> {
        let old = *self.instances.get(instance.0).ok_or(SceneError::NoSuchInstance(instance.0))?;
        self.leave(&old);
        let unseen = InstanceConfig { shape: Shape::Plane, visibility: 0, ..InstanceConfig::default() };
        // An index of a material that the scene has or had: baked scenes with other indices are rejected.
        let blank = Instance { material: old.material, ..Instance::new(&unseen)? };
        self.instances.remove(instance.0, blank);
        self.poses[instance.0 as usize] = Pose::IDENTITY;
        Ok(())
    }

    /// Sets the visibility mask of an instance; with 0 no sensor sees it.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`].
    pub fn set_visibility(&mut self, instance: InstanceId, visibility: u32) -> Result<(), SceneError> {
        self.instances.get_mut(instance.0).ok_or(SceneError::NoSuchInstance(instance.0))?.visibility =
            visibility;
        Ok(())
    }

    /// Returns the pose of an instance, or `None` if there is no such instance.
    pub fn pose(&self, instance: InstanceId) -> Option<Pose> {
        self.instances.get(instance.0)?;
        self.poses.get(instance.0 as usize).copied()
    }

    /// Sets the pose of an instance.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`], [`SceneError::BadPose`].
    pub fn set_pose(&mut self, instance: InstanceId, world_from_instance: Pose) -> Result<(), SceneError> {
        limits::pose(&world_from_instance)?;
        self.instances.get(instance.0).ok_or(SceneError::NoSuchInstance(instance.0))?;
        self.poses[instance.0 as usize] = world_from_instance;
        Ok(())
    }

    /// Checks an instance that is to be added, or to replace another.
    fn check_instance(
        &self,
        config: &InstanceConfig,
        replaced: Option<&Instance>,
    ) -> Result<Instance, SceneError> {
        let instance = Instance::new(config)?;
        match instance.kind() {
            Kind::Triangles(Triangles::Mesh) if self.meshes.get(instance.mesh).is_none() => {
                return Err(SceneError::NoSuchMesh(instance.mesh));
            }
            Kind::Triangles(Triangles::HeightField) if self.height_fields.get(instance.mesh).is_none() => {
                return Err(SceneError::NoSuchHeightField(instance.mesh));
            }
            Kind::Triangles(Triangles::Mesh | Triangles::HeightField) | Kind::Solid(_) => {}
        }
        let is_first = self.materials.is_empty() && config.material == MaterialId(0);
        if !is_first && self.materials.get(instance.material).is_none() {
            return Err(SceneError::NoSuchMaterial(instance.material));
        }
        // Slots of all instances together are counted in 31 bits.
        let replaced = replaced.map_or(0, |replaced| self.slots_of(replaced));
        if self.slots - replaced + self.slots_of(&instance) >= 1 << 31 {
            return Err(SceneError::TooMany);
        }
        Ok(instance)
    }

    /// Number of slots of one instance.
    fn slots_of(&self, instance: &Instance) -> u64 {
        u64::from(self.scene().slots(instance))
    }

    /// Counts the slots, mesh, height field and material that an instance uses.
    fn enter(&mut self, instance: &Instance) {
        self.slots += self.slots_of(instance);
        self.materials.use_one(instance.material);
        match instance.kind() {
            Kind::Triangles(Triangles::Mesh) => self.meshes.use_one(instance.mesh),
            Kind::Triangles(Triangles::HeightField) => self.height_fields.use_one(instance.mesh),
            Kind::Solid(_) => {}
        }
    }

    /// The opposite of [`SceneBuilder::enter`].
    fn leave(&mut self, instance: &Instance) {
        self.slots -= self.slots_of(instance);
        self.materials.leave_one(instance.material);
        match instance.kind() {
            Kind::Triangles(Triangles::Mesh) => self.meshes.leave_one(instance.mesh),
            Kind::Triangles(Triangles::HeightField) => self.height_fields.leave_one(instance.mesh),
            Kind::Solid(_) => {}
        }
    }

    /// The error that names the first instance that matches.
    pub(super) fn used_by_instance(&self, uses: impl Fn(&Instance) -> bool) -> SceneError {
        let mut all = self.instances.items().iter().enumerate();
        let user =
            all.position(|(index, instance)| uses(instance) && self.instances.get(index as u32).is_some());
        SceneError::InUse { user: "instance", index: user.unwrap_or(0) as u32 }
    }
}
