//! Textures are the right way up on surfaces, and neither alias nor lose a row.

use crate::common;

use crate::common::{SIZE, add, camera, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::optics::Lens;
use belvedere_sensors::scene::{
    Environment, MaterialConfig, MaterialId, SceneBuilder, Shape, fill_mip_levels, mip_levels, mip_texels,
};
use core::f64::consts::PI;
use glam::DVec3;

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const WHITE: [u8; 3] = [255; 3];

/// A builder whose ambient light shows textures unchanged.
fn bright() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [1.0; 3], background: [0.0; 3] });
    builder
}

fn material(builder: &mut SceneBuilder, width: u32, texels: &[[u8; 4]], repeat: [f32; 2]) -> MaterialId {
    let height = texels.len() as u32 / width;
    let texture = builder.add_texture(width, height, texels).unwrap();
    let config = MaterialConfig {
        ambient: [1.0; 3],
        diffuse: [0.0; 3],
        texture: Some(texture),
        texture_repeat: repeat,
        ..MaterialConfig::default()
    };
    builder.add_material(&config).unwrap()
}

/// Red and green above, blue and white below.
fn quarters(builder: &mut SceneBuilder, repeat: [f32; 2]) -> MaterialId {
    let texels: Vec<[u8; 4]> = (0..64 * 64)
        .map(|i| {
            let [r, g, b] = match (i % 64 < 32, i / 64 < 32) {
                (true, true) => RED,
                (false, true) => GREEN,
                (true, false) => BLUE,
                (false, false) => WHITE,
            };
            [r, g, b, 255]
        })
        .collect();
    material(builder, 64, &texels, repeat)
}

/// The colour of the quarter around (u, v).
fn quarter(u: f64, v: f64) -> [u8; 3] {
    match (u.rem_euclid(1.0) < 0.5, v.rem_euclid(1.0) > 0.5) {
        (true, true) => RED,
        (false, true) => GREEN,
        (true, false) => BLUE,
        (false, false) => WHITE,
    }
}

/// The colour of the pixel that shows a point of the world.
fn colour_at(pixels: &[u8], view: &Pose, point: DVec3) -> [u8; 3] {
    let lens = common::pinhole(&camera());
    let seen = view.inverse().transform_point(point);
    let pixel = lens.lens().project(DVec3::new(-seen.y, -seen.z, seen.x)).unwrap().round();
    let at = (pixel.y as usize * SIZE[0] as usize + pixel.x as usize) * 3;
    [pixels[at], pixels[at + 1], pixels[at + 2]]
}

const QUARTER_CENTRES: [(f64, f64); 4] = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];

#[test]
fn faces_of_a_box_and_a_rectangle() {
    let half = DVec3::new(0.6, 0.45, 0.3);
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    // Outward, right, up: the table in the documentation of `scene`.
    let faces = [(x, y, z), (-x, -y, z), (y, -x, z), (-y, x, z), (z, x, y), (-z, x, -y)];
    let pose = Pose::from_xyz_rpy(DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.4, -0.3, 2.0));
    for (outward, right, up) in faces {
        for shape in [Shape::Box { size: (half * 2.0).to_array() }, Shape::Rectangle { size: [1.2, 0.9] }] {
            let flat = matches!(shape, Shape::Rectangle { .. });
            if flat && outward != z {
                continue;
            }
            let mut builder = bright();
            let pattern = quarters(&mut builder, [1.0; 2]);
            add(&mut builder, shape, pose, pattern);
            let centre = if flat { DVec3::ZERO } else { outward * half };
            let eye = pose.transform_point(centre + outward * 1.5 + right * 0.2 + up * 0.1);
            let view = look_at(eye, pose.transform_point(centre), 0.3);
            let pixels = picture(&builder, camera(), view);
            for (u, v) in QUARTER_CENTRES {
                let on_face = right * (2.0 * u - 1.0) * half + up * (2.0 * v - 1.0) * half;
                let colour = colour_at(&pixels, &view, pose.transform_point(centre + on_face));
                assert_eq!(colour, quarter(u, v), "({u}, {v}) of the face {outward} of {shape:?}");
            }
        }
    }
}

#[test]
fn round_shapes_and_ends_of_a_cylinder() {
    for (shape, top, bottom, radius) in [
        (Shape::Sphere { radius: 0.5 }, 0.5, -0.5, 0.5),
        (Shape::Cylinder { radius: 0.3, length: 1.0 }, 0.5, -0.5, 0.3),
        (Shape::Capsule { radius: 0.3, length: 0.8 }, 0.7, -0.7, 0.3),
    ] {
        let mut builder = bright();
        let pattern = quarters(&mut builder, [1.0; 2]);
        add(&mut builder, shape, Pose::IDENTITY, pattern);
        for (u, v) in QUARTER_CENTRES {
            let (sin, cos) = (u * 2.0 * PI - PI).sin_cos();
            let height = bottom + v * (top - bottom);
            let across = if let Shape::Sphere { radius } = shape {
                (radius * radius - height * height).sqrt()
            } else {
                radius
            };
            let point = DVec3::new(cos * across, sin * across, height);
            let view = look_at(DVec3::new(cos * 2.0, sin * 2.0, 0.0), DVec3::ZERO, 0.0);
            let pixels = picture(&builder, camera(), view);
            assert_eq!(colour_at(&pixels, &view, point), quarter(u, v), "({u}, {v}) of {shape:?}");
        }
        if let Shape::Cylinder { radius, length } = shape {
            for sign in [1.0, -1.0] {
                let end = DVec3::Z * sign * length * 0.5;
                let view = look_at(end * 3.0 + DVec3::X * 0.1, end, 0.0);
                let pixels = picture(&builder, camera(), view);
                for (u, v) in QUARTER_CENTRES {
                    let on_end = DVec3::new(u - 0.5, (v - 0.5) * sign, 0.0) * 2.0 * radius;
                    assert_eq!(
                        colour_at(&pixels, &view, end + on_end),
                        quarter(u, v),
                        "({u}, {v}) of {sign}"
                    );
                }
            }
        }
    }
}

#[test]
fn repetition() {
    let mut builder = bright();
    let pattern = quarters(&mut builder, [3.0, 2.0]);
    add(&mut builder, Shape::Rectangle { size: [1.2, 0.9] }, Pose::IDENTITY, pattern);
    let view = look_at(DVec3::new(0.1, -0.1, 1.5), DVec3::ZERO, 0.0);
    let pixels = picture(&builder, camera(), view);
    for column in 0..6 {
        for row in 0..4 {
            let (u, v) = ((f64::from(column) + 0.5) / 6.0, (f64::from(row) + 0.5) / 4.0);
            let colour = colour_at(&pixels, &view, DVec3::new((u - 0.5) * 1.2, (v - 0.5) * 0.9, 0.0));
            assert_eq!(colour, quarter(u * 3.0, v * 2.0), "({u}, {v})");
        }
    }
}

#[test]
fn texture_coordinates_of_a_mesh() {
    // A trapezium of two triangles over the unit square, which shows the left half of the picture upside down.
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let uvs = corners.map(|[x, y, _]: [f32; 3]| [0.5 - 0.5 * x, 1.0 - y]);
    let mut builder = bright();
    let pattern = quarters(&mut builder, [1.0; 2]);
    let mesh = builder.add_mesh(&corners, &uvs, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let pose = Pose::from_xyz_rpy(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.2, 0.1, 0.4));
    add(&mut builder, Shape::Mesh(mesh), pose, pattern);
    let view = look_at(
        pose.transform_point(DVec3::new(0.5, 0.4, 1.5)),
        pose.transform_point(DVec3::new(0.5, 0.5, 0.0)),
        0.0,
    );
    let pixels = picture(&builder, camera(), view);
    for (x, y) in QUARTER_CENTRES {
        let colour = colour_at(&pixels, &view, pose.transform_point(DVec3::new(x, y, 0.0)));
        assert_eq!(colour, quarter(0.5 - 0.5 * x, 1.0 - y), "({x}, {y})");
    }
}

/// The mean and standard deviation of the red values of some rows.
fn statistics(pixels: &[u8], rows: core::ops::Range<usize>) -> (f64, f64) {
    let row_stride = SIZE[0] as usize * 3;
    let reds: Vec<f64> = pixels[rows.start * row_stride..rows.end * row_stride]
        .iter()
        .step_by(3)
        .map(|red| f64::from(*red))
        .collect();
    let mean = reds.iter().sum::<f64>() / reds.len() as f64;
    let variance = reds.iter().map(|red| (red - mean) * (red - mean)).sum::<f64>() / reds.len() as f64;
    (mean, variance.sqrt())
}

#[test]
fn a_chequered_floor_turns_grey_far_away() {
    // Squares of half a metre, up to 500 m away; the eye is 1 m above them.
    let texels: Vec<[u8; 4]> =
        (0..64 * 64).map(|i| [if (i % 64 / 32 + i / 64 / 32) % 2 == 0 { 255 } else { 0 }; 4]).collect();
    for yaw in [0.0, 0.3, 0.785] {
        let mut builder = bright();
        let pattern = material(&mut builder, 64, &texels, [1000.0; 2]);
        add(
            &mut builder,
            Shape::Rectangle { size: [1000.0; 2] },
            Pose::from_translation(DVec3::NEG_Z),
            pattern,
        );
        let view = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::Z * yaw);
        let pixels = picture(&builder, camera(), view);
        // f = 468 px: rows 243 … 252 show the floor at 134 to 37 m, where a pixel covers several squares.
        let (mean, deviation) = statistics(&pixels, 243..253);
        assert!((mean - 127.5).abs() < 2.0 && deviation < 12.0, "yaw {yaw}, far: {mean} ± {deviation}");
        // At 2 to 2.5 m a square is a hundred pixels wide: black and white.
        let (mean, deviation) = statistics(&pixels, 430..479);
        assert!((mean - 127.5).abs() < 30.0 && deviation > 110.0, "yaw {yaw}, near: {mean} ± {deviation}");
    }
}

#[test]
fn a_tag_far_away_keeps_its_brightness() {
    // A picture of odd size with 1 white texel in 5: its mean is 51 at any distance.
    let texels: Vec<[u8; 4]> = (0..35 * 21).map(|i| [if i % 5 == 0 { 255 } else { 0 }; 4]).collect();
    let mut builder = bright();
    let pattern = material(&mut builder, 35, &texels, [1.0; 2]);
    let wall = Pose::from_xyz_rpy(DVec3::X * 5.0, DVec3::new(0.0, -PI / 2.0, 0.0));
    add(&mut builder, Shape::Rectangle { size: [0.4, 0.4] }, wall, pattern);
    let pixels = picture(&builder, camera_of(SIZE, 2.0), Pose::IDENTITY);
    let sum: f64 = pixels.iter().step_by(3).map(|red| f64::from(*red)).sum();
    // f = 205.5 px: 0.4 m at 5 m are 16.4 pixels across, plus or minus one at each edge.
    let mean = sum / 16.4_f64.powi(2);
    assert!((mean - 51.0).abs() < 5.0, "mean brightness {mean}");
}

#[test]
fn mip_levels_of_any_size_keep_the_mean() {
    for (width, height) in [(1, 1), (1, 9), (7, 1), (5, 3), (31, 17), (33, 64), (100, 75), (255, 127)] {
        let mut texels = vec![[0_u8; 4]; mip_texels(width, height)];
        let count = (width * height) as usize;
        for (index, texel) in texels[..count].iter_mut().enumerate() {
            *texel =
                [(index * 37 % 256) as u8, if index % 7 == 0 { 255 } else { 0 }, (index % 251) as u8, 255];
        }
        fill_mip_levels(width, height, &mut texels);
        for channel in 0..4 {
            let sum: f64 = texels[..count].iter().map(|texel| f64::from(texel[channel])).sum();
            let last = f64::from(texels[texels.len() - 1][channel]);
            let error = (last - sum / count as f64).abs();
            // At most half a level is lost in each rounding.
            assert!(error <= 0.5 * f64::from(mip_levels(width, height)), "{width} × {height}: {error} off");
        }
    }
}
