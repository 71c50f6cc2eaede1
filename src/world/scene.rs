//! What the sensors see of the world: its shapes, looks and lamps as a `sensors` scene, kept in step with physics.

mod assembly;
mod looks;

pub use looks::Looks;

use crate::description::diagnostics::Problem;
use crate::description::housing::{Part, ShapeIndex};
use crate::description::model as description;
use crate::description::model::{LinkIndex, Model, World};
use crate::world::physics::{ModelIndex, Physics};
use assembly::{Assembly, Placed, of_link, refused};
use belvedere_sensors::scene::{
    ColourSpace, Environment, InstanceId, LightConfig, LightKind, Scene, SceneBuilder, SceneError, Shape,
    visibility,
};
use belvedere_sensors::{Moment, Pose};

/// The bit of visibility of what no sensor sees.
const HIDDEN: u32 = 1 << 31;

/// The scene of a running world.
#[derive(Debug)]
pub struct WorldScene {
    assembly: Assembly,
    stamp_ns: Option<u64>,
    edition: u64,
    /// In the place of what the files say.
    looks: Option<Looks>,
}

impl WorldScene {
    /// Builds the scene of a world, whose links stand where `physics` has them now.
    ///
    /// # Errors
    /// A shape that cannot be traced; the problem names its place in the file.
    pub fn new(world: &World, physics: &Physics) -> Result<Self, Problem> {
        let mut assembly = Assembly::default();
        assembly
            .builder
            .set_environment(Environment { ambient: world.ambient, background: world.background });
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

    /// Moves everything that moves to where it is at a time between the last two physics steps.
    pub fn move_to(&mut self, physics: &Physics, stamp_ns: u64) {
        if self.stamp_ns == Some(stamp_ns) {
            return;
        }
        self.stamp_ns = Some(stamp_ns);
        for (model, link, world_from_link) in physics.moving_links_at(stamp_ns) {
            self.assembly.set_pose((model, link), &world_from_link);
        }
    }

    /// Takes over where physics has everything now, also what never moves by itself: after it was moved by hand.
    pub fn replace(&mut self, physics: &Physics) {
        self.stamp_ns = None;
        for model in 0..self.assembly.placed.len() {
            self.replace_model(model, physics);
        }
    }

    /// The same of one model.
    pub fn replace_model(&mut self, model: ModelIndex, physics: &Physics) {
        self.stamp_ns = None;
        for link in 0..self.assembly.placed.get(model).map_or(0, Vec::len) {
            self.assembly.set_pose((model, link), &physics.world_from_link(model, link));
        }
    }

    /// Adds a model whose frame is at `world_from_model`.
    ///
    /// # Errors
    /// As [`WorldScene::new`]; nothing of it is seen then.
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

    /// Returns what could not be drawn as the files say since the last call.
    pub fn take_notes(&mut self) -> Vec<Problem> {
        std::mem::take(&mut self.assembly.notes)
    }

    /// Lets rays pass through shapes of a model, or no more.
    pub fn hide(&mut self, model: ModelIndex, shapes: &[ShapeIndex], hidden: bool) {
        for (link, part) in shapes {
            let seen = match part {
                // Not 0, so that nothing else of the scene changes.
                _ if hidden => HIDDEN,
                Part::Visual(_) => visibility::VISUAL,
                Part::Collision(_) => visibility::COLLISION,
            };
            let placed = of_link(&self.assembly.placed, (model, *link)).iter();
            for placed in placed.filter(|placed| placed.part == *part) {
                // It is there.
                let _ = self.assembly.builder.set_visibility(placed.instance, seen);
            }
        }
    }

    /// Lets a model be seen no more. Its places and memory in the scene are used again.
    pub fn remove_model(&mut self, index: ModelIndex) {
        self.edition += 1;
        self.looks = None;
        let assembly = &mut self.assembly;
        let links = assembly.placed.get_mut(index).map(std::mem::take).unwrap_or_default();
        let mut gone: Vec<_> = links.into_iter().flatten().collect();
        assembly.fiducials.retain(|tag| gone.iter().all(|placed| placed.instance.0 != tag.instance));
        // The last first: the places of the first are those that are used again first.
        gone.sort_unstable_by_key(|placed| std::cmp::Reverse(placed.instance.0));
        for placed in &gone {
            // It is there.
            let _ = assembly.builder.remove_instance(placed.instance);
        }
        // What others use as well, or is gone already, is refused.
        for Placed { shape, material, .. } in gone {
            if let Shape::Mesh(mesh) = shape {
                let _ = assembly.builder.remove_mesh(mesh);
            }
            if assembly.bare != Some(material) {
                let _ = assembly.builder.remove_material(material);
            }
        }
    }

    /// The moment at which everything is where it was moved last, and a sensor at `world_from_sensor`.
    pub fn moment(&self, world_from_sensor: Pose) -> Moment<'_> {
        self.assembly.builder.moment(world_from_sensor)
    }

    /// Where all instances are.
    pub fn poses(&self) -> &[Pose] {
        self.assembly.builder.poses()
    }

    /// A number that is another one after models were added or taken out: instances are others then.
    pub fn edition(&self) -> u64 {
        self.edition
    }

    /// Appends where all instances were at an earlier time, as far back as physics remembers.
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

    /// The tags that there are, in the order in which they were added.
    pub fn fiducials(&self) -> &[PlacedFiducial] {
        &self.assembly.fiducials
    }

    /// All that is seen, and where each instance stands now.
    pub fn builder(&self) -> &SceneBuilder {
        &self.assembly.builder
    }

    /// What was made of each link: its instances, and where they are in the frame of the link.
    pub fn parts(&self) -> impl Iterator<Item = (ModelIndex, LinkIndex, InstanceId, Pose)> + '_ {
        self.assembly.placed.iter().enumerate().flat_map(|(model, links)| {
            links.iter().enumerate().flat_map(move |(link, parts)| {
                parts.iter().map(move |placed| (model, link, placed.instance, placed.link_from_shape))
            })
        })
    }

    /// What there is to see.
    pub fn scene(&self) -> Scene<'_> {
        let scene = self.assembly.builder.scene();
        // They were looked at when they came, and end when there are other materials.
        self.looks.as_ref().and_then(|looks| looks.on(scene).ok()).unwrap_or(scene)
    }

    /// Lets everything look otherwise, or again as the files say, until a model is added or taken out.
    ///
    /// # Errors
    /// [`SceneError`] if there are not as many materials or lamps, or one of them cannot be.
    pub fn set_looks(&mut self, looks: Option<Looks>) -> Result<(), SceneError> {
        if let Some(looks) = &looks {
            looks.on(self.assembly.builder.scene())?;
        }
        self.looks = looks;
        Ok(())
    }
}

/// A tag of a visual that is seen.
#[derive(Debug, Clone)]
pub struct PlacedFiducial {
    /// Index of the instance that bears it.
    pub instance: u32,
    /// Pose of its middle in the instance: x to the right and y up as one reads it, z towards the reader.
    pub instance_from_fiducial: Pose,
    /// As the file says: `tag36h11`, `qr`.
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
    LightConfig {
        kind,
        diffuse: light.diffuse,
        specular: light.specular,
        range_m: light.range_m as f32,
        attenuation: light.attenuation.map(|factor| factor as f32),
        cast_shadows: shadows && light.cast_shadows,
    }
}
