//! `<device>` of a `<camera>`, and the preset of our plugin in a camera's sensor, which are our extensions: sensor and
//! electronics, shutter, automatic exposure. docs/cameras.md describes the elements.

use super::reader::Reader;
use crate::model::{AutoExposed, CameraDevice};
use crate::values::child_text;
use crate::xml::Element;
use belvedere_sensors::device::{AutoExposure, AutoExposureConfig, DeviceConfig, Metering, presets};
use belvedere_sensors::{ParameterError, Rule};

/// Name and accessor of a number of the device.
type Number = (&'static str, fn(&mut DeviceConfig) -> &mut f64);

/// Elements have the names of the fields of [`DeviceConfig`], except exposure time and gain.
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
/// The other elements of a device.
const OTHERS: [&str; 5] = ["preset", "bits", "readout_time_s", "motion_blur_samples", "auto_exposure"];
/// The elements of `<auto_exposure>`.
const AUTOMATIC: [&str; 6] =
    ["target", "tolerance", "shortest_time_s", "longest_time_s", "most_gain", "metering"];
/// Longest readout, and longest exposure with motion blur, in seconds: the poses of everything are stored for so long.
const LONGEST_WINDOW_S: f64 = 10.0;
/// Most samples of an exposure: each costs a frame.
const MOST_SAMPLES: u32 = 64;

/// Seconds from the reading of the first row to that of the last, for the presets with a rolling shutter. The machine
/// vision preset has a global shutter.
///
/// OV5647: 1079 rows of 2416 clocks at 87.5 MHz, its mode of 1920 × 1080 pixels and 30 Hz in Linux's driver. IMX477: 1519 rows of
/// 12740 pixels at 840 MHz, its mode of 2028 × 1520 pixels in Raspberry Pi's driver.
const READOUT_TIMES_S: [(&str, f64); 2] =
    [("webcam", 1079.0 * 2416.0 / 87.5e6), ("raspberry_pi_hq", 1519.0 * 12740.0 / 840e6)];

impl Reader<'_> {
    /// Reads the device of a camera: its `<device>`, the preset of our plugin `own`, or that preset with the changes of
    /// `<device>`. The inner none means that the camera has no device.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    pub(super) fn device(
        &mut self,
        camera: Option<&Element>,
        own: Option<&Element>,
    ) -> Option<Option<CameraDevice>> {
        let written = camera.and_then(|camera| camera.child("device"));
        let preset = own.or(written.filter(|device| device.child("preset").is_some()));
        let (mut config, readout_time_s) = match preset {
            Some(preset) => self.preset(preset)?,
            None => (DeviceConfig::default(), 0.0),
        };
        let Some(element) = written else {
            let device = CameraDevice { config, readout_time_s, motion_blur_samples: 1, auto_exposure: None };
            return Some(preset.map(|_| device));
        };
        if let (Some(own), Some(second)) = (own, element.child("preset")) {
            let what = format!("the camera of sensor '{}' has two presets", self.sensor);
            let remedy = format!("remove this one or that of the plugin 'belvedere' ({})", own.source);
            self.diagnostics.error(&second.source, what, remedy);
            return None;
        }
        for (name, field) in NUMBERS {
            let value = self.number(Some(element), name, *field(&mut config));
            *field(&mut config) = value?;
        }
        config.bits = self.count(Some(element), "bits", config.bits, 16)?;
        let names = || NUMBERS.iter().map(|(name, _)| *name).chain(OTHERS);
        let remedy = format!("remove it: a device has {}", names().collect::<Vec<_>>().join(", "));
        self.left_out(element, |name| names().any(|known| known == name), &remedy);
        if let Err(error) = config.check() {
            self.refuse(element, &error, [0.0; 2]);
            return None;
        }
        let is_window = |time: f64| (0.0..=LONGEST_WINDOW_S).contains(&time);
        let remedy = format!("write a time in seconds from 0 to {LONGEST_WINDOW_S}; 0 is a global shutter");
        let readout_time_s =
            self.checked(Some(element), "readout_time_s", readout_time_s, is_window, &remedy)?;
        let motion_blur_samples = self.count(Some(element), "motion_blur_samples", 1, MOST_SAMPLES)?;
        let auto_exposure = match element.child("auto_exposure") {
            Some(automatic) => Some(self.auto_exposure(element, automatic, &config)?),
            None => None,
        };
        let device = CameraDevice { config, readout_time_s, motion_blur_samples, auto_exposure };
        if motion_blur_samples > 1 && !is_window(device.longest_exposure_s()) {
            let what = format!(
                "{} is set for exposures of up to {} s, which are too long for it",
                self.what("motion_blur_samples"),
                device.longest_exposure_s()
            );
            let remedy = format!("write times of exposure of {LONGEST_WINDOW_S} s at most, or remove it");
            self.diagnostics.error(Self::place(Some(element), "motion_blur_samples", element), what, remedy);
            return None;
        }
        Some(Some(device))
    }

    /// Returns the preset that an element names, and its readout time in seconds.
    fn preset(&mut self, element: &Element) -> Option<(DeviceConfig, f64)> {
        let name = self.preset_name(element, &presets::NAMES)?;
        let readout = READOUT_TIMES_S.iter().find(|(preset, _)| *preset == name);
        Some((presets::named(name)?.config(), readout.map_or(0.0, |(_, time_s)| *time_s)))
    }

    fn auto_exposure(
        &mut self,
        device: &Element,
        element: &Element,
        start: &DeviceConfig,
    ) -> Option<AutoExposed> {
        let described = AutoExposureConfig::default();
        let [shortest, longest] = described.time_range_s;
        let remedy = format!("remove it: an auto_exposure has {}", AUTOMATIC.join(", "));
        self.left_out(element, |name| AUTOMATIC.contains(&name), &remedy);
        let mut number = |name, default| self.number(Some(element), name, default);
        let target = number("target", described.target);
        let tolerance = number("tolerance", described.tolerance);
        let times = [number("shortest_time_s", shortest), number("longest_time_s", longest)];
        let most_gain = number("most_gain", described.most_gain);
        let time_range_s = [times[0]?, times[1]?];
        let config = AutoExposureConfig::default()
            .target(target?)
            .tolerance(tolerance?)
            .time_range_s(time_range_s)
            .most_gain(most_gain?);
        let metering = match child_text(element, "metering").as_deref() {
            None | Some("mean") => Metering::Mean,
            Some("centre") => Metering::Centre,
            Some(other) => {
                let what = format!("{} is '{other}'", self.what("metering"));
                let place = Self::place(Some(element), "metering", element);
                self.diagnostics.error(place, what, "write mean or centre");
                return None;
            }
        };
        if let Err(error) = AutoExposure::new(config, start.exposure) {
            let of_start = error.parameter.starts_with("start.");
            self.refuse(if of_start { device } else { element }, &error, time_range_s);
            return None;
        }
        Some(AutoExposed { config, metering })
    }

    /// Adds an error for a parameter that is out of its range, at its element.
    fn refuse(&mut self, element: &Element, error: &ParameterError, time_range_s: [f64; 2]) {
        let (least, remedy) = match error.rule {
            Rule::Range([least, most]) => (Some(least), format!("write a number from {least} to {most}")),
            Rule::Text(rule) => (None, format!("it must be {rule}")),
        };
        let name = match error.parameter {
            "exposure.time_s" | "start.time_s" => "exposure_time_s",
            "exposure.gain" | "start.gain" => "gain",
            "time_range_s" if error.value == time_range_s[0] && least != Some(time_range_s[0]) => {
                "shortest_time_s"
            }
            "time_range_s" => "longest_time_s",
            name => name,
        };
        let what = format!("{} is {}", self.what(name), error.value);
        self.diagnostics.error(Self::place(Some(element), name, element), what, remedy);
    }
}
