//! Functions that return pieces of SDF text.

use std::fmt::Write;

/// Colour of a surface, both for lamps and for ambient light.
pub(crate) type Color = [f64; 3];

pub(crate) const HEADER: &str = "<?xml version=\"1.0\"?>\n<!-- Made by examples/make_tag_room -->\n";

/// Returns a `<material>` of one colour.
pub(crate) fn paint([r, g, b]: Color) -> String {
    format!(
        "<material><ambient>{r} {g} {b} 1</ambient><diffuse>{r} {g} {b} 1</diffuse>\
         <specular>0 0 0 1</specular></material>"
    )
}

pub(crate) fn cuboid([x, y, z]: [f64; 3]) -> String {
    format!("<box><size>{x} {y} {z}</size></box>")
}

pub(crate) fn cylinder(radius: f64, length: f64) -> String {
    format!("<cylinder><radius>{radius}</radius><length>{length}</length></cylinder>")
}

pub(crate) fn sphere(radius: f64) -> String {
    format!("<sphere><radius>{radius}</radius></sphere>")
}

/// A shape that is both `<visual>` and `<collision>`.
pub(crate) struct Part {
    pub(crate) name: String,
    /// The pose: x, y, z and yaw.
    pub(crate) place: [f64; 4],
    pub(crate) shape: String,
    pub(crate) material: String,
    /// The reflectivity that lidars report.
    pub(crate) laser_retro: u32,
}

impl Part {
    pub(crate) fn write(&self, out: &mut String) {
        let Self { name, place: [x, y, z, yaw], shape, material, laser_retro } = self;
        let _ = write!(
            out,
            "      <collision name=\"{name}\">\n\
             \x20       <pose>{x} {y} {z} 0 0 {yaw}</pose>\n\
             \x20       <geometry>{shape}</geometry>\n\
             \x20       <laser_retro>{laser_retro}</laser_retro>\n\
             \x20     </collision>\n\
             \x20     <visual name=\"{name}\">\n\
             \x20       <pose>{x} {y} {z} 0 0 {yaw}</pose>\n\
             \x20       <geometry>{shape}</geometry>\n\
             \x20       {material}\n\
             \x20     </visual>\n"
        );
    }
}

/// Returns a static model with one link.
pub(crate) fn model(name: &str, link: &str, content: &str) -> String {
    format!(
        "{HEADER}<sdf version=\"1.6\">\n  <model name=\"{name}\">\n    <static>true</static>\n    \
         <link name=\"{link}\">\n{content}    </link>\n  </model>\n</sdf>\n"
    )
}

/// Returns the `model.config` of a Gazebo model folder.
pub(crate) fn config(name: &str, description: &str) -> String {
    format!(
        "{HEADER}<model>\n  <name>{name}</name>\n  <version>1.0</version>\n  \
         <sdf version=\"1.6\">model.sdf</sdf>\n  <author><name>The Belvedere developers</name></author>\n  \
         <description>{description}</description>\n</model>\n"
    )
}
