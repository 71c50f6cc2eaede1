//! Reports the image, lens and device of a camera.

use super::super::pictures::encoding;
use super::super::report::{Say, noise};
use super::{drawn_lens, mapped_share};
use crate::description::model::{
    AngleFunction, AutoExposed, CameraDevice, CameraPlugin, CameraSensor, Lens, LensIntrinsics, LensModel,
    Noise,
};
use crate::description::text::{angle, number};

/// Describes how much of the image a lens maps, if that is not everything.
fn mapped(camera: &CameraSensor, drawn: &Lens) -> Option<String> {
    match mapped_share(camera, drawn) {
        Ok(1.0) => None,
        // Rounded down, so that less than 100 % is never shown as 100 %.
        Ok(share) => {
            Some(format!("{:.1} % of the pixels, the others are black", (share * 1000.0).floor() / 10.0))
        }
        Err(error) => Some(format!("nothing: {error}")),
    }
}

/// Reports the camera as it is drawn with its plugin, and values in `CameraInfo` that differ.
pub(in crate::rig) fn camera(
    camera: &CameraSensor,
    plugin: Option<&CameraPlugin>,
    gazebo_compat: bool,
    say: Say<'_>,
) {
    let drawn =
        plugin.map_or_else(|| camera.lens.clone(), |plugin| drawn_lens(camera, plugin, gazebo_compat));
    let format = encoding(camera.format).as_str();
    let (width, height) = (camera.width, camera.height);
    say("picture", format!("{width} x {height} {format}"));
    let across = angle(camera.horizontal_fov_rad);
    let LensIntrinsics { fx, fy, cx, cy, skew } = drawn.intrinsics;
    match drawn.model {
        LensModel::Pinhole => {
            let down = angle(2.0 * libm::atan(0.5 * f64::from(height) / fy));
            say("view", format!("{across} across, {down} down"));
        }
        LensModel::BrownConrady { .. } => say("view", format!("{across} across, before distortion")),
        LensModel::WideAngle { scale_to_hfov: false, .. } => {}
        _ if drawn.has_own_focal_length => {}
        _ => say("view", format!("{across} across")),
    }
    if fx == fy {
        say("focal length", format!("{fx:.4} pixels"));
    } else {
        say("focal length", format!("{fx:.4} pixels across, {fy:.4} down"));
    }
    let middle = [width, height].map(|size| 0.5 * (f64::from(size) - 1.0));
    if [cx, cy] != middle {
        say("middle", format!("column {}, row {}", number(cx), number(cy)));
    }
    if skew != 0.0 {
        say("skew", number(skew));
    }
    if let Some(lens) = lens(&drawn.model) {
        say("lens", lens);
    }
    if let Some(mapped) = mapped(camera, &drawn) {
        say("maps", mapped);
    }
    say("clip", format!("{} to {} m", number(camera.near_m), number(camera.far_m)));
    if camera.anti_aliasing > 1 {
        say("edges", edges(camera, gazebo_compat));
    }
    if camera.device.is_none() || camera.noise != Noise::default() {
        say("noise", noise(&camera.noise, "of [0, 1]"));
    }
    if let Some(device) = &camera.device {
        device_report(device, say);
    }
    if let Some(p) = camera.lens.projection {
        let values = [p.fx, p.fy, p.cx, p.cy, p.tx, p.ty].map(number).join(", ");
        say("projection", format!("fx, fy, cx, cy, tx, ty = {values}"));
    }
    if let Some(plugin) = plugin {
        camera_info(plugin, gazebo_compat, say);
    }
}

/// Reports the noise, the shutter and the exposure of the image sensor.
fn device_report(device: &CameraDevice, say: Say<'_>) {
    let config = &device.config;
    let [read, converter, dark, dsnu, prnu, well] = [
        config.read_noise_e,
        config.converter_noise_dn,
        config.dark_current_e_per_s,
        config.dsnu_e,
        config.prnu,
        config.full_well_e,
    ]
    .map(number);
    say(
        "device",
        format!(
            "{} bits, up to {well} e of light with its shot noise, read noise {read} e and {converter} DN, dark current \
             {dark} e/s, DSNU {dsnu} e, PRNU {prnu}",
            config.bits
        ),
    );
    let rolling = match device.readout_time_s {
        0.0 => "global".to_owned(),
        time_s => format!("rolling, {} ms from the first row to the last", number(time_s * 1e3)),
    };
    let blur = match device.motion_blur_samples {
        1 => String::new(),
        samples => format!(", motion blur of {samples} moments"),
    };
    say("shutter", rolling + &blur);
    let start = device.config.exposure;
    let exposure = format!("{} ms, gain {}", number(start.time_s * 1e3), number(start.gain));
    say(
        "exposure",
        match &device.auto_exposure {
            None => exposure,
            Some(AutoExposed { config, .. }) => {
                let [shortest, longest] = config.time_range_s.map(|time_s| number(time_s * 1e3));
                format!(
                    "automatic to {} of full scale, {shortest} to {longest} ms, gain up to {}, at first {exposure}",
                    number(config.target),
                    number(config.most_gain)
                )
            }
        },
    );
}

/// Returns the model and its parameters, or `None` for a pinhole.
fn lens(model: &LensModel) -> Option<String> {
    const COEFFICIENTS: [&str; 14] =
        ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"];
    let parameters: Vec<(&str, f64)> = match model {
        LensModel::Pinhole => return None,
        LensModel::BrownConrady { coefficients } => {
            COEFFICIENTS.into_iter().zip(coefficients.iter().copied()).collect()
        }
        LensModel::KannalaBrandt { k } => ["k1", "k2", "k3", "k4"].into_iter().zip(*k).collect(),
        LensModel::Eucm { alpha, beta } => vec![("alpha", *alpha), ("beta", *beta)],
        LensModel::DoubleSphere { xi, alpha } => vec![("xi", *xi), ("alpha", *alpha)],
        LensModel::Mei { xi, k1, k2, p1, p2 } => {
            vec![("xi", *xi), ("k1", *k1), ("k2", *k2), ("p1", *p1), ("p2", *p2)]
        }
        LensModel::Equirectangular => Vec::new(),
        LensModel::WideAngle { map, cutoff_angle_rad, .. } => {
            let factor = number(map.c1 * map.focal_px);
            let function = match map.function {
                AngleFunction::Sine => "sin",
                AngleFunction::Tangent => "tan",
                AngleFunction::Identity => "",
            };
            let (c2, c3) = (number(map.c2), number(map.c3));
            let cutoff = angle(*cutoff_angle_rad);
            return Some(format!(
                "wide angle, radius {factor} {function}(angle / {c2} + {c3}) pixels, up to {cutoff}"
            ));
        }
    };
    if parameters.is_empty() {
        return Some(model.name().into());
    }
    let (names, values): (Vec<_>, Vec<_>) =
        parameters.into_iter().map(|(name, value)| (name, value.to_string())).unzip();
    Some(format!("{}, {} = {}", model.name(), names.join(", "), values.join(", ")))
}

/// Reports the values in `CameraInfo` that come from the plugin and are not part of the drawn lens.
fn camera_info(plugin: &CameraPlugin, gazebo_compat: bool, say: Say<'_>) {
    let mut info = Vec::new();
    if plugin.hack_baseline_m != 0.0 {
        info.push(format!("baseline {} m", number(plugin.hack_baseline_m)));
    }
    // Otherwise the image has this distortion, which was reported with the lens.
    if gazebo_compat && !plugin.auto_distortion {
        let values = plugin.distortion.map(|value| value.to_string()).join(", ");
        info.push(format!("k1, k2, k3, t1, t2 = {values}"));
    }
    for (name, value) in [
        ("cx", plugin.principal_point[0]),
        ("cy", plugin.principal_point[1]),
        ("focal length", plugin.focal_length),
    ] {
        info.extend(value.filter(|_| gazebo_compat).map(|value| format!("{name} {}", number(value))));
    }
    if !info.is_empty() {
        say("camera_info", info.join(", "));
    }
}

/// Describes the effect of `<anti_aliasing>`.
fn edges(camera: &CameraSensor, gazebo_compat: bool) -> String {
    let has_moments = camera.device.is_some_and(|device| !device.is_of_one_moment());
    match (gazebo_compat, has_moments) {
        (true, _) => "sharp, as in Gazebo classic, whatever <anti_aliasing> says".into(),
        (_, true) => "sharp, as those of a rolling shutter or motion blur".into(),
        _ => format!("smoothed, as <anti_aliasing> of {} asks", camera.anti_aliasing),
    }
}
