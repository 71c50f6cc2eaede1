//! What commands from other processes do to a simulation.

use super::{Simulation, Steps};
use crate::control::roster::MAX_NAME_BYTES;
use crate::control::states::{MAX_SPAWNED_LINKS, MAX_SPAWNED_MODELS};
use crate::control::{Request, Resident, Role, values};
use crate::description::model::Model;
use crate::robot::Robot;
use crate::world::physics::Physics;
use belvedere_bridge::Operation;
use belvedere_bridge::payload::SimulationCommand;
use belvedere_sensors::Pose;
use std::time::Duration;

/// Commands applied between two frames.
const COMMANDS_AT_ONCE: usize = 16;

impl Simulation {
    /// Whether simulated time stands.
    pub fn is_paused(&self) -> bool {
        self.paused && self.steps.is_none()
    }

    /// Lets simulated time stand until a command resumes it.
    pub fn pause(&mut self) {
        self.paused = true;
    }

    /// A number that is another one after time was paused, stepped or set back: the wall clock has to be matched anew.
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Applies commands that wait, between two frames: at most a few, so that a flood of them does not stop time.
    pub fn serve(&mut self) {
        for _ in 0..COMMANDS_AT_ONCE {
            let Some(request) = self.inbox.take() else { break };
            self.apply(&request);
        }
    }

    /// While time stands: waits at most so long for a command, applies what comes, and serves who came late.
    pub fn idle(&mut self, at_most: Duration) {
        self.inbox.wait(at_most);
        self.serve();
        self.take_commands();
        self.rig.update();
        if self.is_paused() {
            self.states.repeat(&self.roster, &self.physics);
        }
    }

    fn apply(&mut self, request: &Request) {
        let command = &request.command;
        let time_ns = self.physics.time_ns();
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
                // Answered when they are done.
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
        self.answer(command, self.physics.time_ns(), &outcome);
        if self.is_paused() {
            self.states.send(self.physics.time_ns(), &self.roster, &self.physics);
        }
    }

    /// Answers a command. What was published before it is out before the answer: who has that knows that what comes next
    /// is of the time after the command.
    fn answer(&self, command: &SimulationCommand, time_ns: u64, outcome: &Result<(), String>) {
        if let Some(post) = &self.post {
            post.flush();
        }
        self.inbox.answer(command, time_ns, outcome);
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
            Operation::Step => {}
            Operation::ResetWorld => {
                let before = self.bases();
                for (index, resident) in self.roster.iter() {
                    self.physics.place_model(index, &resident.start);
                }
                self.carried(&before);
            }
            Operation::ResetSimulation => self.restart()?,
            Operation::SetModelState => self.set_model_state(command)?,
            Operation::Spawn => self.spawn(command, request.text.as_deref().map_err(Clone::clone)?)?,
            Operation::Delete => self.delete(command.name.as_str())?,
            Operation::Configure => {
                let text = request.text.as_deref().map_err(Clone::clone)?;
                self.rig.configure(command.name.as_str(), text, self.physics.time_ns())?;
            }
        }
        Ok(())
    }

    /// Begins to run some steps, after which time stands.
    fn step_for(&mut self, command: &SimulationCommand) -> Result<(), String> {
        let length_ns = command.steps.checked_mul(self.physics.step_ns());
        let until_ns = length_ns.and_then(|length_ns| self.physics.time_ns().checked_add(length_ns));
        let until_ns = until_ns.filter(|_| command.steps > 0).ok_or_else(|| {
            format!(
                "{} steps cannot be run; ask for 1 or more, each is {} ns",
                command.steps,
                self.physics.step_ns()
            )
        })?;
        self.end_steps("was ended by another step command");
        self.paused = true;
        self.epoch += 1;
        self.steps = Some(Steps { command: *command, until_ns });
        Ok(())
    }

    /// Answers a step command that does not come to its end.
    fn end_steps(&mut self, why: &str) {
        if let Some(Steps { command, until_ns }) = self.steps.take() {
            let time_ns = self.physics.time_ns();
            let left = until_ns.saturating_sub(time_ns) / self.physics.step_ns();
            let reason = format!("it {why}, {left} of {} steps before its end", command.steps);
            self.answer(&command, time_ns, &Err(reason));
        }
    }

    /// Answers a step command that is done.
    pub(super) fn finish_steps(&mut self) {
        if let Some(steps) = self.steps.take_if(|steps| self.physics.time_ns() >= steps.until_ns) {
            self.answer(&steps.command, self.physics.time_ns(), &Ok(()));
            self.states.send(self.physics.time_ns(), &self.roster, &self.physics);
        }
    }

    /// Begins again at time 0, with everybody who is there now in the place where each was at first. What is built is
    /// what a fresh start builds, so that the same bytes follow.
    fn restart(&mut self) -> Result<(), String> {
        let mut physics =
            Physics::with_models(&self.world, self.roster.places()).map_err(|problem| problem.to_string())?;
        let robots = self.roster.iter().filter(|(_, resident)| resident.role == Role::Robot);
        self.robots = robots.map(|(index, robot)| Robot::new(&robot.model, index, &mut physics).0).collect();
        self.end_steps("was ended by a reset");
        self.before_resets_ns += self.physics.time_ns();
        self.physics = physics;
        self.physics.remember(self.rig.window_ns());
        self.scene.replace(&self.physics);
        self.rig.restart()?;
        self.states.restart();
        self.commanded_ns = None;
        self.epoch += 1;
        Ok(())
    }

    fn set_model_state(&mut self, command: &SimulationCommand) -> Result<(), String> {
        let (index, _) = self.roster.find(command.name.as_str())?;
        let world_from_reference = self.roster.world_from_frame(command.reference.as_str(), &self.physics)?;
        let pose = values::pose(command)?;
        let (linear, angular) = values::twist(command)?;
        let [linear, angular] = [linear, angular].map(|vector| world_from_reference.transform_vector(vector));
        let before = self.bases();
        self.physics.move_model(index, &(world_from_reference * pose), linear, angular);
        self.carried(&before);
        Ok(())
    }

    /// Where the robots' bases are.
    fn bases(&self) -> Vec<Pose> {
        self.robots.iter().map(|robot| robot.world_from_base(&self.physics)).collect()
    }

    /// Tells everybody of a move by hand, before which the bases were there.
    fn carried(&mut self, before: &[Pose]) {
        for (robot, world_from_before) in self.robots.iter_mut().zip(before) {
            robot.carried(&self.physics, world_from_before);
        }
        self.scene.replace(&self.physics);
    }

    fn spawn(&mut self, command: &SimulationCommand, text: &str) -> Result<(), String> {
        let name = command.name.as_str();
        let model = self.spawn_options.load(text, name)?;
        let name = if name.is_empty() { model.name.clone() } else { name.to_owned() };
        if name.len() > MAX_NAME_BYTES {
            return Err(format!("the name '{name}' has more than {MAX_NAME_BYTES} bytes; give it another"));
        }
        if self.roster.is_taken(&name) {
            return Err(format!(
                "there is a model '{name}' already; give it another name, or delete that one first"
            ));
        }
        self.check_room(&model)?;
        let world_from_reference = self.roster.world_from_frame(command.reference.as_str(), &self.physics)?;
        let start: Pose = world_from_reference * values::pose(command)? * model.world_from_model;
        let model = Model { name: name.clone(), ..model };
        let index = self.physics.insert_model(&model, &start).map_err(|problem| problem.to_string())?;
        if let Err(problem) = self.scene.add_model(index, &model, &start) {
            self.physics.remove_model(index);
            self.roster.add_nobody();
            return Err(problem.to_string());
        }
        self.roster.add(Resident { name, model, start, role: Role::Spawned });
        Ok(())
    }

    /// Refuses what the streams of states have no room for.
    fn check_room(&self, model: &Model) -> Result<(), String> {
        let models = self.roster.spawned().count();
        let links: usize = self.roster.spawned().map(|resident| resident.model.links.len()).sum();
        if models >= MAX_SPAWNED_MODELS || links + model.links.len() > MAX_SPAWNED_LINKS {
            return Err(format!(
                "at most {MAX_SPAWNED_MODELS} models with {MAX_SPAWNED_LINKS} links together may be spawned, \
                 and {models} with {links} are there; delete some first"
            ));
        }
        Ok(())
    }

    fn delete(&mut self, name: &str) -> Result<(), String> {
        let (index, resident) = self.roster.find(name)?;
        if resident.role == Role::Robot {
            return Err(format!(
                "'{name}' is the robot that this simulation is of: its sensors and streams cannot go; \
                 stop the simulator instead, or move it away"
            ));
        }
        self.physics.remove_model(index);
        self.scene.remove_model(index);
        self.roster.remove(index);
        Ok(())
    }
}
