//! [`Place`]: a pose on the command line.

use crate::world::physics::FARTHEST_M;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::str::FromStr;

/// A position in metres and a heading in degrees, counter-clockwise seen from above: `X,Y`, `X,Y,YAW` or `X,Y,Z,YAW`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    position: [f64; 3],
    yaw_deg: f64,
}

/// The syntax of a place, for help texts.
pub(super) const PLACE: &str = "X,Y[,[Z,]YAW]";

impl Place {
    /// Creates a place on the floor, with heading 0.
    pub(super) fn on_floor(x: f64, y: f64) -> Self {
        Self { position: [x, y, 0.0], yaw_deg: 0.0 }
    }

    pub(super) fn pose(self) -> Pose {
        let position = DVec3::from_array(self.position);
        Pose::from_xyz_rpy(position, DVec3::Z * self.yaw_deg.to_radians())
    }
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "'{text}' is not a pose; write X,Y or X,Y,YAW or X,Y,Z,YAW in metres and degrees, such as 1,0.5,90"
            )
        };
        let numbers = text.split(',').map(|number| number.trim().parse().map_err(|_| wrong()));
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        let (position, yaw_deg) = match numbers[..] {
            [x, y] => ([x, y, 0.0], 0.0),
            [x, y, yaw] => ([x, y, 0.0], yaw),
            [x, y, z, yaw] => ([x, y, z], yaw),
            _ => return Err(wrong()),
        };
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(wrong());
        }
        if position.iter().any(|coordinate| coordinate.abs() > FARTHEST_M) {
            return Err(format!("'{text}' is too far away; write coordinates of at most {FARTHEST_M:e} m"));
        }
        Ok(Self { position, yaw_deg })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_to_four_numbers() {
        let place = |x, y, z, yaw_deg| Ok(Place { position: [x, y, z], yaw_deg });
        assert_eq!("1, -2".parse(), place(1.0, -2.0, 0.0, 0.0));
        assert_eq!("1,-2,90".parse(), place(1.0, -2.0, 0.0, 90.0));
        assert_eq!("1,-2,3,90".parse(), place(1.0, -2.0, 3.0, 90.0));
        assert_eq!("448262.27,5428765.81".parse(), place(448_262.27, 5_428_765.81, 0.0, 0.0));
        for bad in ["", "1", "1,2,3,4,5", "a,b,c", "1,2,nan", "1,2,inf"] {
            assert!(bad.parse::<Place>().unwrap_err().contains("write X,Y"), "{bad}");
        }
        assert!("0,-1e8".parse::<Place>().unwrap_err().contains("at most 1e7 m"));
    }
}
