//! Gazebo's GPU lidars see the outside of visuals, its CPU lidars both sides of collision shapes.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::point::XyzIrPoint;
use belvedere_bridge::{Encoding, Kind};
use std::f64::consts::FRAC_PI_2;

const FREE: f32 = f32::INFINITY;

/// The surroundings of the sensor: ahead a wall with only a visual, on the left one with only a collision shape, behind
/// one with both, whose visual is nearer; on the right an open sheet with both, whose outside faces away.
const WALLS: &str = "<sdf version='1.6'><model name='walls'><static>true</static><link name='l'>
    <visual name='ahead'><pose>3 0 1 0 0 0</pose><laser_retro>7</laser_retro><geometry><box><size>0.2 2 2</size></box></geometry></visual>
    <collision name='left'><pose>0 4 1 0 0 0</pose><geometry><box><size>2 0.2 2</size></box></geometry></collision>
    <visual name='behind'><pose>-2 0 1 0 0 0</pose><geometry><box><size>0.2 2 2</size></box></geometry></visual>
    <collision name='behind'><pose>-5 0 1 0 0 0</pose><laser_retro>9</laser_retro><geometry><box><size>0.2 2 2</size></box></geometry></collision>
    <visual name='right'><pose>0 -6 1 0 0 0</pose><geometry><plane><normal>0 -1 0</normal><size>2 2</size></plane></geometry></visual>
    <collision name='right'><pose>0 -6 1 0 0 0</pose><geometry><box><size>2 0.2 2</size></box></geometry></collision>
    </link></model></sdf>";

/// A lidar of four beams (ahead, left, behind, right) in a housing with a visual and a collision shape.
fn lidar(kind: &str, frames: &str) -> String {
    let housing = "<pose>0 0 1 0 0 0</pose><geometry><box><size>.3 .3 .3</size></box></geometry>";
    // The outside of the head in the housing would be visible.
    let head = "<pose>0 0 1 0 0 0</pose><geometry><cylinder><radius>.05</radius><length>.1</length></cylinder></geometry>";
    format!(
        "<sdf version='1.6'><model name='m'><static>true</static><link name='l'>
         <visual name='v'>{housing}</visual><visual name='h'>{head}</visual><collision name='c'>{housing}</collision>
         <sensor name='s' type='{kind}'><pose>0 0 1 0 0 0</pose><{frames}><scan><horizontal><samples>4</samples>
         <min_angle>0</min_angle><max_angle>4.71238898</max_angle></horizontal></scan>
         <range><min>0.1</min><max>20</max></range></{frames}><topic>scan</topic></sensor></link></model></sdf>"
    )
}

fn scan(sensor: &str) -> (Vec<f32>, Vec<f32>) {
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    for model in [WALLS, sensor] {
        simulation.spawn(&load::model(model).unwrap(), SpawnOptions::default()).unwrap();
    }
    let mut frame = FrameBuf::default();
    simulation.render("scan", &mut frame).unwrap();
    let planes: &[f32] = bytemuck::cast_slice(frame.view().payload());
    (planes[..4].to_vec(), planes[4..8].to_vec())
}

#[track_caller]
fn assert_sees(sensor: &str, ranges: [f32; 4], intensities: [f32; 4]) {
    let found = scan(sensor);
    let near = |(is, wanted): (&f32, &f32)| is == wanted || (is - wanted).abs() < 1e-5;
    assert!(found.0.iter().zip(&ranges).all(near), "{:?} instead of {ranges:?}", found.0);
    assert_eq!(found.1, intensities);
}

#[test]
fn gpu_lidars_see_the_outside_of_visuals() {
    for (kind, element) in [("gpu_ray", "ray"), ("gpu_lidar", "lidar")] {
        assert_sees(&lidar(kind, element), [2.9, FREE, 1.9, FREE], [7.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn cpu_lidars_hit_collision_shapes() {
    for (kind, element) in [("ray", "ray"), ("lidar", "lidar")] {
        assert_sees(&lidar(kind, element), [FREE, 3.9, 4.9, 5.9], [0.0, 0.0, 9.0, 0.0]);
    }
}

/// A visual of the sensor's link that surrounds it is its housing; one beside the sensor blocks its view.
#[test]
fn a_gpu_lidar_sees_through_its_housing() {
    let post = "</visual><visual name='post'><pose>0 0.5 1 0 0 0</pose><geometry><cylinder><radius>.02</radius><length>1</length></cylinder></geometry></visual><collision name='c'>";
    let robot = lidar("gpu_ray", "ray").replace("</visual><collision name='c'>", post);
    assert_sees(&robot, [2.9, 0.48, 1.9, FREE], [7.0, 0.0, 0.0, 0.0]);
}

/// gz-sim publishes the points of a lidar on `TOPIC/points` besides the scan on `TOPIC`.
#[test]
fn a_lidar_of_gz_sim_publishes_its_points_as_well() {
    let layers = "</horizontal><vertical><samples>3</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle></vertical>";
    let sensor = lidar("gpu_lidar", "lidar").replace("</horizontal>", layers);
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    for model in [WALLS, &sensor] {
        simulation.spawn(&load::model(model).unwrap(), SpawnOptions::default()).unwrap();
    }
    let (mut scan, mut cloud) = (FrameBuf::default(), FrameBuf::default());
    simulation.render("scan/points", &mut cloud).unwrap();
    simulation.render("scan", &mut scan).unwrap();
    let header = cloud.view().header();
    assert_eq!((header.kind(), header.encoding()), (Some(Kind::PointCloud), Some(Encoding::XyzIrF32)));
    assert_eq!((header.width, header.height, header.stamp_ns), (4, 3, scan.view().header().stamp_ns));
    assert_eq!(header.frame_id, scan.view().header().frame_id);

    let planes: &[f32] = bytemuck::cast_slice(scan.view().payload());
    let (ranges, intensities) = planes.split_at(12);
    let (points, rest) = cloud.view().payload().as_chunks::<{ XyzIrPoint::SIZE }>();
    assert_eq!((points.len(), rest.len()), (12, 0));
    let mut seen = 0;
    for (beam, bytes) in points.iter().enumerate() {
        let (layer, column) = (beam / 4, beam % 4);
        let point = XyzIrPoint::from_bytes(bytes);
        assert_eq!((usize::from(point.ring), point.intensity), (layer, intensities[beam]), "beam {beam}");
        if ranges[beam].is_infinite() {
            assert!(point.xyz().iter().all(|part| part.is_nan()), "beam {beam}: {point:?}");
            continue;
        }
        seen += 1;
        let (azimuth, elevation) = (column as f64 * FRAC_PI_2, (layer as f64 - 1.0) * 0.1);
        let direction = [elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin()];
        for (part, along) in point.xyz().into_iter().zip(direction) {
            let expected = f64::from(ranges[beam]) * along;
            assert!((f64::from(part) - expected).abs() < 1e-5, "beam {beam}: {point:?} at {}", ranges[beam]);
        }
    }
    assert_eq!(seen, 8, "two walls in three layers, and the ground on two sides of the lowest: {ranges:?}");
}

/// Classic Gazebo's plugins publish one stream, and so does a preset.
#[test]
fn other_lidars_publish_no_points_besides() {
    let plugin = |plugin: &str| lidar("gpu_ray", "ray").replace("<topic>scan</topic>", plugin);
    let classic = "<plugin name='p' filename='libgazebo_ros_laser.so'><topicName>scan</topicName><frameName>l</frameName></plugin>";
    let preset =
        "<topic>scan</topic><plugin name='d' filename='belvedere'><preset>rplidar_a1</preset></plugin>";
    for robot in [plugin(classic), plugin(preset)] {
        let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
        simulation.spawn(&load::model(&robot).unwrap(), SpawnOptions::default()).unwrap();
        let topics = simulation.topics().unwrap();
        assert!(topics.contains(&"/scan".into()), "{topics:?}");
        assert!(!topics.contains(&"/scan/points".into()), "{topics:?}");
    }
}
