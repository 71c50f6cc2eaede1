//! [`Twist`]: velocities that Foxglove clients publish.

use bytemuck::pod_read_unaligned;
use serde::Deserialize;

/// A `geometry_msgs/Twist`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Twist {
    pub(super) linear: Xyz,
    pub(super) angular: Xyz,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

impl Xyz {
    pub(super) fn array(&self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }
}

impl From<[f64; 3]> for Xyz {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl Twist {
    /// Parses JSON or ROS 1 bytes.
    ///
    /// # Errors
    /// The end of a message: a colon and the reason, or nothing if the length is wrong.
    pub(super) fn read(encoding: &str, payload: &[u8]) -> Result<Self, String> {
        match encoding {
            "json" => serde_json::from_slice(payload).map_err(|error| format!(": {error}")),
            _ if payload.len() == 48 => {
                let [linear, angular] = pod_read_unaligned::<[[f64; 3]; 2]>(payload);
                Ok(Self { linear: linear.into(), angular: angular.into() })
            }
            _ => Err(String::new()),
        }
    }
}
