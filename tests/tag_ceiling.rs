//! The tag-ceiling room, looked at by detectors that nobody here wrote: the AprilTag library and rqrr.

// The example's modules bring what only its main function uses.
#![allow(dead_code)]

#[path = "../examples/make_tag_room/ceiling.rs"]
mod ceiling;
#[path = "../examples/make_tag_room/codes.rs"]
mod codes;
#[path = "../examples/make_tag_room/floor.rs"]
mod floor;
#[path = "../examples/make_tag_room/output.rs"]
mod output;
#[path = "../examples/make_tag_room/room.rs"]
mod room;
#[path = "../examples/make_tag_room/sdf.rs"]
mod sdf;

use belvedere::description::Diagnostics;
use belvedere::description::model::{Geometry, Model, World};
use belvedere::description::package::PackagePath;
use belvedere::description::world::load_world;
use belvedere_sensors::Pose;
use glam::DVec3;
use image::GrayImage;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models")
}

fn tag_ceiling() -> World {
    let mut diagnostics = Diagnostics::default();
    let world = load_world("tag_ceiling", &PackagePath::new([], None), false, &mut diagnostics);
    assert!(diagnostics.problems().is_empty(), "{:#?}", diagnostics.problems());
    world.unwrap()
}

fn model<'a>(world: &'a World, name: &str) -> &'a Model {
    world.models.iter().find(|model| model.name == name).unwrap()
}

/// A code of `tag_ceiling.tags.json`.
struct Listed {
    name: String,
    /// `7` of an AprilTag, `BV-007` of a QR code.
    says: String,
    edge_m: f64,
    corners: [DVec3; 4],
}

fn listed() -> Vec<Listed> {
    let text = std::fs::read_to_string(models().join("worlds/tag_ceiling.tags.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    json["codes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|code| {
            let corners: [[f64; 3]; 4] = serde_json::from_value(code["corners_m"].clone()).unwrap();
            Listed {
                name: code["name"].as_str().unwrap().into(),
                says: match code["family"].as_str().unwrap() {
                    "qr" => code["text"].as_str().unwrap().into(),
                    _ => code["id"].to_string(),
                },
                edge_m: code["edge_m"].as_f64().unwrap(),
                corners: corners.map(DVec3::from_array),
            }
        })
        .collect()
}

// Both detectors: by what a code says, its four corners in pixels with pixel centres at integers, in the order bottom
// left, bottom right, top right, top left of the code.

/// What the AprilTag library sees: by id, corners in pixels.
fn april_tags(picture: &GrayImage) -> HashMap<String, [[f64; 2]; 4]> {
    let (width, height) = picture.dimensions();
    let mut image = apriltag::Image::zeros_with_alignment(width as usize, height as usize, 96).unwrap();
    for (x, y, pixel) in picture.enumerate_pixels() {
        image[(x as usize, y as usize)] = pixel.0[0];
    }
    let family = apriltag::Family::tag_36h11();
    let mut detector = apriltag::Detector::builder().add_family_bits(family, 1).build().unwrap();
    detector.set_decimation(1.0);
    detector
        .detect(&image)
        .iter()
        // The library counts from the edge of the first pixel.
        .map(|found| (found.id().to_string(), found.corners().map(|corner| corner.map(|value| value - 0.5))))
        .collect()
}

/// Edge of the windows that rqrr looks through, a little more than a code's diagonal of 148 px; and their step.
const WINDOW_PX: u32 = 200;
const WINDOW_STEP_PX: u32 = 40;

/// rqrr pairs the finder marks of neighbouring codes, so it looks at one window after another: in some window each
/// code is alone.
fn qr_codes(picture: &GrayImage) -> HashMap<String, [[f64; 2]; 4]> {
    let (width, height) = picture.dimensions();
    let starts = |size: u32| {
        let last = size.saturating_sub(WINDOW_PX);
        (0..last).step_by(WINDOW_STEP_PX as usize).chain([last])
    };
    let mut seen = HashMap::new();
    for (x0, y0) in starts(height).flat_map(|y| starts(width).map(move |x| (x, y))) {
        let (w, h) = (WINDOW_PX.min(width), WINDOW_PX.min(height));
        let mut window = rqrr::PreparedImage::prepare_from_greyscale(w as usize, h as usize, |x, y| {
            picture.get_pixel(x0 + x as u32, y0 + y as u32).0[0]
        });
        // It panics on some marks that do not belong together; then there is no code in this window.
        let found = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            let grids = window.detect_grids();
            let read = |grid: &rqrr::Grid<_>| Some((grid.decode().ok()?.1, grid.bounds));
            grids.iter().filter_map(read).collect::<Vec<_>>()
        }));
        for (says, bounds) in found.unwrap_or_default() {
            let [top_left, top_right, bottom_right, bottom_left] =
                bounds.map(|point| [f64::from(point.x) + f64::from(x0), f64::from(point.y) + f64::from(y0)]);
            // rqrr's bounds go one module of 25 too far to the right and to the bottom.
            let shrink =
                |corner: [f64; 2]| [0, 1].map(|i| top_left[i] + (corner[i] - top_left[i]) * 25.0 / 26.0);
            let [top_right, bottom_right, bottom_left] = [top_right, bottom_right, bottom_left].map(shrink);
            seen.insert(says, [bottom_left, bottom_right, top_right, top_left]);
        }
    }
    seen
}

/// The committed files are what the generator makes.
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

/// Every texture says what the list says, and is upright: its corners are where the list's order wants them.
#[test]
fn textures_decode_upright() {
    for code in listed() {
        let file = models().join(format!("tag_ceiling/materials/textures/{}.png", code.name));
        let mut picture = image::open(&file).unwrap().into_luma8();
        let is_qr = code.name.starts_with("qr");
        if is_qr {
            // Small enough for the reader's window.
            let edge = picture.width() / 4;
            picture = image::imageops::resize(&picture, edge, edge, image::imageops::FilterType::Triangle);
        }
        let seen = if is_qr { qr_codes(&picture) } else { april_tags(&picture) };
        assert_eq!(seen.keys().collect::<Vec<_>>(), [&code.says], "{}", code.name);
        let size = f64::from(picture.width());
        let margin = 16.0;
        let (near, far) = (margin - 0.5, size - margin - 0.5);
        for (seen, wanted) in
            seen[&code.says].iter().zip([[near, far], [far, far], [far, near], [near, near]])
        {
            let off = (seen[0] - wanted[0]).hypot(seen[1] - wanted[1]);
            assert!(off < 2.5, "{}: corner at {seen:?}, expected {wanted:?}", code.name);
        }
    }
}

/// The loaded world has each code once, with its texture, where the list says.
#[test]
fn plates_hang_where_the_list_says() {
    let world = tag_ceiling();
    let ceiling = model(&world, "tag_ceiling");
    let codes = listed();
    assert_eq!(codes.len(), 63);
    let mut sayings: Vec<&str> = codes.iter().map(|code| code.says.as_str()).collect();
    sayings.sort_unstable();
    sayings.dedup();
    assert_eq!(sayings.len(), codes.len(), "every code says something else");
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
        // Seen from below the order is counter-clockwise.
        let [a, b, c, _] = code.corners;
        assert!((b - a).cross(c - b).z < 0.0, "{} is mirrored", code.name);
    }
}

/// The AprilTag library's corners are off by 0.09 px in the mean; rqrr rounds to whole pixels and to its own corners of
/// the finder marks.
const TAG_TOLERANCE_PX: f64 = 0.5;
/// See [`TAG_TOLERANCE_PX`].
const QR_TOLERANCE_PX: f64 = 5.0;

/// f of a 640 × 480 picture with a horizontal angle of view of 1.3962634 rad.
const FOCAL: f64 = 381.361_15;
const CENTER: [f64; 2] = [319.5, 239.5];

/// Pixel of a point for a camera that looks straight up.
fn project(world_from_camera: &Pose, point: DVec3) -> [f64; 2] {
    // Camera frame: x forward, y left, z up.
    let p = world_from_camera.inverse().transform_point(point);
    [CENTER[0] - FOCAL * p.y / p.x, CENTER[1] - FOCAL * p.z / p.x]
}

/// The ceiling as the loaded boxes show it to the camera: each pixel the mean of 4 × 4 rays.
fn photograph(ceiling: &Model, world_from_camera: &Pose) -> GrayImage {
    struct Plate {
        from_world: Pose,
        center: DVec3,
        half: f64,
        texture: GrayImage,
    }
    let plates: Vec<Plate> = ceiling.links[0]
        .visuals
        .iter()
        .filter_map(|visual| {
            let Geometry::Box { size } = visual.geometry else { return None };
            let texture = image::open(visual.material.texture.as_ref()?).unwrap().into_luma8();
            let world_from_plate =
                ceiling.world_from_model * ceiling.links[0].model_from_link * visual.link_from_visual;
            let center = world_from_plate.translation();
            Some(Plate { from_world: world_from_plate.inverse(), center, half: size.x / 2.0, texture })
        })
        .collect();
    let eye = world_from_camera.translation();
    let mut noise = 1_u64;
    GrayImage::from_fn(640, 480, |column, row| {
        let mut sum = 0.0;
        for sample in 0..16 {
            let offset = |i: u32| (f64::from(i) + 0.5) / 4.0 - 0.5;
            let u = f64::from(column) + offset(sample % 4) - CENTER[0];
            let v = f64::from(row) + offset(sample / 4) - CENTER[1];
            let ray = world_from_camera.transform_vector(DVec3::new(1.0, -u / FOCAL, -v / FOCAL));
            let hit = eye + ray * ((2.498 - eye.z) / ray.z);
            sum += plates
                .iter()
                .find_map(|plate| {
                    let beside = (hit - plate.center).abs();
                    if beside.x.max(beside.y) > plate.half * std::f64::consts::SQRT_2 {
                        return None;
                    }
                    let p = plate.from_world.transform_point(hit);
                    (p.x.abs() < plate.half && p.y.abs() < plate.half).then(|| {
                        // Lower face of a box: right is +x, up is −y; row 0 is the top.
                        let size = f64::from(plate.texture.width());
                        let at = |value: f64| ((value / (2.0 * plate.half) + 0.5) * size) as u32;
                        f64::from(plate.texture.get_pixel(at(p.x), at(p.y)).0[0])
                    })
                })
                .unwrap_or(200.0);
        }
        // The articles' camera noise, σ = 0.007 of 255, as uniform noise of the same deviation.
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let uniform = (noise >> 40) as f64 / f64::from(1 << 24) - 0.5;
        image::Luma([(sum / 16.0 * 0.7 + 10.0 + uniform * 0.007 * 255.0 * 12f64.sqrt()) as u8])
    })
}

/// From the robot's eye every code that lies wholly in the picture is found, at the place the list gives.
#[test]
fn codes_are_found_from_the_robots_eye() {
    let world = tag_ceiling();
    let ceiling = model(&world, "tag_ceiling");
    let codes = listed();
    let (mut tags_seen, mut qrs_seen) = (0, 0);
    for step in 0..20 {
        let angle = f64::from(step) * 0.314_159;
        let at = DVec3::new(2.2 * angle.cos(), 1.4 * angle.sin(), 0.36);
        let camera = Pose::from_xyz_rpy(at, DVec3::new(0.0, 0.0, angle * 1.7))
            * Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, -std::f64::consts::FRAC_PI_2, 0.0));
        let picture = photograph(ceiling, &camera);
        let mut seen = april_tags(&picture);
        seen.extend(qr_codes(&picture));
        for code in &codes {
            let is_qr = code.name.starts_with("qr");
            let wanted = code.corners.map(|corner| project(&camera, corner));
            // With its white margin: 1 of 8 modules, 4 of 25.
            let grow = if is_qr { 33.0 / 25.0 } else { 10.0 / 8.0 };
            let middle = [0, 1].map(|axis| wanted.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
            let in_picture = wanted.iter().all(|corner| {
                let [x, y] = [0, 1].map(|axis| middle[axis] + (corner[axis] - middle[axis]) * grow);
                (0.0..=639.0).contains(&x) && (0.0..=479.0).contains(&y)
            });
            if !in_picture {
                continue;
            }
            let Some(corners) = seen.get(&code.says) else {
                panic!("step {step}: {} was not found", code.name);
            };
            let tolerance_px = if is_qr { QR_TOLERANCE_PX } else { TAG_TOLERANCE_PX };
            for (found, wanted) in corners.iter().zip(wanted) {
                let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
                assert!(off < tolerance_px, "step {step}: {}: {off} px off", code.name);
            }
            if is_qr { qrs_seen += 1 } else { tags_seen += 1 }
        }
    }
    println!("{tags_seen} AprilTags and {qrs_seen} QR codes");
    assert!(tags_seen > 60 && qrs_seen > 40, "{tags_seen} AprilTags and {qrs_seen} QR codes");
}

/// From anywhere in the free area nothing stands between the camera and a code that is in its picture; and nothing
/// stands in the area.
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
                // A box around it will do.
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

/// Lamps and ambient light together never saturate white, and leave the ceiling bright enough everywhere.
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
