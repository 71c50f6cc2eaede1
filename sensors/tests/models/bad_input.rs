//! Any input to a scene or a sensor gives an error or a frame, but never a panic.

use crate::common;

use crate::common::random::tries;
use crate::common::{LIDAR, add_grey, camera_of, depth_camera};
use belvedere_sensors::camera::{Camera, CameraConfig};
use belvedere_sensors::depth::{DepthCamera, DepthFrame, POINT_STEP};
use belvedere_sensors::lidar::{Beams, Lidar, Scan, TooNear};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{
    HeightFieldId, InstanceConfig, InstanceId, LightConfig, LightKind, MaterialConfig, MaterialId, MeshId,
    Pbr, Scene, SceneBuilder, SceneError, Shape, TextureAlpha, TextureId, visibility,
};
use belvedere_sensors::trace::{WorkspaceBuf, grid_workspace_len};
use belvedere_sensors::{Capture, Pose, Rule, SenseError, Sensor};
use glam::{DQuat, DVec3};
use proptest::array::uniform3;
use proptest::collection::vec;
use proptest::prelude::*;

/// Reasonable numbers, and unreasonable ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -5.0..5.0,
        1 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-310, 1e300, -1.0]),
    ]
}

fn single() -> impl Strategy<Value = f32> {
    number().prop_map(|x| x as f32)
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        uniform3(number()).prop_map(|size| Shape::Box { size }),
        (number(), number()).prop_map(|(x, y)| Shape::Rectangle { size: [x, y] }),
        number().prop_map(|radius| Shape::Sphere { radius }),
        (number(), number()).prop_map(|(radius, length)| Shape::Cylinder { radius, length }),
        (number(), number()).prop_map(|(radius, length)| Shape::Capsule { radius, length }),
        Just(Shape::Plane),
        uniform3(number()).prop_map(|radii| Shape::Ellipsoid { radii }),
        (number(), number()).prop_map(|(radius, length)| Shape::Cone { radius, length }),
        (0_u32..4).prop_map(|mesh| Shape::Mesh(MeshId(mesh))),
        (0_u32..2).prop_map(|field| Shape::HeightField(HeightFieldId(field))),
    ]
}

fn pose() -> impl Strategy<Value = Pose> {
    (uniform3(number()), uniform3(number()), any::<bool>()).prop_map(|(xyz, rpy, quaternion)| {
        let xyz = DVec3::from_array(xyz);
        if quaternion {
            Pose::new(xyz, DQuat::from_xyzw(rpy[0], rpy[1], rpy[2], 0.0))
        } else {
            Pose::from_xyz_rpy(xyz, DVec3::from_array(rpy))
        }
    })
}

fn light() -> impl Strategy<Value = LightConfig> {
    let kind = (0..3, uniform3(number()), uniform3(number()), uniform3(single())).prop_map(
        |(kind, position, direction, [cos_inner, cos_outer, falloff])| match kind {
            0 => LightKind::Point { position },
            1 => LightKind::Directional { direction },
            _ => LightKind::Spot { position, direction, cos_inner, cos_outer, falloff },
        },
    );
    (kind, uniform3(single()), uniform3(single()), single(), uniform3(single()), any::<bool>()).prop_map(
        |(kind, diffuse, specular, range_m, attenuation, cast_shadows)| LightConfig {
            kind,
            diffuse,
            specular,
            range_m,
            attenuation,
            cast_shadows,
        },
    )
}

type MeshParts = (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>);

fn mesh() -> impl Strategy<Value = MeshParts> {
    let triangle = uniform3(prop_oneof![20 => 0_u32..5, 1 => any::<u32>()]);
    (vec(uniform3(single()), 0..8), vec([single(), single()], 0..8), vec(triangle, 0..12))
}

/// Takes one small frame of every kind.
fn sense_all(builder: &SceneBuilder, pose: Pose) {
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    let capture = Capture::new(u64::MAX, builder.moment(pose));
    let small = camera_of([37, 9], 1.2);
    let camera = DepthCamera::new(depth_camera().camera(small)).unwrap();
    let (mut metres, mut millimetres) = (vec![0.0; camera.pixels()], vec![0; camera.pixels()]);
    let (mut colour, mut points) =
        (vec![0; camera.camera().frame_len()], vec![0; camera.pixels() * POINT_STEP]);
    let output = DepthFrame::new()
        .depth_32fc1(&mut metres)
        .depth_16uc1(&mut millimetres)
        .colour(&mut colour)
        .points(&mut points);
    let expected = if pose.is_finite() { Ok(()) } else { Err(SenseError::Pose) };
    let lent = &mut workspace.lend(camera.workspace_len(&scene, &capture));
    assert_eq!(camera.sense(&scene, &capture, lent, output), expected);
    let lidar = Lidar::new(LIDAR.horizontal(Beams { samples: 70, ..LIDAR.horizontal })).unwrap();
    let mut ranges = vec![0.0; lidar.beams()];
    let lent = &mut workspace.lend(lidar.workspace_len(&scene, &capture));
    assert_eq!(lidar.sense(&scene, &capture, lent, Scan::new().ranges(&mut ranges)), expected);
    assert!(ranges.iter().all(|range| !range.is_nan()));
}

proptest! {
    #![proptest_config(tries(1500))]

    #[test]
    fn scenes(
        texture in (0_u32..70, 0_u32..5, 0_usize..350),
        material in (uniform3(single()), single(), single(), prop::option::of(0_u32..2)),
        meshes in vec(mesh(), 0..4),
        terrain in (0_u32..9, 0_u32..9, number(), vec(single(), 0..40)),
        instances in vec((shape(), pose(), uniform3(number()), 0_u32..2, single()), 0..8),
        lights in vec(light(), 0..3),
        moved in (0_u32..9, pose()),
        view in pose(),
    ) {
        let mut builder = SceneBuilder::new();
        let (width, height, texels) = texture;
        let fits = width > 0 && height > 0 && texels == (width * height) as usize;
        prop_assert_eq!(builder.add_texture(width, height, &vec![[7; 4]; texels]).is_ok(), fits);
        let (colour, u, v, texture) = material;
        let _ = builder.add_material(&MaterialConfig {
            diffuse: colour,
            texture: texture.map(TextureId),
            texture_repeat: [u, v],
            ..MaterialConfig::default()
        });
        for (positions, uvs, triangles) in &meshes {
            if let Ok(mesh) = builder.add_mesh(positions, uvs, triangles) {
                let normals: Vec<_> = positions.iter().map(|[x, y, z]| [y * x, *z, -x]).collect();
                let _ = builder.set_mesh_normals(mesh, &normals);
            }
        }
        let (rows, columns, length, heights) = terrain;
        let _ = builder.add_height_field(rows, columns, [length, 1.0], &heights);
        let flat = vec![0.5; (rows * columns) as usize];
        prop_assert_eq!(
            builder.add_height_field(rows, columns, [2.0, 1.0], &flat).is_ok(),
            rows >= 2 && columns >= 2
        );
        for (shape, world_from_instance, scale, material, laser_retro) in instances {
            let visibility = visibility::VISUAL | visibility::COLLISION;
            let material = MaterialId(material);
            let _ = builder.add_instance(&InstanceConfig {
                shape, world_from_instance, scale, material, visibility, laser_retro,
                class: laser_retro.to_bits(),
            });
        }
        for light in &lights {
            let _ = builder.add_light(light);
        }
        let (instance, pose) = moved;
        let _ = builder.set_pose(InstanceId(instance), pose);
        sense_all(&builder, view);
        let baked = builder.bake();
        let (scene, poses) = Scene::from_baked(bytemuck::cast_slice(&baked)).expect("accepted scenes can be read back");
        prop_assert_eq!(scene.instances().len(), builder.scene().instances().len());
        prop_assert_eq!(poses, builder.poses());
    }

    #[test]
    fn configurations(
        size in (any::<u32>(), 0_u32..20),
        numbers in [number(), number(), number(), number(), number(), number(), number(), number()],
        beams in (0_u32..40, prop_oneof![0_u32..20, any::<u32>()]),
    ) {
        let [fov, near, far, min, max, from, to, up] = numbers;
        let Ok(grid) = PinholeGrid::from_fov(size.0, size.1, fov) else {
            // In a very narrow field of view, the focal length overflows.
            let focal_px = f64::from(size.0) * 0.5 / (fov * 0.5).tan();
            prop_assert!(size.0 == 0 || size.1 == 0 || !(fov > 0.0 && fov < core::f64::consts::PI) || focal_px > f64::MAX / 2.0);
            return Ok(());
        };
        let camera = CameraConfig::new(grid).near_m(near).far_m(far);
        if Camera::new(camera).is_ok() {
            prop_assert!(size.0 > 0 && size.1 > 0 && fov > 0.0 && near > 0.0 && near < far);
        }
        let depth = depth_camera().camera(camera).min_depth_m(min).max_depth_m(max);
        if DepthCamera::new(depth).is_ok() {
            prop_assert!(min >= 0.0 && min < max);
        }
        let config = LIDAR.horizontal(Beams { samples: beams.0, min_angle_rad: from, max_angle_rad: to }).vertical(Beams { samples: beams.1, min_angle_rad: up, max_angle_rad: up }).range_min_m(min).range_max_m(max).too_near(TooNear::SeenThrough);
        if let Ok(lidar) = Lidar::new(config) && lidar.beams() < 1000 {
            let mut builder = SceneBuilder::new();
            add_grey(&mut builder, Shape::Sphere { radius: 2.0 }, Pose::IDENTITY);
            let scene = builder.scene();
            let mut ranges = vec![0.0; lidar.beams()];
            let capture = Capture::new(0, builder.moment(Pose::IDENTITY));
            let mut workspace = WorkspaceBuf::default();
            let lent = &mut workspace.lend(lidar.workspace_len(&scene, &capture));
            lidar.sense(&scene, &capture, lent, Scan::new().ranges(&mut ranges)).unwrap();
            prop_assert!(ranges.iter().all(|range| !range.is_nan()));
        }
    }
}

#[test]
fn every_invalid_input_gives_its_own_error() {
    let mut builder = SceneBuilder::new();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, f32::NAN, 0.0]];
    assert_eq!(builder.add_texture(0, 4, &[]), Err(SceneError::BadTexture));
    assert_eq!(builder.add_texture(2, 2, &[[0; 4]; 3]), Err(SceneError::BadTexture));
    let missing = MaterialConfig { texture: Some(TextureId(0)), ..MaterialConfig::default() };
    assert_eq!(builder.add_material(&missing), Err(SceneError::NoSuchTexture(0)));
    assert!(
        builder.add_mesh(&corners[..2], &[], &[]).is_ok(),
        "a mesh without triangles exists, and is not hit"
    );
    assert_eq!(builder.add_mesh(&corners, &[], &[[0, 1, 2]]), Err(SceneError::BadVertex(2)));
    assert_eq!(
        builder.add_mesh(&corners[..2], &[], &[[0, 1, 1], [0, 1, 2]]),
        Err(SceneError::BadTriangle(1))
    );
    assert_eq!(builder.add_mesh(&corners[..2], &[[0.0; 2]], &[[0, 1, 1]]), Err(SceneError::UvCount));
    let config = InstanceConfig {
        shape: Shape::Sphere { radius: 1.0 },
        visibility: visibility::VISUAL,
        ..Default::default()
    };
    let unknown = InstanceConfig { material: MaterialId(1), ..config };
    assert_eq!(builder.add_instance(&unknown), Err(SceneError::NoSuchMaterial(1)));
    let no_mesh = InstanceConfig { shape: Shape::Mesh(MeshId(1)), ..config };
    assert_eq!(builder.add_instance(&no_mesh), Err(SceneError::NoSuchMesh(1)));
    assert_eq!(SceneError::NoSuchMesh(1).to_string(), "the scene has no mesh 1");
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e13, 1e-13] {
        let bad = InstanceConfig { shape: Shape::Sphere { radius }, ..config };
        assert_eq!(builder.add_instance(&bad), Err(SceneError::BadSize));
    }
    for factor in [0.0, f64::NAN, f64::INFINITY, -1e13, 1e-13] {
        let bad = InstanceConfig { scale: [1.0, factor, 1.0], ..config };
        assert_eq!(builder.add_instance(&bad), Err(SceneError::BadScale));
    }
    assert_eq!(builder.add_mesh(&corners[..2], &[[0.0; 2], [0.0, f32::NAN]], &[]), Err(SceneError::BadUv(1)));
    let often = MaterialConfig { texture_repeat: [1.0, f32::INFINITY], ..MaterialConfig::default() };
    assert_eq!(builder.add_material(&often), Err(SceneError::BadTextureRepeat));
    let kind = LightKind::Point { position: [0.0, 0.0, f64::NAN] };
    assert_eq!(builder.add_light(&LightConfig { kind, ..Default::default() }), Err(SceneError::BadLight));
    for value in [-0.1, 1.1e4, f32::NAN] {
        let shiny = MaterialConfig { shininess: value, ..MaterialConfig::default() };
        assert_eq!(builder.add_material(&shiny), Err(SceneError::BadShininess));
        for pbr in [Pbr { roughness: value, ..Pbr::default() }, Pbr { metalness: value, ..Pbr::default() }] {
            let metal = MaterialConfig { pbr: Some(pbr), ..MaterialConfig::default() };
            assert_eq!(builder.add_material(&metal), Err(SceneError::BadPbr));
        }
        let clear = MaterialConfig { alpha: value, ..MaterialConfig::default() };
        assert_eq!(builder.add_material(&clear), Err(SceneError::BadAlpha));
        let texture_alpha = TextureAlpha::CutOut { least: value };
        let cut_out = MaterialConfig { texture_alpha, ..MaterialConfig::default() };
        assert_eq!(builder.add_material(&cut_out), Err(SceneError::BadAlpha));
        let kind = common::spot([0.0; 3], DVec3::X, [0.9, 0.8, value]);
        assert_eq!(
            builder.add_light(&LightConfig { kind, ..Default::default() }),
            Err(SceneError::BadFalloff)
        );
    }
    for beyond in [DVec3::X * 1e13, DVec3::Y * f64::INFINITY] {
        let bad = InstanceConfig { world_from_instance: Pose::from_translation(beyond), ..config };
        assert_eq!(builder.add_instance(&bad), Err(SceneError::BadPose));
    }
    let nowhere = Pose::from_translation(DVec3::NAN);
    let bad = InstanceConfig { world_from_instance: nowhere, ..config };
    assert_eq!(builder.add_instance(&bad), Err(SceneError::BadPose));
    let ball = builder.add_instance(&config).unwrap();
    assert_eq!(builder.set_pose(ball, nowhere), Err(SceneError::BadPose));
    assert_eq!(builder.set_pose(InstanceId(1), Pose::IDENTITY), Err(SceneError::NoSuchInstance(1)));
}

#[test]
fn grids_that_cannot_be_cast_are_refused() {
    use belvedere_sensors::optics::{Intrinsics, Pinhole};
    use belvedere_sensors::optics::{MAX_GRID_SIZE, Optics, SphericalGrid};
    use belvedere_sensors::scene::visibility::VISUAL;
    use belvedere_sensors::trace::{Faces, Hits, Workspace, cast_grid};
    let mut builder = SceneBuilder::new();
    common::add_grey(&mut builder, Shape::Sphere { radius: 2.0 }, Pose::IDENTITY);
    let scene = builder.scene();
    let cast = |grid: &Optics, range: [f64; 2], pose: &Pose, length: usize| {
        let mut distance = vec![7.0; length];
        let mut memory = WorkspaceBuf::default();
        let hits = Hits { distance: Some(&mut distance), ..Hits::default() };
        let mut workspace = memory.lend(grid_workspace_len(&scene, grid));
        let result =
            cast_grid(&scene, &builder.moment(*pose), grid, range, VISUAL, Faces::Both, &mut workspace, hits);
        match &result {
            Ok(()) => assert!(distance.iter().all(|distance| (distance - 2.0).abs() < 2e-5)),
            Err(error) => {
                assert!(distance.iter().all(|&distance| distance == 7.0));
                assert!(!error.to_string().is_empty());
            }
        }
        result
    };
    let good = SphericalGrid {
        columns: 8,
        rows: 2,
        first_azimuth_rad: 0.0,
        azimuth_step_rad: 0.1,
        first_elevation_rad: 0.0,
        elevation_step_rad: 0.1,
    };
    let range = [0.0, f64::INFINITY];
    let spherical = |grid| cast(&Optics::Spherical(grid), range, &Pose::IDENTITY, 16);
    assert_eq!(spherical(good), Ok(()));
    let size_of_grid = |result| match result {
        Err(SenseError::Grid(error)) => {
            assert_eq!(error.rule, Rule::Range([1.0, f64::from(MAX_GRID_SIZE)]));
            (error.parameter, error.value)
        }
        other => panic!("{other:?}"),
    };
    for value in [0, MAX_GRID_SIZE + 1, 65_000, u32::MAX] {
        let columns = spherical(SphericalGrid { columns: value, ..good });
        assert_eq!(size_of_grid(columns), ("columns", f64::from(value)));
        let rows = spherical(SphericalGrid { rows: value, ..good });
        assert_eq!(size_of_grid(rows), ("rows", f64::from(value)));
    }
    for value in [f64::NAN, f64::INFINITY] {
        for grid in [
            SphericalGrid { first_azimuth_rad: value, ..good },
            SphericalGrid { azimuth_step_rad: value, ..good },
            SphericalGrid { first_elevation_rad: value, ..good },
            SphericalGrid { elevation_step_rad: value, ..good },
        ] {
            let error = spherical(grid).unwrap_err().to_string();
            assert!(error.ends_with("it must be a finite number"), "{grid:?}: {error}");
        }
    }
    let good = Optics::Spherical(good);
    for range in [[f64::NAN, 1.0], [0.0, f64::NAN], [-1.0, 1.0], [2.0, 1.0], [f64::INFINITY; 2]] {
        let found = cast(&good, range, &Pose::IDENTITY, 16);
        assert!(matches!(found, Err(SenseError::Range { .. })), "{range:?}");
    }
    let nowhere = Pose::from_translation(DVec3::splat(f64::NAN));
    assert_eq!(cast(&good, range, &nowhere, 16), Err(SenseError::Pose));
    let short = cast(&good, range, &Pose::IDENTITY, 15);
    assert_eq!(short, Err(SenseError::Output { parameter: "distance", value: 15, need: 16 }));
    let mut none = Workspace { buffer: &mut [], execution: belvedere_sensors::Execution::default() };
    let here = builder.moment(Pose::IDENTITY);
    let refused = cast_grid(&scene, &here, &good, range, VISUAL, Faces::Both, &mut none, Hits::default());
    assert!(matches!(refused, Err(SenseError::Workspace { value: 0, .. })));
    // Invalid pinholes are refused when they are created.
    let lens = PinholeGrid::from_fov(8, 2, 1.0).unwrap();
    let intrinsics = lens.intrinsics();
    for bad in [
        Intrinsics { fx: 0.0, ..intrinsics },
        Intrinsics { fy: f64::NAN, ..intrinsics },
        Intrinsics { cx: f64::INFINITY, ..intrinsics },
    ] {
        assert!(Pinhole::new(bad).is_err(), "{bad:?}");
    }
    assert!(PinholeGrid::new(0, 8, *lens.lens()).is_err());
    let skewed = Pinhole::new(Intrinsics { skew: 0.1, ..intrinsics }).unwrap();
    assert!(PinholeGrid::new(8, 2, skewed).is_err());
    let large = Optics::Pinhole(PinholeGrid::new(8, 40_000, *lens.lens()).unwrap());
    let refused = cast(&large, range, &Pose::IDENTITY, 16);
    assert_eq!(size_of_grid(refused), ("height", 40_000.0));
    // The largest number of columns, with more than a turn.
    let many = SphericalGrid {
        columns: MAX_GRID_SIZE,
        rows: 1,
        first_azimuth_rad: -3.2,
        azimuth_step_rad: 6.4 / f64::from(MAX_GRID_SIZE),
        first_elevation_rad: 0.0,
        elevation_step_rad: 0.0,
    };
    assert_eq!(cast(&Optics::Spherical(many), range, &Pose::IDENTITY, MAX_GRID_SIZE as usize), Ok(()));
}

#[test]
fn the_error_of_a_picture_that_is_too_large_names_the_requested_size() {
    for ([width, height], wrong) in [
        ([40_000, 8], "width of the camera is 40000"),
        ([8, 16_385], "height of the camera is 16385"),
        ([u32::MAX, u32::MAX], "width of the camera is 4294967295"),
    ] {
        let config = CameraConfig::new(PinholeGrid::from_fov(width, height, 1.0).unwrap());
        let expected = format!("{wrong}; it must be from 1 to 16384");
        assert_eq!(Camera::new(config).unwrap_err().to_string(), expected);
        assert_eq!(DepthCamera::new(depth_camera().camera(config)).unwrap_err().to_string(), expected);
    }
}
