//! Layouts of the packets of an Ouster's inertial unit: `<udp_profile_imu>` of our plugin, for the unit that sends them and
//! for the lidar whose metadata names the layout.

use super::plugin::extension;
use super::reader::Reader;
use crate::values::child_text;
use crate::xml::Element;

/// A layout of the packets of an Ouster's inertial unit, as `udp_profile_imu` of its configuration names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ImuProfile {
    /// The layout of the first firmware: one sample per packet, in g and degrees per second.
    #[default]
    Legacy,
    /// Eight samples per packet, in m/s² and rad/s, and an NMEA sentence, which is always empty here.
    Accel32Gyro32Nmea,
}

impl ImuProfile {
    /// All layouts.
    pub const ALL: [Self; 2] = [Self::Legacy, Self::Accel32Gyro32Nmea];
    const NAMES: [&str; 2] = ["LEGACY", "ACCEL32_GYRO32_NMEA"];

    /// Returns Ouster's name for it.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

impl Reader<'_> {
    /// Reads the `<udp_profile_imu>` of our plugin, which only Ouster's sensors have; the inner none means that it is absent.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    pub(super) fn imu_profile(&mut self, sensor: &Element, is_ouster: bool) -> Option<Option<ImuProfile>> {
        let written = extension(sensor).and_then(|own| Some((own, child_text(own, "udp_profile_imu")?)));
        let Some((own, name)) = written else { return Some(None) };
        let found = ImuProfile::ALL.into_iter().find(|profile| profile.name() == name);
        if found.is_none() || !is_ouster {
            let what = format!("{} is '{name}', which is not a profile of it", self.what("udp_profile_imu"));
            let names = ImuProfile::NAMES.join(", ");
            let remedy = if is_ouster {
                format!("choose from {names}")
            } else {
                "remove it: only Ouster's sensors have one".into()
            };
            self.diagnostics.error(Self::place(Some(own), "udp_profile_imu", own), what, remedy);
            return None;
        }
        Some(found)
    }
}
