//! The tables of a plan's file, and their checks.

use super::SensorPlan;
use super::placement::{Random, Route};
use super::randomize::RandomizeTable;
use super::text::Text;
use crate::description::Diagnostics;
use crate::description::diagnostics::Source;
use crate::description::text;
use crate::world::physics::FARTHEST_M;
use belvedere_sensors::Pose;
use glam::DVec3;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanFile {
    pub(super) worlds: Spanned<Vec<Spanned<String>>>,
    pub(super) robot: Spanned<String>,
    #[serde(default)]
    pub(super) seeds: Option<Spanned<Vec<u64>>>,
    #[serde(default)]
    pub(super) samples_per_shard: Option<Spanned<u64>>,
    pub(super) sensors: Vec<Spanned<SensorTable>>,
    pub(super) poses: Spanned<PosesTable>,
    #[serde(default)]
    pub(super) randomize: Option<RandomizeTable>,
    #[serde(default)]
    pub(super) classes: BTreeMap<Spanned<String>, String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SensorTable {
    name: Spanned<String>,
    topic: String,
    #[serde(default)]
    truth: Vec<Spanned<String>>,
    #[serde(default)]
    labels: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PosesTable {
    #[serde(default)]
    pub(super) list: Vec<Spanned<Vec<f64>>>,
    pub(super) path: Option<Spanned<PathTable>>,
    pub(super) random: Option<Spanned<RandomTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PathTable {
    points: Vec<[f64; 3]>,
    count: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RandomTable {
    count: u64,
    min: [f64; 3],
    max: [f64; 3],
    #[serde(default)]
    roll_deg: [f64; 2],
    #[serde(default)]
    pitch_deg: [f64; 2],
    #[serde(default = "all_round")]
    yaw_deg: [f64; 2],
    #[serde(default)]
    clearance_m: f64,
}

fn all_round() -> [f64; 2] {
    [-180.0, 180.0]
}

pub(super) fn sensors(
    text: &Text<'_>,
    tables: &[Spanned<SensorTable>],
    diagnostics: &mut Diagnostics,
) -> Vec<SensorPlan> {
    let mut taken = BTreeSet::new();
    let mut sensors = Vec::new();
    for table in tables {
        let SensorTable { name, topic, truth, labels } = table.get_ref();
        let source = text.source(&name.span());
        let is_name = |name: &str| {
            !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        };
        if !is_name(name.get_ref()) {
            let what = format!("the sensor's name '{}' cannot be part of a file name", name.get_ref());
            diagnostics.error(&source, what, "write letters, digits and _");
        } else if !taken.insert(name.get_ref().clone()) {
            let what = format!("two sensors are called '{}'", name.get_ref());
            diagnostics.error(&source, what, "give each its own name");
        }
        if let Some(forward) = truth.iter().find(|truth| truth.get_ref() == "flow_forward") {
            let source = text.source(&forward.span());
            let what = "flow_forward is known only after the next frame";
            diagnostics.error(&source, what, "use flow_back");
        }
        sensors.push(SensorPlan {
            name: name.get_ref().clone(),
            topic: format!("/{}", topic.trim_start_matches('/')),
            truth: truth.iter().map(|truth| truth.get_ref().clone()).collect(),
            labels: *labels,
            source,
        });
    }
    if tables.is_empty() {
        let what = "sensors is empty";
        diagnostics.error(&Source::new(text.path, 0), what, "write a [[sensors]] with name and topic");
    }
    sensors
}

fn is_place(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.abs() <= FARTHEST_M)
}

pub(super) fn listed(
    text: &Text<'_>,
    list: &[Spanned<Vec<f64>>],
    diagnostics: &mut Diagnostics,
) -> Vec<Pose> {
    let pose = |numbers: &[f64]| match *numbers {
        [x, y, yaw] => Some((DVec3::new(x, y, 0.0), DVec3::Z * yaw)),
        [x, y, z, roll, pitch, yaw] => Some((DVec3::new(x, y, z), DVec3::new(roll, pitch, yaw))),
        _ => None,
    };
    let mut poses = Vec::new();
    for numbers in list {
        match pose(numbers.get_ref()).filter(|_| is_place(numbers.get_ref())) {
            Some((xyz, rpy_deg)) => {
                poses.push(Pose::from_xyz_rpy(xyz, rpy_deg.map(f64::to_radians)));
            }
            None => diagnostics.error(
                &text.source(&numbers.span()),
                format!("{:?} is not a pose", numbers.get_ref()),
                "write [x, y, yaw] or [x, y, z, roll, pitch, yaw] in metres, up to 10,000 km, and degrees",
            ),
        }
    }
    poses
}

pub(super) fn route(
    text: &Text<'_>,
    path: &Spanned<PathTable>,
    diagnostics: &mut Diagnostics,
) -> Option<Route> {
    let PathTable { points, count } = path.get_ref();
    let points_m: Vec<DVec3> = points.iter().map(|point| DVec3::from_array(*point)).collect();
    let is_way = points.iter().all(|point| is_place(point));
    let route = Route::new(points_m, *count).filter(|_| is_way);
    if route.is_none() {
        diagnostics.error(
            &text.source(&path.span()),
            format!("a path of {} and {}", text::count(points.len() as u64, "point"), text::count(*count, "pose")),
            "write points = [[x, y, z], …], two or more, no two equal ones in a row, in metres up to 10,000 km, and a count of 2 or more",
        );
    }
    route
}

pub(super) fn random(
    text: &Text<'_>,
    table: &Spanned<RandomTable>,
    diagnostics: &mut Diagnostics,
) -> Option<Random> {
    let source = text.source(&table.span());
    let RandomTable { count, min, max, roll_deg, pitch_deg, yaw_deg, clearance_m } = table.get_ref();
    let is_ordered = min.iter().zip(max).all(|(low, high)| low <= high)
        && [roll_deg, pitch_deg, yaw_deg]
            .iter()
            .all(|[low, high]| low <= high && low.is_finite() && high.is_finite());
    if !is_ordered || !is_place(min) || !is_place(max) {
        let what = format!("the region from {min:?} to {max:?}, or a range of angles, is invalid");
        diagnostics.error(
            &source,
            what,
            "write the lower limit first, in metres up to 10,000 km and degrees",
        );
        return None;
    }
    if !(0.0..=100.0).contains(clearance_m) {
        let what = format!("clearance_m = {clearance_m}");
        diagnostics.error(&source, what, "write 0 to 100 metres");
        return None;
    }
    let rpy = |end: usize| DVec3::new(roll_deg[end], pitch_deg[end], yaw_deg[end]).map(f64::to_radians);
    Some(Random {
        count: *count,
        xyz: [DVec3::from_array(*min), DVec3::from_array(*max)],
        rpy: [rpy(0), rpy(1)],
        clearance_m: *clearance_m,
        source,
    })
}

pub(super) fn classes(
    text: &Text<'_>,
    table: &BTreeMap<Spanned<String>, String>,
    diagnostics: &mut Diagnostics,
) -> BTreeMap<u32, String> {
    let mut classes = BTreeMap::new();
    for (number, name) in table {
        if let Ok(number) = number.get_ref().parse::<u32>() {
            classes.insert(number, name.clone());
        } else {
            let what = format!("'{}' is not a class number", number.get_ref());
            diagnostics.error(
                &text.source(&number.span()),
                what,
                "write [classes] with lines such as 7 = \"chair\"",
            );
        }
    }
    classes
}
