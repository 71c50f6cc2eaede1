//! Draws the random looks of a sample: lights, materials, ambient light.

use super::plan::{Plan, Ranges, Sample};
use crate::entities::EntityId;
use crate::randomize::{Draws, LightRanges, Limits, MaterialRanges, Thing};
use crate::simulation::Simulation;
use crate::world::scene::Looks;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The looks in a sample's JSON: only those that were drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LooksJson {
    /// Ambient light: red, green, blue.
    pub(super) ambient: [f32; 3],
    pub(super) lights: Vec<LightJson>,
    pub(super) materials: Vec<MaterialJson>,
}

/// A light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LightJson {
    pub(super) name: String,
    /// The factor that was drawn.
    pub(super) intensity: f64,
    /// Colour times brightness, including the factor.
    pub(super) color: [f32; 3],
    /// Direction in which its light travels: a unit vector in the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) direction: Option<[f64; 3]>,
    /// Position in the world, in metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) position: Option<[f64; 3]>,
}

/// The material of a visual.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct MaterialJson {
    /// `model::link`.
    pub(super) body: String,
    pub(super) visual: String,
    /// Its number in the channel `instance`.
    pub(super) instance: u32,
    pub(super) color: [f32; 3],
    /// True if it has a texture.
    pub(super) textured: bool,
}

/// The lights and materials of a world whose looks are drawn.
pub(super) struct Wardrobe {
    own: Looks,
    ambient: Limits,
    lights: Vec<RandomLight>,
    bodies: Vec<RandomBody>,
}

struct RandomLight {
    index: u32,
    name: String,
    ranges: LightRanges,
}

struct RandomBody {
    /// Index among all bodies; those of the robot come last.
    index: u32,
    name: String,
    /// Name, instance and material of each visual.
    visuals: Vec<(String, u32, usize)>,
    ranges: MaterialRanges,
}

/// Returns the ranges of the last table that applies to one of these names.
fn last_for<T: Clone>(tables: &Ranges<T>, names: &[&str], all: bool) -> Option<T> {
    let is_for = |chosen: &Option<Vec<String>>| match chosen {
        Some(chosen) => chosen.iter().any(|name| names.contains(&name.as_str())),
        None => all,
    };
    tables.iter().rev().find(|(chosen, _)| is_for(chosen)).map(|(_, ranges)| ranges.clone())
}

impl Wardrobe {
    /// Returns the wardrobe of a world of the plan, if the plan randomizes looks.
    pub(super) fn of(
        plan: &Plan,
        world: usize,
        simulation: &mut Simulation,
        robot: EntityId,
    ) -> Option<Self> {
        let randomization = plan.randomization.as_ref()?;
        let mut bodies = Vec::new();
        let mut parts: BTreeMap<_, Vec<u32>> = BTreeMap::new();
        for (model, link, instance, _) in simulation.scene().parts() {
            parts.entry((model, link)).or_default().push(instance.0);
        }
        let scene = simulation.scene().scene();
        let own = Looks::of(&scene);
        let material_of: Vec<_> = scene.instances().iter().map(|one| one.material_id().0 as usize).collect();
        let mut index = 0;
        for (id, entity) in simulation.entities().iter() {
            for (number, link) in entity.model.links.iter().enumerate() {
                index += 1;
                let name = format!("{}::{}", entity.name, link.name);
                let names = [entity.name.as_str(), name.as_str()];
                let Some(ranges) = last_for(&randomization.materials, &names, id != robot) else { continue };
                let of_link = parts.get(&(id.index(), number)).map_or(&[][..], Vec::as_slice);
                // A link's visuals come first.
                let visuals = link.visuals.iter().zip(of_link).map(|(visual, instance)| {
                    (visual.name.clone(), *instance, material_of[*instance as usize])
                });
                let visuals = visuals.collect();
                bodies.push(RandomBody { index: index - 1, name, visuals, ranges });
            }
        }
        let lights = plan.worlds[world].lights.iter().enumerate().filter_map(|(index, light)| {
            let ranges = last_for(&randomization.lights, &[&light.name], true)?;
            Some(RandomLight { index: index as u32, name: light.name.clone(), ranges })
        });
        Some(Self { own, ambient: randomization.ambient, lights: lights.collect(), bodies })
    }

    /// Draws the looks of a sample, which depend only on its world, its seed and its pose's number.
    pub(super) fn draw(&self, plan: &Plan, sample: Sample) -> (Looks, LooksJson) {
        let draws = Draws::new(plan.seeds[sample.seed], sample.world as u32, sample.pose);
        let mut looks = self.own.clone();
        let factor = draws.between(self.ambient, Thing::World, 0) as f32;
        looks.environment.ambient = looks.environment.ambient.map(|part| part * factor);
        let mut json =
            LooksJson { ambient: looks.environment.ambient, lights: Vec::new(), materials: Vec::new() };
        for RandomLight { index, name, ranges } in &self.lights {
            let Some(light) = looks.lights.get_mut(*index as usize) else { continue };
            let drawn = ranges.draw(&draws, *index);
            *light = drawn.of(light);
            json.lights.push(LightJson {
                name: name.clone(),
                intensity: drawn.intensity,
                color: light.vector_and_diffuse().1,
                direction: light.direction(),
                position: light.position(),
            });
        }
        for RandomBody { index, name, visuals, ranges } in &self.bodies {
            let drawn = ranges.draw(&draws, *index);
            for (visual, instance, material) in visuals {
                let Some(material) = looks.materials.get_mut(*material) else { continue };
                *material = drawn.of(material);
                json.materials.push(MaterialJson {
                    body: name.clone(),
                    visual: visual.clone(),
                    instance: *instance,
                    color: material.colour(),
                    textured: material.is_textured(),
                });
            }
        }
        (looks, json)
    }
}
