//! [`Studio`]: a world with the robot in it, which renders its sensors' frames at any pose.

use super::DatasetError;
use super::fields::{self, Field};
use super::labels::{self, Labels, Names};
use super::looks::Wardrobe;
use super::plan::{FLOW, Plan, Sample, SensorPlan};
use crate::description::Severity;
use crate::description::diagnostics::Problem;
use crate::entities::EntityId;
use crate::rig::FrameBuf;
use crate::simulation::{Simulation, SimulationError, SpawnOptions};
use belvedere_sensors::{Execution, Pose};
use glam::DVec3;
use std::collections::BTreeMap;

/// Position of the robot at the start, in metres: above everything, so that it collides with nothing.
const WAITING: DVec3 = DVec3::new(0.0, 0.0, 5e3);

/// A world with the robot in it.
pub(super) struct Studio<'a> {
    plan: &'a Plan,
    world: usize,
    simulation: Simulation,
    robot: EntityId,
    names: Names,
    /// Present if looks are drawn at random.
    wardrobe: Option<Wardrobe>,
    /// The memory of a sensor's frames.
    frames: Vec<FrameBuf>,
}

impl<'a> Studio<'a> {
    /// Opens one of the plan's worlds.
    pub(super) fn open(plan: &'a Plan, world: usize, execution: Execution) -> Result<Self, DatasetError> {
        let refused = |error| in_plan(plan, None, error);
        let builder = Simulation::builder(plan.worlds[world].clone()).execution(execution);
        let mut simulation = builder.build().map_err(refused)?;
        let world_from_model = Pose::from_translation(WAITING);
        let options = SpawnOptions { world_from_model, is_robot: Some(true), ..SpawnOptions::default() };
        let robot = simulation.spawn(&plan.robot, options).map_err(refused)?;
        let names = Names::of(&mut simulation, plan);
        let wardrobe = Wardrobe::of(plan, world, &mut simulation, robot);
        let mut studio = Self { plan, world, simulation, robot, names, wardrobe, frames: Vec::new() };
        studio.check()?;
        Ok(studio)
    }

    pub(super) fn world(&self) -> usize {
        self.world
    }

    /// Checks that the robot has all streams of the plan.
    fn check(&mut self) -> Result<(), DatasetError> {
        for sensor in &self.plan.sensors {
            let topics = wanted(sensor);
            let topics: Vec<&str> = topics.iter().map(String::as_str).collect();
            let refused = |error| in_plan(self.plan, Some(sensor), error);
            let filled = self.shoot(&topics, 0, false).map_err(refused)?;
            if !filled[0] || fields::of_stream(&sensor.name, &self.frames[0].view()).is_none() {
                let what = format!("{} is not an image, depth image, scan or cloud", sensor.topic);
                return Err(refused(SimulationError::Refused(what)));
            }
        }
        Ok(())
    }

    /// Returns true if the robot can be placed at this pose.
    pub(super) fn is_free(
        &mut self,
        sample: Sample,
        pose: &Pose,
        clearance_m: f64,
    ) -> Result<bool, DatasetError> {
        let failed = |source| DatasetError::Sample { sample: sample.index, source };
        self.simulation.set_down(self.robot, pose).map_err(failed)?;
        self.simulation.is_clear(self.robot, clearance_m).map_err(failed)
    }

    /// Returns the files of a sample of this world.
    pub(super) fn take(&mut self, sample: Sample) -> Result<Vec<Field>, DatasetError> {
        let plan = self.plan;
        let failed = |source| DatasetError::Sample { sample: sample.index, source };
        let seed = plan.seeds[sample.seed];
        if self.simulation.options().seed != seed {
            self.simulation.set_seed(seed);
        }
        let pose = plan.pose(sample, self)?;
        let before = plan.before(sample).map(|before| plan.pose(before, self)).transpose()?;
        let drawn = self.wardrobe.as_ref().map(|wardrobe| wardrobe.draw(plan, sample));
        let (looks, looks_json) = drawn.unzip();
        if looks.is_some() {
            self.simulation.set_looks(looks).map_err(failed)?;
        }
        let mut fields = Vec::new();
        let mut of_sensors = BTreeMap::new();
        for sensor in &plan.sensors {
            let topics = wanted(sensor);
            let topics: Vec<&str> = topics.iter().map(String::as_str).collect();
            let flow = topics.iter().copied().find(|topic| topic.ends_with(FLOW));
            let before = before.as_ref().zip(flow);
            if let Some((before, flow)) = before {
                self.simulation.set_down(self.robot, before).map_err(failed)?;
                self.shoot(&[flow], sample.pose, false).map_err(failed)?;
            }
            self.simulation.set_down(self.robot, &pose).map_err(failed)?;
            let filled = self.shoot(&topics, sample.pose, before.is_some()).map_err(failed)?;
            let view = |at: usize| filled[at].then(|| self.frames[at].view());
            let nothing = || failed(SimulationError::NoFrame { topic: sensor.topic.clone() });
            let own = view(0).ok_or_else(nothing)?;
            fields.extend(fields::of_stream(&sensor.name, &own).ok_or_else(nothing)?);
            for (number, channel) in sensor.truth.iter().enumerate() {
                let size = fields::size(own.header());
                let field = fields::of_truth(&sensor.name, channel, view(1 + number).as_ref(), size);
                fields.push(field.ok_or_else(nothing)?);
            }
            let boxes = view(1 + sensor.truth.len()).filter(|_| sensor.labels);
            let objects = boxes.map(|boxes| self.names.objects(&mut self.simulation, own.header(), &boxes));
            let known = labels::of_sensor(&sensor.topic, own.header(), objects);
            of_sensors.insert(sensor.name.clone(), known);
        }
        let labels = Labels {
            world: plan.world_names[sample.world].clone(),
            seed,
            pose: sample.pose,
            world_from_robot: (&pose).into(),
            looks: looks_json,
            sensors: of_sensors,
        };
        let bytes = serde_json::to_vec(&labels).unwrap_or_default();
        fields.push(Field { name: "json".into(), bytes });
        Ok(fields)
    }

    /// Renders topics of one sensor into `frames`. Returns for each whether there is a frame, with a final false.
    fn shoot(&mut self, topics: &[&str], number: u64, goes_on: bool) -> Result<Vec<bool>, SimulationError> {
        self.frames.resize_with(topics.len().max(self.frames.len()), FrameBuf::default);
        let mut filled = self.simulation.render_numbered(topics, number, goes_on, &mut self.frames)?;
        filled.push(false);
        Ok(filled)
    }
}

/// Returns the topics of a sensor that a sample needs: its own, those of its truth channels, and that of its boxes.
fn wanted(sensor: &SensorPlan) -> Vec<String> {
    let truth = sensor.truth.iter().map(String::as_str).chain(sensor.labels.then_some("boxes"));
    let truth = truth.map(|channel| format!("{}/truth/{channel}", sensor.topic));
    [sensor.topic.clone()].into_iter().chain(truth).collect()
}

/// Converts an error to a problem with a sensor of the plan, or with the robot in the world.
fn in_plan(plan: &Plan, sensor: Option<&SensorPlan>, error: SimulationError) -> DatasetError {
    if let SimulationError::Description(problem) = error {
        return problem.into();
    }
    let source = sensor.map_or_else(|| plan.robot.source.clone(), |sensor| sensor.source.clone());
    let remedy = match sensor {
        Some(_) => "choose a topic and truth channels that the robot has".to_owned(),
        None => "choose another robot or world".to_owned(),
    };
    Problem { severity: Severity::Error, source, what: error.to_string(), remedy }.into()
}
