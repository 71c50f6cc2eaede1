//! The beams of a lidar as described in files: several returns, reflectivity and weather in its clouds.

use belvedere::description::load;
use belvedere::description::model::{Lidar, PacketProfile, SensorKind};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::{Encoding, FrameHeader};
use belvedere_sensors::Pose;
use belvedere_sensors::scanner::{Beam, Crosstalk, Halo, Intensity, Receiver, Returns, Weather};
use glam::DVec3;

const EYE: DVec3 = DVec3::new(0.0, 0.0, 2.5);
/// A plate in front of a wall: the distance of each from the sensor, and its reflectivity in per cent.
const PLATE: (f64, f64) = (3.0, 40.0);
const WALL: (f64, f64) = (8.0, 80.0);
/// Half the size of the plate.
const HALF: f64 = 0.5;

fn plates() -> String {
    let plate = |(x, retro): (f64, f64), size: f64| {
        format!(
            "<collision name='c{x}'><laser_retro>{retro}</laser_retro><pose>{} 0 2.5 0 0 0</pose>
             <geometry><box><size>0.02 {size} {size}</size></box></geometry></collision>",
            x + 0.01
        )
    };
    let both = plate(PLATE, 2.0 * HALF) + &plate(WALL, 40.0);
    format!(
        "<sdf version='1.6'><model name='plates'><static>true</static><link name='l'>{both}</link></model></sdf>"
    )
}

/// A floating sensor with an update rate of 10 Hz; `beams` begins on line 3.
fn floating(beams: &str) -> String {
    format!(
        "<sdf version='1.6'><model name='floating'><link name='l'><gravity>false</gravity>
         <sensor name='s' type='ray'><update_rate>10</update_rate>
{beams}</sensor></link></model></sdf>"
    )
}

fn own(elements: &str) -> String {
    format!("<plugin filename='belvedere'>{elements}</plugin>")
}

fn velodyne(parameters: &str) -> String {
    format!(
        "<plugin name='p' filename='libgazebo_ros_velodyne_laser.so'><topicName>points</topicName>{parameters}</plugin>"
    )
}

/// 301 columns of 9 beams over 0.6 by 0.4 rad, without noise.
fn grid(elements: &str, parameters: &str) -> String {
    format!(
        "<ray><scan><horizontal><samples>301</samples><min_angle>-0.3</min_angle><max_angle>0.3</max_angle></horizontal>
         <vertical><samples>9</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle></vertical></scan>
         <range><min>0.1</min><max>100</max></range></ray>{}{}",
        own(elements),
        velodyne(parameters)
    )
}

struct Point {
    place: DVec3,
    intensity: f64,
    ring: u16,
    time_s: f32,
}

fn points(frame: &FrameBuf) -> Vec<Point> {
    let view = frame.view();
    view.numbers::<[u8; 22]>(view.rows())
        .map(|bytes| {
            let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            Point {
                place: DVec3::new(float(0).into(), float(4).into(), float(8).into()),
                intensity: float(12).into(),
                ring: u16::from_le_bytes([bytes[16], bytes[17]]),
                time_s: float(18),
            }
        })
        .collect()
}

/// The content of a topic of the sensor in front of the plates.
fn taken(beams: &str, topic: &str) -> (FrameHeader, FrameBuf) {
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    simulation.spawn(&load::model(&plates()).unwrap(), SpawnOptions::default()).unwrap();
    let sensor = simulation.spawn(&load::model(&floating(beams)).unwrap(), SpawnOptions::default()).unwrap();
    simulation.place(sensor, &Pose::from_translation(EYE), DVec3::ZERO, DVec3::ZERO).unwrap();
    let mut frame = FrameBuf::default();
    simulation.render(topic, &mut frame).unwrap();
    (*frame.header(), frame)
}

fn cloud(elements: &str, parameters: &str) -> (FrameHeader, Vec<Point>) {
    let (header, frame) = taken(&grid(elements, parameters), "points");
    (header, points(&frame))
}

/// The cosine of the angle at which a beam hits the plates, and the plate that a point is on.
fn met(point: &Point) -> (f64, (f64, f64)) {
    let cos = point.place.normalize().x;
    let plate = if point.place.x < 0.5 * (PLATE.0 + WALL.0) { PLATE } else { WALL };
    assert!((point.place.x - plate.0).abs() < 0.05, "{}", point.place);
    (cos, plate)
}

#[test]
fn both_returns_of_a_beam_at_an_edge_are_in_the_cloud() {
    let wide = "<returns>dual</returns><beam_divergence>0.02 0.02</beam_divergence><intensity>reflectivity</intensity>";
    let (header, points) = cloud(wide, "");
    assert_eq!((header.width as usize, header.height), (points.len(), 1));
    let (mut pairs, mut next) = (0, 0);
    while next < points.len() {
        let (last, second) = (&points[next], points.get(next + 1));
        let (cos, plate) = met(last);
        let second = second.filter(|second| (second.time_s, second.ring) == (last.time_s, last.ring));
        let Some(second) = second else {
            // The whole beam, from a diffuse surface.
            assert!((last.intensity / (plate.1 * cos) - 1.0).abs() < 1e-3, "{}", last.intensity);
            next += 1;
            continue;
        };
        let (second_cos, before) = met(second);
        assert_eq!((plate, before), (WALL, PLATE));
        // The two shares add up to the whole.
        let shares = last.intensity / (WALL.1 * cos) + second.intensity / (PLATE.1 * second_cos);
        assert!((shares - 1.0).abs() < 5e-3, "{shares}");
        let edge = second.place.y.abs().max(second.place.z.abs()) / second.place.x * PLATE.0;
        assert!((edge - HALF).abs() < 0.0101 * PLATE.0 * 1.05, "{edge}");
        (pairs, next) = (pairs + 1, next + 2);
    }
    // Seven rows of beams end at the plate's left and right side. Each beam reaches this far to either side, because
    // the rings of rays are at three quarters of the radius.
    let expected = 7.0 * 2.0 * (2.0 * 0.75 * 0.01) / 0.002;
    assert!((f64::from(pairs) / expected - 1.0).abs() < 0.25, "{pairs}");
    // With `organize_cloud`, there is one row per return; without the second return, one row.
    let organized = "<organize_cloud>true</organize_cloud>";
    let (header, rows) = cloud(wide, organized);
    assert_eq!((header.width, header.height, rows.len()), (9, 301 * 2, 9 * 301 * 2));
    let there =
        |row: usize| rows[9 * row..9 * (row + 1)].iter().filter(|point| !point.place.is_nan()).count();
    assert!((0..301).all(|column| there(2 * column) == 9 && there(2 * column + 1) <= 9));
    assert_eq!((0..301).map(|column| there(2 * column + 1)).sum::<usize>(), pairs as usize);
    let (header, _) = cloud("", organized);
    assert_eq!((header.width, header.height), (9, 301));
}

#[test]
fn fog_attenuates_and_a_receiver_has_a_threshold() {
    let seen = |more: &str| cloud(&format!("<intensity>reflectivity</intensity>{more}"), "").1;
    let (clear, fog) = (seen(""), seen("<fog_visibility>20</fog_visibility>"));
    let extinction = 20.0_f64.ln() / 20.0;
    assert_eq!(clear.len(), fog.len());
    for (one, other) in clear.iter().zip(&fog) {
        assert!((one.place - other.place).length() < 1e-5);
        let lost = (-2.0 * extinction * one.place.length()).exp();
        assert!((other.intensity / one.intensity / lost - 1.0).abs() < 1e-4, "{}", other.intensity);
    }
    // 0.0125 is left of the wall's 0.8 from 8 m; 0.9 from 8 m is 0.0141, and the plate returns 0.044.
    let near = seen("<receiver_reach>8</receiver_reach>");
    assert!(near.len() > 500 && near.iter().all(|point| met(point).1 == PLATE), "{}", near.len());
    let far = seen("<receiver_reach>12</receiver_reach>");
    assert_eq!(far.len(), clear.len());
}

/// The second returns are in a separate cloud, pixel by pixel.
#[test]
fn second_returns_of_an_ouster_are_a_second_cloud() {
    let beams = own("<preset>os0_32</preset><columns>2048</columns><returns>dual</returns>") + &velodyne("");
    let images = ["points", "points2"].map(|topic| taken(&beams, topic));
    let [first, second] = images.map(|(header, frame)| {
        assert_eq!(header.encoding(), Some(Encoding::OusterPoint));
        assert_eq!((header.width, header.height, header.elem_stride), (2048, 32, 48));
        let view = frame.view();
        let place = |bytes: [u8; 48]| {
            let float = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
            DVec3::new(float(0), float(4), float(8))
        };
        view.numbers::<[u8; 48]>(view.rows()).map(place).collect::<Vec<_>>()
    });
    let both = first.iter().zip(&second).filter(|(_, second)| !second.is_nan()).collect::<Vec<_>>();
    assert!(both.len() > 4, "{}", both.len());
    for (one, other) in both {
        assert!((one.length() - other.length()).abs() > 1.0, "{one} {other}");
        let off = one.normalize().angle_between(other.normalize());
        assert!(off < 0.02, "{off}");
    }
}

fn lidar_of(beams: &str) -> Result<Lidar, String> {
    let mut model = load::model(&floating(beams)).map_err(|error| error.to_string())?;
    let SensorKind::Ray(lidar) = model.sensors.remove(0).kind else { panic!() };
    Ok(lidar)
}

#[test]
fn elements_of_the_plugin_are_those_of_a_scanner() {
    let all = "<preset>vlp16</preset><returns>3</returns><beam_rays>19</beam_rays><beam_divergence>0.002 0.001</beam_divergence>
        <beam_aperture>0.01 0.02</beam_aperture><pulse_length>0.5</pulse_length><intensity>power</intensity>
        <receiver_reach>90</receiver_reach><receiver_resolution>0.1</receiver_resolution><receiver_background>3</receiver_background>
        <beam_halo>0.02 0.01</beam_halo><crosstalk>0.001</crosstalk><fog_visibility>50</fog_visibility><rain_rate>30</rain_rate><snow_rate>2</snow_rate>";
    let physics = lidar_of(&(own(all) + &velodyne(""))).unwrap().physics;
    assert_eq!(physics.beam, Beam { divergence_rad: [0.002, 0.001], aperture_m: [0.01, 0.02], rays: 19 });
    assert_eq!(
        (physics.returns, physics.intensity, physics.pulse_m),
        (Returns::Several(3), Intensity::Power, 0.5)
    );
    assert_eq!(physics.halo, Halo { share: 0.02, radius_rad: 0.01 });
    assert_eq!(physics.crosstalk, Crosstalk { chance: 0.001 });
    assert_eq!(physics.receiver, Some(Receiver { reach_m: 90.0, resolution_m: 0.1, background: 3.0 }));
    assert_eq!(physics.weather, Weather { visibility_m: 50.0, rain_mm_per_h: 30.0, snow_mm_per_h: 2.0 });
    // If more than the strongest return is requested, the beam has several rays, and the width of the preset's beam.
    let lidar = lidar_of(&(own("<preset>vlp16</preset><returns>dual</returns>") + &velodyne(""))).unwrap();
    let beam = Beam { divergence_rad: [3e-3, 1.5e-3], aperture_m: [0.0127, 0.0095], rays: 8 };
    assert_eq!((lidar.physics.returns, lidar.physics.beam), (Returns::Dual, beam));
    let lidar = lidar_of(&(own("<preset>vlp16</preset>") + &velodyne(""))).unwrap();
    assert_eq!((lidar.physics.returns, lidar.physics.beam.rays), (Returns::Strongest, 1));
    // Ouster's profile with two returns implies two returns of the packets, and the reverse.
    let dual = PacketProfile::Rng19Rfl8Sig16Nir16Dual;
    for more in
        ["<returns>dual</returns>", "<udp_profile_lidar>RNG19_RFL8_SIG16_NIR16_DUAL</udp_profile_lidar>"]
    {
        let lidar = lidar_of(&(own(&format!("<preset>os1_32</preset>{more}")) + &velodyne(""))).unwrap();
        assert_eq!(
            (lidar.profile, lidar.physics.returns, lidar.physics.beam.rays),
            (dual, Returns::Ranked(2), 8)
        );
    }
}

#[test]
fn invalid_beams_are_refused_with_their_line() {
    let laser = "<plugin name='p' filename='libgazebo_ros_laser.so'><topicName>points</topicName></plugin>";
    let vlp = |element: &str| own(&format!("<preset>vlp16</preset>\n{element}")) + &velodyne("");
    for (beams, expected) in [
        (
            vlp("<returns>both</returns>"),
            "<returns> of sensor 's' is 'both'; write strongest, first, last, dual, mean, or a number",
        ),
        (vlp("<returns>6</returns>"), "<returns> of sensor 's' is '6'"),
        (vlp("<beam_rays>9</beam_rays>"), "<beam_rays> of sensor 's' is 9; write 1, 7, 8 or 19"),
        (vlp("<beam_divergence>1</beam_divergence>"), "too few numbers"),
        (
            vlp("<beam_divergence>1 1</beam_divergence>"),
            "<beam_divergence> of sensor 's' is 1 1; write two numbers from 0 to 0.2",
        ),
        (vlp("<beam_aperture>0 -1</beam_aperture>"), "<beam_aperture> of sensor 's' is 0 -1"),
        (vlp("<pulse_length>-1</pulse_length>"), "<pulse_length> of sensor 's' is -1"),
        (
            vlp("<intensity>grey</intensity>"),
            "<intensity> of sensor 's' is 'grey'; write retro, power, reflectivity",
        ),
        (vlp("<receiver_reach>0</receiver_reach>"), "<receiver_reach> of sensor 's' is 0"),
        (
            vlp("<receiver_background>1</receiver_background>"),
            "needs a receiver with a reach; write <receiver_reach>",
        ),
        (
            vlp("<beam_halo>0.6 0.01</beam_halo>"),
            "<beam_halo> of sensor 's' is 0.6 0.01; write a share of the light, 0 to 0.5, and a radius",
        ),
        (vlp("<crosstalk>1.5</crosstalk>"), "<crosstalk> of sensor 's' is 1.5; write a share of the firings"),
        (
            vlp("<fog_visibility>0.5</fog_visibility>"),
            "<fog_visibility> of sensor 's' is 0.5; write 1 or more",
        ),
        (vlp("<rain_rate>501</rain_rate>"), "<rain_rate> of sensor 's' is 501; write a number from 0 to 500"),
        (vlp("<snow_rate>wet</snow_rate>"), "'wet' is not a finite number"),
        (
            own("<preset>hdl32e</preset>\n<returns>dual</returns>") + &velodyne(""),
            "<returns> of sensor 's' needs beams with a width, but these have none; write <beam_divergence>",
        ),
        (
            own(
                "<preset>os1_32</preset><udp_profile_lidar>RNG19_RFL8_SIG16_NIR16_DUAL</udp_profile_lidar>\n<returns>last</returns>",
            ) + &velodyne(""),
            "<udp_profile_lidar> of sensor 's' has two returns, but <returns> has not",
        ),
        (
            own("<preset>lms111</preset>\n<returns>dual</returns>") + laser,
            "requests several returns, but a scan has one per ray",
        ),
        (
            own("\n<rain_rate>3</rain_rate>")
                + "<ray><range><min>0.1</min><max>9</max></range></ray>"
                + laser,
            "<rain_rate> of sensor 's' only applies to scanners, and this lidar is Gazebo's; write a <preset>",
        ),
        (
            own("\n<rain_rate>3</rain_rate>")
                + "<ray><range><min>0.1</min><max>inf</max></range></ray>"
                + &velodyne(""),
            "is weather, and this lidar has an infinite range; write <receiver_reach>",
        ),
    ] {
        let refused = lidar_of(&beams).unwrap_err();
        assert!(refused.contains(expected) && refused.contains(":4: "), "{refused}");
    }
}
