//! `<noise>`.

use super::reader::Reader;
use crate::model::Noise;
use crate::values::child_text;
use crate::xml::Element;
use belvedere_sensors::noise::InstrumentConfig;

/// The elements that are simulated.
const READ: [&str; 6] = ["type", "mean", "stddev", "bias_mean", "bias_stddev", "precision"];
/// Additional elements for instruments.
const DRIFT: [&str; 2] = ["dynamic_bias_stddev", "dynamic_bias_correlation_time"];

impl Reader<'_> {
    /// Reads the noise in a `<camera>` or a `<ray>`; none means no noise.
    pub(super) fn noise(&mut self, parent: Option<&Element>) -> Option<Noise> {
        let Some(element) = parent.and_then(|parent| parent.child("noise")) else {
            return Some(Noise::default());
        };
        self.noise_of(element, &[])
    }

    /// Reads the noise of an instrument's quantity, whose bias may drift.
    pub(super) fn drifting_noise(&mut self, parent: &Element) -> Option<Noise> {
        let Some(element) = parent.child("noise") else { return Some(Noise::default()) };
        self.noise_of(element, &DRIFT)
    }

    /// Reads a `<noise>` element; `besides` are the additional elements that are simulated.
    pub(super) fn noise_of(&mut self, element: &Element, besides: &[&str]) -> Option<Noise> {
        // From SDF 1.7 on the type is an attribute.
        let kind = child_text(element, "type")
            .or_else(|| element.attribute("type").map(str::to_owned))
            .unwrap_or_else(|| "gaussian".into());
        let is_quantized = match kind.trim().to_ascii_lowercase().as_str() {
            "none" => return Some(Noise::default()),
            "gaussian" => false,
            "gaussian_quantized" => true,
            _ => {
                let source = Self::place(Some(element), "type", element);
                self.diagnostics.error(
                    source,
                    format!("the noise of sensor '{}' is of type '{kind}'", self.sensor),
                    "write gaussian, gaussian_quantized or none",
                );
                return None;
            }
        };
        let is_nothing = |name: &str| {
            let value: Option<f64> = child_text(element, name).and_then(|text| text.parse().ok());
            name.starts_with("dynamic_bias_") && value == Some(0.0)
        };
        let read = [&READ[..], besides].concat();
        let remedy = format!("remove it: a noise has {}", read.join(", "));
        self.left_out(element, |name| read.contains(&name) || is_nothing(name), &remedy);
        let element = Some(element);
        let mean = self.number(element, "mean", 0.0);
        let stddev = self.not_negative(element, "stddev");
        let bias_mean = self.number(element, "bias_mean", 0.0);
        let bias_stddev = self.not_negative(element, "bias_stddev");
        let precision = self.not_negative(element, "precision");
        let drift = if besides.is_empty() { Some([0.0; 2]) } else { self.drift(element) };
        Some(Noise {
            mean: mean?,
            stddev: stddev?,
            bias_mean: bias_mean?,
            bias_stddev: bias_stddev?,
            // Plain Gaussian noise is not rounded, even with a <precision>.
            precision: if is_quantized { precision? } else { precision.map(|_| 0.0)? },
            drift: drift?,
        })
    }

    /// Reads density and correlation time of a bias that drifts: no drift unless both are given, as in Gazebo.
    fn drift(&mut self, element: Option<&Element>) -> Option<[f64; 2]> {
        let [drift, time_s] = DRIFT.map(|name| self.not_negative(element, name));
        let (drift, time_s) = (drift?, time_s?);
        if (drift > 0.0) == (time_s > 0.0) {
            return Some([drift, time_s]);
        }
        if let Some(element) = element {
            let (given, missing) = if drift > 0.0 { (DRIFT[0], DRIFT[1]) } else { (DRIFT[1], DRIFT[0]) };
            self.diagnostics.warning(
                Self::place(Some(element), given, element),
                format!("{} has no effect without <{missing}>, as in Gazebo", self.what(given)),
                format!("write <{missing}> above 0, too"),
            );
        }
        Some([0.0; 2])
    }
}

/// Returns the instrument whose axes have these noises.
pub(super) fn instrument<const N: usize>(noises: [Noise; N]) -> InstrumentConfig<N> {
    let drifts = |noise: Noise| noise.drift[0] > 0.0;
    InstrumentConfig::default()
        .mean(noises.map(|noise| noise.mean))
        .stddev(noises.map(|noise| noise.stddev))
        .bias_mean(noises.map(|noise| noise.bias_mean))
        .bias_stddev(noises.map(|noise| noise.bias_stddev))
        .precision(noises.map(|noise| noise.precision))
        .drift(noises.map(|noise| noise.drift[0]))
        .drift_time_s(noises.map(|noise| if drifts(noise) { noise.drift[1] } else { f64::INFINITY }))
}
