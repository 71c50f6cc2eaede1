//! `<noise>`.

use super::reader::Reader;
use crate::description::model::Noise;
use crate::description::values::child_text;
use crate::description::xml::Element;

/// What of it is simulated.
const READ: [&str; 6] = ["type", "mean", "stddev", "bias_mean", "bias_stddev", "precision"];

impl Reader<'_> {
    /// The noise in a `<camera>` or a `<ray>`; none at all if it is not there.
    pub(super) fn noise(&mut self, parent: Option<&Element>) -> Option<Noise> {
        let Some(element) = parent.and_then(|parent| parent.child("noise")) else {
            return Some(Noise::default());
        };
        // SDF 1.7 writes the type as an attribute.
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
        let remedy = format!("take it out: a noise has {}", READ.join(", "));
        self.left_out(element, |name| READ.contains(&name) || is_nothing(name), &remedy);
        let element = Some(element);
        let mean = self.number(element, "mean", 0.0);
        let stddev = self.not_negative(element, "stddev");
        let bias_mean = self.number(element, "bias_mean", 0.0);
        let bias_stddev = self.not_negative(element, "bias_stddev");
        let precision = self.not_negative(element, "precision");
        Some(Noise {
            mean: mean?,
            stddev: stddev?,
            bias_mean: bias_mean?,
            bias_stddev: bias_stddev?,
            // Plain gaussian noise is not rounded, whatever <precision> says.
            precision: if is_quantized { precision? } else { precision.map(|_| 0.0)? },
        })
    }
}
