//! `<optics>` of visuals and collisions: lidars and depth cameras see reflections in mirrors and surfaces behind panes.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};

/// A wall 4 m to the left, a mirror 3 m ahead at 45° that reflects it, and a pane 2 m behind with a wall 5 m behind.
/// Gazebo's CPU lidars see the collisions, all other sensors the visuals.
fn walls(part: &str) -> String {
    let thing = |name: &str, pose: &str, size: &str, optics: &str| {
        format!(
            "<{part} name='{name}'><pose>{pose}</pose>{optics}<laser_retro>{}</laser_retro>
             <geometry><box><size>{size}</size></box></geometry></{part}>",
            name.len()
        )
    };
    let optics = |reflectance: f64, transmittance: f64| {
        format!(
            "<optics><specular_reflectance>{reflectance}</specular_reflectance><transmittance>{transmittance}</transmittance></optics>"
        )
    };
    let quarter = std::f64::consts::FRAC_PI_4;
    // The front of the mirror goes through (3, 0).
    let back = 3.0 + 0.05 * std::f64::consts::SQRT_2;
    let things = [
        thing("mirror", &format!("{back} 0 1 0 0 {}", -quarter), "0.1 2 2", &optics(0.9, 0.0)),
        thing("left", "3 4.1 1 0 0 0", "2 0.2 2", ""),
        thing("pane", "-2 0 1 0 0 0", "0.01 2 2", &optics(0.08, 0.9)),
        thing("behind", "-5.1 0 1 0 0 0", "0.2 2 2", ""),
    ];
    format!(
        "<sdf version='1.6'><model name='walls'><static>true</static><link name='l'>{}</link></model></sdf>",
        things.concat()
    )
}

fn taken(sensor: &str, part: &str, topic: &str) -> FrameBuf {
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    let robot = format!(
        "<sdf version='1.6'><model name='m'><static>true</static><link name='l'>{sensor}</link></model></sdf>"
    );
    for model in [walls(part), robot] {
        simulation.spawn(&load::model(&model).unwrap(), SpawnOptions::default()).unwrap();
    }
    let mut frame = FrameBuf::default();
    simulation.render(topic, &mut frame).unwrap();
    frame
}

#[test]
fn lidars_see_reflections_and_through_panes() {
    for (kind, part) in [("ray", "collision"), ("gpu_ray", "visual")] {
        let lidar = format!(
            "<sensor name='s' type='{kind}'><pose>0 0 1 0 0 0</pose><ray><scan><horizontal><samples>3</samples>
             <min_angle>0</min_angle><max_angle>3.14159265</max_angle></horizontal></scan>
             <range><min>0.1</min><max>20</max></range></ray><topic>scan</topic></sensor>"
        );
        let frame = taken(&lidar, part, "scan");
        let planes: &[f32] = bytemuck::cast_slice(frame.view().payload());
        // Ahead, the wall on the left, 3 + 4 m away; on the left nothing; behind, the wall behind the pane.
        let expected = [7.0, f32::INFINITY, 5.0];
        for (found, expected) in planes[..3].iter().zip(expected) {
            let near = (found - expected).abs() < 1e-4 || *found == expected;
            assert!(near, "{kind}: {:?} instead of {expected}", &planes[..3]);
        }
        // For "left" and "behind", `laser_retro` is the number of letters of the name.
        assert_eq!(planes[3..6], [4.0, 0.0, 6.0], "{kind}");
    }
}

#[test]
fn depth_cameras_see_reflections_and_through_panes() {
    for (yaw, expected) in [(0.0, 7.0), (std::f64::consts::PI, 5.0)] {
        let camera = format!(
            "<sensor name='s' type='depth_camera'><pose>0 0 1 0 0 {yaw}</pose><camera><horizontal_fov>0.1</horizontal_fov>
             <image><width>9</width><height>7</height></image><clip><near>0.1</near><far>20</far></clip></camera>
             <topic>depth</topic></sensor>"
        );
        let frame = taken(&camera, "visual", "depth");
        let depths: &[f32] = bytemuck::cast_slice(frame.view().payload());
        let middle = depths[3 * 9 + 4];
        assert!((middle - expected).abs() < 1e-4, "{middle}, not {expected}");
    }
}

#[test]
fn invalid_optics_are_refused_with_their_line() {
    let model = |optics: &str| {
        format!(
            "<sdf version='1.6'><model name='m'><link name='l'><visual name='v'>
             <geometry><box><size>1 1 1</size></box></geometry>
{optics}</visual></link></model></sdf>"
        )
    };
    for (optics, expected) in [
        (
            "<optics><transmittance>1.2</transmittance></optics>",
            "<transmittance> of an <optics> is 1.2; write a share",
        ),
        (
            "<optics><specular_reflectance>-1</specular_reflectance></optics>",
            "is -1; write a share of the light, 0 to 1",
        ),
        (
            "<optics><specular_reflectance>0.6</specular_reflectance><transmittance>0.5</transmittance></optics>",
            "an <optics> reflects 0.6 of the light and transmits 0.5, more than 1 in total",
        ),
    ] {
        let refused = load::model(&model(optics)).unwrap_err().to_string();
        assert!(refused.contains(expected) && refused.contains(":3: "), "{refused}");
    }
    let fine = load::model(&model("<optics><transmittance>0.9</transmittance></optics>")).unwrap();
    let optics = fine.links[0].visuals[0].optics;
    assert_eq!((optics.specular_reflectance, optics.transmittance), (0.0, 0.9));
}
