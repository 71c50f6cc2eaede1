//! Exports objects in the format of KITTI's detection benchmark: images, a line of text for each object, calibrations.

use super::{Shot, data_of, find_sensor, for_each_shot, make_folder, write_if_other};
use crate::dataset::labels::{IntrinsicsJson, ObjectJson, optical_from_world};
use crate::dataset::{DatasetError, Folder, Making, Plan, SensorPlan};
use belvedere_bridge::point::XyzIrtPoint;
use belvedere_bridge::{DistortionModel, Encoding};
use belvedere_sensors::Pose;
use glam::{DVec2, DVec3};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Least depth of a corner in metres. Nearer corners are moved there, because points beside or behind the camera have
/// no projection.
const NEAR_M: f64 = 0.01;

/// Returns the camera with this name, if the plan has it with labels, and the lidar too if one is named. Whether the
/// camera is a pinhole is known only from its samples, so only the export checks that.
///
/// # Errors
/// [`DatasetError::NoExport`].
pub fn check_kitti<'a>(
    plan: &'a Plan,
    (camera, lidar): (&str, Option<&str>),
) -> Result<&'a SensorPlan, DatasetError> {
    let camera = find_sensor(plan, camera, &[])?;
    let has_lidar = |name: &&str| plan.sensors().iter().any(|sensor| sensor.name == **name);
    if let Some(name) = lidar.filter(|name| !has_lidar(name)) {
        let what = format!("the plan has no sensor '{name}'; write CAMERA,LIDAR by the names that it has");
        return Err(DatasetError::NoExport { what });
    }
    Ok(camera)
}

/// Writes `training/image_2`, `label_2` and `calib` of a pinhole camera to a folder, and `velodyne` of a lidar if one
/// is named; returns the path of `training`.
///
/// KITTI's boxes are upright in the camera's frame. If an object's box is not, its yaw is that of its forward axis. The
/// hidden share of an object is not known, so `occluded` is 3.
///
/// # Errors
/// If the plan's camera has no labels or is not a pinhole, the lidar sends no clouds in Velodyne's layout, a shard
/// cannot be read, or a file cannot be written.
pub fn export_kitti(
    plan: &Plan,
    folder: &Folder,
    (sensor, lidar): (&str, Option<&str>),
    to: &Path,
    making: &dyn Making,
) -> Result<PathBuf, DatasetError> {
    let sensor = check_kitti(plan, (sensor, lidar))?;
    let training = make_folder(to.join("training"))?;
    let [pictures, labels, calibrations] =
        ["image_2", "label_2", "calib"].map(|name| make_folder(training.join(name)));
    let (pictures, labels, calibrations) = (pictures?, labels?, calibrations?);
    let clouds = lidar.map(|name| Ok::<_, DatasetError>((name, make_folder(training.join("velodyne"))?)));
    let clouds = clouds.transpose()?;
    for_each_shot((plan, folder), sensor, making, |shot| {
        let Shot { index, png, known, objects, .. } = shot;
        let pinhole = known.intrinsics.as_ref().filter(|lens| is_pinhole(lens));
        let Some(pinhole) = pinhole else {
            let what = format!(
                "the sensor '{}' is not a pinhole camera, which KITTI requires; choose another",
                sensor.name
            );
            return Err(DatasetError::NoExport { what });
        };
        let size = DVec2::new(f64::from(known.width), f64::from(known.height));
        write_if_other(&pictures.join(format!("{index:06}.png")), png)?;
        let lines: String = objects.iter().map(|object| line(object, pinhole, size)).collect();
        write_if_other(&labels.join(format!("{index:06}.txt")), lines.as_bytes())?;
        let mut optical_from_lidar = optical_from_world(&Pose::IDENTITY);
        if let Some((name, clouds)) = &clouds {
            let (world_from_lidar, points) = cloud(&shot, name)?;
            optical_from_lidar = optical_from_world(&known.world_from_sensor.pose()) * world_from_lidar;
            write_if_other(&clouds.join(format!("{index:06}.bin")), &points)?;
        }
        let calibration = calibration(pinhole, &optical_from_lidar);
        write_if_other(&calibrations.join(format!("{index:06}.txt")), calibration.as_bytes())
    })?;
    Ok(training)
}

/// Returns true if the projection of a lens is x/z. Coefficients of 0 mean that only in ROS's two pinhole-based models.
fn is_pinhole(lens: &IntrinsicsJson) -> bool {
    let models =
        [DistortionModel::PlumbBob, DistortionModel::RationalPolynomial].map(DistortionModel::as_str);
    lens.distortion_model.as_deref().is_none_or(|model| models.contains(&model))
        && lens.distortion.iter().all(|k| *k == 0.0)
}

/// Returns an object's line: type, truncated, occluded, alpha, the box in the image, height, width and length,
/// position, yaw.
fn line(object: &ObjectJson, lens: &IntrinsicsJson, size: DVec2) -> String {
    let optical_from_box = object.optical_from_box.pose();
    let [length, width, height] = object.size;
    let forward = optical_from_box.transform_vector(DVec3::X);
    let yaw = libm::atan2(-forward.z, forward.x);
    // The centre of the bottom.
    let place = optical_from_box.transform_point(DVec3::NEG_Z * height / 2.0);
    let alpha = wrapped(yaw - libm::atan2(place.x, place.z));
    let [left, top, columns, rows] = object.bbox;
    let mut text = object.category.split_whitespace().collect::<Vec<_>>().join("_");
    let _ = writeln!(
        text,
        " {:.2} 3 {alpha:.4} {left}.00 {top}.00 {}.00 {}.00 {height:.4} {width:.4} {length:.4} {:.4} {:.4} {:.4} {yaw:.4}",
        truncated(object, &optical_from_box, lens, size),
        left + columns - 1,
        top + rows - 1,
        place.x,
        place.y,
        place.z,
    );
    text
}

/// Returns the share of the object's projected box that is outside the image, 0 to 1.
fn truncated(object: &ObjectJson, optical_from_box: &Pose, lens: &IntrinsicsJson, size: DVec2) -> f64 {
    let half = DVec3::from_array(object.size) / 2.0;
    let mut extent = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    for corner in 0..8 {
        let sign = |axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let point = optical_from_box.transform_point(half * DVec3::new(sign(0), sign(1), sign(2)));
        let depth = point.z.max(NEAR_M);
        let pixel = DVec2::new(lens.fx * point.x / depth + lens.cx, lens.fy * point.y / depth + lens.cy);
        extent = [extent[0].min(pixel), extent[1].max(pixel)];
    }
    let area = |[low, high]: [DVec2; 2]| (high - low).max(DVec2::ZERO).element_product();
    let inside = [extent[0].max(DVec2::splat(-0.5)), extent[1].min(size - 0.5)];
    let whole = area(extent);
    if whole > 0.0 { 1.0 - area(inside) / whole } else { 0.0 }
}

/// Wraps an angle to −π … π.
fn wrapped(angle: f64) -> f64 {
    angle - (angle / core::f64::consts::TAU).round() * core::f64::consts::TAU
}

/// Returns the pose of a lidar, and its points: x, y, z in metres and the reflectance, 0 to 1.
fn cloud(shot: &Shot<'_>, name: &str) -> Result<(Pose, Vec<u8>), DatasetError> {
    let known = shot.sensors.get(name).filter(|known| known.encoding == Encoding::XyzIrtF32.as_str());
    let npy = shot.files.get(&format!("{name}.npy"));
    let Some((known, npy)) = known.zip(npy) else {
        let what = format!(
            "the sensor '{name}' does not send clouds in Velodyne's layout, which KITTI requires; choose another"
        );
        return Err(DatasetError::NoExport { what });
    };
    let point = |point: &[u8; XyzIrtPoint::SIZE]| {
        let XyzIrtPoint { x, y, z, intensity, .. } = XyzIrtPoint::from_bytes(point);
        [x, y, z, (intensity / 255.0).clamp(0.0, 1.0)]
    };
    let (points, _) = data_of(npy).as_chunks::<{ XyzIrtPoint::SIZE }>();
    let points: Vec<[f32; 4]> = points.iter().map(point).collect();
    Ok((known.world_from_sensor.pose(), bytemuck::cast_slice(&points).to_vec()))
}

/// Returns the calibration. All four cameras get the same projection.
fn calibration(lens: &IntrinsicsJson, optical_from_lidar: &Pose) -> String {
    let IntrinsicsJson { fx, fy, cx, cy, .. } = lens;
    let projection = format!("{fx:e} 0 {cx:e} 0 0 {fy:e} {cy:e} 0 0 0 1 0");
    let mut text = [0, 1, 2, 3].map(|number| format!("P{number}: {projection}\n")).concat();
    text.push_str("R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam:");
    let (turn, shift) = (optical_from_lidar.rotation_matrix(), optical_from_lidar.translation());
    for row in 0..3 {
        let [x, y, z] = turn.row(row).to_array();
        let _ = write!(text, " {x:e} {y:e} {z:e} {:e}", shift[row]);
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::labels::PoseJson;
    use glam::DQuat;

    #[test]
    fn a_pinhole_is_recognized_by_its_model_and_not_by_zeros() {
        let lens = |model: Option<&str>, distortion: &[f64]| IntrinsicsJson {
            fx: 100.0,
            fy: 100.0,
            cx: 50.0,
            cy: 50.0,
            distortion_model: model.map(str::to_owned),
            distortion: distortion.to_vec(),
        };
        for pinhole in [
            lens(None, &[]),
            lens(Some("plumb_bob"), &[0.0; 5]),
            lens(Some("rational_polynomial"), &[0.0; 8]),
        ] {
            assert!(is_pinhole(&pinhole), "{pinhole:?}");
        }
        for other in [
            lens(Some("plumb_bob"), &[0.1, 0.0, 0.0, 0.0, 0.0]),
            lens(Some("equidistant"), &[0.0; 4]),
            lens(Some("equirectangular"), &[]),
            lens(Some("double_sphere"), &[0.0, 0.0]),
        ] {
            assert!(!is_pinhole(&other), "{other:?}");
        }
    }

    #[test]
    fn a_car_that_drives_away_ahead_has_kittis_yaw() {
        // 10 m ahead and 1 m below the camera, its x forward along the camera's z, its z up.
        let optical_from_box = glam::DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y);
        let object = ObjectJson {
            model: "car".into(),
            class: 1,
            category: "a car".into(),
            instances: vec![3],
            pixels: 1,
            bbox: [10, 20, 5, 6],
            optical_from_box: PoseJson {
                position: [0.0, 1.0, 10.0],
                orientation: DQuat::from_mat3(&optical_from_box).to_array(),
            },
            size: [4.0, 1.8, 1.5],
        };
        let lens = IntrinsicsJson {
            fx: 100.0,
            fy: 100.0,
            cx: 49.5,
            cy: 49.5,
            distortion_model: None,
            distortion: Vec::new(),
        };
        let text = line(&object, &lens, DVec2::splat(100.0));
        // A car that drives away along z has a yaw of −π/2; its bottom is half its height below its middle.
        assert_eq!(
            text,
            "a_car 0.00 3 -1.5708 10.00 20.00 14.00 25.00 1.5000 1.8000 4.0000 0.0000 1.7500 10.0000 -1.5708\n"
        );
        // An image whose right edge is the optical axis shows half of the car.
        let lens = IntrinsicsJson { cx: 99.5, ..lens };
        let half = truncated(
            &object,
            &Pose::new(DVec3::new(0.0, 1.0, 10.0), DQuat::from_mat3(&optical_from_box)),
            &lens,
            DVec2::splat(100.0),
        );
        assert!((half - 0.5).abs() < 1e-9, "{half}");
    }
}
