//! Mirrors the colliders of rapier3d in a scene, and keeps them in step with their bodies (feature `rapier`).

use crate::parry::{ParryError, Part};
use crate::pose::Pose;
use crate::scene::{InstanceConfig, InstanceId, SceneBuilder};
use alloc::vec::Vec;
use core::fmt;
use parry3d::shape::SharedShape;
use rapier3d::dynamics::{IslandManager, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// An instance of a collider, and its pose in the collider's frame.
#[derive(Debug, Clone, Copy)]
struct PlacedPart {
    instance: InstanceId,
    collider_from_instance: Pose,
}

/// A collider that is mirrored in the scene.
#[derive(Debug, Default)]
struct Mirrored {
    /// Address of its shape.
    address: usize,
    instances: Vec<PlacedPart>,
}

/// A shape that is in the scene.
struct Taken {
    /// Keeps the shape alive, so that no other shape can have its address.
    _shape: SharedShape,
    parts: Vec<Part>,
    /// Number of colliders that use the shape.
    users: usize,
}

/// A mirror of a [`ColliderSet`] in a scene, which may contain other things as well.
///
/// After each step, [`ColliderScene::update`] copies the poses of the bodies that are awake, and of those that have
/// fallen asleep since the last call; bodies at rest cost nothing. Colliders with the same [`SharedShape`] share its
/// mesh, which is removed with the last of them, so a scene in which things come and go does not grow.
///
/// ```
/// use belvedere_sensors::{rapier::ColliderScene, scene::*};
/// use rapier3d::prelude::*;
/// let mut world = PhysicsWorld::new();
/// let (body, collider) = world.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::ball(0.5));
/// let mut builder = SceneBuilder::new();
/// let material = builder.add_material(&MaterialConfig::default())?;
/// let mut mirror = ColliderScene::new();
/// let look = InstanceConfig { material, ..Default::default() };
/// mirror.add(&mut builder, &world.colliders, collider, &look)?;
/// world.step();
/// mirror.update(&mut builder, &world.islands, &world.bodies, &world.colliders);
/// let ball = mirror.instances(collider).next().unwrap();
/// let height = builder.pose(ball).unwrap().translation().z;
/// assert_eq!(height, f64::from(world.bodies[body].translation().z));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct ColliderScene {
    placed: HashMap<ColliderHandle, Mirrored>,
    /// Shapes by their addresses.
    shapes: HashMap<usize, Taken>,
    /// Bodies that were awake at the last update.
    awake: Vec<RigidBodyHandle>,
}

impl fmt::Debug for ColliderScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ColliderScene")
            .field("placed", &self.placed)
            .field("shapes", &self.shapes.len())
            .field("awake", &self.awake)
            .finish()
    }
}

impl ColliderScene {
    /// Creates an empty mirror.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a collider to the scene, with the material, visibility and lidar intensity of `look`. If the collider is
    /// already mirrored, it is replaced, using its current shape.
    ///
    /// # Errors
    /// [`ColliderError::NoSuchCollider`]; [`ColliderError::Shape`] if the shape cannot be traced. In the latter case,
    /// the collider is not in the scene.
    pub fn add(
        &mut self,
        builder: &mut SceneBuilder,
        colliders: &ColliderSet,
        collider: ColliderHandle,
        look: &InstanceConfig,
    ) -> Result<(), ColliderError> {
        let handle = collider;
        let collider = colliders.get(handle).ok_or(ColliderError::NoSuchCollider(handle))?;
        // The new shape is added before the old one is removed, so that an unchanged shape is not rebuilt.
        let taken = self.take(builder, collider);
        self.remove(builder, handle);
        let address = taken?;
        let parts = self.shapes.get(&address).map_or(&[][..], |taken| &taken.parts);
        let look = InstanceConfig { world_from_instance: Pose::from(*collider.position()), ..*look };
        let mirrored = self.placed.entry(handle).or_default();
        mirrored.address = address;
        for part in parts {
            match builder.add_instance(&part.instance(&look)) {
                Ok(instance) => {
                    mirrored
                        .instances
                        .push(PlacedPart { instance, collider_from_instance: part.shape_from_part });
                }
                Err(error) => {
                    self.remove(builder, handle);
                    return Err(ParryError::from(error).into());
                }
            }
        }
        Ok(())
    }

    /// Removes a collider from the scene; returns false if it is not mirrored. The collider set may or may not still
    /// contain it.
    pub fn remove(&mut self, builder: &mut SceneBuilder, collider: ColliderHandle) -> bool {
        let Some(mirrored) = self.placed.remove(&collider) else { return false };
        for PlacedPart { instance, .. } in mirrored.instances {
            let removed = builder.remove_instance(instance);
            debug_assert!(removed.is_ok(), "the instances of a collider are its mirror's alone");
        }
        if let Entry::Occupied(mut taken) = self.shapes.entry(mirrored.address) {
            taken.get_mut().users -= 1;
            if taken.get().users == 0 {
                let removed = builder.remove_parry_shape(&taken.remove().parts);
                debug_assert!(removed.is_ok(), "the meshes of a shape are its mirror's alone");
            }
        }
        true
    }

    /// Adds a collider's shape, or counts one more user of it, and returns its key in `shapes`.
    fn take(&mut self, builder: &mut SceneBuilder, collider: &Collider) -> Result<usize, ColliderError> {
        let address = address(collider);
        match self.shapes.entry(address) {
            Entry::Occupied(mut taken) => taken.get_mut().users += 1,
            Entry::Vacant(place) => {
                let parts = builder.add_parry_shape(collider.shape(), [1.0; 3])?;
                place.insert(Taken { _shape: collider.shared_shape().clone(), parts, users: 1 });
            }
        }
        Ok(address)
    }

    /// The instances that show a collider; empty if it is not mirrored.
    pub fn instances(&self, collider: ColliderHandle) -> impl Iterator<Item = InstanceId> + '_ {
        self.placed
            .get(&collider)
            .into_iter()
            .flat_map(|mirrored| &mirrored.instances)
            .map(|placed| placed.instance)
    }

    /// Copies the poses of all colliders whose bodies may have moved since the last call: bodies that are awake now,
    /// and those that were awake then. Call this after each step.
    ///
    /// rapier3d counts neither fixed bodies nor colliders without a body as awake. If you move one of these yourself,
    /// call [`ColliderScene::refresh`].
    pub fn update(
        &mut self,
        builder: &mut SceneBuilder,
        islands: &IslandManager,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) {
        let mut awake = core::mem::take(&mut self.awake);
        for body in awake.drain(..).filter_map(|handle| bodies.get(handle)) {
            // Bodies that are still awake are handled below.
            if body.is_sleeping() || !body.is_enabled() {
                self.refresh_all(builder, colliders, body.colliders());
            }
        }
        awake.extend(islands.active_bodies());
        for body in awake.iter().filter_map(|handle| bodies.get(*handle)) {
            self.refresh_all(builder, colliders, body.colliders());
        }
        self.awake = awake;
    }

    fn refresh_all(&self, builder: &mut SceneBuilder, colliders: &ColliderSet, handles: &[ColliderHandle]) {
        for handle in handles {
            self.refresh(builder, colliders, *handle);
        }
    }

    /// Copies the pose of one collider; returns false if it is not mirrored, is no longer in the set, or has an invalid
    /// pose.
    pub fn refresh(
        &self,
        builder: &mut SceneBuilder,
        colliders: &ColliderSet,
        collider: ColliderHandle,
    ) -> bool {
        let (Some(placed), Some(collider)) = (self.placed.get(&collider), colliders.get(collider)) else {
            return false;
        };
        let world_from_collider = Pose::from(*collider.position());
        placed.instances.iter().all(|part| {
            builder.set_pose(part.instance, world_from_collider * part.collider_from_instance).is_ok()
        })
    }
}

/// The key that identifies a shape.
fn address(collider: &Collider) -> usize {
    core::ptr::from_ref(collider.shape()).addr()
}

/// The reason why a collider cannot be mirrored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ColliderError {
    /// The set does not contain the collider.
    NoSuchCollider(ColliderHandle),
    /// The collider's shape cannot be traced.
    Shape(ParryError),
}

impl fmt::Display for ColliderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchCollider(handle) => write!(f, "the set has no collider {handle:?}"),
            Self::Shape(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ColliderError {}

impl From<ParryError> for ColliderError {
    fn from(error: ParryError) -> Self {
        Self::Shape(error)
    }
}
