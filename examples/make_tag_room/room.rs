//! The room: floor, walls, furniture along them, two lamps, and the world file that puts it together.
//!
//! The furniture leaves the rectangle |x| < 2.5, |y| < 1.7 free for driving. It is so low that from there it hides no
//! code from a camera at a height of 0.36 m.

use super::output::{Content, Generated};
use super::sdf::{self, Color, HEADER, Part};
use std::fmt::Write;

/// Inside length along x.
pub(crate) const LENGTH_M: f64 = 8.0;
/// Inside width along y.
pub(crate) const WIDTH_M: f64 = 6.0;
/// Height of the ceiling.
pub(crate) const HEIGHT_M: f64 = 2.5;
/// Thickness of walls and floor.
pub(crate) const WALL_M: f64 = 0.1;

/// Floor lamps at two opposite corners. They are 1.2 m high, so that they illuminate the ceiling evenly. A lamp just below
/// the ceiling would not.
const LAMPS: [[f64; 2]; 2] = [[3.4, 2.45], [-3.4, -2.45]];
const LAMP_HEIGHT_M: f64 = 1.2;
/// The sum of ambient light and lamps is below 1 even above a lamp, so that no white saturates.
const AMBIENT: f64 = 0.45;
const LAMP_DIFFUSE: f64 = 0.45;

const WALL_RETRO: u32 = 50;
const WOOD_RETRO: u32 = 20;
const METAL_RETRO: u32 = 200;

const WOOD: Color = [0.55, 0.38, 0.22];
const DARK_WOOD: Color = [0.36, 0.23, 0.14];
const STEEL: Color = [0.42, 0.44, 0.47];

pub(crate) fn files() -> Vec<Generated> {
    let file = |path: &str, text| Generated { path: path.into(), content: Content::Text(text) };
    vec![
        file(
            "tag_room/model.config",
            sdf::config("tag_room", "A furnished room of 8 m × 6 m without ceiling."),
        ),
        file("tag_room/model.sdf", model()),
        file("tag_room/materials/scripts/room.material", material()),
        file("worlds/tag_ceiling.world", world()),
    ]
}

fn world() -> String {
    let mut lights = String::new();
    for (number, [x, y]) in LAMPS.iter().enumerate() {
        let _ = write!(
            lights,
            "    <light type=\"point\" name=\"lamp_{number}\">\n\
             \x20     <pose>{x} {y} {LAMP_HEIGHT_M} 0 0 0</pose>\n\
             \x20     <cast_shadows>true</cast_shadows>\n\
             \x20     <diffuse>{LAMP_DIFFUSE} {LAMP_DIFFUSE} {LAMP_DIFFUSE} 1</diffuse>\n\
             \x20     <specular>0 0 0 1</specular>\n\
             \x20     <attenuation><range>20</range><constant>1</constant><linear>0</linear>\
             <quadratic>0</quadratic></attenuation>\n\
             \x20   </light>\n"
        );
    }
    format!(
        "{HEADER}<sdf version=\"1.6\">\n  <world name=\"tag_ceiling\">\n\
         \x20   <scene>\n\
         \x20     <ambient>{AMBIENT} {AMBIENT} {AMBIENT} 1</ambient>\n\
         \x20     <background>0.7 0.7 0.7 1</background>\n\
         \x20     <shadows>true</shadows>\n\
         \x20   </scene>\n\
         \x20   <physics type=\"ode\">\n\
         \x20     <max_step_size>0.005</max_step_size>\n\
         \x20     <real_time_factor>1</real_time_factor>\n\
         \x20     <real_time_update_rate>200</real_time_update_rate>\n\
         \x20   </physics>\n\
         \x20   <gravity>0 0 -9.8</gravity>\n\
         \x20   <include><uri>model://tag_room</uri></include>\n\
         \x20   <include><uri>model://tag_ceiling</uri><pose>0 0 {HEIGHT_M} 0 0 0</pose></include>\n\
         {lights}  </world>\n</sdf>\n"
    )
}

/// Returns the material of the floor, whose planks repeat every 2 m.
fn material() -> String {
    let (u, v) = (2.0 / LENGTH_M, 2.0 / WIDTH_M);
    format!(
        "// Made by: cargo run --example make_tag_room\n\
         material TagRoom/floor\n{{\n  technique\n  {{\n    pass\n    {{\n      ambient 1 1 1 1\n      \
         diffuse 1 1 1 1\n      specular 0 0 0 1 0\n      texture_unit\n      {{\n        texture floor.png\n        \
         scale {u} {v}\n        filtering anisotropic\n        max_anisotropy 16\n      }}\n    }}\n  }}\n}}\n"
    )
}

fn model() -> String {
    let mut parts = Vec::new();
    shell(&mut parts);
    furniture(&mut parts);
    lamps(&mut parts);
    let mut content = String::new();
    for part in parts {
        part.write(&mut content);
    }
    sdf::model("tag_room", "room", &content)
}

/// Adds a box with its name, pose and appearance.
fn cuboid(
    parts: &mut Vec<Part>,
    name: &str,
    place: [f64; 4],
    size: [f64; 3],
    color: Color,
    laser_retro: u32,
) {
    let shape = sdf::cuboid(size);
    parts.push(Part { name: name.into(), place, shape, material: sdf::paint(color), laser_retro });
}

fn cylinder(
    parts: &mut Vec<Part>,
    name: &str,
    [x, y, z]: [f64; 3],
    [radius, length]: [f64; 2],
    color: Color,
    laser_retro: u32,
) {
    let shape = sdf::cylinder(radius, length);
    let material = sdf::paint(color);
    parts.push(Part { name: name.into(), place: [x, y, z, 0.0], shape, material, laser_retro });
}

/// Adds the floor, the walls, and the parts that protrude from them.
fn shell(parts: &mut Vec<Part>) {
    let floor = "<material><script><uri>model://tag_room/materials/scripts</uri>\
                 <uri>model://tag_room/materials/textures</uri><name>TagRoom/floor</name></script></material>";
    parts.push(Part {
        name: "floor".into(),
        place: [0.0, 0.0, -WALL_M / 2.0, 0.0],
        shape: sdf::cuboid([LENGTH_M, WIDTH_M, WALL_M]),
        material: floor.into(),
        laser_retro: WALL_RETRO,
    });
    let (x, y, z) = (LENGTH_M / 2.0 + WALL_M / 2.0, WIDTH_M / 2.0 + WALL_M / 2.0, HEIGHT_M / 2.0);
    let across = [WALL_M, WIDTH_M + 2.0 * WALL_M, HEIGHT_M];
    let along = [LENGTH_M, WALL_M, HEIGHT_M];
    // Each wall has its own tint, so that an image shows the direction of the camera.
    cuboid(parts, "wall_east", [x, 0.0, z, 0.0], across, [0.82, 0.76, 0.66], WALL_RETRO);
    cuboid(parts, "wall_west", [-x, 0.0, z, 0.0], across, [0.66, 0.75, 0.80], WALL_RETRO);
    cuboid(parts, "wall_north", [0.0, y, z, 0.0], along, [0.80, 0.80, 0.72], WALL_RETRO);
    cuboid(parts, "wall_south", [0.0, -y, z, 0.0], along, [0.72, 0.80, 0.70], WALL_RETRO);
    // A door with its frame on the west wall.
    cuboid(parts, "door", [-3.98, 0.4, 1.0, 0.0], [0.04, 0.9, 2.0], DARK_WOOD, WOOD_RETRO);
    cuboid(parts, "door_post_left", [-3.95, -0.1, 1.05, 0.0], [0.1, 0.1, 2.1], WOOD, WOOD_RETRO);
    cuboid(parts, "door_post_right", [-3.95, 0.9, 1.05, 0.0], [0.1, 0.1, 2.1], WOOD, WOOD_RETRO);
    cuboid(parts, "door_lintel", [-3.95, 0.4, 2.05, 0.0], [0.1, 0.9, 0.1], WOOD, WOOD_RETRO);
    // Two pilasters make a niche in the east wall.
    for (name, y) in [("pilaster_south", -1.3), ("pilaster_north", 0.3)] {
        cuboid(parts, name, [3.9, y, z, 0.0], [0.2, 0.3, HEIGHT_M], [0.74, 0.68, 0.58], WALL_RETRO);
    }
}

fn furniture(parts: &mut Vec<Part>) {
    // A table with two stools at the north wall.
    cuboid(parts, "table_top", [0.4, 2.3, 0.73, 0.0], [1.4, 0.7, 0.04], WOOD, WOOD_RETRO);
    for (number, (x, y)) in [(-0.22, 2.03), (1.02, 2.03), (-0.22, 2.57), (1.02, 2.57)].into_iter().enumerate()
    {
        let name = format!("table_leg_{number}");
        cuboid(parts, &name, [x, y, 0.355, 0.0], [0.06, 0.06, 0.71], DARK_WOOD, WOOD_RETRO);
    }
    cylinder(parts, "stool_west", [-0.9, 2.25, 0.225], [0.17, 0.45], [0.62, 0.18, 0.16], WOOD_RETRO);
    cylinder(parts, "stool_east", [1.7, 2.3, 0.225], [0.17, 0.45], [0.16, 0.30, 0.58], WOOD_RETRO);
    // A shelf at the south wall: two sides, four boards, a back.
    for (name, x) in [("shelf_side_west", -1.81), ("shelf_side_east", -0.79)] {
        cuboid(parts, name, [x, -2.8, 0.7, 0.0], [0.02, 0.3, 1.4], WOOD, WOOD_RETRO);
    }
    for (number, z) in [0.06, 0.5, 0.94, 1.38].into_iter().enumerate() {
        let name = format!("shelf_board_{number}");
        cuboid(parts, &name, [-1.3, -2.8, z, 0.0], [1.0, 0.3, 0.02], WOOD, WOOD_RETRO);
    }
    cuboid(parts, "shelf_back", [-1.3, -2.955, 0.7, 0.0], [1.0, 0.01, 1.4], DARK_WOOD, WOOD_RETRO);
    cuboid(parts, "books_red", [-1.55, -2.8, 0.63, 0.0], [0.3, 0.2, 0.24], [0.60, 0.14, 0.12], WOOD_RETRO);
    cuboid(parts, "books_green", [-1.1, -2.8, 0.19, 0.0], [0.4, 0.2, 0.24], [0.14, 0.45, 0.20], WOOD_RETRO);
    // A bench beside it.
    cuboid(parts, "bench_seat", [1.2, -2.65, 0.42, 0.0], [1.3, 0.35, 0.06], WOOD, WOOD_RETRO);
    for (name, x) in [("bench_leg_west", 0.7), ("bench_leg_east", 1.7)] {
        cuboid(parts, name, [x, -2.65, 0.195, 0.0], [0.08, 0.3, 0.39], DARK_WOOD, WOOD_RETRO);
    }
    // Crates, a drum and a ball in the corners.
    let cardboard = [0.70, 0.55, 0.36];
    cuboid(parts, "crate_lower", [3.35, -2.25, 0.25, 0.35], [0.5, 0.5, 0.5], cardboard, WOOD_RETRO);
    cuboid(parts, "crate_upper", [3.38, -2.28, 0.65, -0.4], [0.3, 0.3, 0.3], [0.62, 0.47, 0.30], WOOD_RETRO);
    cylinder(parts, "drum", [-3.2, 2.1, 0.44], [0.28, 0.88], [0.14, 0.32, 0.62], METAL_RETRO);
    parts.push(Part {
        name: "ball".into(),
        place: [3.1, 1.0, 0.2, 0.0],
        shape: sdf::sphere(0.2),
        material: sdf::paint([0.85, 0.36, 0.10]),
        laser_retro: WOOD_RETRO,
    });
}

fn lamps(parts: &mut Vec<Part>) {
    for (number, [x, y]) in LAMPS.into_iter().enumerate() {
        let name = |what: &str| format!("lamp_{number}_{what}");
        cylinder(parts, &name("foot"), [x, y, 0.015], [0.15, 0.03], STEEL, METAL_RETRO);
        cylinder(parts, &name("post"), [x, y, 0.54], [0.025, 1.02], STEEL, METAL_RETRO);
        // The light is above the bowl, because the bowl would shade it.
        parts.push(Part {
            name: name("bowl"),
            place: [x, y, 1.08, 0.0],
            shape: sdf::cylinder(0.13, 0.06),
            material: "<material><ambient>0.9 0.9 0.85 1</ambient><diffuse>0.3 0.3 0.28 1</diffuse>\
                       <specular>0 0 0 1</specular><emissive>0.5 0.5 0.45 1</emissive></material>"
                .into(),
            laser_retro: METAL_RETRO,
        });
    }
}
