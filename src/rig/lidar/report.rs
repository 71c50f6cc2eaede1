//! Reports a lidar's beams, returns and packets.

use super::super::packets::Packets;
use super::super::report::{Say, noise};
use crate::description::model::{self, BeamPhysics, Noise, RaySensor};
use crate::description::text::{angle, count, number};
use belvedere_sensors::scanner::presets::{Maker, Preset};
use belvedere_sensors::scanner::{Beam, Halo, Intensity, Returns, Spread, Weather};

/// Reports beams, ranges and noise.
pub(in crate::rig) fn ray(ray: &RaySensor, say: Say<'_>) {
    beams(ray, say);
    say("noise", noise(&ray.noise, "m"));
}

/// Reports all parameters of a lidar.
pub(super) fn lidar(lidar: &model::Lidar, gazebo_compat: bool, say: Say<'_>) {
    if let Some(preset) = &lidar.preset {
        say("preset", preset.name.into());
    }
    beams(&lidar.ray, say);
    say("noise", noise_of_ranges(&lidar.ray.noise, lidar.preset.map_or(&[], |preset| preset.spreads)));
    if lidar.is_scanner() {
        physics(&lidar.physics, say);
    }
    if let Some(layout) = lidar.plugin.as_ref().and_then(|plugin| plugin.cloud) {
        let shape =
            if layout.is_organized { "organized, one row per column of beams" } else { "only returns" };
        let times = if gazebo_compat { "all beams at the same time" } else { "each beam at its own time" };
        say("cloud", format!("{shape}, {times}"));
    }
    if let Some(preset) = lidar.preset.filter(|_| Packets::of(lidar).is_some()) {
        packets(lidar, &preset, say);
    }
}

fn beams(ray: &RaySensor, say: Say<'_>) {
    for (name, axis) in [("beams", ray.horizontal), ("lines", ray.vertical)] {
        if name == "beams" || axis.samples > 1 {
            let (from, to) = (angle(axis.min_angle_rad), angle(axis.max_angle_rad));
            say(name, format!("{} from {from} to {to}", axis.samples));
        }
    }
    say("sees", if ray.sees_visuals { "visuals" } else { "collision shapes" }.into());
    say("range", format!("{} to {} m", number(ray.range_min_m), number(ray.range_max_m)));
    if ray.range_resolution_m > 0.0 {
        say("resolution", format!("{} m, not applied, as in Gazebo", number(ray.range_resolution_m)));
    }
}

/// Describes the noise of a range r: the noise of a preset, which depends on the distance, and noise that is the same at
/// all distances.
fn noise_of_ranges(same: &Noise, spreads: &[Spread]) -> String {
    let part = |spread: &Spread| {
        let terms = spread.stddev.into_iter().zip(["", "·r", "·r²"]).filter(|(factor, _)| *factor != 0.0);
        let terms: Vec<String> = terms.map(|(factor, of)| format!("{}{of}", number(factor))).collect();
        let from = match spread.from_m {
            0.0 => String::new(),
            from_m => format!(" from {} m on", number(from_m)),
        };
        format!("stddev {} m{from}", terms.join(" + "))
    };
    let mut parts: Vec<String> = spreads.iter().map(part).collect();
    if parts.iter().any(|part| part.contains("·r")) {
        parts.push("r the range in m".into());
    }
    if parts.is_empty() || *same != Noise::default() {
        parts.push(noise(same, "m"));
    }
    parts.join(", ")
}

/// Reports all parameters that differ from single rays in clear air with the strongest return.
fn physics(physics: &BeamPhysics, say: Say<'_>) {
    let BeamPhysics { beam, halo, crosstalk, pulse_m, returns, intensity, receiver, weather } = physics;
    if *beam != Beam::RAY {
        let [across, up] = beam.divergence_rad.map(number);
        let [width, height] = beam.aperture_m.map(number);
        say(
            "beam",
            format!(
                "{width} x {height} m, widens by {across} x {up} rad, {}",
                count(beam.rays.into(), "ray")
            ),
        );
    }
    say("returns", returns_name(*returns));
    say(
        "intensity",
        match intensity {
            Intensity::Retro => "retro, as <laser_retro> is written".into(),
            Intensity::Power => "power".into(),
            Intensity::Reflectivity => "reflectivity, 0 to 255".into(),
            other => format!("{other:?}"),
        },
    );
    if returns.count() > 1 || *returns != Returns::Strongest {
        say("pulse", format!("{} m", number(*pulse_m)));
    }
    if let Some(receiver) = receiver {
        let [reach, resolution, background] =
            [receiver.reach_m, receiver.resolution_m, receiver.background].map(number);
        say("receiver", format!("reach {reach} m, resolution {resolution} m, background {background}"));
    }
    if *halo != Halo::NONE {
        say("halo", format!("{} of the light within {} rad", number(halo.share), number(halo.radius_rad)));
    }
    if crosstalk.chance > 0.0 {
        say("crosstalk", format!("{} of the firings", number(crosstalk.chance)));
    }
    if *weather != Weather::CLEAR {
        let mut parts = Vec::new();
        if weather.visibility_m.is_finite() {
            parts.push(format!("fog, visibility {} m", number(weather.visibility_m)));
        }
        for (what, rate) in [("rain", weather.rain_mm_per_h), ("snow", weather.snow_mm_per_h)] {
            if rate > 0.0 {
                parts.push(format!("{what} of {} mm/h", number(rate)));
            }
        }
        say("weather", parts.join(", "));
    }
}

fn returns_name(returns: Returns) -> String {
    match returns {
        Returns::Strongest => "strongest".into(),
        Returns::First => "first".into(),
        Returns::Last => "last".into(),
        Returns::Dual => "dual: the last and the strongest".into(),
        Returns::Mean => "mean".into(),
        Returns::Several(count) => format!("{count}, the nearest first"),
        Returns::Ranked(count) => format!("{count}, the strongest first"),
        other => format!("{other:?}"),
    }
}

/// Reports the layout of the packets that `--udp` and `--pcap` send.
fn packets(lidar: &model::Lidar, preset: &Preset, say: Say<'_>) {
    let profile = match preset.maker {
        Maker::Ouster => {
            format!(", {}, those of its inertial unit {}", lidar.profile.name(), lidar.imu_profile.name())
        }
        _ => String::new(),
    };
    say("packets", format!("{:?}'s{profile}, by --udp or --pcap", preset.maker));
}
