//! Gazebo's GPU lidars see the outside of visuals, its CPU lidars both sides of collision shapes.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};

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
