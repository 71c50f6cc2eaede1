//! What is known of a sample, as JSON: where the robot and its sensors were, their intrinsics, the things that are seen.

use super::plan::Plan;
use crate::simulation::Simulation;
use belvedere_bridge::payload::BoundingBox;
use belvedere_bridge::{DistortionModel, FrameHeader, FrameView, Kind};
use belvedere_sensors::Pose;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A sample's JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Labels {
    /// As the plan has it.
    pub(super) world: String,
    pub(super) seed: u64,
    /// Its number among the poses of the world and seed.
    pub(super) pose: u64,
    pub(super) world_from_robot: PoseJson,
    pub(super) sensors: BTreeMap<String, SensorLabels>,
}

/// A rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct PoseJson {
    /// Metres.
    pub(super) position: [f64; 3],
    /// x y z w.
    pub(super) orientation: [f64; 4],
}

impl From<&Pose> for PoseJson {
    fn from(pose: &Pose) -> Self {
        Self { position: pose.translation().to_array(), orientation: pose.rotation().to_array() }
    }
}

/// What is known of one sensor's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SensorLabels {
    pub(super) topic: String,
    pub(super) encoding: String,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Of the frame of its description: x forward, z up.
    pub(super) world_from_sensor: PoseJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) intrinsics: Option<IntrinsicsJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) angles: Option<AnglesJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) objects: Option<Vec<ObjectJson>>,
}

/// A camera's; pixels, centres of pixels at integers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct IntrinsicsJson {
    pub(super) fx: f64,
    pub(super) fy: f64,
    pub(super) cx: f64,
    pub(super) cy: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) distortion_model: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) distortion: Vec<f64>,
}

/// A scan's, in radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct AnglesJson {
    pub(super) angle_min: f64,
    pub(super) angle_increment: f64,
    pub(super) vertical_angle_min: f64,
    pub(super) vertical_angle_increment: f64,
}

/// A thing that is seen: a visual of a link of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ObjectJson {
    /// Its number in the channel of instances.
    pub(super) instance: u32,
    /// Its number in the channel of classes.
    pub(super) class: u32,
    /// The name of its class: the plan's; without one the model's if it has no label, else the number.
    pub(super) category: String,
    pub(super) model: String,
    pub(super) link: String,
    /// How many pixels show it.
    pub(super) pixels: u32,
    /// First column and row of these, then how many columns and rows.
    pub(super) bbox: [u32; 4],
    /// The box that holds the whole of it, along its own axes: its middle in the optical frame (x right, y down, z forward).
    pub(super) optical_from_box: PoseJson,
    /// Edges of that box in metres.
    pub(super) size: [f64; 3],
}

/// What a frame's header and the boxes of what is seen tell.
pub(super) fn of_sensor(
    topic: &str,
    header: &FrameHeader,
    boxes: Option<&FrameView<'_>>,
    names: &Names,
) -> SensorLabels {
    let is_scan = header.kind() == Some(Kind::LaserScan);
    let intrinsics = header.intrinsics().filter(|intrinsics| intrinsics.fx > 0.0);
    let angles = header.scan_geometry().filter(|_| is_scan);
    SensorLabels {
        topic: topic.to_owned(),
        encoding: header.encoding().map(|encoding| encoding.as_str().to_owned()).unwrap_or_default(),
        width: header.width,
        height: header.height,
        world_from_sensor: PoseJson {
            position: header.position,
            orientation: header.orientation.map(f64::from),
        },
        intrinsics: intrinsics.map(|intrinsics| IntrinsicsJson {
            fx: intrinsics.fx,
            fy: intrinsics.fy,
            cx: intrinsics.cx,
            cy: intrinsics.cy,
            distortion_model: intrinsics.model().map(DistortionModel::as_str).map(str::to_owned),
            distortion: intrinsics.parameters().to_vec(),
        }),
        angles: angles.map(|scan| AnglesJson {
            angle_min: scan.angle_min,
            angle_increment: scan.angle_increment,
            vertical_angle_min: scan.vertical_angle_min,
            vertical_angle_increment: scan.vertical_angle_increment,
        }),
        objects: boxes.map(|boxes| {
            let boxes = boxes.structs::<BoundingBox>().into_iter().flatten();
            boxes.map(|seen| names.object(&seen)).collect()
        }),
    }
}

/// What the numbers of a world's instances mean.
pub(super) struct Names {
    /// By instance: model, link, and the label that its file gives it.
    instances: BTreeMap<u32, (String, String, Option<u32>)>,
    classes: BTreeMap<u32, String>,
}

impl Names {
    pub(super) fn of(simulation: &mut Simulation, plan: &Plan) -> Self {
        let parts: Vec<_> =
            simulation.scene().parts().map(|(model, link, instance, _)| (model, link, instance.0)).collect();
        let mut instances = BTreeMap::new();
        for (id, entity) in simulation.entities().iter() {
            for (index, link) in entity.model.links.iter().enumerate() {
                let of_link = parts.iter().filter(|part| (part.0, part.1) == (id.index(), index));
                // A link's visuals come first.
                for (visual, (_, _, instance)) in link.visuals.iter().zip(of_link) {
                    instances.insert(*instance, (entity.name.clone(), link.name.clone(), visual.label));
                }
            }
        }
        Self { instances, classes: plan.classes.clone() }
    }

    fn object(&self, seen: &BoundingBox) -> ObjectJson {
        let (model, link, label) = self.instances.get(&seen.instance).cloned().unwrap_or_default();
        let category = match (self.classes.get(&seen.label), label) {
            (Some(name), _) => name.clone(),
            (None, None) => model.clone(),
            (None, Some(label)) => label.to_string(),
        };
        let [left, top] = seen.min;
        ObjectJson {
            instance: seen.instance,
            class: seen.label,
            category,
            model,
            link,
            pixels: seen.pixels,
            bbox: [left, top, seen.max[0] - left + 1, seen.max[1] - top + 1],
            optical_from_box: PoseJson { position: seen.position, orientation: seen.orientation },
            size: seen.size,
        }
    }
}
