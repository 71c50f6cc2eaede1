//! A sensor with all its parameters after defaults and plugins.

use super::text::{angle, number, pose};
use crate::description::model::{
    AngleFunction, AutoExposed, CameraDevice, CameraPlugin, CameraSensor, Lens, LensIntrinsics, LensModel,
    Model, Noise, Plugin, Radiation, RaySensor, Sensor, SensorKind,
};
use crate::rig::eye::{drawn_lens, mapped_share};
use crate::rig::pictures::encoding;

pub(super) fn report(model: &Model, sensor: &Sensor, gazebo_compat: bool) -> Vec<String> {
    let kind = match sensor.kind {
        SensorKind::Camera(_) => "camera",
        SensorKind::Depth(_) => "depth camera",
        SensorKind::Ray(_) if matches!(sensor.plugin, Some(Plugin::Range(_))) => "rangefinder",
        SensorKind::Ray(_) => "lidar",
    };
    let mut lines = vec![format!("{kind} {} ({})", sensor.name, sensor.source)];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    let link = &model.links[sensor.link].name;
    say("link", format!("{link} {}", pose(&sensor.link_from_sensor)));
    say("rate", rate(sensor));
    match &sensor.kind {
        SensorKind::Camera(camera) | SensorKind::Depth(camera) => {
            camera_report(camera, &sensor_lens(camera, sensor, gazebo_compat), &mut say);
        }
        SensorKind::Ray(ray) => ray_report(ray, &mut say),
    }
    match &sensor.plugin {
        None => say("topics", "none: it has no plugin that is simulated".into()),
        Some(Plugin::Laser(laser)) => {
            say("topic", laser.topic.clone());
            say("frame", laser.frame_name.clone());
        }
        Some(Plugin::Range(range)) => {
            say("topic", range.topic.clone());
            say("frame", range.frame_name.clone());
            let radiation = match range.radiation {
                Radiation::Ultrasound => "ultrasound",
                Radiation::Infrared => "infrared",
            };
            say("cone", format!("{} of {radiation}", angle(range.field_of_view_rad)));
        }
        Some(Plugin::Camera(camera)) => {
            say("topics", format!("{}, {}", camera.image_topic, camera.camera_info_topic));
            camera_plugin_report(camera, &mut say);
        }
        Some(Plugin::DepthCamera(depth)) => {
            say("topics", format!("{}, {}", depth.camera.image_topic, depth.camera.camera_info_topic));
            say("", format!("{}, {}", depth.depth_image_topic, depth.depth_camera_info_topic));
            say("", depth.point_cloud_topic.clone());
            let coding = if depth.depth_16uc1 { "16UC1 in millimetres" } else { "32FC1 in metres" };
            let (from, to) = (number(depth.cutoff_m), number(depth.cutoff_max_m));
            say("depth", format!("{coding}, valid from {from} to {to} m"));
            camera_plugin_report(&depth.camera, &mut say);
        }
    }
    lines
}

fn rate(sensor: &Sensor) -> String {
    let Some(effective) = sensor.effective_rate_hz() else { return "every step of physics".into() };
    match sensor.update_rate_hz {
        Some(own) if own > effective => {
            format!("{} Hz (the sensor's own {} Hz, limited by its plugin)", number(effective), number(own))
        }
        _ => format!("{} Hz", number(effective)),
    }
}

/// The lens that is drawn.
fn sensor_lens(camera: &CameraSensor, sensor: &Sensor, gazebo_compat: bool) -> Lens {
    match &sensor.plugin {
        Some(Plugin::Camera(plugin)) => drawn_lens(camera, plugin, gazebo_compat),
        Some(Plugin::DepthCamera(plugin)) => drawn_lens(camera, &plugin.camera, gazebo_compat),
        Some(Plugin::Laser(_) | Plugin::Range(_)) | None => camera.lens.clone(),
    }
}

/// How much of the picture a lens maps, if that is not all.
fn mapped(camera: &CameraSensor, drawn: &Lens) -> Option<String> {
    match mapped_share(camera, drawn) {
        Ok(1.0) => None,
        // Rounded down: what is not all never reads as all.
        Ok(share) => {
            Some(format!("{:.1} % of the pixels, the others are black", (share * 1000.0).floor() / 10.0))
        }
        Err(error) => Some(format!("nothing: {error}")),
    }
}

fn camera_report(camera: &CameraSensor, drawn: &Lens, say: &mut impl FnMut(&str, String)) {
    let format = encoding(camera.format).as_str();
    let (width, height) = (camera.width, camera.height);
    say("picture", format!("{width} x {height} {format}"));
    let across = angle(camera.horizontal_fov_rad);
    let LensIntrinsics { fx, fy, cx, cy, skew } = camera.lens.intrinsics;
    match camera.lens.model {
        LensModel::Pinhole => {
            let down = angle(2.0 * libm::atan(0.5 * f64::from(height) / fy));
            say("view", format!("{across} across, {down} down"));
        }
        LensModel::BrownConrady { .. } => say("view", format!("{across} across, before distortion")),
        LensModel::WideAngle { scale_to_hfov: false, .. } => {}
        _ if camera.lens.has_own_focal_length => {}
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
    if let Some(lens) = lens(&camera.lens.model) {
        say("lens", lens);
    }
    if let Some(mapped) = mapped(camera, drawn) {
        say("maps", mapped);
    }
    say("clip", format!("{} to {} m", number(camera.near_m), number(camera.far_m)));
    say("noise", noise(&camera.noise, "of [0, 1]"));
    if let Some(device) = &camera.device {
        device_report(device, say);
    }
    if let Some(p) = camera.lens.projection {
        let values = [p.fx, p.fy, p.cx, p.cy, p.tx, p.ty].map(number).join(", ");
        say("projection", format!("fx, fy, cx, cy, tx, ty = {values}"));
    }
}

/// When the light is collected, and how much.
fn device_report(device: &CameraDevice, say: &mut impl FnMut(&str, String)) {
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

/// The model and its parameters; none for a pinhole.
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

fn camera_plugin_report(camera: &CameraPlugin, say: &mut impl FnMut(&str, String)) {
    say("frame", if camera.frame_name.is_empty() { "none".into() } else { camera.frame_name.clone() });
    let mut info = Vec::new();
    if camera.hack_baseline_m != 0.0 {
        info.push(format!("baseline {} m", number(camera.hack_baseline_m)));
    }
    if camera.distortion != [0.0; 5] {
        let values = camera.distortion.map(|value| value.to_string()).join(", ");
        info.push(format!("k1, k2, k3, t1, t2 = {values}"));
    }
    for (name, value) in [
        ("cx", camera.principal_point[0]),
        ("cy", camera.principal_point[1]),
        ("focal length", camera.focal_length),
    ] {
        info.extend(value.map(|value| format!("{name} {}", number(value))));
    }
    if !info.is_empty() {
        say("camera_info", info.join(", "));
    }
}

fn ray_report(ray: &RaySensor, say: &mut impl FnMut(&str, String)) {
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
    say("noise", noise(&ray.noise, "m"));
}

fn noise(noise: &Noise, unit: &str) -> String {
    if *noise == Noise::default() {
        return "none".into();
    }
    let mut parts =
        vec![format!("gaussian, mean {}, stddev {} {unit}", number(noise.mean), number(noise.stddev))];
    if noise.bias_mean != 0.0 || noise.bias_stddev != 0.0 {
        let (mean, stddev) = (number(noise.bias_mean), number(noise.bias_stddev));
        parts.push(format!("bias mean {mean}, bias stddev {stddev}"));
    }
    if noise.precision > 0.0 {
        parts.push(format!("rounded to {}", number(noise.precision)));
    }
    parts.join(", ")
}
