//! The same bytes at every SIMD level, for any number of threads, and on every machine.

mod common;

use belvedere_sensors::camera::{Mosaic, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthFrame, POINT_STEP};
use belvedere_sensors::device::depth_model::{DisparityNoise, SecondEye, published};
use belvedere_sensors::device::{DeviceConfig, Exposure, Tone, Vignetting};
use belvedere_sensors::lidar::{Beams, Lidar, Scan};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::scanner::{
    Beam, Columns, Echoes, Intensity, Laser, Pattern, Raster, Receiver, Returns, Scanner, ScannerConfig,
    Spinning, Weather, presets,
};
use belvedere_sensors::scene::{
    Air, ColourSpace, CubeTexture, InstanceConfig, LightConfig, MaterialConfig, Pbr, SceneBuilder, Shape,
    Sky, TextureAlpha,
    TextureMode::{self, Light, Reflectance},
};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Keyframe, Moment, Pose, Sensor};
use common::casts::levels;
use common::{LIDAR, add, camera, camera_of, depth_camera, picture_with, scenery, spot};
use glam::DVec3;

/// All outputs of the scenery, with names, as bytes.
fn sense_all(execution: Execution) -> Vec<(&'static str, Vec<u8>)> {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let scene = builder.scene();
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let noise = GaussianNoise::new(
        GaussianNoiseConfig::default().mean(0.001).stddev(0.007).bias_mean(0.002).bias_stddev(0.001),
    )
    .unwrap();
    // Neither side is a multiple of a tile's.
    let camera = camera_of([333, 245], 1.2).noise(noise);
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    let capture = Capture::new(7, builder.moment(pose));

    let depth_camera = depth_camera().camera(camera).faces(Faces::Front).max_depth_m(6.0).model(noise);
    let depth_camera = DepthCamera::new(depth_camera).unwrap();
    let pixels = depth_camera.pixels();
    let (mut metres, mut millimetres) = (vec![0.0_f32; pixels], vec![0_u16; pixels]);
    let mut points = vec![0; pixels * POINT_STEP];
    let output = DepthFrame::new().depth_32fc1(&mut metres).depth_16uc1(&mut millimetres).points(&mut points);
    depth_camera
        .sense(&scene, &capture, &mut workspace.lend(depth_camera.workspace_len(&scene, &capture)), output)
        .expect("outputs of the right size");

    // Both sides of surfaces.
    let both = DepthCamera::new(depth_camera.config().faces(Faces::Both)).unwrap();
    let (mut metres_of_both, mut points_of_both) = (metres.clone(), points.clone());
    let output = DepthFrame::new().depth_32fc1(&mut metres_of_both).points(&mut points_of_both);
    both.sense(&scene, &capture, &mut workspace.lend(both.workspace_len(&scene, &capture)), output)
        .expect("outputs of the right size");

    // Models with a second pass over the frame: shadows and noise beside the ray, dots, and modulated light.
    let device_camera = |model| DepthCamera::new(depth_camera.config().model(model)).unwrap();
    let kinect = published::nguyen().steps(published::KINECT_STEPS).second_eye(SecondEye::at(0.075));
    let locking = DisparityNoise { focal_px: 240.0, baseline_m: 0.05, stddev_px: 0.08, locking_px: 0.04 };
    let stereo =
        published::active_stereo(240.0, 0.05, 0.08, 0.6).noise(locking).matching(published::D4XX_MATCHING);
    let light = published::fankhauser().window(published::KINECT_V2_LIGHT);
    let (mut measured, mut measured_points) = (Vec::new(), points.clone());
    for model in [kinect, published::redwood(), published::icl_nuim(), stereo, light] {
        let camera = device_camera(model);
        let mut depths = metres.clone();
        let output = DepthFrame::new().depth_32fc1(&mut depths).points(&mut measured_points);
        camera
            .sense(&scene, &capture, &mut workspace.lend(camera.workspace_len(&scene, &capture)), output)
            .expect("outputs of the right size");
        measured.extend(depths);
    }

    let vertical = Beams { samples: 16, min_angle_rad: -0.4, max_angle_rad: 0.3 };
    let lidar = Lidar::new(LIDAR.vertical(vertical).noise(noise)).unwrap();
    let mut ranges = vec![0.0_f32; lidar.beams()];
    lidar
        .sense(
            &scene,
            &capture,
            &mut workspace.lend(lidar.workspace_len(&scene, &capture)),
            Scan::new().ranges(&mut ranges),
        )
        .expect("outputs of the right size");

    let lasers = lasers();
    let columns = Columns::Every { time_ns: 55_296 };
    let head = Spinning { lasers: &lasers, columns, first_azimuth_rad: 0.3, clockwise: true };
    let plain = ScannerConfig::new(Pattern::Spinning(head));
    let firings = fire(&mut workspace, &builder, pose, plain);
    // Wide beams in fog, rain and snow.
    let wide = plain
        .beam(Beam { divergence_rad: [3e-3, 1.5e-3], aperture_m: [0.0127, 0.0095], rays: 8 })
        .returns(Returns::Dual)
        .intensity(Intensity::Reflectivity)
        .receiver(Some(Receiver { resolution_m: 0.09, ..Receiver::new(60.0) }))
        .weather(Weather { visibility_m: 50.0, rain_mm_per_h: 30.0, snow_mm_per_h: 3.0 });
    let returns = fire(&mut workspace, &builder, pose, wide);
    let raster =
        Raster { pixels: [61, 33], field_rad: [1.9, 0.8], pixel_time_ns: 20_000, row_time_ns: 1_300_000 };
    let ranked = wide.returns(Returns::Ranked(3));
    let pixels = fire(&mut workspace, &builder, pose, ranked.pattern(Pattern::Raster(raster)));
    let rosette = fire(&mut workspace, &builder, pose, plain.pattern(presets::MID_70.pattern));
    let prisms = [presets::MID_360, presets::HAP]
        .map(|preset| fire(&mut workspace, &builder, pose, plain.pattern(preset.pattern)));

    // Few electrons and many, and a tone curve.
    let device = DeviceConfig::default()
        .exposure(Exposure { time_s: 1e-4, gain: 3.0 })
        .vignetting(Vignetting { natural: true, polynomial: [0.1, -0.2, 0.05] })
        .dark_current_e_per_s(500.0)
        .read_noise_e(2.0)
        .dsnu_e(1.0)
        .prnu(0.01)
        .black_level_dn(16.0);
    let developed = device.read_noise_e(0.1).tone(Tone::Srgb { white_balance: [1.4, 1.0, 1.2] });
    let camera_with = |device, format| camera.noise(GaussianNoise::NONE).device(Some(device)).format(format);
    let bayer = camera_with(device, PixelFormat::Bayer16(Mosaic::Gbrg));
    let srgb = camera_with(developed, PixelFormat::Rgba8);

    let bytes = |floats: &[f32]| floats.iter().flat_map(|x| x.to_bits().to_le_bytes()).collect();
    // The same with mirrors and panes.
    let glazed = mirrors_and_panes(builder.clone());
    let [mirrored, passed] = fire(&mut workspace, &glazed, pose, wide);
    let glazed_scene = glazed.scene();
    let capture = Capture::new(7, glazed.moment(pose));
    let mut glazed_depths = metres.clone();
    let output = DepthFrame::new().depth_32fc1(&mut glazed_depths);
    let camera_of_stereo = device_camera(stereo);
    camera_of_stereo
        .sense(
            &glazed_scene,
            &capture,
            &mut workspace.lend(camera_of_stereo.workspace_len(&glazed_scene, &capture)),
            output,
        )
        .expect("outputs of the right size");

    vec![
        ("rgb8", picture_with(&builder, camera, pose, 7, execution)),
        ("mono8", picture_with(&builder, camera.format(PixelFormat::Mono8), pose, 7, execution)),
        ("32fc1", bytes(&metres)),
        ("16uc1", millimetres.iter().flat_map(|x| x.to_le_bytes()).collect()),
        ("points", points),
        ("32fc1 of both sides", bytes(&metres_of_both)),
        ("points of both sides", points_of_both),
        ("ranges", bytes(&ranges)),
        ("firings", bytes(&firings[0])),
        ("returns", bytes(&returns.concat())),
        ("pixels", bytes(&pixels.concat())),
        ("rosette", bytes(&rosette[0])),
        ("prisms with a mirror", bytes(&prisms[0][0])),
        ("prisms", bytes(&prisms[1][0])),
        ("32fc1 of a device", bytes(&measured)),
        ("points of a device", measured_points),
        ("bayer_gbrg16", picture_with(&builder, bayer, pose, 7, execution)),
        ("rgba8 of sRGB", picture_with(&builder, srgb, pose, 7, execution)),
        (
            "rgb8 of gloss and glass",
            picture_with(&gloss_and_glass(builder.clone(), Reflectance), camera, pose, 7, execution),
        ),
        (
            "rgb8 of a texture of light",
            picture_with(&gloss_and_glass(builder.clone(), Light), camera, pose, 7, execution),
        ),
        ("rgb8 of facets", picture_with(&facets(builder.clone(), false), camera, pose, 7, execution)),
        ("rgb8 of mapped facets", picture_with(&facets(builder.clone(), true), camera, pose, 7, execution)),
        ("rgb8 of meshes with normals", picture_with(&smooth(builder.clone()), camera, pose, 7, execution)),
        (
            "rgb8 of both sides of meshes with normals",
            picture_with(&smooth(builder.clone()), camera.faces(Faces::Both), pose, 7, execution),
        ),
        ("rgb8 of cube textures", picture_with(&cubes(builder.clone()), camera, pose, 7, execution)),
        ("ranges of mirrors and panes", bytes(&mirrored)),
        ("intensities of mirrors and panes", bytes(&passed)),
        ("32fc1 of mirrors and panes", bytes(&glazed_depths)),
    ]
}

/// Sixteen lasers, beside the axis and at various azimuths.
fn lasers() -> Vec<Laser> {
    let laser = |id: u32| {
        let id = f64::from(id);
        let aside = Laser::at_degrees(2.0 * id - 15.0, 0.3 * id);
        Laser { origin_m: [0.02, -0.01, 0.002 * id], time_s: 2.304e-6 * id, ..aside }
    };
    (0..16).map(laser).collect()
}

/// Ranges and intensities of a scanner that drives and turns among objects, every other of which moves.
fn fire(
    workspace: &mut WorkspaceBuf,
    builder: &SceneBuilder,
    pose: Pose,
    config: ScannerConfig<'_>,
) -> [Vec<f32>; 2] {
    let scanner = Scanner::new(config).unwrap();
    let shift = |time: f64| Pose::from_xyz_rpy(DVec3::X * time, DVec3::new(0.1, 0.3, 2.0) * time);
    let times: Vec<_> = (0..=20).map(|step| 5e-3 * f64::from(step)).collect();
    let place = |time: f64| {
        let places = builder.poses().iter().enumerate();
        places.map(|(index, at)| if index % 2 == 0 { *at } else { *at * shift(time) }).collect()
    };
    let places: Vec<Vec<_>> = times.iter().map(|time| place(*time)).collect();
    let keyframes: Vec<_> = (times.iter().zip(&places))
        .map(|(&time_s, places)| Keyframe {
            time_s,
            at: Moment { world_from_sensor: pose * shift(time_s), world_from_instance: places },
        })
        .collect();
    let (scene, capture) = (builder.scene(), Capture::new(3, keyframes.as_slice()));
    let values = scanner.most_firings() * scanner.returns();
    let (mut ranges, mut intensities) = (vec![0.0; values], vec![0.0; values]);
    let memory = &mut workspace.lend(scanner.workspace_len(&scene, &capture));
    let output = Echoes::new().ranges(&mut ranges).intensities(&mut intensities);
    scanner.sense(&scene, &capture, memory, output).expect("outputs of the right size");
    [ranges, intensities]
}

/// The scene below a sky of a cube texture, with shapes that have it, too.
fn cubes(mut builder: SceneBuilder) -> SceneBuilder {
    let texels: Vec<[u8; 4]> =
        (0..6 * 16 * 16).map(|i| [i, 7 * i, 31 * i, 0].map(|value: u32| value as u8)).collect();
    let cube = builder.add_cube_texture(16, &texels).unwrap();
    builder.set_air(Air { sky: Some(Sky::Cube(cube)), ..Default::default() }).unwrap();
    for (texture_mode, shape, y) in [
        (Light, Shape::Capsule { radius: 0.2, length: 0.4 }, 0.8),
        (Reflectance, Shape::Box { size: [0.3, 0.4, 0.6] }, 0.2),
        (Light, Shape::Ellipsoid { radii: [0.2, 0.3, 0.4] }, -0.4),
    ] {
        let cube_texture = Some(CubeTexture { texture: cube, stretch: [1.0, 0.9, 1.2] });
        let look = MaterialConfig { cube_texture, texture_mode, emissive: [0.1; 3], ..Default::default() };
        let material = builder.add_material(&look).unwrap();
        let at = Pose::from_xyz_rpy(DVec3::new(-1.6, y, 1.1), DVec3::new(0.3, 0.5, 0.7));
        add(&mut builder, shape, at, material);
    }
    builder
}

/// The scene with a mirroring ball and two panes in front of everything.
fn mirrors_and_panes(mut builder: SceneBuilder) -> SceneBuilder {
    for (specular_reflectance, transmittance, shape, y) in [
        (0.9, 0.0, Shape::Sphere { radius: 0.4 }, 0.8),
        (0.1, 0.85, Shape::Box { size: [0.1, 0.7, 0.9] }, -0.4),
        (0.05, 0.9, Shape::Cylinder { radius: 0.3, length: 0.9 }, 0.2),
    ] {
        let look = MaterialConfig { specular_reflectance, transmittance, ..Default::default() };
        let material = builder.add_material(&look).unwrap();
        add(&mut builder, shape, Pose::from_translation(DVec3::new(-1.6, y, 1.1)), material);
    }
    builder
}

/// The scene with a glossy ball, a ball of glass and a pane with holes in it, in linear light.
fn gloss_and_glass(mut builder: SceneBuilder, texture_mode: TextureMode) -> SceneBuilder {
    builder.set_colour_space(ColourSpace::Srgb);
    let texels = [[255, 200, 100, 255], [0, 0, 0, 0], [50, 60, 70, 120], [9, 250, 3, 200]];
    let texture = Some(builder.add_texture(2, 2, &texels).unwrap());
    let gloss = MaterialConfig { specular: [0.6, 0.5, 0.4], shininess: 25.0, ..Default::default() };
    let texture_alpha = TextureAlpha::Blended;
    for (config, shape, y) in [
        (gloss, Shape::Sphere { radius: 0.4 }, 0.8),
        (MaterialConfig { alpha: 0.4, ..gloss }, Shape::Sphere { radius: 0.5 }, -0.4),
        (
            MaterialConfig { texture, texture_alpha, texture_mode, ..gloss },
            Shape::Box { size: [0.1, 0.7, 0.9] },
            0.3,
        ),
    ] {
        let material = builder.add_material(&config).unwrap();
        add(&mut builder, shape, Pose::from_translation(DVec3::new(-1.6, y, 1.1)), material);
    }
    let kind = spot([-2.5, 0.5, 2.5], DVec3::new(0.6, 0.0, -0.8), [0.9, 0.7, 1.7]);
    builder.add_light(&LightConfig { kind, specular: [0.9; 3], ..Default::default() }).unwrap();
    builder
}

/// The scene with balls and a box of metal and plastic, one of them with a texture; with maps if they are `mapped`.
fn facets(mut builder: SceneBuilder, mapped: bool) -> SceneBuilder {
    let texels = [[255, 200, 100, 255], [90, 80, 9, 255], [50, 60, 70, 255], [9, 250, 3, 255]];
    let texture = Some(builder.add_texture(2, 2, &texels).unwrap());
    let pbr_map = mapped.then(|| builder.add_pbr_map(2, 2, &texels).unwrap());
    let emissive_map = texture.filter(|_| mapped);
    let emissive = if mapped { [0.2; 3] } else { [0.0; 3] };
    let shapes =
        [Shape::Sphere { radius: 0.4 }, Shape::Sphere { radius: 0.5 }, Shape::Box { size: [0.4; 3] }];
    let looks = [(0.1, 1.0, None, 0.8), (0.4, 0.0, None, -0.4), (0.7, 0.5, texture, 0.3)];
    for (shape, (roughness, metalness, texture, y)) in shapes.into_iter().zip(looks) {
        let pbr = Some(Pbr { roughness, metalness, highlights: [1.0, 0.9, 0.8] });
        let config = MaterialConfig { pbr, pbr_map, emissive, emissive_map, texture, ..Default::default() };
        let material = builder.add_material(&config).unwrap();
        add(&mut builder, shape, Pose::from_translation(DVec3::new(-1.6, y, 1.1)), material);
    }
    let kind = spot([-2.5, 0.5, 2.5], DVec3::new(0.6, 0.0, -0.8), [0.9, 0.7, 1.7]);
    builder.add_light(&LightConfig { kind, specular: [0.9; 3], ..Default::default() }).unwrap();
    builder
}

/// The scene with two coarse vases that have a normal per vertex: a textured one and a shiny one, scaled.
fn smooth(mut builder: SceneBuilder) -> SceneBuilder {
    const SIDES: [[f32; 2]; 6] =
        [[1.0, 0.0], [0.5, 0.9], [-0.5, 0.9], [-1.0, 0.0], [-0.5, -0.9], [0.5, -0.9]];
    let rings = [(0.3, -0.5), (0.5, -0.2), (0.35, 0.2), (0.45, 0.5_f32)];
    let of_rings = |of: &dyn Fn([f32; 2], (f32, f32)) -> [f32; 3]| -> Vec<[f32; 3]> {
        rings.iter().flat_map(|ring| SIDES.iter().map(|side| of(*side, *ring))).collect()
    };
    let corners = of_rings(&|[x, y], (radius, z)| [radius * x, radius * y, z]);
    let normals = of_rings(&|[x, y], (radius, z)| [x, y, radius - 0.4 + z * 0.1]);
    let uvs: Vec<[f32; 2]> = corners.iter().map(|[x, y, z]| [x + y, *z]).collect();
    let quad = |ring: u32, side: u32| {
        let next = (side + 1) % 6;
        let [a, b, c, d] = [6 * ring + side, 6 * ring + next, 6 * ring + 6 + side, 6 * ring + 6 + next];
        [[a, b, c], [b, d, c]]
    };
    let faces: Vec<_> = (0..3).flat_map(|ring| (0..6).flat_map(move |side| quad(ring, side))).collect();
    let mesh = builder.add_mesh(&corners, &uvs, &faces).unwrap();
    builder.set_mesh_normals(mesh, &normals).unwrap();
    let texels = [[255, 200, 100, 255], [90, 80, 9, 255], [50, 60, 70, 255], [9, 250, 3, 255]];
    let texture = Some(builder.add_texture(2, 2, &texels).unwrap());
    let pbr = Some(Pbr { roughness: 0.3, metalness: 0.2, highlights: [1.0, 0.9, 0.8] });
    for (texture, pbr, y, scale) in [(texture, None, 0.6, [1.0; 3]), (None, pbr, -0.4, [0.7, -1.1, 0.9])] {
        let material = builder.add_material(&MaterialConfig { texture, pbr, ..Default::default() }).unwrap();
        let world_from_instance = Pose::from_translation(DVec3::new(-1.6, y, 1.1));
        let shape = Shape::Mesh(mesh);
        let config = InstanceConfig { shape, world_from_instance, material, scale, ..Default::default() };
        builder.add_instance(&config).unwrap();
    }
    builder
}

#[test]
fn every_level() {
    let expected = sense_all(Execution::at(Level::baseline()));
    for (name, level) in levels() {
        let Some(level) = level else {
            println!("this machine has no {name}: not tested");
            continue;
        };
        for (expected, found) in expected.iter().zip(sense_all(Execution::at(level))) {
            assert!(*expected == found, "{} differs at {name}", found.0);
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn any_number_of_threads() {
    let expected = sense_all(Execution::default());
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for (expected, found) in expected.iter().zip(pool.install(|| sense_all(Execution::parallel()))) {
            assert!(*expected == found, "{} differs with {threads} threads", found.0);
        }
    }
}

/// Fowler, Noll and Vo's hash, 1a, 64 bits.
fn fnv(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn every_machine() {
    let expected: [(&str, u64); 28] = [
        ("rgb8", 0xe27f_c2a5_80e6_90f1),
        ("mono8", 0xbf0b_140d_d77e_a4a0),
        ("32fc1", 0xbffd_71f0_3bfb_bc79),
        ("16uc1", 0xbc3f_3d55_accd_1eab),
        ("points", 0x24cd_1139_23b9_13ef),
        ("32fc1 of both sides", 0x0862_62f4_57da_2606),
        ("points of both sides", 0x447b_6f0f_6699_3294),
        ("ranges", 0x9814_84f6_b4ad_3848),
        ("firings", 0x3932_041a_7598_5374),
        ("returns", 0x8833_71ef_54fe_0644),
        ("pixels", 0x1c74_6ccf_2ee2_4c1c),
        ("rosette", 0x1002_5aa6_f5a3_3948),
        ("prisms with a mirror", 0xba88_83ff_322a_8d60),
        ("prisms", 0xe60a_ba93_e160_ba67),
        ("32fc1 of a device", 0x85a2_9dfb_bc21_8ed4),
        ("points of a device", 0xbb8f_2f86_ac28_b956),
        ("bayer_gbrg16", 0xe132_1176_b7dd_c0e3),
        ("rgba8 of sRGB", 0x5d94_93b7_3efb_42af),
        ("rgb8 of gloss and glass", 0x2c18_2a64_e3af_3e53),
        ("rgb8 of a texture of light", 0xb748_c137_3797_4a71),
        ("rgb8 of facets", 0x67fa_f293_d640_2f8d),
        ("rgb8 of mapped facets", 0x8a99_00de_2846_e67c),
        ("rgb8 of meshes with normals", 0x1842_d74c_c512_5f28),
        ("rgb8 of both sides of meshes with normals", 0xaa1b_5e80_3110_39fe),
        ("rgb8 of cube textures", 0x2797_350d_efbb_210d),
        ("ranges of mirrors and panes", 0xe32c_707c_86a7_e51a),
        ("intensities of mirrors and panes", 0xd852_0a22_7b22_d8ec),
        ("32fc1 of mirrors and panes", 0xc7c7_aba7_92a6_86d0),
    ];
    let found: Vec<_> =
        sense_all(Execution::default()).into_iter().map(|(name, bytes)| (name, fnv(&bytes))).collect();
    assert_eq!(
        found, expected,
        "a change that is meant to change frames changes these too: found {found:#x?}"
    );
}

#[test]
fn every_run() {
    let pose = Pose::IDENTITY;
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let config = camera().noise(GaussianNoise::of_stddev(0.007).unwrap());
    let picture = |seed, frame| picture_with(&builder, config.seed(seed), pose, frame, Execution::default());
    assert!(picture(1, 0) == picture(1, 0));
    assert!(picture(1, 0) != picture(2, 0) && picture(1, 0) != picture(1, 1));
}
