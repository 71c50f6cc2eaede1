//! Exports instances in COCO format: one JSON file of images, categories, and annotations with boxes and masks.

use super::{Shot, data_of, find_sensor, for_each_shot, make_folder, write_if_other};
use crate::dataset::{DatasetError, Folder, Making, Plan, SensorPlan};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

#[derive(Serialize)]
struct Instances {
    info: Info,
    images: Vec<Image>,
    categories: Vec<Category>,
    annotations: Vec<Annotation>,
}

#[derive(Serialize)]
struct Info {
    description: String,
}

#[derive(Serialize)]
struct Image {
    id: u64,
    width: u32,
    height: u32,
    file_name: String,
}

#[derive(Serialize)]
struct Category {
    id: u32,
    name: String,
    supercategory: &'static str,
}

#[derive(Serialize)]
struct Annotation {
    /// Starts at 1, because COCO's evaluation treats 0 as none.
    id: u64,
    image_id: u64,
    category_id: u32,
    /// Left, top, width, height.
    bbox: [u32; 4],
    area: u32,
    iscrowd: u8,
    segmentation: Mask,
}

/// Run lengths along the columns, starting with pixels outside the mask.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Mask {
    /// Height and width.
    size: [u32; 2],
    counts: Vec<u32>,
}

/// Returns the sensor with this name, if the plan has it with labels and the instance channel.
///
/// # Errors
/// [`DatasetError::NoExport`].
pub fn check_coco<'a>(plan: &'a Plan, sensor: &str) -> Result<&'a SensorPlan, DatasetError> {
    find_sensor(plan, sensor, &["instance"])
}

/// Writes the images of a sensor and `instances.json` to a folder, and returns the path of the JSON file. Objects of an
/// image come from its labels, their masks from the instance channel. Categories are in the order of their names.
///
/// # Errors
/// If the plan's sensor has no labels or no instance channel, a shard cannot be read, or a file cannot be written.
pub fn export_coco(
    plan: &Plan,
    folder: &Folder,
    sensor: &str,
    to: &Path,
    making: &dyn Making,
) -> Result<PathBuf, DatasetError> {
    let sensor = check_coco(plan, sensor)?;
    let to = make_folder(to.to_owned())?;
    let pictures = make_folder(to.join("images"))?;
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    let field = format!("{}.instance.npy", sensor.name);
    for_each_shot((plan, folder), sensor, making, |Shot { index, png, known, objects, files, .. }| {
        let file_name = format!("{index:08}.png");
        write_if_other(&pictures.join(&file_name), png)?;
        let [width, height] = [known.width, known.height];
        let instance = files.get(&field).map(|npy| instances(npy)).unwrap_or_default();
        for object in objects {
            let segmentation = mask(&instance, [width, height], &object.instances.iter().copied().collect());
            let annotation = Annotation {
                id: annotations.len() as u64 + 1,
                image_id: index,
                category_id: 0,
                bbox: object.bbox,
                area: object.pixels,
                iscrowd: 0,
                segmentation,
            };
            annotations.push((object.category.clone(), annotation));
        }
        images.push(Image { id: index, width, height, file_name });
        Ok(())
    })?;
    let names: BTreeSet<String> = annotations.iter().map(|(name, _)| name.clone()).collect();
    let numbers: BTreeMap<String, u32> = names.into_iter().zip(1..).collect();
    let categories =
        numbers.iter().map(|(name, id)| Category { id: *id, name: name.clone(), supercategory: "" });
    let instances = Instances {
        info: Info { description: format!("{} of {}", sensor.topic, plan.source.display()) },
        images,
        categories: categories.collect(),
        annotations: annotations
            .into_iter()
            .map(|(name, annotation)| Annotation { category_id: numbers[&name], ..annotation })
            .collect(),
    };
    let path = to.join("instances.json");
    write_if_other(&path, &serde_json::to_vec(&instances).unwrap_or_default())?;
    Ok(path)
}

/// Returns the numbers in an instance channel.
fn instances(npy: &[u8]) -> Vec<u32> {
    data_of(npy).as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect()
}

/// Returns the mask of the pixels that show one of these instances.
fn mask(instance: &[u32], [width, height]: [u32; 2], of: &BTreeSet<u32>) -> Mask {
    let mut counts = vec![0];
    let mut is_inside = false;
    for column in 0..width as usize {
        for row in 0..height as usize {
            let is_of = instance.get(row * width as usize + column).is_some_and(|number| of.contains(number));
            if is_of != is_inside {
                counts.push(0);
                is_inside = is_of;
            }
            if let Some(count) = counts.last_mut() {
                *count += 1;
            }
        }
    }
    Mask { size: [height, width], counts }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_run_down_the_columns() {
        // Two rows of three.
        let instance = [7, 1, 2, 7, 2, 2];
        let of = |numbers: &[u32]| mask(&instance, [3, 2], &numbers.iter().copied().collect()).counts;
        assert_eq!(of(&[2]), [3, 3]);
        assert_eq!(of(&[7]), [0, 2, 4]);
        assert_eq!(of(&[1, 7]), [0, 3, 3]);
        assert_eq!(of(&[5]), [6]);
    }
}
