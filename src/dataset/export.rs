//! Exports a data set to other formats, from its shards alone.

mod coco;
mod kitti;

use super::labels::{Labels, ObjectJson, SensorLabels};
use super::shard::{read_shard, sweep, write_whole};
use super::{DatasetError, Folder, Making, Plan, SensorPlan};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

pub use coco::{check_coco, export_coco};
pub use kitti::{check_kitti, export_kitti};

/// An image of one sensor, with its labels.
struct Shot<'a> {
    /// Index of the sample.
    index: u64,
    png: &'a [u8],
    known: &'a SensorLabels,
    objects: &'a [ObjectJson],
    /// Labels of all sensors of the sample.
    sensors: &'a BTreeMap<String, SensorLabels>,
    files: &'a BTreeMap<String, Vec<u8>>,
}

/// Calls `each` with the images of a sensor, in the order of the samples.
fn for_each_shot(
    (plan, folder): (&Plan, &Folder),
    sensor: &SensorPlan,
    making: &dyn Making,
    mut each: impl FnMut(Shot<'_>) -> Result<(), DatasetError>,
) -> Result<(), DatasetError> {
    for shard in 0..plan.shards() {
        let path = folder.shard(shard);
        let damaged = |what: String| DatasetError::Damaged { path: path.clone(), what };
        read_shard(&path, |index, files| {
            if making.is_stopped() {
                return Err(DatasetError::Stopped);
            }
            let lacks = |field: &str| damaged(format!("sample {index} has no {field}"));
            let json = files.get("json").ok_or_else(|| lacks("json"))?;
            let labels: Labels = serde_json::from_slice(json)
                .map_err(|error| damaged(format!("the JSON of sample {index}: {error}")))?;
            let known = labels.sensors.get(&sensor.name).ok_or_else(|| lacks(&sensor.name))?;
            let field = format!("{}.png", sensor.name);
            let png = files.get(&field).ok_or_else(|| lacks(&field))?;
            let objects = known.objects.as_deref().ok_or_else(|| lacks("objects"))?;
            each(Shot { index, png, known, objects, sensors: &labels.sensors, files: &files })
        })?;
    }
    Ok(())
}

/// Returns the sensor with this name, if it has what an export needs: an image, labels, and these truth channels.
fn find_sensor<'a>(plan: &'a Plan, name: &str, truth: &[&str]) -> Result<&'a SensorPlan, DatasetError> {
    let refused = |what: String| DatasetError::NoExport { what };
    let found = plan.sensors().iter().find(|sensor| sensor.name == name);
    let names: Vec<&str> = plan.sensors().iter().map(|sensor| &*sensor.name).collect();
    let sensor = found
        .ok_or_else(|| refused(format!("the plan has no sensor '{name}'; it has {}", names.join(", "))))?;
    if !sensor.labels {
        return Err(refused(format!("the sensor '{name}' has no labels; give it labels = true in the plan")));
    }
    if let Some(lacking) = truth.iter().find(|truth| !sensor.truth.iter().any(|there| there == *truth)) {
        let what = format!("the sensor '{name}' has no truth \"{lacking}\"; add it in the plan");
        return Err(refused(what));
    }
    Ok(sensor)
}

/// Returns the data of an npy file, without its header.
fn data_of(npy: &[u8]) -> &[u8] {
    let length = npy.get(8..10).map_or(0, |bytes| usize::from(u16::from_le_bytes([bytes[0], bytes[1]])));
    npy.get(10 + length..).unwrap_or_default()
}

/// Creates a folder if it does not exist, and removes temporary files of killed processes from it.
fn make_folder(path: PathBuf) -> Result<PathBuf, DatasetError> {
    fs::create_dir_all(&path).map_err(|source| DatasetError::Output { path: path.clone(), source })?;
    sweep(&path, "");
    Ok(path)
}

/// Writes a file unless it already has these bytes.
fn write_if_other(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    if fs::read(path).is_ok_and(|there| there == bytes) { Ok(()) } else { write_whole(path, bytes) }
}
