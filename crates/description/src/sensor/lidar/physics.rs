//! Beam width, returns, receiver and weather of a lidar: elements of our plugin, which docs/lidars.md describes.

use super::PacketProfile;
use crate::sensor::plugin::extension;
use crate::sensor::reader::Reader;
use crate::values::{child_text, numbers};
use crate::xml::Element;
use belvedere_sensors::scanner::presets::{Maker, Preset};
use belvedere_sensors::scanner::{
    Beam, Crosstalk, Halo, Intensity, MAX_RETURNS, Pattern, Receiver, Returns, ScannerConfig, Weather,
};

/// The physics of beams and receiver, as in [`ScannerConfig`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamPhysics {
    /// Width of the beams.
    pub beam: Beam,
    /// Light around the beams.
    pub halo: Halo,
    /// Interference from other lidars.
    pub crosstalk: Crosstalk,
    /// Distance in metres below which two returns merge.
    pub pulse_m: f64,
    /// The returns that are reported.
    pub returns: Returns,
    /// The intensity that is reported.
    pub intensity: Intensity,
    /// The receiver's sensitivity; none if it detects everything.
    pub receiver: Option<Receiver>,
    /// Weather.
    pub weather: Weather,
}

impl BeamPhysics {
    /// Returns the physics of a preset; without one, single rays that are all returned.
    pub(super) fn of(preset: Option<&Preset>) -> Self {
        let ScannerConfig { halo, crosstalk, pulse_m, returns, intensity, receiver, weather, .. } =
            ScannerConfig::new(Pattern::Table(&[]));
        let beam = preset.map_or(Beam::RAY, |preset| preset.beam);
        Self { beam, halo, crosstalk, pulse_m, returns, intensity, receiver, weather }
    }

    /// Applies it to a scanner's configuration.
    pub fn applied_to<'a>(&self, config: ScannerConfig<'a>) -> ScannerConfig<'a> {
        config
            .beam(self.beam)
            .halo(self.halo)
            .crosstalk(self.crosstalk)
            .pulse_m(self.pulse_m)
            .returns(self.returns)
            .intensity(self.intensity)
            .receiver(self.receiver)
            .weather(self.weather)
    }
}

/// The names of the elements in our plugin.
pub(super) const NAMES: [&str; 14] = [
    "beam_rays",
    "beam_divergence",
    "beam_aperture",
    "beam_halo",
    "crosstalk",
    "pulse_length",
    "returns",
    "intensity",
    "receiver_reach",
    "receiver_resolution",
    "receiver_background",
    "fog_visibility",
    "rain_rate",
    "snow_rate",
];
/// The words of `<returns>` and `<intensity>`; returns may also be a number.
const RETURNS: [(&str, Returns); 5] = [
    ("strongest", Returns::Strongest),
    ("first", Returns::First),
    ("last", Returns::Last),
    ("dual", Returns::Dual),
    ("mean", Returns::Mean),
];
const INTENSITIES: [(&str, Intensity); 3] =
    [("retro", Intensity::Retro), ("power", Intensity::Power), ("reflectivity", Intensity::Reflectivity)];
/// Default number of rays per beam if more than the strongest return is reported.
const RAYS: u32 = 8;
/// The largest width of a beam, in radians and in metres.
const WIDEST: f64 = 0.2;
/// The least visibility in fog, in metres, and the strongest rain and snow, in millimetres per hour.
const DENSEST_M: f64 = 1.0;
const MOST_RAIN: f64 = 500.0;
const MOST_SNOW: f64 = 50.0;

impl Reader<'_> {
    /// Reads the physics and the packet layout of a scanner from our plugin.
    pub(super) fn beam_physics(
        &mut self,
        sensor: &Element,
        preset: Option<&Preset>,
    ) -> Option<(BeamPhysics, PacketProfile)> {
        let profile = self.packet_profile(sensor, preset)?;
        let own = extension(sensor);
        let mut physics = BeamPhysics::of(preset);
        let returns = self.returns(own, preset);
        let is_dual = profile == Some(PacketProfile::Rng19Rfl8Sig16Nir16Dual);
        let strongest = if is_dual { Returns::Ranked(2) } else { Returns::Strongest };
        let written = returns?;
        physics.returns = written.unwrap_or(strongest);
        if is_dual && physics.returns.count() != 2 {
            let what = format!("{} has two returns, but <returns> has not", self.what("udp_profile_lidar"));
            self.diagnostics.error(
                Self::place(own, "returns", sensor),
                what,
                "write <returns>dual</returns>, or remove it",
            );
            return None;
        }
        let pair = match physics.returns.count() {
            2 => PacketProfile::Rng19Rfl8Sig16Nir16Dual,
            _ => PacketProfile::default(),
        };
        let intensity = self.one_of(own, "intensity", &INTENSITIES, "");
        let shape = self.beam(own, physics);
        let halo = self.halo(own);
        let is_share = |chance: f64| (0.0..=1.0).contains(&chance);
        let chance = self.checked(own, "crosstalk", 0.0, is_share, "write a share of the firings, 0 to 1");
        let pulse = self.not_negative_or(own, "pulse_length", physics.pulse_m);
        let receiver = self.receiver(own);
        let weather = self.weather(own);
        physics.intensity = intensity?.unwrap_or_default();
        physics.beam = shape?;
        physics.halo = halo?;
        physics.crosstalk = Crosstalk { chance: chance? };
        physics.pulse_m = pulse?;
        physics.receiver = receiver?;
        physics.weather = weather?;
        Some((physics, profile.unwrap_or(pair)))
    }

    /// Reads `<returns>`; the inner none means that it is absent.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    fn returns(&mut self, own: Option<&Element>, preset: Option<&Preset>) -> Option<Option<Returns>> {
        let text = own.and_then(|own| child_text(own, "returns"));
        if let Some(count) = text.and_then(|text| text.parse().ok())
            && (1..=MAX_RETURNS).contains(&usize::from(count))
        {
            return Some(Some(Returns::Several(count)));
        }
        let returns = self.one_of(own, "returns", &RETURNS, ", or a number from 1 to 5")?;
        // Ouster orders returns by strength.
        let is_ouster = preset.is_some_and(|preset| preset.maker == Maker::Ouster);
        Some(returns.map(|returns| match returns {
            Returns::Dual if is_ouster => Returns::Ranked(2),
            returns => returns,
        }))
    }

    /// Returns the value of a word; the inner none means that the element is absent.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    fn one_of<T: Copy>(
        &mut self,
        own: Option<&Element>,
        name: &str,
        choices: &[(&str, T)],
        more: &str,
    ) -> Option<Option<T>> {
        let Some(child) = own.and_then(|own| own.child(name)) else { return Some(None) };
        let text = child.text();
        if let Some((_, value)) = choices.iter().find(|(word, _)| *word == text) {
            return Some(Some(*value));
        }
        let words = choices.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
        let what = format!("{} is '{text}'", self.what(name));
        self.diagnostics.error(&child.source, what, format!("write {words}{more}"));
        None
    }

    fn beam(&mut self, own: Option<&Element>, physics: BeamPhysics) -> Option<Beam> {
        let is_several = physics.returns != Returns::Strongest;
        let rays = if is_several { RAYS } else { physics.beam.rays };
        let is_bundle = |rays: f64| [1.0, 7.0, 8.0, 19.0].contains(&rays);
        let rays = self.checked(own, "beam_rays", rays.into(), is_bundle, "write 1, 7, 8 or 19");
        let divergence_rad = self.width(own, "beam_divergence", physics.beam.divergence_rad);
        let aperture_m = self.width(own, "beam_aperture", physics.beam.aperture_m);
        let beam = Beam { divergence_rad: divergence_rad?, aperture_m: aperture_m?, rays: rays? as u32 };
        if let Some(own) = own
            && beam.rays > 1
            && beam.divergence_rad == [0.0; 2]
            && beam.aperture_m == [0.0; 2]
        {
            let name = if own.child("beam_rays").is_some() { "beam_rays" } else { "returns" };
            let what = format!("{} needs beams with a width, but these have none", self.what(name));
            let remedy = "write <beam_divergence> in radians, as 0.003 0.0015: across, and up";
            self.diagnostics.error(Self::place(Some(own), name, own), what, remedy);
            return None;
        }
        Some(beam)
    }

    /// Reads a width across and up.
    fn width(&mut self, own: Option<&Element>, name: &str, default: [f64; 2]) -> Option<[f64; 2]> {
        let Some(child) = own.and_then(|own| own.child(name)) else { return Some(default) };
        let (text, what) = (child.text(), self.what(name));
        let width = numbers::<2>(&text, &what, &child.source, self.diagnostics)?;
        if width.iter().all(|width| (0.0..=WIDEST).contains(width)) {
            return Some(width);
        }
        let remedy = format!("write two numbers from 0 to {WIDEST}: across, and up");
        self.diagnostics.error(&child.source, format!("{what} is {text}"), remedy);
        None
    }

    /// Reads the halo: a share of the light, and a radius.
    fn halo(&mut self, own: Option<&Element>) -> Option<Halo> {
        let Some(child) = own.and_then(|own| own.child("beam_halo")) else { return Some(Halo::NONE) };
        let (text, what) = (child.text(), self.what("beam_halo"));
        let [share, radius_rad] = numbers::<2>(&text, &what, &child.source, self.diagnostics)?;
        if (0.0..=0.5).contains(&share) && (0.0..=WIDEST).contains(&radius_rad) {
            return Some(Halo { share, radius_rad });
        }
        let remedy = format!("write a share of the light, 0 to 0.5, and a radius in radians, 0 to {WIDEST}");
        self.diagnostics.error(&child.source, format!("{what} is {text}"), remedy);
        None
    }

    /// Reads a number of 0 or more, with a default.
    fn not_negative_or(&mut self, own: Option<&Element>, name: &str, default: f64) -> Option<f64> {
        self.checked(own, name, default, |value| value >= 0.0, "write 0 or more")
    }

    /// Reads the receiver; the inner none means that it detects everything.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    fn receiver(&mut self, own: Option<&Element>) -> Option<Option<Receiver>> {
        let reach =
            self.checked(own, "receiver_reach", 0.0, |reach| reach > 0.0, "write more than 0, in metres");
        let resolution = self.not_negative(own, "receiver_resolution");
        let background = self.not_negative(own, "receiver_background");
        let receiver =
            Receiver { resolution_m: resolution?, background: background?, ..Receiver::new(reach?) };
        let Some(own) = own else { return Some(None) };
        if receiver.reach_m > 0.0 {
            return Some(Some(receiver));
        }
        let Some(name) =
            ["receiver_resolution", "receiver_background"].into_iter().find(|name| own.child(name).is_some())
        else {
            return Some(None);
        };
        let what = format!("{} needs a receiver with a reach", self.what(name));
        let remedy = "write <receiver_reach>: the distance in metres up to which a surface of reflectivity 0.9 is detected";
        self.diagnostics.error(Self::place(Some(own), name, own), what, remedy);
        None
    }

    fn weather(&mut self, own: Option<&Element>) -> Option<Weather> {
        let fog = format!("write {DENSEST_M} or more, in metres; without fog, remove it");
        let visibility = Weather::CLEAR.visibility_m;
        let visibility = self.checked(own, "fog_visibility", visibility, |metres| metres >= DENSEST_M, &fog);
        let mut rate = |name, most: f64| {
            let remedy = format!("write a number from 0 to {most}, in millimetres an hour");
            self.checked(own, name, 0.0, |rate| (0.0..=most).contains(&rate), &remedy)
        };
        let (rain, snow) = (rate("rain_rate", MOST_RAIN), rate("snow_rate", MOST_SNOW));
        Some(Weather { visibility_m: visibility?, rain_mm_per_h: rain?, snow_mm_per_h: snow? })
    }
}
