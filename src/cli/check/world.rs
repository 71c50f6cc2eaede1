//! The report on a world: its physics, lights and models.

use super::counted::{counted, fiducials};
use super::robot::{joint_kind, parts};
use super::streams::Streams;
use crate::description::model::{Geometry, Light, LightKind, World};
use crate::description::text::{angle, count, number, pose, vector};
use crate::rig::Part;
use crate::rig::sensor_report::sensor_report;
use belvedere_sensors::scene::{Fog, FogLaw};

pub(super) fn report(world: &World, streams: &Streams, gazebo_compat: bool) -> Vec<String> {
    let mut lines = vec![format!("world {} ({})", world.name, world.source)];
    lines.push(format!(
        "physics: step {} s, gravity {} m/s²",
        number(world.max_step_size_s),
        vector(world.gravity)
    ));
    let shadows = if world.shadows { "with shadows" } else { "without shadows" };
    lines.push(format!("scene: ambient {:?}, background {:?}, {shadows}", world.ambient, world.background));
    if let Some(Fog { colour, law }) = world.air.fog {
        let law = match law {
            FogLaw::Linear { start_m, end_m } => format!("from {start_m} m to {end_m} m"),
            FogLaw::Exponential { density_per_m } => format!("exponential, density {density_per_m}/m"),
            FogLaw::ExponentialSquared { density_per_m } => {
                format!("exponential of the square, density {density_per_m}/m")
            }
        };
        lines.push(format!("fog: {colour:?}, {law}"));
    }
    if world.air.sky.is_some() {
        lines.push("sky: clear day, instead of the background".into());
    }
    lines.extend(world.lights.iter().map(light_line));
    for (index, model) in world.models.iter().enumerate() {
        let fixed = if model.is_static { "static" } else { "moving" };
        lines.push(format!("model {} {fixed} {}", model.name, pose(&model.world_from_model)));
        lines.extend(fiducials(model).map(|line| format!("  fiducials: {line}")));
        for link in &model.links {
            let shapes: Vec<_> = link.visuals.iter().map(|visual| shape(&visual.geometry)).collect();
            let shown = if shapes.is_empty() { "nothing to see".into() } else { counted(&shapes) };
            lines.push(format!("  {} {}: {shown}", link.name, pose(&link.model_from_link)));
        }
        for joint in &model.joints {
            let (parent, child) = (&model.links[joint.parent].name, &model.links[joint.child].name);
            lines.push(format!("  joint {} {parent} → {child}: {}", joint.name, joint_kind(joint)));
        }
        let mut said = Vec::new();
        for (number, sensor) in model.sensors.iter().enumerate() {
            said.extend(sensor_report(model, sensor, gazebo_compat));
            said.extend(streams.of_part(index, Part::Sensor(number)));
        }
        said.extend(parts(model, index, streams));
        lines.extend(said.iter().map(|line| format!("  {line}")));
    }
    lines.push(String::new());
    lines
}

fn light_line(light: &Light) -> String {
    let kind = match light.kind {
        LightKind::Point => "point".to_owned(),
        LightKind::Directional => "directional".to_owned(),
        LightKind::Spot { inner_angle, outer_angle, .. } => {
            format!("spot {} to {}", angle(inner_angle), angle(outer_angle))
        }
    };
    let direction = match light.kind {
        LightKind::Point => String::new(),
        _ => {
            format!(" towards {}", vector(light.world_from_light.transform_vector(light.direction)))
        }
    };
    format!(
        "light {} {kind} {}{direction}, diffuse {:?}, range {} m{}",
        light.name,
        pose(&light.world_from_light),
        light.diffuse,
        number(light.range_m),
        if light.cast_shadows { ", casts shadows" } else { "" }
    )
}

fn shape(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Box { size } => format!("box {}", vector(*size)),
        Geometry::Cylinder { radius, length } => {
            format!("cylinder r {} l {}", number(*radius), number(*length))
        }
        Geometry::Sphere { radius } => format!("sphere r {}", number(*radius)),
        Geometry::Capsule { radius, length } => {
            format!("capsule r {} l {}", number(*radius), number(*length))
        }
        Geometry::Ellipsoid { radii } => format!("ellipsoid {}", vector(*radii)),
        Geometry::Cone { radius, length } => format!("cone r {} l {}", number(*radius), number(*length)),
        Geometry::HeightMap(map) => {
            let ([rows, columns], [x, y]) = (map.heights.grid, map.heights.size);
            format!(
                "height map {} of {columns} × {rows} heights, {} × {} m",
                map.heights.path.display(),
                number(x),
                number(y)
            )
        }
        Geometry::Plane { size: [x, y], .. } => format!("plane {} {}", number(*x), number(*y)),
        Geometry::Mesh(mesh) => {
            format!("mesh {} of {}", mesh.path.display(), count(mesh.triangles.len() as u64, "triangle"))
        }
    }
}
