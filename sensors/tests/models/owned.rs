//! Sensors that own their tables give the same bytes as those that borrow them, also after the original tables are
//! gone.

use crate::common::scenery;
use belvedere_sensors::camera::{Camera, CameraBuf, CameraConfig, Picture};
use belvedere_sensors::depth::{DepthCamera, DepthCameraBuf, DepthCameraConfig, DepthFrame};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, PinholeGrid, RayTableBuf};
use belvedere_sensors::scanner::{Echoes, Scanner, ScannerBuf, Spread, presets};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, SceneError, Shape, visibility};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{AnyOutput, AnySensor, Capture, Pose, Rule, SenseError, Sensor};
use glam::DVec3;

const SIZE: [u32; 2] = [97, 61];

fn fisheye() -> RayTableBuf {
    let intrinsics = Intrinsics { fx: 30.0, fy: 31.0, cx: 48.2, cy: 29.7, skew: 0.0 };
    let lens = KannalaBrandt::new(intrinsics, [-0.01, 0.003, 0.0, 0.0]).unwrap();
    RayTableBuf::from_lens(SIZE[0], SIZE[1], &lens).unwrap()
}

fn world() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    builder
}

const WHERE: Pose = Pose::IDENTITY;

#[test]
fn a_fisheye_camera_can_own_its_table() {
    let table = fisheye();
    let noise = GaussianNoise::of_stddev(0.01).unwrap();
    let borrowing = Camera::new(CameraConfig::new(&table).noise(noise).seed(3)).unwrap();
    let depth = DepthCamera::new(DepthCameraConfig::new(*borrowing.config()).model(noise)).unwrap();
    let world = world();
    let (scene, capture) = (world.scene(), Capture::new(5, world.moment(WHERE)));
    let mut workspace = WorkspaceBuf::default();
    let mut expected = (vec![0; borrowing.frame_len()], vec![0.0; depth.pixels()]);
    let picture = Picture::new().colour(&mut expected.0);
    borrowing.sense_in(&mut workspace, &scene, &capture, picture).unwrap();
    let frame = DepthFrame::new().depth_32fc1(&mut expected.1);
    depth.sense_in(&mut workspace, &scene, &capture, frame).unwrap();

    let kept: (CameraBuf, DepthCameraBuf) = (borrowing.to_buf(), depth.to_buf());
    assert_eq!(
        (*kept.0.camera().config(), *kept.1.camera().config()),
        (*borrowing.config(), *depth.config())
    );
    drop(table);
    // Moved to another address, and to another thread.
    let kept = std::thread::spawn(move || Box::new(kept)).join().unwrap();
    let mut found = (vec![1; expected.0.len()], vec![1.0; expected.1.len()]);
    let picture = Picture::new().colour(&mut found.0);
    kept.0.sense_in(&mut workspace, &scene, &capture, picture).unwrap();
    let frame = DepthFrame::new().depth_32fc1(&mut found.1);
    kept.1.sense_in(&mut workspace, &scene, &capture, frame).unwrap();
    assert!(found == expected, "other bytes");
    assert!(expected.1.iter().any(|depth| depth.is_finite()), "something is seen");
}

/// The ranges of two frames.
fn ranges<S: for<'a> Sensor<Output<'a> = Echoes<'a>>>(
    sensor: &S,
    firings: usize,
    returns: usize,
) -> Vec<u32> {
    let world = world();
    let mut workspace = WorkspaceBuf::default();
    let mut all = Vec::new();
    for frame in 0..2 {
        let mut ranges = vec![0.0; firings * returns];
        let capture = Capture::new(frame, world.moment(WHERE));
        let output = Echoes::new().ranges(&mut ranges);
        sensor.sense_in(&mut workspace, &world.scene(), &capture, output).unwrap();
        all.extend(ranges.into_iter().map(f32::to_bits));
    }
    all
}

#[test]
fn every_scanner_can_own_its_tables() {
    for name in presets::NAMES {
        let preset = presets::named(name).unwrap();
        let config = preset.config().frame_time_ns(20_000_000);
        // All tables are on the heap, so that a dangling reference to one of them would be found.
        let spreads: Vec<_> = config.spreads.iter().copied().chain([far_spread()]).collect();
        let borrowing = Scanner::new(config.spreads(&spreads).seed(9)).unwrap();
        let kept: ScannerBuf = borrowing.to_buf();
        let (firings, returns) = (borrowing.most_firings(), borrowing.returns());
        assert!(*kept.scanner().config() == *borrowing.config(), "{name}");
        let expected = ranges(&borrowing, firings, returns);
        drop(spreads);
        assert!(ranges(&kept, firings, returns) == expected, "{name}: other bytes");
    }
}

/// A spread beyond all ranges.
fn far_spread() -> Spread {
    Spread { from_m: 1e6, stddev: [0.0; 3] }
}

#[test]
fn the_output_of_another_kind_of_sensor_is_refused() {
    let world = world();
    let (scene, capture) = (world.scene(), Capture::new(0, world.moment(WHERE)));
    let sensor = AnySensor::from(Lidar::new(LidarConfig::new(Beams::turn(8))).unwrap());
    let mut pixels = vec![7; 8];
    let output = AnyOutput::from(Picture::new().colour(&mut pixels));
    let refused = sensor.sense_in(&mut WorkspaceBuf::default(), &scene, &capture, output).unwrap_err();
    assert_eq!(refused, SenseError::OutputKind { sensor: "lidar", output: "camera" });
    assert_eq!(refused.to_string(), "the output is that of a camera; the sensor is a lidar");
    assert_eq!(pixels, [7; 8]);
    let mut ranges = [0.0; 8];
    let output = Scan::new().ranges(&mut ranges).into();
    sensor.sense_in(&mut WorkspaceBuf::default(), &scene, &capture, output).unwrap();
}

/// The beams of a turn are evenly spaced across its seam too, and none is duplicated.
#[test]
fn the_beams_of_a_turn_are_even_across_its_seam() {
    for samples in [1, 2, 3, 360, 32_767] {
        let turn = Beams::turn(samples);
        let lidar = Lidar::new(LidarConfig::new(turn)).unwrap();
        assert_eq!(lidar.beams(), samples as usize);
        let step = core::f64::consts::TAU / f64::from(samples);
        let seam = turn.angle(0) + core::f64::consts::TAU - turn.angle(samples - 1);
        assert!(
            (seam - step).abs() < 1e-12,
            "{samples} beams: {seam} across the seam, {step} between the others"
        );
    }
}

#[test]
fn a_scene_for_lidars_needs_no_material() {
    let mut builder = SceneBuilder::new();
    let ball = InstanceConfig {
        shape: Shape::Sphere { radius: 0.5 },
        world_from_instance: Pose::from_translation(DVec3::X * 2.0),
        visibility: visibility::COLLISION,
        ..Default::default()
    };
    // A refused instance leaves no material behind.
    let nothing = InstanceConfig { shape: Shape::Sphere { radius: 0.0 }, ..ball };
    assert!(builder.add_instance(&nothing).is_err());
    assert!(builder.scene().materials().is_empty());
    builder.add_instance(&ball).unwrap();
    builder.add_instance(&ball).unwrap();
    assert_eq!(builder.scene().materials().len(), 1);
    let unknown = InstanceConfig { material: belvedere_sensors::scene::MaterialId(1), ..ball };
    assert_eq!(builder.add_instance(&unknown), Err(SceneError::NoSuchMaterial(1)));
    // After everything is removed, the builder equals a new one, except for the order of its free ids.
    let mut emptied = SceneBuilder::new();
    let materials = [(); 3].map(|()| emptied.add_material(&MaterialConfig::default()).unwrap());
    for material in [2, 0, 1] {
        emptied.remove_material(materials[material]).unwrap();
    }
    emptied.add_instance(&ball).unwrap();
    assert!(
        matches!(emptied.remove_material(materials[1]), Err(SceneError::InUse { .. })),
        "the place freed last"
    );
    let lidar = Lidar::new(LidarConfig::new(Beams::ONE)).unwrap();
    let mut ranges = [0.0];
    let capture = Capture::new(0, builder.moment(Pose::IDENTITY));
    let scan = Scan::new().ranges(&mut ranges);
    lidar.sense_in(&mut WorkspaceBuf::default(), &builder.scene(), &capture, scan).unwrap();
    assert_eq!(ranges, [1.5]);
}

#[test]
fn each_bad_number_of_a_noise_or_a_lidar_is_named() {
    let noise = GaussianNoiseConfig::default;
    for (config, parameter) in [
        (noise().mean(f32::NAN), "mean"),
        (noise().stddev(-1.0), "stddev"),
        (noise().bias_mean(f32::INFINITY), "bias_mean"),
        (noise().bias_stddev(f32::NAN), "bias_stddev"),
        (noise().precision(1e-40), "precision"),
    ] {
        assert_eq!(GaussianNoise::new(config).unwrap_err().parameter, parameter);
    }
    let lidar = LidarConfig::new(Beams::turn(8));
    let line = |samples, min_angle_rad, max_angle_rad| Beams { samples, min_angle_rad, max_angle_rad };
    for (config, parameter) in [
        (LidarConfig::new(line(0, 0.0, 1.0)), "horizontal.samples"),
        (LidarConfig::new(line(40_000, 0.0, 1.0)), "horizontal.samples"),
        (LidarConfig::new(line(4, f64::NAN, 1.0)), "horizontal.min_angle_rad"),
        (LidarConfig::new(line(4, 0.0, f64::INFINITY)), "horizontal.max_angle_rad"),
        (lidar.vertical(line(4, 1.0, -1.0)), "vertical.max_angle_rad"),
        (LidarConfig::new(line(32_767, 0.0, 1.0)).vertical(line(600, 0.0, 1.0)), "number of all beams"),
        (lidar.range_min_m(-1.0), "range_min_m"),
        (lidar.range_min_m(3.0).range_max_m(2.0), "range_min_m"),
    ] {
        assert_eq!(Lidar::new(config).unwrap_err().parameter, parameter);
    }
    let camera = CameraConfig::new(PinholeGrid::from_fov(8, 6, 1.0).unwrap()).exposure(f32::NAN);
    let error = Camera::new(camera).unwrap_err();
    assert_eq!(
        (error.of, error.parameter, error.rule),
        ("camera", "exposure", Rule::Text("a finite number, 0 or more"))
    );
}
