//! Executes commands from other processes.

use super::inbox::Request;
use super::states::{MAX_SPAWNED_LINKS, MAX_SPAWNED_MODELS};
use super::{Server, Steps, values};
use crate::description::model::Model;
use crate::entities::Origin;
use crate::simulation::SpawnOptions;
use belvedere_bridge::Operation;
use belvedere_bridge::payload::SimulationCommand;
use std::time::Duration;

/// Most commands that are applied between two frames.
const COMMANDS_AT_ONCE: usize = 16;

impl Server<'_> {
    /// Returns true if simulated time is paused.
    pub fn is_paused(&self) -> bool {
        self.paused && self.steps.is_none()
    }

    /// Pauses simulated time until a command resumes it.
    pub fn pause(&mut self) {
        self.paused = true;
    }

    /// Returns a number that changes when time is stepped, resumed or reset. The wall clock must then be matched again.
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Applies waiting commands between two frames: only a few, so that a flood of commands does not stop simulated
    /// time.
    pub fn serve(&mut self) {
        for _ in 0..COMMANDS_AT_ONCE {
            let Some(request) = self.inbox.take() else { break };
            self.apply(&request);
        }
    }

    /// While simulated time is paused: waits for a command for at most this long, applies it, and serves new
    /// subscribers.
    pub fn idle(&mut self, at_most: Duration) {
        self.inbox.wait(at_most);
        self.serve();
        self.take_commands();
        self.rig.update();
        if self.is_paused() {
            self.states.repeat(self.simulation.entities(), self.simulation.physics());
        }
    }

    fn apply(&mut self, request: &Request) {
        let command = &request.command;
        let time_ns = self.simulation.time_ns();
        if request.operation() == Some(Operation::Query) {
            // It changes nothing, so frames that wait in the post need not be sent first.
            let answer = self.describe(command.name.as_str());
            return self.inbox.tell(command, time_ns, answer.as_deref().map_err(String::as_str));
        }
        let outcome = match request.operation() {
            None => Err(format!(
                "operation {} is not known to this simulator; it knows {}",
                command.operation,
                Operation::ALL
                    .iter()
                    .map(|known| format!("{} {known}", known.to_wire()))
                    .collect::<Vec<_>>()
                    .join(", ")
            )),
            Some(Operation::Step) => match self.step_for(command) {
                // Answered when the steps are done.
                Ok(()) => {
                    tracing::debug!(time_ns, id = command.id, steps = command.steps, "step begins");
                    return;
                }
                Err(reason) => Err(reason),
            },
            Some(operation) => self.operate(operation, request),
        };
        let name = request.operation().map_or("unknown", Operation::as_str);
        match &outcome {
            Ok(()) => tracing::debug!(time_ns, id = command.id, model = %command.name, "{name} applied"),
            Err(reason) => {
                tracing::debug!(time_ns, id = command.id, model = %command.name, "{name} refused: {reason}");
            }
        }
        self.answer(command, self.simulation.time_ns(), &outcome);
        if self.is_paused() {
            self.states.send(
                self.simulation.time_ns(),
                self.simulation.entities(),
                self.simulation.physics(),
            );
        }
    }

    /// Sends a command's result. Everything published earlier is sent first, so a client that has the result knows that
    /// all later frames were made after the command.
    fn answer(&self, command: &SimulationCommand, time_ns: u64, outcome: &Result<(), String>) {
        if let Some(post) = &self.sink.post {
            post.flush();
        }
        self.inbox.answer(command, time_ns, outcome);
    }

    /// Describes the simulation and a model, if it is named, in words.
    fn describe(&self, name: &str) -> Result<String, String> {
        let time = match (&self.steps, self.paused) {
            (Some(_), _) => "stepping",
            (None, true) => "paused",
            (None, false) => "playing",
        };
        let mut words = vec![time];
        if !name.is_empty() {
            let (_, entity) = self.simulation.entities().find(name)?;
            words.push(match entity {
                entity if entity.robot.is_some() => "robot",
                entity if entity.model.trajectory.is_some() => "actor",
                entity if entity.model.is_static => "static",
                _ => "object",
            });
            if entity.origin == Origin::Spawned {
                words.push("spawned");
            }
        }
        Ok(words.join(" "))
    }

    fn operate(&mut self, operation: Operation, request: &Request) -> Result<(), String> {
        let command = &request.command;
        match operation {
            Operation::Pause => {
                self.end_steps("was ended by a pause");
                self.paused = true;
            }
            Operation::Resume => {
                self.end_steps("was ended by a resume");
                self.paused = false;
                self.epoch += 1;
            }
            // Answered by the caller.
            Operation::Step | Operation::Query => {}
            Operation::ResetWorld => {
                self.simulation.replace();
            }
            Operation::ResetSimulation => self.restart()?,
            Operation::SetModelState => self.set_model_state(command)?,
            Operation::Spawn => self.spawn(command, request.text.as_deref().map_err(Clone::clone)?)?,
            Operation::Delete => self.delete(command.name.as_str())?,
            Operation::Configure => {
                let text = request.text.as_deref().map_err(Clone::clone)?;
                let window_ns = self.rig.window_ns();
                self.rig.configure(command.name.as_str(), text, self.simulation.time_ns())?;
                // A lidar that turns more slowly needs a longer history.
                if self.rig.window_ns() > window_ns {
                    self.simulation.remember(self.rig.window_ns());
                }
            }
        }
        Ok(())
    }

    /// Starts to run some steps, after which time is paused.
    fn step_for(&mut self, command: &SimulationCommand) -> Result<(), String> {
        let length_ns = command.steps.checked_mul(self.simulation.physics().step_ns());
        let until_ns = length_ns.and_then(|length_ns| self.simulation.time_ns().checked_add(length_ns));
        let until_ns = until_ns.filter(|_| command.steps > 0).ok_or_else(|| {
            format!(
                "{} steps cannot be run; request 1 or more; each is {} ns long",
                command.steps,
                self.simulation.physics().step_ns()
            )
        })?;
        self.end_steps("was ended by another step command");
        self.paused = true;
        self.epoch += 1;
        self.steps = Some(Steps { command: *command, until_ns });
        Ok(())
    }

    /// Answers a step command that was interrupted.
    fn end_steps(&mut self, why: &str) {
        if let Some(Steps { command, until_ns }) = self.steps.take() {
            let time_ns = self.simulation.time_ns();
            let left = until_ns.saturating_sub(time_ns) / self.simulation.physics().step_ns();
            let reason = format!("it {why}, {left} of {} steps before its end", command.steps);
            self.answer(&command, time_ns, &Err(reason));
        }
    }

    /// Answers a step command that is finished.
    pub(super) fn finish_steps(&mut self) {
        if let Some(steps) = self.steps.take_if(|steps| self.simulation.time_ns() >= steps.until_ns) {
            self.answer(&steps.command, self.simulation.time_ns(), &Ok(()));
            self.states.send(
                self.simulation.time_ns(),
                self.simulation.entities(),
                self.simulation.physics(),
            );
        }
    }

    /// Restarts the simulation at time 0.
    fn restart(&mut self) -> Result<(), String> {
        self.end_steps("was ended by a reset");
        self.simulation.reset().map_err(|error| error.to_string())?;
        self.rig.restart()?;
        self.states.restart();
        self.epoch += 1;
        Ok(())
    }

    fn set_model_state(&mut self, command: &SimulationCommand) -> Result<(), String> {
        let (entities, physics) = (self.simulation.entities(), self.simulation.physics());
        let (id, _) = entities.find(command.name.as_str())?;
        let world_from_reference = entities.world_from_frame(command.reference.as_str(), physics)?;
        let pose = world_from_reference * values::pose(command)?;
        let (linear, angular) = values::twist(command)?;
        let [linear, angular] = [linear, angular].map(|vector| world_from_reference.transform_vector(vector));
        self.simulation.place(id, &pose, linear, angular).map_err(|error| error.to_string())
    }

    fn spawn(&mut self, command: &SimulationCommand, text: &str) -> Result<(), String> {
        let name = command.name.as_str();
        let model = self.files.load(text, name)?;
        self.check_room(&model)?;
        let (entities, physics) = (self.simulation.entities(), self.simulation.physics());
        let world_from_reference = entities.world_from_frame(command.reference.as_str(), physics)?;
        let options = SpawnOptions {
            name: name.to_owned(),
            namespace: command.robot_namespace.as_str().to_owned(),
            world_from_model: world_from_reference * values::pose(command)?,
            ..SpawnOptions::default()
        };
        let noted = self.simulation.notes().len();
        let spawned = self.simulation.spawn_as(&model, options, Origin::Spawned);
        let id = spawned.map_err(|error| error.to_string())?;
        if let Err(error) = self.mount(id) {
            // This cannot fail for a model that was just added.
            let _ = self.simulation.delete(id);
            return Err(error.to_string());
        }
        for note in &self.simulation.notes()[noted..] {
            tracing::info!("{note}");
        }
        self.descriptions.extend(self.files.description(text).map(|urdf| (id, urdf)));
        Ok(())
    }

    /// Refuses a model that does not fit into the streams of states.
    fn check_room(&self, model: &Model) -> Result<(), String> {
        let models = self.simulation.entities().spawned().count();
        let links: usize = self.simulation.entities().spawned().map(|entity| entity.model.links.len()).sum();
        if models >= MAX_SPAWNED_MODELS || links + model.links.len() > MAX_SPAWNED_LINKS {
            return Err(format!(
                "at most {MAX_SPAWNED_MODELS} models with {MAX_SPAWNED_LINKS} links together may be spawned, \
                and {models} with {links} exist; delete some first"
            ));
        }
        Ok(())
    }

    fn delete(&mut self, name: &str) -> Result<(), String> {
        let (id, _) = self.simulation.entities().find(name)?;
        self.unmount(id);
        self.simulation.delete(id).map_err(|error| error.to_string())
    }
}
