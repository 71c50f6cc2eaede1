//! Tiles of a single colour are shaded without tracing each ray, with the same result.

use crate::common::random::tries;
use crate::common::{add, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::PixelFormat;
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
use belvedere_sensors::scene::{
    ColourSpace, Environment, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape,
};
use glam::DVec3;
use proptest::prelude::*;
use std::ops::Range;

/// The position, rotation and size of an object.
type Thing = ([f64; 3], [f64; 3], [f64; 3]);

fn thing() -> impl Strategy<Value = Thing> {
    let [any, size] = [-3.0..3.0, 0.1..2.0];
    let each = |range: Range<f64>| [range.clone(), range.clone(), range];
    ([-3.0..3.0, -3.0..3.0, -0.5..2.5], each(any), each(size))
}

/// Objects with flat faces on a floor in front of a wall and a hill, under lamps that shine from these directions.
fn room(things: &[Thing], lamps: &[[f64; 3]], space: ColourSpace) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_colour_space(space);
    builder.set_environment(Environment { ambient: [0.3, 0.25, 0.2], background: [0.2, 0.5, 0.9] });
    let paint = |builder: &mut SceneBuilder, number: usize| {
        let shade = 0.2 + 0.07 * number as f32;
        let diffuse = [shade, 1.0 - shade, 0.5];
        let gloss = if number % 5 == 4 { 20.0 } else { 0.0 };
        let config = MaterialConfig {
            diffuse,
            ambient: diffuse,
            emissive: [0.01 * number as f32, 0.0, 0.02],
            specular: [0.3; 3],
            shininess: gloss,
            ..MaterialConfig::default()
        };
        builder.add_material(&config).unwrap()
    };
    let grey = paint(&mut builder, 0);
    add(&mut builder, Shape::Plane, Pose::IDENTITY, grey);
    let wall = Pose::from_xyz_rpy(DVec3::new(4.0, 0.0, 1.0), DVec3::new(0.1, -1.5, 0.2));
    add(&mut builder, Shape::Rectangle { size: [4.0, 7.0] }, wall, grey);
    let heights: Vec<f32> = (0..42).map(|at| 0.3 * ((at * at % 17) as f32 / 17.0)).collect();
    let hill = builder.add_height_field(6, 7, [6.0, 5.0], &heights).unwrap();
    add(&mut builder, Shape::HeightField(hill), Pose::from_translation(DVec3::new(0.0, 4.0, 0.1)), grey);
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let pyramid = builder.add_mesh(&corners, &[], &faces).unwrap();
    for (number, &(at, turn, size)) in things.iter().enumerate() {
        let pose = Pose::from_xyz_rpy(DVec3::from_array(at), DVec3::from_array(turn));
        let material = paint(&mut builder, number + 1);
        let shape = match number % 4 {
            3 => Shape::Mesh(pyramid),
            2 => Shape::Sphere { radius: size[0] * 0.3 },
            _ => Shape::Box { size },
        };
        add(&mut builder, shape, pose, material);
    }
    for &direction in lamps {
        let kind = LightKind::Directional { direction };
        let config = LightConfig { kind, diffuse: [0.6, 0.5, 0.4], ..LightConfig::default() };
        builder.add_light(&config).unwrap();
    }
    builder
}

proptest! {
    #![proptest_config(tries(60))]

    /// A lamp with a position makes rays be shaded one by one. If it gives no light, the picture must not change.
    #[test]
    fn a_lamp_without_light_changes_nothing(
        things in prop::collection::vec(thing(), 0..14),
        lamps in prop::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..-0.1], 0..3),
        srgb in any::<bool>(),
        size in [1..200_u32, 1..150_u32],
        fov in 0.1..2.6,
        eye in [-6.0..-1.0, -4.0..4.0, 0.2..5.0],
        roll in -3.0..3.0,
        fisheye in any::<bool>(),
        noisy in any::<bool>(),
    ) {
        let space = if srgb { ColourSpace::Srgb } else { ColourSpace::AsGiven };
        let lit = room(&things, &lamps, space);
        let mut also_black = lit.clone();
        let black = LightConfig { diffuse: [0.0; 3], ..LightConfig::default() };
        also_black.add_light(&black).unwrap();

        let focal = f64::from(size[0]) / fov;
        let [cx, cy] = size.map(|pixels| 0.5 * f64::from(pixels) - 0.5);
        let lens = KannalaBrandt::new(Intrinsics { fx: focal, fy: focal, cx, cy, skew: 0.0 }, [0.0; 4]).unwrap();
        let table = RayTableBuf::from_lens(size[0], size[1], &lens).unwrap();
        let mut camera = camera_of(size, fov).format(PixelFormat::Rgb8);
        if fisheye {
            camera = camera.optics(&table);
        }
        if noisy {
            camera = camera.noise(GaussianNoise::of_stddev(0.01).unwrap());
        }
        let pose = look_at(DVec3::from_array(eye), DVec3::new(0.5, 0.0, 0.7), roll);
        let (without, with) = (picture(&lit, camera, pose), picture(&also_black, camera, pose));
        let differing = without.iter().zip(&with).filter(|(a, b)| a != b).count();
        prop_assert_eq!(differing, 0, "of {} bytes", with.len());
    }
}
