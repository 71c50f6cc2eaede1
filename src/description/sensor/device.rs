//! `<device>` of a `<camera>`, which is ours: sensor and electronics; docs/cameras.md has the elements in words.

use super::reader::Reader;
use crate::description::values::{child_text, nearest};
use crate::description::xml::Element;
use belvedere_sensors::device::{DeviceConfig, presets};

/// A number of the device, by the name of its element.
type Number = (&'static str, fn(&mut DeviceConfig) -> &mut f64);

/// Elements are called as the fields of [`DeviceConfig`], time and gain of the exposure as these.
const NUMBERS: [Number; 14] = [
    ("exposure_time_s", |device| &mut device.exposure.time_s),
    ("gain", |device| &mut device.exposure.gain),
    ("white_radiance_w_m2_sr", |device| &mut device.white_radiance_w_m2_sr),
    ("wavelength_nm", |device| &mut device.wavelength_nm),
    ("f_number", |device| &mut device.f_number),
    ("pixel_pitch_um", |device| &mut device.pixel_pitch_um),
    ("full_well_e", |device| &mut device.full_well_e),
    ("dark_current_e_per_s", |device| &mut device.dark_current_e_per_s),
    ("read_noise_e", |device| &mut device.read_noise_e),
    ("converter_noise_dn", |device| &mut device.converter_noise_dn),
    ("dsnu_e", |device| &mut device.dsnu_e),
    ("prnu", |device| &mut device.prnu),
    ("dn_per_electron", |device| &mut device.dn_per_electron),
    ("black_level_dn", |device| &mut device.black_level_dn),
];

impl Reader<'_> {
    /// The device of a camera; the inner none means that it has none.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    pub(super) fn device(&mut self, camera: Option<&Element>) -> Option<Option<DeviceConfig>> {
        let Some(element) = camera.and_then(|camera| camera.child("device")) else { return Some(None) };
        let mut device = self.preset(element)?;
        for (name, field) in NUMBERS {
            let value = self.number(Some(element), name, *field(&mut device));
            *field(&mut device) = value?;
        }
        device.bits = self.count(Some(element), "bits", device.bits, 16)?;
        let names = || NUMBERS.iter().map(|(name, _)| *name).chain(["preset", "bits"]);
        let remedy = format!("take it out: a device has {}", names().collect::<Vec<_>>().join(", "));
        self.left_out(element, |name| names().any(|known| known == name), &remedy);
        let Err(error) = device.check() else { return Some(Some(device)) };
        let name = match error.parameter {
            "exposure.time_s" => "exposure_time_s",
            "exposure.gain" => "gain",
            name => name,
        };
        let what = format!("{} is {}", self.what(name), error.value);
        let [least, most] = error.range;
        let remedy = format!("write a number from {least} to {most}");
        self.diagnostics.error(Self::place(Some(element), name, element), what, remedy);
        None
    }

    fn preset(&mut self, element: &Element) -> Option<DeviceConfig> {
        let Some(name) = child_text(element, "preset") else { return Some(DeviceConfig::default()) };
        let device = presets::named(&name);
        if device.is_none() {
            let what = format!("{} is '{name}', which is none", self.what("preset"));
            let near = nearest(&name, presets::NAMES).unwrap_or_default();
            let remedy = format!("did you mean {near}? there are {}", presets::NAMES.join(", "));
            self.diagnostics.error(Self::place(Some(element), "preset", element), what, remedy);
        }
        device
    }
}
