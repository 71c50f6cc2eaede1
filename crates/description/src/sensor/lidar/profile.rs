//! Layouts of Ouster's packets: `<udp_profile_lidar>` of our plugin.

use crate::sensor::plugin::extension;
use crate::sensor::reader::Reader;
use crate::values::child_text;
use crate::xml::Element;
use belvedere_sensors::scanner::presets::{Maker, Preset};

/// A layout of Ouster's packets, as `udp_profile_lidar` of its configuration names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PacketProfile {
    /// The layout of the first firmware.
    Legacy,
    /// 12 bytes per beam: range in mm, reflectivity, signal, near infrared.
    #[default]
    Rng19Rfl8Sig16Nir16,
    /// 16 bytes per beam: the same for two returns, the strongest first.
    Rng19Rfl8Sig16Nir16Dual,
    /// 4 bytes per beam: range in units of 8 mm, reflectivity, near infrared.
    Rng15Rfl8Nir8,
}

impl PacketProfile {
    /// All layouts.
    pub const ALL: [Self; 4] =
        [Self::Legacy, Self::Rng19Rfl8Sig16Nir16, Self::Rng19Rfl8Sig16Nir16Dual, Self::Rng15Rfl8Nir8];
    const NAMES: [&str; 4] =
        ["LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"];

    /// Returns Ouster's name for it.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

impl Reader<'_> {
    /// Reads the `<udp_profile_lidar>` next to a preset; the inner none means that it is absent.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    pub(super) fn packet_profile(
        &mut self,
        sensor: &Element,
        preset: Option<&Preset>,
    ) -> Option<Option<PacketProfile>> {
        let written = extension(sensor).and_then(|own| Some((own, child_text(own, "udp_profile_lidar")?)));
        let Some((own, name)) = written else { return Some(None) };
        let is_ouster = preset.is_some_and(|preset| preset.maker == Maker::Ouster);
        let found = PacketProfile::ALL.into_iter().find(|profile| profile.name() == name);
        if is_ouster && found.is_some() {
            return Some(found);
        }
        let names = PacketProfile::NAMES.join(", ");
        let remedy = if is_ouster {
            format!("choose from {names}")
        } else {
            "remove it: only Ouster's have one".into()
        };
        let place = Self::place(Some(own), "udp_profile_lidar", own);
        let what = format!("{} is '{name}', which is not a profile of it", self.what("udp_profile_lidar"));
        self.diagnostics.error(place, what, remedy);
        None
    }
}
