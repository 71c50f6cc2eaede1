//! `<ray>` and `<lidar>`: the angles, ranges and noise of the beams.

use super::sees_visuals;
use crate::model::{RaySensor, ScanAxis};
use crate::sensor::reader::Reader;
use crate::values::{child_bits, child_text};
use crate::xml::Element;
use belvedere_sensors::lidar::{MAX_BEAMS, MAX_SAMPLES};

impl Reader<'_> {
    /// The element whose `<ray>` or `<lidar>` describes the beams: the sensor, or, where that has none, its plugin, as of
    /// Livox. A sensor of which nobody tells the beams measures nothing in Gazebo: it is left out.
    fn describing<'e>(&mut self, sensor: &'e Element) -> Option<&'e Element> {
        if beams_of(sensor).is_some() {
            return Some(sensor);
        }
        let Some(plugin) = sensor.elements_named("plugin").find(|plugin| beams_of(plugin).is_some()) else {
            self.diagnostics.warning(
                &sensor.source,
                format!(
                    "sensor '{}' has no <ray> and no <lidar>: by SDF's defaults its range ends at 0 m, and it is left out",
                    self.sensor
                ),
                "write its <scan> and <range> into a <ray>, or give it a <preset>",
            );
            return None;
        };
        let file = plugin.attribute("filename").unwrap_or_default();
        self.diagnostics.warning(
            &sensor.source,
            format!(
                "sensor '{}' has no <ray> of its own: it has the beams of that in the plugin '{file}'",
                self.sensor
            ),
            "put the <ray> into the sensor, or give it a <preset>",
        );
        Some(plugin)
    }

    /// The beams of a sensor.
    pub(in crate::sensor) fn ray(&mut self, sensor: &Element) -> Option<RaySensor> {
        let described = self.describing(sensor)?;
        let ray = beams_of(described);
        let scan = ray.and_then(|ray| ray.child("scan"));
        let horizontal = self.axis(scan, "horizontal", 640);
        let vertical = self.axis(scan, "vertical", 1);
        let range = ray.and_then(|ray| ray.child("range"));
        let limits = self.range(range, described);
        let resolution = self.not_negative(range, "resolution");
        let noise = self.noise(ray);

        let visibility_mask = self.visibility_mask(sensor, described);

        let (horizontal, vertical) = (horizontal?, vertical?);
        let beams = u64::from(horizontal.samples) * u64::from(vertical.samples);
        if beams > u64::from(MAX_BEAMS) {
            self.diagnostics.error(
                Self::place(ray, "scan", described),
                format!(
                    "sensor '{}' has {} × {} = {beams} beams",
                    self.sensor, horizontal.samples, vertical.samples
                ),
                format!("write fewer <samples>: at most {MAX_BEAMS} beams in all"),
            );
            return None;
        }
        let (range_min_m, range_max_m) = limits?;
        Some(RaySensor {
            sees_visuals: sees_visuals(sensor),
            visibility_mask: visibility_mask?,
            horizontal,
            vertical,
            range_min_m,
            range_max_m,
            range_resolution_m: resolution?,
            noise: noise?,
        })
    }

    /// Which visuals a lidar sees, by their `<visibility_flags>`: all, unless its `<visibility_mask>` says otherwise. One that
    /// hits collision shapes has no use for it, because these have no flags.
    pub(super) fn visibility_mask(&mut self, sensor: &Element, described: &Element) -> Option<u32> {
        let Some(written) = beams_of(described).filter(|ray| ray.child("visibility_mask").is_some()) else {
            return Some(u32::MAX);
        };
        let mask = child_bits(written, "visibility_mask", self.diagnostics)?;
        if mask != u32::MAX && !sees_visuals(sensor) {
            self.diagnostics.warning(
                Self::place(Some(written), "visibility_mask", written),
                format!(
                    "{} is without effect: it hits collision shapes, which have no flags",
                    self.what("visibility_mask")
                ),
                "make it a gpu_ray or gpu_lidar, which sees visuals, or take it out",
            );
        }
        Some(mask)
    }

    fn axis(&mut self, scan: Option<&Element>, name: &str, default_samples: u32) -> Option<ScanAxis> {
        let axis = scan.and_then(|scan| scan.child(name));
        let samples = self.truncated(axis, "samples", default_samples, MAX_SAMPLES);
        let min = self.number(axis, "min_angle", 0.0);
        let max = self.number(axis, "max_angle", 0.0);
        let (samples, min_angle_rad, max_angle_rad) = (samples?, min?, max?);
        if min_angle_rad > max_angle_rad {
            if let Some(axis) = axis {
                self.diagnostics.warning(
                    Self::place(Some(axis), "min_angle", axis),
                    format!(
                        "{} is {min_angle_rad} and <max_angle> is {max_angle_rad} (<{name}>): they are exchanged",
                        self.what("min_angle")
                    ),
                    "write <min_angle> not above <max_angle>",
                );
            }
            return Some(ScanAxis { samples, min_angle_rad: max_angle_rad, max_angle_rad: min_angle_rad });
        }
        Some(ScanAxis { samples, min_angle_rad, max_angle_rad })
    }

    /// Smallest and largest range; the largest may be `inf`.
    fn range(&mut self, range: Option<&Element>, sensor: &Element) -> Option<(f64, f64)> {
        let min = self.not_negative(range, "min");
        let is_infinite = range
            .and_then(|range| child_text(range, "max"))
            .is_some_and(|text| matches!(text.to_ascii_lowercase().as_str(), "inf" | "+inf" | "infinity"));
        let max = if is_infinite { Some(f64::INFINITY) } else { self.number(range, "max", 0.0) };
        let (min, max) = (min?, max?);
        if min < max {
            return Some((min, max));
        }
        self.diagnostics.error(
            Self::place(range, "max", sensor),
            format!("the <range> of sensor '{}' has <min> {min} and <max> {max}", self.sensor),
            "write <range><min> below <max>, in metres; <max> may be inf",
        );
        None
    }
}

/// The `<ray>` of Gazebo classic, or the `<lidar>` of gz-sim.
fn beams_of(described: &Element) -> Option<&Element> {
    described.child("ray").or_else(|| described.child("lidar"))
}
