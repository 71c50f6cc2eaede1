//! Depth cameras in front of planes.

use super::common::planes::{Frame, narrow, nguyen_m, plane, rms, take};
use super::page::{Bound, Page, Row, digits};
use super::plot::{Plot, curve};
use belvedere_sensors::depth::DepthCameraConfig;
use belvedere_sensors::device::depth_model::presets::DepthPreset;
use belvedere_sensors::device::depth_model::{DepthModel, DepthNoise, DisparitySteps};
use core::f64::consts::FRAC_PI_2;

/// The rotation of the planes, because planes are seldom seen exactly from the front.
const TURNED_RAD: f64 = 0.1;

/// The published standard deviation of depths in metres, by depth and angle of incidence.
type Published = fn(f64, f64) -> f64;

/// The published noise of a preset by its name, and whether it depends on the angle.
fn published(name: &str) -> (Published, bool) {
    /// z²·s/(f·B), where f is half the picture's width divided by the tangent of half the view.
    fn stereo(z: f64, width: f64, degrees: f64, baseline: f64) -> f64 {
        z * z * 0.08 / (0.5 * width / libm::tan(0.5 * degrees.to_radians()) * baseline)
    }
    match name {
        "kinect_v1" | "xtion" => (nguyen_m, true),
        "d415" => (|z, _| stereo(z, 1280.0, 65.0, 0.055), false),
        "d435" => (|z, _| stereo(z, 848.0, 90.0, 0.05), false),
        "d455" => (|z, _| stereo(z, 848.0, 87.0, 0.095), false),
        "kinect_v2" => (
            |z, angle| {
                let slant = angle * angle / ((FRAC_PI_2 - angle) * (FRAC_PI_2 - angle));
                1e-3 * (1.5 - 0.5 * z + 0.3 * z * z + 0.1 * z * z.sqrt() * slant)
            },
            true,
        ),
        // Disparities of 35.13 px at 1 m with a σ of 1/36 px, and that of steps of an eighth.
        "redwood" => (|z, _| z * z * (1.0 / (36.0 * 36.0) + 1.0 / (64.0 * 12.0_f64)).sqrt() / 35.13, false),
        "azure_kinect" => (|z, _| 0.017 * (z / 3.5) * (z / 3.5), false),
        _ => panic!("{name} has no report"),
    }
}

/// The number of positions of depths within a step, for depths that are rounded to steps.
const PLACES: u32 = 8;

/// The largest distance at which a stereo camera certainly matches a surface without texture; the deepest plane of its
/// page.
const FOUND_M: f64 = 5.3;

/// The standard deviation of measured depths in a few pixels about the axis. For a device that locks its disparities
/// the mean error is subtracted, which is the effect of locking at that depth.
fn stddev(preset: &DepthPreset, depth: f64, angle: f64) -> f64 {
    let step_m = preset.model(preset.focal_px()).steps.map_or(0.0, |steps| steps.step_m(depth));
    let config = DepthCameraConfig::of_preset(preset).unwrap().camera(narrow([64, 40]).camera);
    let frames = (0..PLACES).map(|place| {
        let depth = depth + step_m * (f64::from(place) / f64::from(PLACES) - 0.5);
        take(&plane(depth, angle), config, place.into())
    });
    let errors = |frame: Frame| {
        frame.depth.into_iter().zip(frame.true_depth).map(|(found, truth)| f64::from(found - truth))
    };
    let errors: Vec<f64> = frames.flat_map(errors).filter(|error| error.is_finite()).collect();
    let mean = match preset.model(preset.focal_px()).noise {
        DepthNoise::Disparity(noise) if noise.locking_px > 0.0 => {
            errors.iter().sum::<f64>() / errors.len() as f64
        }
        _ => 0.0,
    };
    rms(errors.into_iter().map(|error| error - mean))
}

/// The fraction of the pixels of a plane without texture that have a depth.
fn fill_factor(preset: &DepthPreset, depth: f64) -> f64 {
    let config = DepthCameraConfig::of_preset(preset).unwrap().camera(narrow([160, 100]).camera);
    let frame = take(&plane(depth, 0.0), config, 0);
    frame.depth.iter().filter(|depth| depth.is_finite()).count() as f64 / frame.depth.len() as f64
}

/// The step of depths at a depth, measured on a ramp without noise.
fn step(steps: DisparitySteps, depth: f64) -> f64 {
    let model = DepthModel::new().steps(steps);
    let ramp = plane(depth, f64::to_radians(45.0));
    let camera = super::common::camera_of([640, 480], 0.5 / depth);
    let frame = take(&ramp, super::common::depth_camera().camera(camera).model(model), 0);
    let mut values: Vec<f64> = frame.depth.iter().map(|depth| f64::from(*depth)).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let nearest = values.partition_point(|value| *value < depth);
    values[nearest] - values[nearest - 1]
}

/// The page of a preset.
pub(crate) fn page(preset: &DepthPreset) -> Page {
    let (published, is_slanted) = published(preset.name);
    let [least, mut most] = preset.range_m;
    let matching = preset.model(preset.focal_px()).matching;
    if matching.is_some() {
        most = most.min(FOUND_M);
    }
    let mut rows = Vec::new();
    let mut points = Vec::new();
    for share in [0.1, 0.2, 0.35, 0.5, 0.65, 0.8] {
        let depth = least + share * (most - least);
        let (expected, found) = (published(depth, TURNED_RAD), stddev(preset, depth, TURNED_RAD));
        let what = format!("σ of depths at {} m", digits(depth));
        rows.push(Row::new(what, "mm", expected * 1e3, found * 1e3, Bound::Share(0.02)));
        points.push((depth, found * 1e3));
    }
    let mut plots = vec![Plot {
        title: format!("{}: σ of depths", preset.name),
        axes: ["depth in m", "σ in mm"],
        curve: curve([least, most], |depth| published(depth, TURNED_RAD) * 1e3),
        points,
        is_logarithmic: false,
    }];
    if is_slanted {
        let depth = 1.5;
        let mut points = Vec::new();
        for degrees in [10.0, 30.0, 50.0, 65.0, 75.0, 80.0_f64] {
            let angle = degrees.to_radians();
            let (expected, found) = (published(depth, angle), stddev(preset, depth, angle));
            let what = format!("σ at {depth} m and an incidence of {degrees}°");
            rows.push(Row::new(what, "mm", expected * 1e3, found * 1e3, Bound::Share(0.02)));
            points.push((degrees, found * 1e3));
        }
        plots.push(Plot {
            title: format!("{}: σ of depths at {depth} m", preset.name),
            axes: ["incidence in degrees", "σ in mm"],
            curve: curve([0.0, 82.0], |degrees| published(depth, degrees.to_radians()) * 1e3),
            points,
            is_logarithmic: false,
        });
    }
    if matching.is_some() {
        let what = "pixels with a depth, of a plane without texture at 2 m: at least 99 %";
        rows.push(Row::new(what, "%", 100.0, 100.0 * fill_factor(preset, 2.0), Bound::By(1.0)));
    }
    if let Some(steps) = preset.model(preset.focal_px()).steps {
        // Khoshelham and Oude Elberink 2012; the steps of Redwood are eighths of 35.13 px at 1 m.
        let at_1m = if preset.name == "redwood" { 1.0 / (8.0 * 35.13) } else { 2.85e-3 };
        for depth in [1.0, 2.0, 3.0] {
            let (expected, found) = (at_1m * depth * depth, step(steps, depth));
            let what = format!("step of depths at {depth} m");
            rows.push(Row::new(what, "mm", expected * 1e3, found * 1e3, Bound::Share(0.02)));
        }
    }
    Page { name: preset.name, source: preset.source.into(), notes: String::new(), rows, plots }
}
