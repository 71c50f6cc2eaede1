//! The labels of a sample as JSON: poses of the robot and its sensors, intrinsics, and visible objects.

use super::looks::LooksJson;
use super::plan::Plan;
use crate::simulation::Simulation;
use crate::world::physics::ModelIndex;
use crate::world::scene::WorldScene;
use belvedere_bridge::payload::BoundingBox;
use belvedere_bridge::{DistortionModel, FrameHeader, FrameView, Kind};
use belvedere_sensors::Pose;
use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A sample's JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Labels {
    /// The world's name in the plan.
    pub(super) world: String,
    pub(super) seed: u64,
    /// Its number among the poses of the world and seed.
    pub(super) pose: u64,
    pub(super) world_from_robot: PoseJson,
    /// Present if looks are drawn at random.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) looks: Option<LooksJson>,
    pub(super) sensors: BTreeMap<String, SensorLabels>,
}

/// A rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct PoseJson {
    /// Position in metres.
    pub(super) position: [f64; 3],
    /// Quaternion x y z w.
    pub(super) orientation: [f64; 4],
}

impl PoseJson {
    fn of_sensor(header: &FrameHeader) -> Self {
        Self { position: header.position, orientation: header.orientation.map(f64::from) }
    }

    pub(super) fn pose(&self) -> Pose {
        Pose::new(DVec3::from_array(self.position), DQuat::from_array(self.orientation).normalize())
    }
}

impl From<&Pose> for PoseJson {
    fn from(pose: &Pose) -> Self {
        Self { position: pose.translation().to_array(), orientation: pose.rotation().to_array() }
    }
}

/// The labels of one sensor's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SensorLabels {
    pub(super) topic: String,
    pub(super) encoding: String,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Pose of the sensor's frame in its description: x forward, z up.
    pub(super) world_from_sensor: PoseJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) intrinsics: Option<IntrinsicsJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) angles: Option<AnglesJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) objects: Option<Vec<ObjectJson>>,
}

/// A camera's intrinsics in pixels; pixel centres are at integers.
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

/// A scan's angles, in radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct AnglesJson {
    pub(super) angle_min: f64,
    pub(super) angle_increment: f64,
    pub(super) vertical_angle_min: f64,
    pub(super) vertical_angle_increment: f64,
}

/// A visible object: all visuals of a model that have the same class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ObjectJson {
    pub(super) model: String,
    /// Its number in the class channel.
    pub(super) class: u32,
    /// The name of its class in the plan; without one, the model's name if the visual has no label, else the label.
    pub(super) category: String,
    /// Its visible visuals, by their numbers in the instance channel.
    pub(super) instances: Vec<u32>,
    /// Number of pixels that show it.
    pub(super) pixels: u32,
    /// First column and row of these pixels, then the numbers of columns and rows.
    pub(super) bbox: [u32; 4],
    /// The box around the whole object, visible or not, along its model's axes: the pose of its centre in the optical
    /// frame (x right, y down, z forward).
    pub(super) optical_from_box: PoseJson,
    /// Edges of that box in metres.
    pub(super) size: [f64; 3],
}

/// Returns the labels of a sensor from its frame's header and the visible objects.
pub(super) fn of_sensor(topic: &str, header: &FrameHeader, objects: Option<Vec<ObjectJson>>) -> SensorLabels {
    let is_scan = header.kind() == Some(Kind::LaserScan);
    let intrinsics = header.intrinsics().filter(|intrinsics| intrinsics.fx > 0.0);
    let angles = header.scan_geometry().filter(|_| is_scan);
    SensorLabels {
        topic: topic.to_owned(),
        encoding: header.encoding().map(|encoding| encoding.as_str().to_owned()).unwrap_or_default(),
        width: header.width,
        height: header.height,
        world_from_sensor: PoseJson::of_sensor(header),
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
        objects,
    }
}

/// The meaning of a world's instance numbers.
pub(super) struct Names {
    /// The visuals by instance.
    instances: BTreeMap<u32, Visual>,
    /// The instances of a model that have the same class.
    things: BTreeMap<(ModelIndex, u32), Vec<u32>>,
    classes: BTreeMap<u32, String>,
}

/// The visual of an instance.
struct Visual {
    model: ModelIndex,
    name: String,
    /// The label in its file.
    label: Option<u32>,
}

/// The visible part of an object.
#[derive(Default)]
struct Seen {
    instances: Vec<u32>,
    pixels: u32,
    min: [u32; 2],
    max: [u32; 2],
}

impl Names {
    pub(super) fn of(simulation: &mut Simulation, plan: &Plan) -> Self {
        let mut parts: BTreeMap<(ModelIndex, usize), Vec<u32>> = BTreeMap::new();
        for (model, link, instance, _) in simulation.scene().parts() {
            parts.entry((model, link)).or_default().push(instance.0);
        }
        let mut instances = BTreeMap::new();
        let mut things: BTreeMap<(ModelIndex, u32), Vec<u32>> = BTreeMap::new();
        for (id, entity) in simulation.entities().iter() {
            for (index, link) in entity.model.links.iter().enumerate() {
                let model = id.index();
                let of_link = parts.get(&(model, index)).into_iter().flatten();
                // A link's visuals come first.
                for (visual, instance) in link.visuals.iter().zip(of_link) {
                    let name = entity.name.clone();
                    instances.insert(*instance, Visual { model, name, label: visual.label });
                }
            }
        }
        let scene = simulation.scene().scene();
        for (instance, visual) in &instances {
            let class = scene.instances()[*instance as usize].class();
            things.entry((visual.model, class)).or_default().push(*instance);
        }
        Self { instances, things, classes: plan.classes.clone() }
    }

    /// Returns the objects in a frame, from the boxes of its visuals.
    pub(super) fn objects(
        &self,
        simulation: &mut Simulation,
        header: &FrameHeader,
        boxes: &FrameView<'_>,
    ) -> Vec<ObjectJson> {
        let mut things: BTreeMap<(ModelIndex, u32), Seen> = BTreeMap::new();
        for seen in boxes.structs::<BoundingBox>().into_iter().flatten() {
            let Some(visual) = self.instances.get(&seen.instance) else { continue };
            let thing = things.entry((visual.model, seen.label)).or_insert_with(|| Seen {
                min: seen.min,
                max: seen.max,
                ..Seen::default()
            });
            thing.instances.push(seen.instance);
            thing.pixels += seen.pixels;
            for axis in 0..2 {
                thing.min[axis] = thing.min[axis].min(seen.min[axis]);
                thing.max[axis] = thing.max[axis].max(seen.max[axis]);
            }
        }
        let optical_from_world = optical_from_world(&PoseJson::of_sensor(header).pose());
        let object = |((model, class), seen): ((ModelIndex, u32), Seen)| {
            let world_from_model = simulation.physics().world_from_model(model);
            let [low, high] = self.extent(simulation.scene(), (model, class), &world_from_model);
            let middle = Pose::from_translation((low + high) * 0.5);
            let visual = seen.instances.first().and_then(|instance| self.instances.get(instance));
            let name = visual.map(|visual| visual.name.clone()).unwrap_or_default();
            let label = visual.and_then(|visual| visual.label);
            let category = match (self.classes.get(&class), label) {
                (Some(category), _) => category.clone(),
                (None, None) => name.clone(),
                (None, Some(label)) => label.to_string(),
            };
            let [left, top] = seen.min;
            ObjectJson {
                model: name,
                class,
                category,
                instances: seen.instances,
                pixels: seen.pixels,
                bbox: [left, top, seen.max[0] - left + 1, seen.max[1] - top + 1],
                optical_from_box: (&(optical_from_world * world_from_model * middle)).into(),
                size: (high - low).to_array(),
            }
        };
        things.into_iter().map(object).collect()
    }

    /// Returns the corners of the box along a model's axes around all its visuals of a class.
    fn extent(&self, scene: &WorldScene, key: (ModelIndex, u32), world_from_model: &Pose) -> [DVec3; 2] {
        let model_from_world = world_from_model.inverse();
        let mut extent = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for instance in self.things.get(&key).into_iter().flatten() {
            let Some(bounds) = scene.scene().bounds(*instance as usize) else { continue };
            let model_from_instance = model_from_world * scene.poses()[*instance as usize];
            for corner in 0..8 {
                let of_axis = |axis: usize| bounds[corner >> axis & 1][axis];
                let corner =
                    model_from_instance.transform_point(DVec3::new(of_axis(0), of_axis(1), of_axis(2)));
                extent = [extent[0].min(corner), extent[1].max(corner)];
            }
        }
        if extent[0].is_finite() { extent } else { [DVec3::ZERO; 2] }
    }
}

/// Returns the transform to the optical frame (x right, y down, z forward) of a sensor that looks along its x with z
/// up.
pub(super) fn optical_from_world(world_from_sensor: &Pose) -> Pose {
    let axes = DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y);
    Pose::new(DVec3::ZERO, DQuat::from_mat3(&axes)) * world_from_sensor.inverse()
}
