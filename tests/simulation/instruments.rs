//! Receivers, magnetometers, altimeters, barometers, sonars: their readings at known places.

use crate::sdf;

use belvedere::description::load;
use belvedere::description::model::{Model, World};
use belvedere::entities::EntityId;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::payload::{
    Altimeter, FluidPressure, MagneticField, Message, NavSatFix, Range, Vector3,
};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

fn world(inside: &str) -> World {
    sdf::good("1.6", inside)
}

/// Zürich, in a world whose x points this far to the left of east.
fn zurich(heading_deg: f64) -> World {
    world(&format!(
        "<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>47.3667</latitude_deg>
           <longitude_deg>8.55</longitude_deg><elevation>500</elevation><heading_deg>{heading_deg}</heading_deg>
         </spherical_coordinates><magnetic_field>2e-5 0 -4e-5</magnetic_field>"
    ))
}

/// A floating model with this content in its link, or beside it.
fn carrier(in_link: &str, beside: &str) -> Model {
    load::model(&format!(
        "<sdf version='1.6'><model name='thing'><link name='body'><gravity>false</gravity>
           <inertial><mass>1</mass></inertial>{in_link}</link>{beside}</model></sdf>"
    ))
    .unwrap()
}

fn sensor(kind: &str, inside: &str) -> String {
    format!("<sensor name='s' type='{kind}'><update_rate>50</update_rate><topic>s</topic>{inside}</sensor>")
}

struct Bench {
    simulation: Simulation,
    carrier: EntityId,
}

impl Bench {
    fn new(world: World, model: &Model) -> Self {
        let mut simulation = Simulation::builder(world).seed(9).build().unwrap();
        let carrier = simulation.spawn(model, SpawnOptions::default()).unwrap();
        Self { simulation, carrier }
    }

    /// Moves the model to a pose with a velocity, and lets this many ms pass.
    fn put(&mut self, at: Pose, velocity: DVec3, milliseconds: u64) {
        self.simulation.place(self.carrier, &at, velocity, DVec3::ZERO).unwrap();
        self.simulation.run_for(Duration::from_millis(milliseconds));
    }

    fn read<T: Message>(&mut self, topic: &str) -> T {
        let mut frame = FrameBuf::default();
        self.simulation.render(topic, &mut frame).unwrap();
        bytemuck::pod_read_unaligned(frame.payload())
    }
}

fn near(read: [f64; 3], expected: DVec3, within: f64) {
    assert!((DVec3::from(read) - expected).length() < within, "{read:?}, not {expected}");
}

#[test]
fn a_receiver_reports_its_position_on_the_earth() {
    for kind in ["gps", "navsat"] {
        let mut bench = Bench::new(zurich(0.0), &carrier(&sensor(kind, ""), ""));
        bench.put(Pose::from_translation(DVec3::new(100.0, 200.0, 3.0)), DVec3::new(1.0, 2.0, 0.0), 1);
        let fix: NavSatFix = bench.read("s");
        // A degree there and 500 m up, from the radii of curvature of WGS 84; 200 m farther north, a degree to the east
        // is 2.6 m shorter.
        let (north, east) = (200.002 / (fix.latitude - 47.3667), 100.001 / (fix.longitude - 8.55));
        assert!((north - 111_186.8).abs() < 1.0 && (east - 75_540.0).abs() < 3.0, "{north} {east}");
        assert!((fix.altitude - 503.0).abs() < 0.01, "{fix:?}");
        near(fix.velocity, DVec3::new(1.0, 2.0, 0.0), 1e-5);
        assert_eq!(fix.position_covariance, [0.0; 9]);
    }
    // A world whose x points north.
    let mut bench = Bench::new(zurich(90.0), &carrier(&sensor("navsat", ""), ""));
    bench.put(Pose::from_translation(DVec3::X * 50.0), DVec3::X, 1);
    let fix: NavSatFix = bench.read("s");
    assert!(
        ((fix.latitude - 47.3667) * 111_186.8 - 50.0).abs() < 0.01 && (fix.longitude - 8.55).abs() < 1e-9
    );
    near(fix.velocity, DVec3::Y, 1e-6);
}

#[test]
fn errors_of_a_receiver_are_in_metres() {
    let noise = |stddev: f64| format!("<noise type='gaussian'><stddev>{stddev}</stddev></noise>");
    let inside = format!(
        "<gps><position_sensing><horizontal>{}</horizontal><vertical>{}</vertical></position_sensing></gps>",
        noise(0.5),
        noise(2.0)
    );
    let mut bench = Bench::new(zurich(0.0), &carrier(&sensor("gps", &inside), ""));
    let fixes: Vec<NavSatFix> = (0..1000)
        .map(|_| {
            bench.simulation.run_for(Duration::from_millis(20));
            bench.read("s")
        })
        .collect();
    let stddev = |value: &dyn Fn(&NavSatFix) -> f64| {
        let mean = fixes.iter().map(value).sum::<f64>() / 1000.0;
        (fixes.iter().map(|fix| (value(fix) - mean).powi(2)).sum::<f64>() / 1000.0).sqrt()
    };
    let found = [
        stddev(&|fix| fix.longitude * 75_540.0),
        stddev(&|fix| fix.latitude * 111_186.8),
        stddev(&|fix| fix.altitude),
    ];
    // Three standard errors of a standard deviation from 1000 samples.
    for (found, expected) in found.into_iter().zip([0.5, 0.5, 2.0]) {
        assert!((found / expected - 1.0).abs() < 0.07, "{found:?}, not {expected}");
    }
    let covariance = fixes[10].position_covariance;
    near([covariance[0], covariance[4], covariance[8]], DVec3::new(0.25, 0.25, 4.0), 1e-9);
}

/// As in the file of an outdoor robot.
#[test]
fn team_hectors_receiver_has_its_own_reference() {
    let plugin = |inside: &str| {
        format!(
            "<plugin name='gps' filename='libhector_gazebo_ros_gps.so'><bodyName>body</bodyName>{inside}</plugin>"
        )
    };
    let parameters = "<updateRate>40</updateRate><frameId>gps_link</frameId><topicName>navsat/fix</topicName>
        <velocityTopicName>navsat/vel</velocityTopicName><referenceLatitude>49.9</referenceLatitude>
        <referenceLongitude>8.9</referenceLongitude><referenceHeading>0</referenceHeading>
        <referenceAltitude>0</referenceAltitude><drift>0.0001 0.0001 0.0001</drift>";
    let mut bench = Bench::new(zurich(0.0), &carrier("", &plugin(parameters)));
    bench.put(Pose::from_translation(DVec3::new(10.0, 0.0, 0.5)), DVec3::new(1.0, 0.5, 0.0), 1);
    let fix: NavSatFix = bench.read("/navsat/fix");
    // Its x is north, and its y west.
    assert!(((fix.latitude - 49.9) * 111_227.1 - 10.0).abs() < 0.05, "{fix:?}");
    assert!((fix.longitude - 8.9).abs() * 71_844.4 < 0.01 && (fix.altitude - 0.5).abs() < 0.01, "{fix:?}");
    near(bench.read::<Vector3>("/navsat/vel").vector, DVec3::new(1.0, 0.5, 0.0), 1e-5);
    near(fix.velocity, DVec3::new(-0.5, 1.0, 0.0), 1e-5);

    let mut bench = Bench::new(zurich(0.0), &carrier("", &plugin("")));
    assert!((bench.read::<NavSatFix>("/fix").latitude - 49.9).abs() < 1e-6);
    assert!(bench.simulation.topics().unwrap().contains(&"/fix_velocity".to_owned()));
    // Its errors are along the world's axes.
    let errors = "<offset>3 0 1</offset><drift>0 0 0</drift>";
    let fix: NavSatFix = Bench::new(zurich(0.0), &carrier("", &plugin(errors))).read("/fix");
    assert!(((fix.latitude - 49.9) * 111_227.1 - 3.0).abs() < 0.02 && (fix.altitude - 1.0).abs() < 1e-5);
    assert!((fix.longitude - 8.9).abs() < 1e-9, "{fix:?}");
    let errors = "<gaussianNoise>1 2 3</gaussianNoise>";
    let fix: NavSatFix = Bench::new(zurich(0.0), &carrier("", &plugin(errors))).read("/fix");
    let covariance = fix.position_covariance;
    near([covariance[0], covariance[4], covariance[8]], DVec3::new(4.0, 1.0, 9.0), 1e-9);
    let of_world = plugin("<useWorldSphericalCoordinates>true</useWorldSphericalCoordinates>");
    let mut bench = Bench::new(zurich(0.0), &carrier("", &of_world));
    assert!((bench.read::<NavSatFix>("/fix").latitude - 47.3667).abs() < 1e-6);
}

#[test]
fn a_magnetometer_reads_the_worlds_field_along_its_axes() {
    let mut bench = Bench::new(zurich(0.0), &carrier(&sensor("magnetometer", ""), ""));
    near(bench.read::<MagneticField>("s").magnetic_field, DVec3::new(2e-5, 0.0, -4e-5), 1e-12);
    bench.put(Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, 0.0, FRAC_PI_2)), DVec3::ZERO, 1);
    near(bench.read::<MagneticField>("s").magnetic_field, DVec3::new(0.0, -2e-5, -4e-5), 1e-11);
    // Without the element, the field is SDF's default.
    let mut bench = Bench::new(world(""), &carrier(&sensor("magnetometer", ""), ""));
    near(
        bench.read::<MagneticField>("s").magnetic_field,
        DVec3::new(5.5645e-6, 22.8758e-6, -42.3884e-6),
        1e-12,
    );
    // Team Hector's field has length 1 and an inclination of 60° down, by default to the north, which is its x.
    let plugin = |inside: &str| {
        format!(
            "<plugin name='m' filename='libhector_gazebo_ros_magnetic.so'><bodyName>body</bodyName>{inside}</plugin>"
        )
    };
    let mut bench = Bench::new(world(""), &carrier("", &plugin("<updateRate>50</updateRate>")));
    near(bench.read::<Vector3>("/magnetic").vector, DVec3::new(0.5, 0.0, -0.75_f64.sqrt()), 1e-9);
    let inside = "<useMagneticFieldMsgs>true</useMagneticFieldMsgs><magnitude>5e-5</magnitude><inclination>0</inclination>
        <declination>90</declination><offset>0 0 1e-6</offset>";
    let mut bench = Bench::new(world(""), &carrier("", &plugin(inside)));
    near(bench.read::<MagneticField>("/magnetic").magnetic_field, DVec3::new(0.0, -5e-5, 1e-6), 1e-12);
}

#[test]
fn heights_and_pressures_are_those_of_the_place() {
    let altimeter = sensor("altimeter", "").replace("name='s'", "name='a'").replace("<topic>s", "<topic>alt");
    let inside = "<air_pressure><reference_altitude>1000</reference_altitude></air_pressure>";
    let model = carrier(&(altimeter + &sensor("air_pressure", inside)), "");
    let mut bench = Bench::new(world(""), &model);
    let start: Altimeter = bench.read("alt");
    assert_eq!((start.vertical_position, start.vertical_reference), (0.0, 0.0));
    // The table of the standard, at 1000 m.
    let pressure: FluidPressure = bench.read("s");
    assert!((pressure.fluid_pressure / 89_876.0 - 1.0).abs() < 2e-5, "{pressure:?}");
    bench.put(Pose::from_translation(DVec3::Z * 1000.0), DVec3::Z * -3.0, 1);
    let high: Altimeter = bench.read("alt");
    assert!(
        (high.vertical_position - 999.997).abs() < 1e-4 && (high.vertical_velocity + 3.0).abs() < 1e-6,
        "{high:?}"
    );
    let pressure: FluidPressure = bench.read("s");
    assert!((pressure.fluid_pressure / 79_501.0 - 1.0).abs() < 2e-5, "{pressure:?}");

    let baro = "<plugin name='b' filename='libhector_gazebo_ros_baro.so'><bodyName>body</bodyName></plugin>
        <plugin name='p' filename='librotors_gazebo_pressure_plugin.so'><linkName>body</linkName></plugin>";
    let mut bench = Bench::new(world(""), &carrier("", baro));
    bench.put(Pose::from_translation(DVec3::Z * 500.0), DVec3::ZERO, 1);
    assert!((bench.read::<Altimeter>("/pressure_height").vertical_position - 500.0).abs() < 1e-6);
    // 500 m above 500 m.
    let pressure: FluidPressure = bench.read("/air_pressure");
    assert!((pressure.fluid_pressure / 89_876.0 - 1.0).abs() < 2e-5, "{pressure:?}");
}

#[test]
fn a_sonar_measures_the_nearest_surface_in_its_cone() {
    let post = |name: &str, x: f64, z: f64| {
        format!(
            "<model name='{name}'><static>true</static><pose>{x} 0 {z} 0 0 0</pose><link name='l'><collision name='c'>
               <geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model>"
        )
    };
    let floor = "<model name='floor'><static>true</static><link name='l'><collision name='c'><geometry><box>
        <size>20 20 0.2</size></box></geometry></collision></link></model>";
    // It points along its −z: at 4 m the cone extends 1 m to each side.
    let sonar = "<sonar><min>0.1</min><max>4</max><radius>1</radius></sonar>";
    let read = |things: &str, pose: Pose| {
        let mut bench = Bench::new(world(&format!("{floor}{things}")), &carrier(&sensor("sonar", sonar), ""));
        bench.put(pose, DVec3::ZERO, 1);
        bench.read::<Range>("s")
    };
    let above = Pose::from_translation(DVec3::Z * 3.1);
    let alone = read("", above);
    assert!((f64::from(alone.range) - 3.0).abs() < 1e-3, "{alone:?}");
    let full = 2.0 * 0.25_f64.atan();
    assert!(
        (f64::from(alone.field_of_view) - full).abs() < 1e-6 && alone.radiation_type == Range::ULTRASOUND
    );
    // With its centre 2 m below and 0.4 m beside, it is within the cone; 0.8 m beside, it is not.
    let within = read(&post("p", 0.4, 1.1), above);
    let expected = (2.0_f64.powi(2) + 0.4_f64.powi(2)).sqrt() - 0.1;
    assert!((f64::from(within.range) - expected).abs() < 0.01, "{within:?}, not {expected}");
    assert!((f64::from(read(&post("p", 0.8, 1.1), above).range) - 3.0).abs() < 1e-3);
    // Beyond its range there is nothing, and surfaces that are too near are reported so (REP-117).
    assert_eq!(read("", Pose::from_translation(DVec3::Z * 9.0)).range, f32::INFINITY);
    assert_eq!(read("", Pose::from_translation(DVec3::Z * 0.15)).range, f32::NEG_INFINITY);
}

#[test]
fn team_hectors_sonar_has_the_cone_of_its_rays() {
    let model = carrier(
        "<sensor name='sonar' type='ray'><update_rate>10</update_rate><ray><scan>
           <horizontal><samples>3</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle></horizontal>
           <vertical><samples>3</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle></vertical></scan>
           <range><min>0.03</min><max>3</max></range></ray>
           <plugin name='p' filename='libhector_gazebo_ros_sonar.so'><topicName>sonar_height</topicName>
             <frameId>sonar_link</frameId><gaussianNoise>0.01</gaussianNoise></plugin></sensor>",
        "",
    );
    let wall =
        "<model name='wall'><static>true</static><pose>2 0 0 0 0 0</pose><link name='l'><collision name='c'>
        <geometry><box><size>1 9 9</size></box></geometry></collision></link></model>";
    let mut bench = Bench::new(world(wall), &model);
    let mut frame = FrameBuf::default();
    bench.simulation.render("/sonar_height", &mut frame).unwrap();
    assert_eq!(frame.header().frame_id.as_str(), "sonar_link");
    let range: Range = bytemuck::pod_read_unaligned(frame.payload());
    assert!((range.range - 1.5).abs() < 0.05 && (range.field_of_view - 0.2).abs() < 1e-6, "{range:?}");
    assert_eq!(model.sensors[0].effective_rate_hz(), Some(10.0));
}

#[test]
fn invalid_coordinates_of_a_world_give_one_error() {
    for (inside, expected) in [
        ("<latitude_deg>91</latitude_deg>", "<latitude_deg> is 91"),
        ("<longitude_deg>x</longitude_deg>", "'x' is not a finite number"),
        ("<elevation>1e9</elevation>", "<elevation> is 1000000000"),
    ] {
        let text = format!("<spherical_coordinates>{inside}</spherical_coordinates>");
        let (_, problems) = sdf::Folder::new().load("1.6", &text, false);
        assert!(problems.len() == 1, "{problems:?}");
        let problem = problems[0].to_string();
        assert!(problem.contains(expected) && problem.contains(":2: error"), "{problem}");
    }
}
