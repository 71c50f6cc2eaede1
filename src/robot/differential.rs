//! Differential drive: all left wheels turn at one speed, all right wheels at another.
//!
//! Commands are converted to wheel speeds with the radius and separation given in the plugin. As in Gazebo, the
//! resulting motion depends on the wheels in the model. A base with two wheels turns according to their actual
//! separation. With four or more wheels the wheels slip sideways in turns, which is not modelled: such a base turns
//! exactly as commanded, because the plugin's separation is tuned for that.

use super::base::Base;
use super::command::Command;
use super::grip::Axle;
use super::odometry::Odometry;
use super::tracker::Tracker;
use super::transforms::base_link;
use crate::description::diagnostics::Problem;
use crate::description::model::{BasePlugin, DifferentialDrive, LinkIndex, Model};
use crate::world::physics::{ModelIndex, Physics};

/// A base with wheels on two sides.
#[derive(Debug)]
pub(super) struct Differential {
    model: ModelIndex,
    base: LinkIndex,
    axle: Axle,
    radius_m: f64,
    separation_m: f64,
    acceleration_m_s2: f64,
    turns_as_commanded: bool,
    timeout_ns: u64,
    command: Command,
    command_ns: u64,
    /// Current speeds of the left and right wheels' rims, which approach those of the command.
    rims_m_s: [f64; 2],
    tracker: Tracker,
}

impl Differential {
    pub(super) fn new(
        model: &Model,
        plugin: &BasePlugin,
        drive: &DifferentialDrive,
        index: ModelIndex,
        physics: &mut Physics,
    ) -> Result<Self, Problem> {
        let axle = Axle::of(model, plugin, &drive.wheels)?;
        axle.release(physics, index);
        let radius_m = drive.wheels.radius_m.unwrap_or(axle.radius_m);
        let separation_m = drive.separation_m;
        Ok(Self {
            model: index,
            base: base_link(model),
            radius_m,
            separation_m,
            acceleration_m_s2: drive.acceleration_m_s2.unwrap_or(f64::INFINITY),
            turns_as_commanded: drive.skids || axle.wheels.len() > 2,
            timeout_ns: plugin.command_timeout_s.map_or(u64::MAX, |time_s| (time_s * 1e9) as u64),
            command: Command::STOP,
            command_ns: 0,
            rims_m_s: [0.0; 2],
            tracker: Tracker::of_axle(index, &plugin.odometry, &axle, radius_m, separation_m),
            axle,
        })
    }
}

impl Base for Differential {
    fn command(&mut self, command: Command, stamp_ns: u64) {
        (self.command, self.command_ns) = (command.or_stop(), stamp_ns);
    }

    fn control(&mut self, physics: &mut Physics) {
        let expired = physics.time_ns().saturating_sub(self.command_ns) >= self.timeout_ns;
        let Command { linear_m_s, angular_rad_s, .. } = if expired { Command::STOP } else { self.command };
        let change_m_s = self.acceleration_m_s2 * physics.step_s();
        for (rim, side) in self.rims_m_s.iter_mut().zip([-0.5, 0.5]) {
            let wanted = linear_m_s + side * self.separation_m * angular_rad_s;
            *rim += (wanted - *rim).clamp(-change_m_s, change_m_s);
        }
        // The wheels turn according to the plugin's radius, and roll with their actual radius.
        let [left, right] = self.rims_m_s.map(|rim| rim / self.radius_m * self.axle.radius_m);
        let apart_m = if self.turns_as_commanded { self.separation_m } else { self.axle.separation_m };
        let motion = Command::new(0.5 * (left + right), (right - left) / apart_m);
        self.axle.grip(physics, self.model, self.base, motion, [left, right]);
    }

    fn observe(&mut self, physics: &Physics) {
        self.tracker.observe(physics);
    }

    fn odometry_at(&self, physics: &Physics, stamp_ns: u64) -> Odometry {
        self.tracker.odometry_at(physics, stamp_ns)
    }

    fn reset_odometry(&mut self, physics: &Physics) {
        self.tracker.reset(physics);
    }
}
