//! Smooth edges against pictures with 64 rays per pixel, and against the transfer function of the box filter.
#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common::exactness::geosphere;
use crate::common::{Stage, add, glowing, look_at, picture, picture_with};
use belvedere_sensors::camera::{CameraConfig, Edges, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, POINT_STEP};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, Lens, Pinhole, PinholeGrid, RayTableBuf};
use belvedere_sensors::scene::{
    Environment, LightConfig, LightKind, MaterialConfig, MaterialId, SceneBuilder, Shape,
};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Pose, Sensor};
use core::f64::consts::PI;
use glam::{DVec2, DVec3};

/// Neither side is a multiple of a tile's.
const SIZE: [u32; 2] = [203, 151];
/// The number of columns and rows of rays per pixel of a reference.
const FINER: u32 = 8;

/// A lens with this many times as many pixels across and down as another.
struct Finer<L>(L, u32);

impl<L: Lens> Lens for Finer<L> {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let pixel = self.0.project(point_in_optical)?;
        Some((pixel + 0.5) * f64::from(self.1) - 0.5)
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        self.0.unproject((pixel + 0.5) / f64::from(self.1) - 0.5)
    }
}

/// The pinhole of a picture, or of a finer one with the same view.
fn pinhole(finer: u32) -> CameraConfig<'static> {
    let [width, height] = SIZE.map(|size| size * finer);
    CameraConfig::new(PinholeGrid::from_fov(width, height, 1.2).unwrap()).seed(1)
}

fn fisheye(finer: u32) -> RayTableBuf {
    let [width, height] = SIZE;
    let middle = [width, height].map(|size| (f64::from(size) - 1.0) / 2.0);
    let intrinsics = Intrinsics { fx: 70.0, fy: 70.5, cx: middle[0] + 0.3, cy: middle[1] - 0.2, skew: 0.0 };
    let lens = KannalaBrandt::new(intrinsics, [0.02, -0.01, 3e-3, -1e-3]).unwrap();
    RayTableBuf::from_lens(width * finer, height * finer, &Finer(lens, finer)).unwrap()
}

/// The means over the pixels of a finer picture, linear in its bytes.
fn means(fine: &[u8]) -> Vec<f64> {
    let [width, height] = SIZE.map(|size| size as usize);
    let finer = FINER as usize;
    let mut means = vec![0.0; width * height * 3];
    for (row, line) in fine.chunks(width * finer * 3).enumerate() {
        for (column, pixel) in line.chunks(3).enumerate() {
            for (channel, value) in pixel.iter().enumerate() {
                let place = ((row / finer) * width + column / finer) * 3 + channel;
                means[place] += f64::from(*value) / f64::from(FINER * FINER);
            }
        }
    }
    means
}

/// The peak signal-to-noise ratio of a picture in decibels.
fn psnr(found: &[u8], expected: &[f64]) -> f64 {
    let squares = found.iter().zip(expected).map(|(found, expected)| (f64::from(*found) - expected).powi(2));
    10.0 * (255.0 * 255.0 * expected.len() as f64 / squares.sum::<f64>()).log10()
}

/// The ratios of a sharp and of a smooth picture.
fn compare<'a>(
    stage: impl Into<Stage<'a>>,
    once: CameraConfig<'_>,
    finer: CameraConfig<'_>,
    pose: Pose,
) -> [f64; 2] {
    let stage = stage.into();
    let reference = means(&picture(stage, finer, pose));
    [Edges::Sharp, Edges::Smooth].map(|edges| psnr(&picture(stage, once.edges(edges), pose), &reference))
}

fn plain(builder: &mut SceneBuilder, colour: [f32; 3]) -> MaterialId {
    let config = MaterialConfig { diffuse: colour, ambient: colour, ..MaterialConfig::default() };
    builder.add_material(&config).unwrap()
}

fn lamp(builder: &mut SceneBuilder, kind: LightKind, diffuse: [f32; 3]) {
    let config = LightConfig { kind, diffuse, range_m: 50.0, cast_shadows: true, ..Default::default() };
    builder.add_light(&config).unwrap();
}

/// A hall of posts, with the shadows of two lamps, in front of the sky.
fn posts() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.3; 3], background: [0.6, 0.7, 0.9] });
    let [grey, red, pale] =
        [[0.5, 0.5, 0.45], [0.8, 0.25, 0.2], [0.85, 0.85, 0.8]].map(|colour| plain(&mut builder, colour));
    add(&mut builder, Shape::Box { size: [12.0, 12.0, 0.1] }, Pose::from_translation(DVec3::Z * -0.05), grey);
    for index in 0..18 {
        let i = f64::from(index);
        let at = DVec3::new((i * 0.618).fract() * 6.0, (i * 0.414).fract() * 6.0 - 3.0, 0.6);
        let turned = Pose::from_xyz_rpy(at, DVec3::new(0.1 * i.sin(), 0.1 * i.cos(), i));
        let (shape, material) = match index % 3 {
            0 => (Shape::Box { size: [0.15, 0.2, 1.2] }, red),
            1 => (Shape::Cylinder { radius: 0.1, length: 1.2 }, pale),
            _ => (Shape::Cone { radius: 0.25, length: 1.2 }, red),
        };
        add(&mut builder, shape, turned, material);
    }
    lamp(&mut builder, LightKind::Point { position: [-1.0, 2.0, 3.0] }, [0.4; 3]);
    lamp(&mut builder, LightKind::Directional { direction: [0.5, -0.3, -1.0] }, [0.3, 0.3, 0.25]);
    builder
}

/// Meshes, one of them concave, and a height field with a pattern of squares on it.
fn meshes() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.4; 3], background: [0.2, 0.25, 0.3] });
    let texels: Vec<[u8; 4]> =
        (0..64 * 64).map(|i| if (i % 64 / 8 + i / 64 / 8) % 2 == 0 { [220; 4] } else { [60; 4] }).collect();
    let texture = Some(builder.add_texture(64, 64, &texels).unwrap());
    let squares = builder.add_material(&MaterialConfig { texture, ..MaterialConfig::default() }).unwrap();
    let blue = plain(&mut builder, [0.3, 0.4, 0.8]);
    let (vertices, triangles) = geosphere(3);
    let star: Vec<[f32; 3]> = vertices
        .iter()
        .map(|[x, y, z]| [x, y, z].map(|c| c * (0.5 + 0.3 * (9.0 * x).sin() * (7.0 * y + 2.0 * z).cos())))
        .collect();
    let star = builder.add_mesh(&star, &[], &triangles).unwrap();
    let heights: Vec<f32> =
        (0..25 * 25).map(|i| 0.3 * ((i % 25) as f32 * 0.7).sin() * ((i / 25) as f32 * 0.5).cos()).collect();
    let field = builder.add_height_field(25, 25, [8.0, 8.0], &heights).unwrap();
    let ground = Pose::from_translation(DVec3::new(3.0, 0.0, -0.6));
    add(&mut builder, Shape::HeightField(field), ground, squares);
    for (index, material) in [blue, squares, blue].into_iter().enumerate() {
        let at = DVec3::new(1.6 + index as f64, index as f64 - 1.0, 0.1);
        add(&mut builder, Shape::Mesh(star), Pose::from_xyz_rpy(at, DVec3::splat(index as f64)), material);
    }
    lamp(&mut builder, LightKind::Point { position: [0.0, -1.0, 3.0] }, [0.6; 3]);
    builder
}

/// Sheets with black and white squares, like tags, at many distances and angles, between posts.
fn tags() -> SceneBuilder {
    let mut builder = posts();
    for tag in 0..12_u32 {
        let bit = |x: u32, y: u32| (x * 7 + y * 13 + tag * 5 + x * y).is_multiple_of(3);
        let white = |x: u32, y: u32| (1..9).contains(&x) && (1..9).contains(&y) && bit(x, y);
        let texels: Vec<[u8; 4]> =
            (0..160 * 160).map(|i| [if white(i % 160 / 16, i / 160 / 16) { 230 } else { 15 }; 4]).collect();
        let texture = Some(builder.add_texture(160, 160, &texels).unwrap());
        let material =
            builder.add_material(&MaterialConfig { texture, ..MaterialConfig::default() }).unwrap();
        let i = f64::from(tag);
        let at = DVec3::new(0.5 + (i * 0.53).fract() * 5.0, (i * 0.29).fract() * 5.0 - 2.5, 0.4 + i * 0.08);
        let turned =
            Pose::from_xyz_rpy(at, DVec3::new(0.2 * i, -PI / 2.0 + 0.3 * (2.0 * i).sin(), 0.4 * i.cos()));
        add(&mut builder, Shape::Box { size: [0.6, 0.6, 0.02] }, turned, material);
    }
    builder
}

/// Scenes with a name and a viewpoint.
fn worlds() -> [(&'static str, SceneBuilder, Pose); 3] {
    let from = |eye: DVec3| look_at(eye, DVec3::new(2.0, 0.0, 0.2), 0.1);
    [
        ("posts", posts(), from(DVec3::new(-2.5, 0.4, 1.3))),
        ("tags", tags(), from(DVec3::new(-2.0, 0.3, 1.0))),
        ("meshes", meshes(), from(DVec3::new(-1.2, 0.2, 0.8))),
    ]
}

#[test]
fn smooth_edges_are_close_to_many_rays_per_pixel() {
    for (name, builder, pose) in &worlds() {
        let [sharp, smooth] = compare(builder, pinhole(1), pinhole(FINER), *pose);
        println!("{name}: sharp {sharp:.2} dB, smooth {smooth:.2} dB");
        assert!(
            smooth >= 38.0 && smooth > sharp + 3.0,
            "{name}: {smooth} dB, and {sharp} dB with sharp edges"
        );
        let [once, finer] = [1, FINER].map(fisheye);
        let [sharp, smooth] = compare(builder, CameraConfig::new(&once), CameraConfig::new(&finer), *pose);
        println!("{name} through a fisheye: sharp {sharp:.2} dB, smooth {smooth:.2} dB");
        assert!(
            smooth >= 38.0 && smooth > sharp + 3.0,
            "{name}: {smooth} dB, and {sharp} dB with sharp edges"
        );
    }
}

/// sin(πx) / πx.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// The modulation transfer at some frequencies (cycles per pixel) across the edge of a bright sheet that is at `angle`
/// to the columns, by the method of ISO 12233: the profile across the edge in bins of an eighth of a pixel, and the
/// spectrum of its derivative. The attenuation by bins and differences is compensated.
fn transfer<const N: usize>(edges: Edges, angle: f64, frequencies: [f64; N]) -> [f64; N] {
    const BINS: usize = 8;
    const REACH: usize = 4;
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.1; 3] });
    let white = glowing(&mut builder, [0.9; 3]);
    let sheet = Pose::from_xyz_rpy(DVec3::new(2.0, 50.0, 0.0), DVec3::new(0.0, -PI / 2.0, 0.0));
    add(&mut builder, Shape::Rectangle { size: [100.0, 100.0] }, sheet, white);
    let [width, height] = [320, 1000];
    // The edge goes through the middle.
    let lens = Pinhole::new(Intrinsics { fx: 700.0, fy: 700.0, cx: 160.2, cy: 499.6, skew: 0.0 }).unwrap();
    let config = CameraConfig::new(PinholeGrid::new(width, height, lens).unwrap()).format(PixelFormat::Mono8);
    let seen = picture(&builder, config.edges(edges), Pose::from_xyz_rpy(DVec3::ZERO, DVec3::X * angle));
    let mut profile = [[0.0_f64; 2]; 2 * REACH * BINS];
    let (sin, cos) = angle.sin_cos();
    for (index, value) in seen.iter().enumerate() {
        let (column, row) = (index % width as usize, index / width as usize);
        let away = (column as f64 - 160.2) * cos - (row as f64 - 499.6) * sin;
        let bin = ((away + REACH as f64) * BINS as f64).floor();
        if bin >= 0.0 && bin < profile.len() as f64 {
            let [sum, count] = &mut profile[bin as usize];
            (*sum, *count) = (*sum + f64::from(*value), *count + 1.0);
        }
    }
    let profile = profile.map(|[sum, count]| sum / count);
    let contrast = profile[0] - profile[profile.len() - 1];
    frequencies.map(|frequency| {
        let mut spectrum = DVec2::ZERO;
        for (bin, pair) in profile.windows(2).enumerate() {
            let phase = 2.0 * PI * frequency * bin as f64 / BINS as f64;
            spectrum += DVec2::new(phase.cos(), phase.sin()) * (pair[0] - pair[1]);
        }
        spectrum.length() / contrast / sinc(frequency / BINS as f64).powi(2)
    })
}

#[test]
fn a_slanted_edge_has_the_transfer_of_a_box_filter() {
    let frequencies = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5];
    for degrees in [5.0_f64, -7.0, 33.0, 84.0] {
        let angle = degrees.to_radians();
        let (sin, cos) = angle.sin_cos();
        let expected = frequencies.map(|frequency| (sinc(frequency * cos) * sinc(frequency * sin)).abs());
        let smooth = transfer(Edges::Smooth, angle, frequencies);
        let sharp = transfer(Edges::Sharp, angle, frequencies);
        println!("{degrees}°: {smooth:.3?}, box {expected:.3?}, sharp {sharp:.3?}");
        for (index, frequency) in frequencies.iter().enumerate() {
            let off = smooth[index] / expected[index] - 1.0;
            assert!(off.abs() < 0.04, "{degrees}°, {frequency}: {} of {}", smooth[index], expected[index]);
            // With one ray per pixel, nothing is attenuated.
            assert!((sharp[index] - 1.0).abs() < 0.04, "{degrees}°, {frequency}: {}", sharp[index]);
        }
    }
}

#[test]
fn pixels_without_edges_keep_their_bits() {
    let noise = GaussianNoise::of_stddev(0.02).unwrap();
    // A patterned floor up to the horizon, which is outside the picture.
    let mut builder = SceneBuilder::new();
    let texels: Vec<[u8; 4]> =
        (0..32 * 32).map(|i| [if (i % 32 / 4 + i / 128) % 2 == 0 { 250 } else { 5 }; 4]).collect();
    let texture = Some(builder.add_texture(32, 32, &texels).unwrap());
    let config = MaterialConfig { texture, texture_repeat: [40.0; 2], ..MaterialConfig::default() };
    let floor = builder.add_material(&config).unwrap();
    add(&mut builder, Shape::Rectangle { size: [40.0; 2] }, Pose::IDENTITY, floor);
    lamp(&mut builder, LightKind::Point { position: [1.0, 0.0, 3.0] }, [0.5; 3]);
    let pose = Pose::from_xyz_rpy(DVec3::Z, DVec3::new(0.0, 0.8, 0.3));
    let taken =
        |builder: &SceneBuilder, pose, edges| picture(builder, pinhole(1).noise(noise).edges(edges), pose);
    let sharp = taken(&builder, pose, Edges::Sharp);
    assert!(sharp == taken(&builder, pose, Edges::Smooth), "edges were found where there are none");

    // In another scene, only few pixels change.
    let (_, builder, pose) = &worlds()[0];
    let (sharp, smooth) = (taken(builder, *pose, Edges::Sharp), taken(builder, *pose, Edges::Smooth));
    let changed = sharp.chunks(3).zip(smooth.chunks(3)).filter(|(sharp, smooth)| sharp != smooth).count();
    let share = changed as f64 * 3.0 / sharp.len() as f64;
    assert!((0.01..0.15).contains(&share), "{share} of the pixels are others");
}

#[test]
fn depth_cameras_colours_are_the_same() {
    let (_, builder, pose) = &worlds()[0];
    let config = pinhole(1).edges(Edges::Smooth);
    let expected = picture(builder, config, *pose);
    let camera = DepthCamera::new(DepthCameraConfig::new(config)).unwrap();
    let (mut colour, mut points) = (vec![0; expected.len()], vec![0; camera.pixels() * POINT_STEP]);
    let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(*pose)));
    let mut memory = WorkspaceBuf::default();
    let frame = DepthFrame::new().colour(&mut colour).points(&mut points);
    camera.sense_in(&mut memory, &scene, &capture, frame).unwrap();
    assert!(colour == expected, "the colours differ");
    for (pixel, point) in expected.chunks(3).zip(points.chunks(POINT_STEP)) {
        assert_eq!([point[18], point[17], point[16]], pixel);
    }
}

/// Smooth pictures of all scenes, with noise, through a pinhole and a fisheye.
fn all_pictures(execution: Execution) -> Vec<Vec<u8>> {
    let noise = GaussianNoise::new(
        GaussianNoiseConfig::default().mean(0.001).stddev(0.007).bias_mean(0.002).bias_stddev(0.001),
    )
    .unwrap();
    let table = fisheye(1);
    let configs =
        [pinhole(1), CameraConfig::new(&table)].map(|config| config.noise(noise).edges(Edges::Smooth));
    let take = |(_, builder, pose): &(&str, SceneBuilder, Pose)| {
        configs.map(|config| picture_with(builder, config, *pose, 3, execution))
    };
    worlds().iter().flat_map(take).collect()
}

#[test]
fn the_same_bits_for_all_levels_and_threads() {
    let expected = all_pictures(Execution::at(Level::baseline()));
    let best = Level::new();
    let mut levels = vec![("the best level", Some(best))];
    #[cfg(target_arch = "x86_64")]
    levels.extend([
        ("SSE2", best.as_sse2().map(Level::Sse2)),
        ("AVX2", best.as_avx2().map(Level::Avx2)),
        ("AVX-512", best.as_avx512().map(Level::Avx512)),
    ]);
    for (name, level) in levels {
        match level {
            Some(level) => {
                assert!(all_pictures(Execution::at(level)) == expected, "{name} differs");
            }
            None => println!("this machine has no {name}: not tested"),
        }
    }
    #[cfg(feature = "rayon")]
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| all_pictures(Execution::parallel()));
        assert!(found == expected, "{threads} threads differ");
    }
}
