//! Velocity commands.

/// A velocity command for a base: the planar part of a `geometry_msgs/Twist`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Speed along the base's x in m/s.
    pub linear_m_s: f64,
    /// Speed along its y, to the left, in m/s, for bases that can move sideways.
    pub lateral_m_s: f64,
    /// Rate of turn about the base's z in rad/s, positive to the left.
    pub angular_rad_s: f64,
}

impl Command {
    /// Stand still.
    pub const STOP: Self = Self::new(0.0, 0.0);

    /// Creates a command with a speed along the base's x in m/s, and a turn to the left in rad/s.
    pub const fn new(linear_m_s: f64, angular_rad_s: f64) -> Self {
        Self { linear_m_s, lateral_m_s: 0.0, angular_rad_s }
    }

    /// Returns the command, or a stop if a number is not finite.
    #[must_use]
    pub fn or_stop(self) -> Self {
        let is_finite =
            self.linear_m_s.is_finite() && self.lateral_m_s.is_finite() && self.angular_rad_s.is_finite();
        if is_finite { self } else { Self::STOP }
    }

    /// Returns the command within the limits of a base on two wheels. If a wheel would have to be faster than
    /// `max_speed_m_s`, speed and turn are both scaled down, so that the path stays the same. A command that is not
    /// finite becomes a stop.
    #[must_use]
    pub fn limited(self, max_speed_m_s: f64, max_turn_rad_s: f64, separation_m: f64) -> Self {
        let command = self.or_stop();
        let linear_m_s = command.linear_m_s.clamp(-max_speed_m_s, max_speed_m_s);
        let angular_rad_s = command.angular_rad_s.clamp(-max_turn_rad_s, max_turn_rad_s);
        let fastest_wheel = linear_m_s.abs() + 0.5 * separation_m * angular_rad_s.abs();
        let scale = if fastest_wheel > max_speed_m_s { max_speed_m_s / fastest_wheel } else { 1.0 };
        Self::new(linear_m_s * scale, angular_rad_s * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_keep_the_curvature() {
        let command = Command::new(0.7, 3.0).limited(0.7, 3.2, 0.23);
        assert!((command.linear_m_s / command.angular_rad_s - 0.7 / 3.0).abs() < 1e-12);
        assert!((command.linear_m_s + 0.115 * command.angular_rad_s - 0.7).abs() < 1e-12);
        assert_eq!(Command::new(f64::NAN, 0.0).limited(0.7, 3.2, 0.23), Command::STOP);
    }
}
