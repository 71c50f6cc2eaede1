//! The tag-ceiling room, checked with independent detectors: the AprilTag library and zbar. The robot's view of it is
//! tested in `tags.rs`.

// Items of the example that only its main function uses.
#![allow(dead_code)]

#[path = "../../examples/make_tag_room/ceiling.rs"]
mod ceiling;
#[path = "../../examples/make_tag_room/codes.rs"]
mod codes;
#[path = "../../examples/make_tag_room/floor.rs"]
mod floor;
#[path = "../../examples/make_tag_room/output.rs"]
mod output;
#[path = "../../examples/make_tag_room/room.rs"]
mod room;
#[path = "../../examples/make_tag_room/sdf.rs"]
mod sdf;

use crate::eyes::{april_tags, listed, qr_codes};
use belvedere::description::load::load_world;
use belvedere::description::model::{Geometry, Model, World};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use glam::DVec3;
use std::path::{Path, PathBuf};

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models")
}

fn tag_ceiling() -> World {
    let mut diagnostics = Diagnostics::default();
    let world = load_world("tag_ceiling", &package_path([], None), Rules::default(), &mut diagnostics);
    assert!(diagnostics.problems().is_empty(), "{:#?}", diagnostics.problems());
    world.unwrap()
}

fn model<'a>(world: &'a World, name: &str) -> &'a Model {
    world.models.iter().find(|model| model.name == name).unwrap()
}

/// The committed files equal the output of the generator.
#[test]
fn files_are_current() {
    let codes = codes::all().unwrap();
    let mut files = room::files();
    files.extend(ceiling::files(&codes));
    files.push(floor::file());
    for output::Generated { path, content } in files {
        let file = models().join(path);
        if let Err(error) = content.compare(&file) {
            panic!("{}: {error}", file.display());
        }
    }
}

/// Every texture has the content in the list, and is upright: its corners are in the order of the list.
#[test]
fn textures_decode_upright() {
    for code in listed() {
        let file = models().join(format!("tag_ceiling/materials/textures/{}.png", code.name));
        let mut picture = image::open(&file).unwrap().into_luma8();
        if code.is_qr {
            // Reduced to a size that the reader supports.
            let edge = picture.width() / 4;
            picture = image::imageops::resize(&picture, edge, edge, image::imageops::FilterType::Triangle);
        }
        let seen = if code.is_qr { qr_codes(&picture) } else { april_tags(&picture) };
        assert_eq!(seen.len(), 1, "{}", code.name);
        assert_eq!(seen[0].says, code.says, "{}", code.name);
        let size = f64::from(picture.width());
        let margin = 16.0;
        let (near, far) = (margin - 0.5, size - margin - 0.5);
        for (seen, wanted) in seen[0].corners.iter().zip([[near, far], [far, far], [far, near], [near, near]])
        {
            let off = (seen[0] - wanted[0]).hypot(seen[1] - wanted[1]);
            assert!(off < 2.5, "{}: corner at {seen:?}, expected {wanted:?}", code.name);
        }
    }
}

/// The loaded world has each code once, with its texture, at the position in the list.
#[test]
fn plates_have_the_positions_of_the_list() {
    let world = tag_ceiling();
    let ceiling = model(&world, "tag_ceiling");
    let codes = listed();
    assert_eq!(codes.len(), 63);
    let mut sayings: Vec<&str> = codes.iter().map(|code| code.says.as_str()).collect();
    sayings.sort_unstable();
    sayings.dedup();
    assert_eq!(sayings.len(), codes.len(), "every code has a different content");
    for code in &codes {
        let visual = ceiling.links[0].visuals.iter().find(|visual| visual.name == code.name).unwrap();
        let texture = visual.material.texture.as_ref().unwrap();
        assert!(texture.ends_with(format!("{}.png", code.name)), "{}", texture.display());
        assert_eq!((visual.material.diffuse, visual.material.ambient), ([1.0; 3], [1.0; 3]));
        let center = code.corners.iter().sum::<DVec3>() / 4.0;
        let plate = ceiling.world_from_model * ceiling.links[0].model_from_link * visual.link_from_visual;
        assert!((plate.translation() - DVec3::Z * 0.0005 - center).length() < 1e-5, "{}", code.name);
        assert!((center.z - 2.498).abs() < 1e-9);
        for i in 0..4 {
            let edge = (code.corners[i] - code.corners[(i + 1) % 4]).length();
            assert!((edge - code.edge_m).abs() < 5e-6, "{}: edge {i} is {edge}", code.name);
        }
        // Seen from below, the order is counter-clockwise.
        let [a, b, c, _] = code.corners;
        assert!((b - a).cross(c - b).z < 0.0, "{} is mirrored", code.name);
    }
}

/// The focal length of a picture of 640 × 480 with a horizontal angle of view of 1.3962634 rad.
const FOCAL: f64 = 381.361_15;

/// From every position in the free area, nothing is between the camera and a code in its picture, and nothing is in the
/// area.
#[test]
fn furniture_hides_no_code_and_leaves_room_to_drive() {
    let world = tag_ceiling();
    let room = model(&world, "tag_room");
    let codes = listed();
    let solids: Vec<(&str, parry3d::math::Pose, Box<dyn parry3d::shape::Shape>)> = room.links[0]
        .collisions
        .iter()
        .map(|collision| {
            let shape: Box<dyn parry3d::shape::Shape> = match collision.geometry {
                Geometry::Box { size } => Box::new(parry3d::shape::Cuboid::new((size / 2.0).as_vec3())),
                Geometry::Sphere { radius } => Box::new(parry3d::shape::Ball::new(radius as f32)),
                // A box around it is enough.
                Geometry::Cylinder { radius, length } => {
                    let half = DVec3::new(radius, radius, length / 2.0).as_vec3();
                    Box::new(parry3d::shape::Cuboid::new(half))
                }
                ref other => panic!("{other:?}"),
            };
            let pose = room.world_from_model * room.links[0].model_from_link * collision.link_from_collision;
            let pose =
                parry3d::math::Pose::from_parts(pose.translation().as_vec3(), pose.rotation().as_quat());
            (collision.name.as_str(), pose, shape)
        })
        .collect();
    for (name, pose, shape) in &solids {
        let bounds = shape.compute_aabb(pose);
        let above_floor = bounds.maxs.z > 0.001;
        let in_area =
            bounds.mins.x < 2.5 && bounds.maxs.x > -2.5 && bounds.mins.y < 1.7 && bounds.maxs.y > -1.7;
        assert!(!(above_floor && in_area), "{name} stands in the free area");
    }
    for (x, y) in (-5..=5).flat_map(|i| (-5..=5).map(move |j| (f64::from(i) * 0.5, f64::from(j) * 0.34))) {
        let eye = DVec3::new(x, y, 0.36);
        for code in &codes {
            for corner in code.corners {
                // Half the diagonal of the picture: 400 px.
                let flat = (corner - eye).truncate().length();
                if flat / (corner.z - eye.z) > 400.0 / FOCAL {
                    continue;
                }
                let way = (corner - eye).as_vec3();
                let ray = parry3d::query::Ray::new(eye.as_vec3(), way);
                let hidden = solids.iter().find(|(_, pose, shape)| shape.intersects_ray(pose, &ray, 1.0));
                assert!(hidden.is_none(), "{} hides {} from {x}, {y}", hidden.unwrap().0, code.name);
            }
        }
    }
}

/// Lamps and ambient light together never saturate white, and the ceiling is bright enough everywhere.
#[test]
fn the_ceiling_is_evenly_lit() {
    let world = tag_ceiling();
    for code in listed() {
        let point = code.corners[0];
        let lit: f64 = world
            .lights
            .iter()
            .map(|light| {
                let way = light.world_from_light.translation() - point;
                let [constant, linear, quadratic] = light.attenuation;
                let d = way.length();
                let fall = 1.0 / (constant + linear * d + quadratic * d * d);
                f64::from(light.diffuse[0]) * fall.min(1.0) * (-way.z / d).max(0.0)
            })
            .sum();
        let white = f64::from(world.ambient[0]) + lit;
        assert!((0.6..1.0).contains(&white), "{}: {white}", code.name);
    }
}
