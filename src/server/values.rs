//! Checks the poses and velocities in commands.

use crate::world::physics::FARTHEST_M;
use belvedere_bridge::payload::SimulationCommand;
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};

/// Highest speed that a command may set, in m/s or rad/s.
const FASTEST: f64 = 1e4;

/// Returns the pose of a command in its reference frame. An orientation of zeros, as in a message that was not filled
/// in, means no rotation.
///
/// # Errors
/// A message, if it is not finite, too far, or not a rotation.
pub(crate) fn pose(command: &SimulationCommand) -> Result<Pose, String> {
    let position = vector(command.position, FARTHEST_M, "position")?;
    let rotation = DQuat::from_array(command.orientation);
    let length = rotation.length();
    if command.orientation == [0.0; 4] {
        return Ok(Pose::from_translation(position));
    }
    if !(length.is_finite() && length > 1e-6) {
        return Err(format!("its orientation {:?} is not a quaternion x y z w", command.orientation));
    }
    Ok(Pose::new(position, rotation.normalize()))
}

/// Returns the linear and angular velocity of a command, along the axes of its reference frame.
///
/// # Errors
/// A message, if they are not finite or too high.
pub(crate) fn twist(command: &SimulationCommand) -> Result<(DVec3, DVec3), String> {
    Ok((
        vector(command.linear, FASTEST, "linear velocity")?,
        vector(command.angular, FASTEST, "angular velocity")?,
    ))
}

fn vector(values: [f64; 3], most: f64, what: &str) -> Result<DVec3, String> {
    if values.iter().all(|value| value.abs() <= most) {
        Ok(DVec3::from_array(values))
    } else {
        Err(format!("its {what} {values:?} is not three numbers of at most {most:e}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::Operation;

    #[test]
    fn invalid_poses_are_refused() {
        let command = SimulationCommand::new(Operation::SetModelState);
        let with = |position, orientation| pose(&SimulationCommand { position, orientation, ..command });
        assert_eq!(with([1.0, 2.0, 3.0], [0.0; 4]).unwrap().rotation(), DQuat::IDENTITY);
        let turned = with([0.0; 3], [0.0, 0.0, 2.0, 2.0]).unwrap().rotation();
        assert!((turned.length() - 1.0).abs() < 1e-15 && turned.z == turned.w);
        for (position, orientation) in [
            ([f64::NAN, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]),
            ([0.0, f64::INFINITY, 0.0], [0.0, 0.0, 0.0, 1.0]),
            ([0.0, 0.0, 2e7], [0.0, 0.0, 0.0, 1.0]),
            ([0.0; 3], [f64::NAN, 0.0, 0.0, 1.0]),
            ([0.0; 3], [0.0, 0.0, 0.0, 1e-9]),
            ([0.0; 3], [f64::MAX; 4]),
        ] {
            assert!(with(position, orientation).is_err(), "{position:?} {orientation:?}");
        }
        assert!(twist(&SimulationCommand { angular: [f64::NAN; 3], ..command }).is_err());
    }
}
