//! Depth camera presets in the simulator, by file and by rule.

use belvedere::description::load::{LoadOptions, load_robot};
use belvedere::description::model::SensorKind;
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules, SensorModels, load};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_sensors::device::depth_model::presets;

/// A box with edges of 0.4 m, 1 m ahead of the sensor, and a wall 2 m ahead.
const ROOM: &str = "<sdf version='1.6'><model name='room'><static>true</static><link name='l'>
    <visual name='box'><pose>1.2 0 1 0 0 0</pose><geometry><box><size>0.4 0.4 0.4</size></box></geometry></visual>
    <visual name='wall'><pose>2.1 0 1 0 0 0</pose><geometry><box><size>0.2 20 20</size></box></geometry></visual>
    </link></model></sdf>";

fn camera(plugins: &str) -> String {
    format!(
        "<sdf version='1.6'><model name='m'><static>true</static><link name='l'>
         <sensor name='kinect' type='depth'><pose>0 0 1 0 0 0</pose><camera><horizontal_fov>1.0</horizontal_fov>
         <image><width>320</width><height>240</height></image></camera>{plugins}</sensor></link></model></sdf>"
    )
}

const OPENNI: &str =
    "<plugin filename='libgazebo_ros_openni_kinect.so'><cameraName>camera</cameraName></plugin>";

fn depths(sensor: &str) -> Vec<f32> {
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    for model in [ROOM, sensor] {
        simulation.spawn(&load::model(model).unwrap(), SpawnOptions::default()).unwrap();
    }
    let mut frame = FrameBuf::default();
    simulation.render("camera/depth/image_raw", &mut frame).unwrap();
    bytemuck::cast_slice(frame.view().payload()).to_vec()
}

#[test]
fn a_preset_of_the_file_has_noise_steps_and_shadows() {
    let plain = depths(&camera(OPENNI));
    assert!(plain.iter().all(|depth| *depth == 1.0 || *depth == 2.0), "as the file asks");
    let kinect =
        depths(&camera(&format!("{OPENNI}<plugin filename='belvedere'><preset>kinect_v1</preset></plugin>")));
    // f·b·(1/z₁ − 1/z₂) pixels beside the box.
    let expected = 0.5 * 320.0 / 0.5_f64.tan() * 0.075 * 0.5;
    let rows = 90..150;
    let shadow =
        rows.clone().map(|row| kinect[row * 320..][..320].iter().filter(|depth| depth.is_nan()).count());
    let mean = shadow.sum::<usize>() as f64 / rows.len() as f64;
    assert!((mean - expected).abs() < 0.5, "{mean} px, not {expected}");
    // The σ on the wall, except near the frayed edges of the box.
    let errors: Vec<f64> = kinect[..320 * 50].iter().map(|depth| f64::from(*depth) - 2.0).collect();
    let sigma = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((sigma / 6.064e-3 - 1.0).abs() < 0.03, "{sigma}");
    // Steps of 11.4 mm.
    let mut levels = kinect[..320 * 50].to_vec();
    levels.sort_unstable_by(f32::total_cmp);
    levels.dedup();
    assert!(levels.len() < 12, "{} levels", levels.len());
    // A second run gives the same bytes.
    assert_eq!(
        kinect.iter().map(|depth| depth.to_bits()).collect::<Vec<_>>(),
        depths(&camera(&format!("{OPENNI}<plugin filename='belvedere'><preset>kinect_v1</preset></plugin>")))
            .iter()
            .map(|depth| depth.to_bits())
            .collect::<Vec<_>>()
    );
}

/// Without its projector, a stereo camera finds no matches on a plain wall.
#[test]
fn a_stereo_camera_without_its_projector_needs_texture() {
    let share = |projector: &str| {
        let own = format!("<plugin filename='belvedere'>{projector}<preset>d435</preset></plugin>");
        let depths = depths(&camera(&format!("{OPENNI}{own}")));
        // Only the wall, in rows above the box. Its left part is not visible to the other imager.
        let wall = (10..50).flat_map(|row| depths[row * 320 + 100..(row + 1) * 320 - 10].to_vec());
        let found: Vec<bool> = wall.map(f32::is_finite).collect();
        found.iter().filter(|found| **found).count() as f64 / found.len() as f64
    };
    for on in ["", "<projector>true</projector>"] {
        assert!(share(on) > 0.98, "{on}: {}", share(on));
    }
    assert_eq!(share("<projector>false</projector>"), 0.0);
}

#[test]
fn real_sensor_models_make_a_kinect_of_the_articles_robot() {
    let preset = |sensor_models| {
        let rules = Rules { sensor_models, ..Rules::default() };
        let packages = package_path([], None);
        let options = LoadOptions { packages, rules, xacro_args: Vec::new() };
        let mut diagnostics = Diagnostics::default();
        let robot = load_robot("kobuki_hexagons_kinect", &options, &mut diagnostics).unwrap();
        let depth = robot.sensors.iter().find_map(|sensor| match &sensor.kind {
            SensorKind::Depth(depth) => Some(depth.clone()),
            _ => None,
        });
        let depth = depth.unwrap();
        (depth.preset, depth.range_m()[0])
    };
    assert_eq!(preset(SensorModels::AsWritten), (None, 0.4));
    assert_eq!(preset(SensorModels::Real), (presets::named("kinect_v1"), 0.8));
}
