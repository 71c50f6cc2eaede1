//! Fog and sky against their formulas in f64.

use crate::common::oracle::{first_hit, pixel_ray};
use crate::common::{add, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::{CameraConfig, Edges};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
use belvedere_sensors::scene::{
    Air, Environment, Fog, FogLaw, MaterialConfig, Scene, SceneBuilder, SceneError, Shape, Sky,
};
use belvedere_sensors::trace::Faces;
use glam::DVec3;

const FLOOR: Shape = Shape::Rectangle { size: [60.0, 20.0] };
const COLOUR: [f32; 3] = [0.9, 0.6, 0.3];
const BACKGROUND: [f32; 3] = [0.1, 0.2, 0.4];

/// A floor of one colour in this air, under a background.
fn floor(air: Air, alpha: f32) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [1.0; 3], background: BACKGROUND });
    builder.set_air(air).unwrap();
    let look = MaterialConfig { ambient: [0.2, 0.4, 0.1], alpha, ..Default::default() };
    let material = builder.add_material(&look).unwrap();
    add(&mut builder, FLOOR, Pose::IDENTITY, material);
    builder
}

/// The part of a surface's own colour that is left at a depth.
type Share = fn(f64) -> f64;

fn laws() -> [(FogLaw, Share); 3] {
    [
        (FogLaw::Linear { start_m: 2.0, end_m: 9.0 }, |depth| ((9.0 - depth) / 7.0).clamp(0.0, 1.0)),
        (FogLaw::Exponential { density_per_m: 0.25 }, |depth| (-0.25 * depth).exp()),
        (FogLaw::ExponentialSquared { density_per_m: 0.125 }, |depth| (-(0.125 * depth).powi(2)).exp()),
    ]
}

/// Compares a picture with the colours of rays, which are given the depth at which they hit the floor, if they do, and
/// their direction of length 1.
fn compare(
    builder: &SceneBuilder,
    config: &CameraConfig<'_>,
    expected: impl Fn(Option<f64>, DVec3) -> [f64; 3],
) {
    let eye = look_at(DVec3::new(-2.0, -0.5, 1.5), DVec3::new(3.0, 0.3, 1.0), 0.3);
    let pixels = picture(builder, *config, eye);
    let [mut hits, mut misses] = [0; 2];
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let ray = pixel_ray(config, &eye, index as u32 % 160, index as u32 / 160);
        // The directions of a pinhole's rays have length 1 along the axis.
        let depth = first_hit(&FLOOR, &Pose::IDENTITY, &ray, 0.0, false);
        if depth.is_some() {
            hits += 1;
        } else {
            misses += 1;
        }
        for (value, expected) in pixel.iter().zip(expected(depth, ray.direction.normalize())) {
            let error = (f64::from(*value) - 255.0 * expected).abs();
            assert!(error < 0.51, "pixel {index} at {depth:?} is {pixel:?}, should be {}", expected * 255.0);
        }
    }
    assert!(hits > 5000 && misses > 5000, "{hits} {misses}");
}

fn wide(values: [f32; 3]) -> [f64; 3] {
    values.map(f64::from)
}

/// As in Ogre, fog grows with the depth along the optical axis, and there is none in front of the background.
#[test]
fn fog_hides_surfaces_by_their_depth() {
    for (law, share) in laws() {
        let air = Air { fog: Some(Fog { colour: COLOUR, law }), sky: None };
        for alpha in [1.0_f32, 0.5] {
            compare(&floor(air, alpha), &camera_of([160, 120], 1.2), |depth, _| {
                let Some(depth) = depth else { return wide(BACKGROUND) };
                let share = share(depth);
                core::array::from_fn(|channel| {
                    let own = f64::from([0.2_f32, 0.4, 0.1][channel]);
                    let seen = own * share + f64::from(COLOUR[channel]) * (1.0 - share);
                    let alpha = f64::from(alpha);
                    seen * alpha + f64::from(BACKGROUND[channel]) * (1.0 - alpha)
                })
            });
        }
    }
}

/// In a fisheye, whose rays may be at right angles to its axis, the depth is the distance: that of a ball around it is
/// the same everywhere.
#[test]
fn fog_of_a_fisheye() {
    let lens = Intrinsics { fx: 20.0, fy: 20.0, cx: 31.5, cy: 31.5, skew: 0.0 };
    let rays = RayTableBuf::from_lens(64, 64, &KannalaBrandt::new(lens, [0.0; 4]).unwrap()).unwrap();
    for (law, share) in laws() {
        let mut builder = floor(Air { fog: Some(Fog { colour: COLOUR, law }), sky: None }, 1.0);
        let look = MaterialConfig { ambient: [0.5; 3], ..Default::default() };
        let material = builder.add_material(&look).unwrap();
        let at = Pose::from_translation(DVec3::Z * 50.0);
        add(&mut builder, Shape::Sphere { radius: 4.0 }, at, material);
        for edges in [Edges::Sharp, Edges::Smooth] {
            let config = CameraConfig::new(&rays).faces(Faces::Both).edges(edges);
            let pixels = picture(&builder, config, at);
            let pixel = pixels.as_chunks::<3>().0[32 * 64 + 32];
            for (value, colour) in pixel.iter().zip(wide(COLOUR)) {
                let expected = 255.0 * (0.5 * share(4.0) + colour * (1.0 - share(4.0)));
                assert!((f64::from(*value) - expected).abs() < 0.51, "{pixel:?} {expected}");
            }
            let seen = pixels.as_chunks::<3>().0.iter().filter(|other| **other == pixel).count();
            assert!(seen > 3000, "{seen}");
        }
    }
}

#[test]
fn the_sky_depends_on_the_elevation() {
    for edges in [Edges::Sharp, Edges::Smooth] {
        let (zenith, horizon) = ([0.1, 0.3, 0.9], [0.9, 0.8, 0.7]);
        let builder = floor(Air { fog: None, sky: Some(Sky::Clear { zenith, horizon }) }, 1.0);
        let config = camera_of([160, 120], 1.2).edges(edges);
        if edges == Edges::Smooth {
            // Only the pixels at the edge of the floor differ.
            let eye = look_at(DVec3::new(-2.0, -0.5, 1.5), DVec3::new(3.0, 0.3, 1.0), 0.3);
            let [smooth, sharp] =
                [config, config.edges(Edges::Sharp)].map(|config| picture(&builder, config, eye));
            let differ = smooth.iter().zip(&sharp).filter(|(one, other)| one != other).count();
            assert!(differ < 3 * 600, "{differ}");
            continue;
        }
        compare(&builder, &config, |depth, direction| {
            if depth.is_some() {
                return wide([0.2, 0.4, 0.1]);
            }
            let share = 1.0 - (1.0 - direction.z.max(0.0)).powi(2);
            core::array::from_fn(|channel| {
                let [zenith, horizon] = [zenith, horizon].map(|colour| f64::from(colour[channel]));
                horizon + (zenith - horizon) * share
            })
        });
    }
}

#[test]
fn air_is_checked_and_baked() {
    let mut builder = SceneBuilder::new();
    for law in [
        FogLaw::Linear { start_m: 2.0, end_m: 2.0 },
        FogLaw::Linear { start_m: f32::NAN, end_m: 2.0 },
        FogLaw::Exponential { density_per_m: -1.0 },
        FogLaw::ExponentialSquared { density_per_m: f32::INFINITY },
    ] {
        let fog = Some(Fog { colour: COLOUR, law });
        assert_eq!(builder.set_air(Air { fog, sky: None }), Err(SceneError::BadAir), "{law:?}");
    }
    let sky = Some(Sky::Clear { zenith: [f32::NAN; 3], horizon: COLOUR });
    assert_eq!(builder.set_air(Air { fog: None, sky }), Err(SceneError::BadAir));
    for (law, _) in laws() {
        let air = Air { fog: Some(Fog { colour: COLOUR, law }), sky: Some(Sky::DAY) };
        builder.set_air(air).unwrap();
        let baked = builder.bake();
        assert_eq!(Scene::from_baked(bytemuck::cast_slice(&baked)).unwrap().0.air(), air);
    }
}
