//! [`WorldScene`]: the world's shapes, materials and lights as a `sensors` scene, kept in step with physics.

mod assembly;
mod flags;
mod looks;

pub use flags::flag_bits;
pub use looks::Looks;

use crate::description::diagnostics::Problem;
use crate::description::housing::ShapeIndex;
use crate::description::model as description;
use crate::description::model::{LinkIndex, Model, World};
use crate::world::physics::{ModelIndex, Physics};
use assembly::{Assembly, Placed, of_link, refused};
use belvedere_sensors::scene::{
    ColourSpace, Environment, InstanceId, LightConfig, LightKind, Scene, SceneBuilder, SceneError, Shape,
};
use belvedere_sensors::{Moment, Pose};

/// The visibility bit of shapes that no sensor sees.
const HIDDEN: u32 = 1 << 31;

/// The scene of a running world.
#[derive(Debug)]
pub struct WorldScene {
    assembly: Assembly,
    stamp_ns: Option<u64>,
    edition: u64,
    /// Replaces the looks in the files.
    looks: Option<Looks>,
}

impl WorldScene {
    /// Builds the scene of a world, with links at their current poses in `physics`.
    ///
    /// # Errors
    /// A shape that cannot be traced; the problem names its place in the file.
    pub fn new(world: &World, physics: &Physics) -> Result<Self, Problem> {
        let mut assembly = Assembly::default();
        assembly
            .builder
            .set_environment(Environment { ambient: world.ambient, background: world.background });
        let air = assembly.builder.set_air(world.air);
        air.map_err(|error| refused(error, &world.source))?;
        let space = if world.linear_light { ColourSpace::Srgb } else { ColourSpace::AsGiven };
        assembly.builder.set_colour_space(space);
        for (index, model) in world.models.iter().enumerate() {
            for (link_index, link) in model.links.iter().enumerate() {
                let world_from_link = physics.world_from_link(index, link_index);
                assembly.add_link((index, link_index), link, &world_from_link)?;
            }
        }
        for light in &world.lights {
            let added = assembly.builder.add_light(&lamp(light, world.shadows));
            added.map_err(|error| refused(error, &light.source))?;
        }
        assembly.forget_files();
        Ok(Self { assembly, stamp_ns: None, edition: 0, looks: None })
    }

    /// Moves all moving links to their poses at a time between the last two physics steps.
    pub fn move_to(&mut self, physics: &Physics, stamp_ns: u64) {
        if self.stamp_ns == Some(stamp_ns) {
            return;
        }
        self.stamp_ns = Some(stamp_ns);
        for (model, link, world_from_link) in physics.moving_links_at(stamp_ns) {
            self.assembly.set_pose((model, link), &world_from_link);
        }
    }

    /// Updates the poses of all links from physics, including static ones, after a model was moved by hand.
    pub fn replace(&mut self, physics: &Physics) {
        self.stamp_ns = None;
        for model in 0..self.assembly.placed.len() {
            self.replace_model(model, physics);
        }
    }

    /// Like [`WorldScene::replace`], for one model.
    pub fn replace_model(&mut self, model: ModelIndex, physics: &Physics) {
        self.stamp_ns = None;
        for link in 0..self.assembly.placed.get(model).map_or(0, Vec::len) {
            self.assembly.set_pose((model, link), &physics.world_from_link(model, link));
        }
    }

    /// Adds a model whose frame is at `world_from_model`.
    ///
    /// # Errors
    /// The errors of [`WorldScene::new`]; then no part of the model is added.
    pub fn add_model(
        &mut self,
        index: ModelIndex,
        model: &Model,
        world_from_model: &Pose,
    ) -> Result<(), Problem> {
        self.stamp_ns = None;
        self.edition += 1;
        self.looks = None;
        let added = model.links.iter().enumerate().try_for_each(|(number, link)| {
            self.assembly.add_link((index, number), link, &(*world_from_model * link.model_from_link))
        });
        self.assembly.forget_files();
        if added.is_err() {
            self.remove_model(index);
        }
        added
    }

    /// Returns the problems of drawing since the last call.
    pub fn take_notes(&mut self) -> Vec<Problem> {
        std::mem::take(&mut self.assembly.notes)
    }

    /// Hides shapes of a model, so that rays pass through them, or shows them again.
    pub fn hide(&mut self, model: ModelIndex, shapes: &[ShapeIndex], hidden: bool) {
        for (link, part) in shapes {
            let placed = of_link(&self.assembly.placed, (model, *link)).iter();
            for placed in placed.filter(|placed| placed.part == *part) {
                // Not 0, so that nothing else in the scene changes.
                let seen = if hidden { HIDDEN } else { placed.visibility };
                // This cannot fail, because the instance exists.
                let _ = self.assembly.builder.set_visibility(placed.instance, seen);
            }
        }
    }

    /// Removes a model. Its places and memory in the scene are used again.
    pub fn remove_model(&mut self, index: ModelIndex) {
        self.edition += 1;
        self.looks = None;
        let assembly = &mut self.assembly;
        let links = assembly.placed.get_mut(index).map(std::mem::take).unwrap_or_default();
        let mut gone: Vec<_> = links.into_iter().flatten().collect();
        assembly.fiducials.retain(|tag| gone.iter().all(|placed| placed.instance.0 != tag.instance));
        // Removed in reverse order, so that the first places are used again first.
        gone.sort_unstable_by_key(|placed| std::cmp::Reverse(placed.instance.0));
        for placed in &gone {
            // This cannot fail, because the instance exists.
            let _ = assembly.builder.remove_instance(placed.instance);
        }
        // Meshes and materials that others use, or that are already removed, are refused.
        for Placed { shape, material, .. } in gone {
            if let Shape::Mesh(mesh) = shape {
                let _ = assembly.builder.remove_mesh(mesh);
            }
            if assembly.bare != Some(material) {
                let _ = assembly.builder.remove_material(material);
            }
        }
    }

    /// Returns the current moment of the scene, with a sensor at `world_from_sensor`.
    pub fn moment(&self, world_from_sensor: Pose) -> Moment<'_> {
        self.assembly.builder.moment(world_from_sensor)
    }

    /// Returns the poses of all instances.
    pub fn poses(&self) -> &[Pose] {
        self.assembly.builder.poses()
    }

    /// Returns a number that changes when models are added or removed, which changes the instances.
    pub fn edition(&self) -> u64 {
        self.edition
    }

    /// Appends the poses of all instances at an earlier time, which must be within physics' history.
    pub fn poses_at(&self, physics: &Physics, time_ns: u64, poses: &mut Vec<Pose>) {
        let first = poses.len();
        poses.extend_from_slice(self.poses());
        for (model, link, world_from_link) in physics.moving_links_at(time_ns) {
            for placed in of_link(&self.assembly.placed, (model, link)) {
                let pose = world_from_link * placed.link_from_shape;
                if pose.is_finite() {
                    poses[first + placed.instance.0 as usize] = pose;
                }
            }
        }
    }

    /// Returns all tags in the order in which they were added.
    pub fn fiducials(&self) -> &[PlacedFiducial] {
        &self.assembly.fiducials
    }

    /// Returns the scene builder with the current poses.
    pub fn builder(&self) -> &SceneBuilder {
        &self.assembly.builder
    }

    /// Returns the instances of each link, with their poses in the link's frame.
    pub fn parts(&self) -> impl Iterator<Item = (ModelIndex, LinkIndex, InstanceId, Pose)> + '_ {
        self.assembly.placed.iter().enumerate().flat_map(|(model, links)| {
            links.iter().enumerate().flat_map(move |(link, parts)| {
                parts.iter().map(move |placed| (model, link, placed.instance, placed.link_from_shape))
            })
        })
    }

    /// Returns the scene with its current looks.
    pub fn scene(&self) -> Scene<'_> {
        let scene = self.assembly.builder.scene();
        // `set_looks` has checked the looks, and they are removed when the materials change.
        self.looks.as_ref().and_then(|looks| looks.on(&scene).ok()).unwrap_or(scene)
    }

    /// Replaces the looks of everything, or restores those of the files, until a model is added or removed.
    ///
    /// # Errors
    /// [`SceneError`] if the number of materials or lights differs, or one of them is invalid.
    pub fn set_looks(&mut self, looks: Option<Looks>) -> Result<(), SceneError> {
        if let Some(looks) = &looks {
            looks.on(&self.assembly.builder.scene())?;
        }
        self.looks = looks;
        Ok(())
    }
}

/// A tag on a visual.
#[derive(Debug, Clone)]
pub struct PlacedFiducial {
    /// Index of the instance that it is on.
    pub instance: u32,
    /// Pose of its centre in the instance: x to the right and y up as one reads it, z towards the reader.
    pub instance_from_fiducial: Pose,
    /// The family in the file, such as `tag36h11` or `qr`.
    pub family: String,
    /// Its number in the family.
    pub id: u32,
    /// Edge of its square without the white margin.
    pub size_m: f64,
}

fn lamp(light: &description::Light, shadows: bool) -> LightConfig {
    let position = light.world_from_light.translation().to_array();
    let direction = light.world_from_light.transform_vector(light.direction).to_array();
    let kind = match light.kind {
        description::LightKind::Point => LightKind::Point { position },
        description::LightKind::Directional => LightKind::Directional { direction },
        description::LightKind::Spot { inner_angle, outer_angle, falloff } => LightKind::Spot {
            position,
            direction,
            cos_inner: (inner_angle * 0.5).cos() as f32,
            cos_outer: (outer_angle * 0.5).cos() as f32,
            falloff: falloff as f32,
        },
    };
    // Without an angle, only its axis would be lit, and that depends on rounding.
    let is_dark = matches!(light.kind, description::LightKind::Spot { outer_angle: 0.0, .. });
    let colour = |colour: [f32; 3]| if is_dark { [0.0; 3] } else { colour };
    LightConfig {
        kind,
        diffuse: colour(light.diffuse),
        specular: colour(light.specular),
        range_m: light.range_m as f32,
        attenuation: light.attenuation.map(|factor| factor as f32),
        cast_shadows: shadows && light.cast_shadows,
    }
}
