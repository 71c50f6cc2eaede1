//! `<visibility_mask>`: a sensor looks through water, whose visual has another flag, at a wall that has all.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::payload::TagDetection;

const WATER: &str = "<sdf version='1.9'><model name='water'><static>1</static><pose>2 0 1 0 0 0</pose><link name='l'><visual name='v'>
    <visibility_flags>0x02</visibility_flags><geometry><box><size>.1 4 4</size></box></geometry>
    <fiducial><family>tag36h11</family><id>1</id><size>.1</size><pose>-.05 0 0 1.5708 0 -1.5708</pose></fiducial>
    <material><emissive>1 0 0 1</emissive><diffuse>0 0 0 1</diffuse></material></visual></link></model></sdf>";
const WALL: &str = "<sdf version='1.9'><model name='wall'><static>1</static><pose>6 0 1 0 0 0</pose><link name='l'><visual name='v'>
    <geometry><box><size>.1 10 10</size></box></geometry>
    <fiducial><family>tag36h11</family><id>2</id><size>.1</size><pose>-.05 0 0 1.5708 0 -1.5708</pose></fiducial>
    <material><emissive>0 1 0 1</emissive><diffuse>0 0 0 1</diffuse></material></visual></link></model></sdf>";

/// Each mask, and whether the water and the wall are seen.
const MASKS: [(&str, [bool; 2]); 7] = [
    ("0xFFFFFFFD", [false, true]),
    ("4294967293", [false, true]),
    ("0x02", [true, true]),
    ("3", [true, true]),
    ("0xFFFFFFFF", [true, true]),
    ("0x10000000", [false, true]),
    ("0", [false, false]),
];

/// The payload of the first frame of a sensor a metre above the ground.
fn payload(kind: &str, inside: &str, topic: &str) -> Vec<u8> {
    let sensor = format!(
        "<sdf version='1.9'><model name='m'><static>1</static><pose>0 0 1 0 0 0</pose><link name='l'>
         <sensor name='s' type='{kind}'><update_rate>10</update_rate>{inside}</sensor></link></model></sdf>"
    );
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    for model in [WATER, WALL, sensor.as_str()] {
        simulation.spawn(&load::model(model).unwrap(), SpawnOptions::default()).unwrap();
    }
    let mut frame = FrameBuf::default();
    simulation.render(topic, &mut frame).unwrap();
    frame.view().payload().to_vec()
}

fn range(kind: &str, mask: &str) -> f32 {
    let element = if kind.ends_with("ray") { "ray" } else { "lidar" };
    let inside = format!(
        "<topic>scan</topic><{element}><visibility_mask>{mask}</visibility_mask><scan><horizontal><samples>1</samples>
         </horizontal></scan><range><min>0.1</min><max>20</max></range></{element}>"
    );
    bytemuck::pod_read_unaligned(&payload(kind, &inside, "scan")[..4])
}

#[test]
fn lidars_that_see_visuals() {
    for kind in ["gpu_ray", "gpu_lidar"] {
        for (mask, seen) in MASKS {
            let expected = match seen {
                [true, _] => 1.95,
                [false, true] => 5.95,
                _ => f32::INFINITY,
            };
            let found = range(kind, mask);
            assert!(
                found == expected || (found - expected).abs() < 1e-5,
                "{kind}, {mask}: {found} is not {expected}"
            );
        }
    }
    // Collision shapes have no flags, and there are none here.
    for kind in ["ray", "lidar"] {
        assert_eq!(range(kind, "0x02"), f32::INFINITY);
    }
}

#[test]
fn cameras_and_depth_cameras() {
    for (mask, [water, wall]) in MASKS {
        let camera = format!(
            "<camera><visibility_mask>{mask}</visibility_mask><horizontal_fov>0.1</horizontal_fov><image><width>1</width>
             <height>1</height></image><clip><near>0.1</near><far>20</far></clip></camera>"
        );
        let pixel = payload("camera", &format!("<topic>eye</topic>{camera}"), "eye");
        let is = |value: u8| value > 200;
        assert_eq!(
            [is(pixel[0]), is(pixel[1]) && !is(pixel[0])],
            [water, wall && !water],
            "{mask}: {pixel:?}"
        );
        // A tag on what is hidden is not in the ground truth, and what is hidden does not hide a tag.
        let tags = payload("camera", &format!("<topic>eye</topic>{camera}"), "eye/truth/tags");
        let tags: Vec<TagDetection> = bytemuck::pod_collect_to_vec(&tags);
        let expected = match [water, wall] {
            [true, _] => &[1][..],
            [false, true] => &[2],
            _ => &[],
        };
        assert_eq!(tags.iter().map(|tag| tag.id).collect::<Vec<_>>(), expected, "{mask}: {tags:?}");
        let depth = payload("depth_camera", &format!("<topic>deep</topic>{camera}"), "deep");
        let depth: f32 = bytemuck::pod_read_unaligned(&depth[..4]);
        let expected = match [water, wall] {
            [true, _] => 1.95,
            [false, true] => 5.95,
            _ => f32::INFINITY,
        };
        assert!(depth == expected || (depth - expected).abs() < 1e-5, "{mask}: {depth} is not {expected}");
    }
}
