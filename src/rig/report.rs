//! Describes parameters of sensors and streams in words, for `check`.

use super::outlet::Outlet;
use crate::description::model::Noise;
use crate::description::text::number;
use belvedere_bridge::Encoding;
use belvedere_sensors::noise::InstrumentConfig;

/// Receives the name and the value of a parameter.
pub(super) type Say<'a> = &'a mut dyn FnMut(&str, String);

/// Describes the streams of a part of a model, one line each.
pub fn stream_lines<'a>(outlets: impl IntoIterator<Item = &'a Outlet>) -> Vec<String> {
    let lines = outlets.into_iter().map(|outlet| {
        let coded = match outlet.encoding() {
            Encoding::Struct => String::new(),
            encoding => format!(" {}", encoding.as_str()),
        };
        let rate = outlet.rate_hz().map_or("when it changes".to_owned(), |hz| format!("{} Hz", number(hz)));
        let frame = match outlet.frame_id() {
            "" => String::new(),
            frame => format!(", frame {frame}"),
        };
        format!("  publishes    {}: {}{coded}, {rate}{frame}", outlet.topic(), outlet.kind().as_str())
    });
    let lines: Vec<String> = lines.collect();
    if lines.is_empty() { vec!["  publishes    nothing".into()] } else { lines }
}

/// Describes the noise of a value in this unit.
pub(super) fn noise(noise: &Noise, unit: &str) -> String {
    if *noise == Noise::default() {
        return "none".into();
    }
    let mut parts = Vec::new();
    if noise.mean != 0.0 || noise.stddev != 0.0 {
        let (mean, stddev) = (number(noise.mean), number(noise.stddev));
        parts.push(format!("gaussian, mean {mean}, stddev {stddev} {unit}"));
    }
    if noise.bias_mean != 0.0 || noise.bias_stddev != 0.0 {
        let (mean, stddev) = (number(noise.bias_mean), number(noise.bias_stddev));
        parts.push(format!("bias mean {mean}, bias stddev {stddev}"));
    }
    if noise.precision > 0.0 {
        parts.push(format!("rounded to {} {unit}", number(noise.precision)));
    }
    parts.join(", ")
}

/// Describes the errors of an instrument for values in this unit; errors that it does not have are omitted.
pub(super) fn instrument<const N: usize>(errors: &InstrumentConfig<N>, unit: &str) -> String {
    let axes = |values: &[f64; N]| {
        let is_one = values.iter().all(|value| *value == values[0]);
        let shown = if is_one { &values[..1] } else { &values[..] };
        shown.iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ")
    };
    let mut parts = Vec::new();
    let mut add = |values: &[f64; N], name: &str, unit: &str| {
        if values.iter().any(|value| *value != 0.0) {
            parts.push(format!("{name} {} {unit}", axes(values)).trim_end().to_owned());
        }
    };
    add(&errors.mean, "mean", unit);
    add(&errors.stddev, "stddev", unit);
    add(&errors.density, "density", &format!("{unit}/√Hz"));
    add(&errors.bias_mean, "bias mean", unit);
    add(&errors.bias_stddev, "bias stddev", unit);
    add(&errors.drift, "bias walk", &format!("{unit}/s/√Hz"));
    if errors.drift.iter().any(|drift| *drift > 0.0) {
        add(&errors.drift_time_s, "forgotten in", "s");
    }
    add(&errors.precision, "steps of", unit);
    for (row, sensitivities) in errors.sensitivity.iter().enumerate() {
        let plain: [f64; N] = std::array::from_fn(|column| f64::from(u8::from(column == row)));
        if *sensitivities != plain {
            let shown = sensitivities.map(number).join(" ");
            parts.push(format!("axis {row} reads {shown}"));
        }
    }
    if errors.limit.is_finite() {
        parts.push(format!("at most {} {unit}", number(errors.limit)));
    }
    if parts.is_empty() { "exact".into() } else { parts.join(", ") }
}
