//! Poses and velocities in messages.

use crate::ros2::cdr::{Cdr, Unreadable};
use belvedere_bridge::RosBytes;
use belvedere_bridge::payload::{ModelState, SimulationCommand};

/// A position in metres, and an orientation as x y z w.
pub(super) type Pose = ([f64; 3], [f64; 4]);
/// A linear and an angular velocity.
pub(super) type Twist = ([f64; 3], [f64; 3]);

/// A `simulation_interfaces/msg/EntityState`.
#[derive(Debug, Clone)]
pub(super) struct EntityState {
    pub(super) frame: String,
    pub(super) pose: Pose,
    pub(super) twist: Twist,
    pub(super) acceleration: Twist,
}

impl EntityState {
    pub(super) fn read(fields: &mut Cdr<'_>) -> Result<Self, Unreadable> {
        let (frame, pose) = read_pose_stamped(fields)?;
        Ok(Self { frame, pose, twist: read_twist(fields)?, acceleration: read_twist(fields)? })
    }
}

/// Reads a `geometry_msgs/msg/PoseStamped`: the name of its frame, and the pose.
pub(super) fn read_pose_stamped(fields: &mut Cdr<'_>) -> Result<(String, Pose), Unreadable> {
    // Its time is ignored, as the interface says.
    fields.i32()?;
    fields.u32()?;
    Ok((fields.text()?.to_owned(), (numbers(fields)?, numbers(fields)?)))
}

fn read_twist(fields: &mut Cdr<'_>) -> Result<Twist, Unreadable> {
    Ok((numbers(fields)?, numbers(fields)?))
}

fn numbers<const N: usize>(fields: &mut Cdr<'_>) -> Result<[f64; N], Unreadable> {
    let mut values = [0.0; N];
    values.iter_mut().try_for_each(|value| fields.f64().map(|read| *value = read))?;
    Ok(values)
}

/// Sets the pose of a command.
pub(super) fn set_pose(command: &mut SimulationCommand, (position, orientation): Pose) {
    (command.position, command.orientation) = (position, orientation);
}

/// Sets the velocity of a command.
pub(super) fn set_twist(command: &mut SimulationCommand, (linear, angular): Twist) {
    (command.linear, command.angular) = (linear, angular);
}

/// Writes a `simulation_interfaces/msg/EntityState` in the frame of the world, or one of zeros. Accelerations are not
/// known, so they are zero.
pub(super) fn write_state(reply: &mut RosBytes<'_>, stamp_ns: u64, state: Option<&ModelState>) {
    reply.time(stamp_ns);
    reply.text(if state.is_some() { "world" } else { "" });
    let mut put = |values: &[f64]| values.iter().for_each(|value| reply.f64(*value));
    match state {
        Some(ModelState { position, orientation, linear, angular, .. }) => {
            put(position);
            put(orientation);
            put(linear);
            put(angular);
        }
        None => put(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    }
    put(&[0.0; 6]);
}
