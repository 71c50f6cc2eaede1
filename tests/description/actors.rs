//! Actors follow their scripts, and are seen, pushed against and deleted like any other model.

use crate::sdf::{Folder, load};
use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::Duration;

/// A box of 1 m that moves from x = 3 to x = 5 in 2 s and back in 2 s, starting after half a second.
const SCRIPT: &str =
    "<script><loop>true</loop><delay_start>0.5</delay_start><trajectory id='0' type='x' tension='1'>
    <waypoint><time>0</time><pose>3 0 1 0 0 0</pose></waypoint>
    <waypoint><time>2</time><pose>5 0 1 0 0 0</pose></waypoint>
    <waypoint><time>4</time><pose>3 0 1 0 0 0</pose></waypoint></trajectory></script>";

const BOX: &str =
    "<link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>
    <collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link>";

const LIDAR: &str =
    "<sdf version='1.6'><model name='eye'><static>true</static><link name='l'><pose>0 0 1 0 0 0</pose>
    <sensor name='s' type='gpu_ray'><ray><scan><horizontal><samples>1</samples><min_angle>0</min_angle>
    <max_angle>0</max_angle></horizontal></scan><range><min>0.1</min><max>20</max></range></ray>
    <topic>scan</topic></sensor></link></model></sdf>";

fn world_of(inside: &str) -> String {
    format!("<sdf version='1.6'><world name='w'>{inside}</world></sdf>")
}

/// The ranges of the lidar at these times in seconds, in increasing order.
fn ranges(world: &str, times: &[f64]) -> Vec<f64> {
    let folder = Folder::new();
    let (world, _) = load(folder.write("w.world", world).to_str().unwrap(), false);
    let mut simulation = Simulation::builder(world.unwrap()).build().unwrap();
    simulation.spawn(&load::model(LIDAR).unwrap(), SpawnOptions::default()).unwrap();
    let (mut frame, mut now) = (FrameBuf::default(), 0.0);
    let mut range = |time: &f64| {
        simulation.run_for(Duration::from_secs_f64(time - now));
        now = *time;
        simulation.render("scan", &mut frame).unwrap();
        f64::from(bytemuck::cast_slice::<u8, f32>(frame.view().payload())[0])
    };
    times.iter().map(&mut range).collect()
}

#[test]
fn an_actor_follows_its_script_and_repeats_it() {
    let world = world_of(&format!("<actor name='a'><pose>9 0 1 0 0 0</pose>{BOX}{SCRIPT}</actor>"));
    // At its <pose> until the script begins; half-way at 1.5 s; at rest at each waypoint.
    let cases =
        [(0.2, 8.5), (0.5, 2.5), (1.5, 3.5), (2.5, 4.5), (4.0, 2.5 + 2.0 * 0.15625), (4.5, 2.5), (6.5, 4.5)];
    let times = cases.map(|(time, _)| time);
    for ((time, expected), found) in cases.iter().zip(ranges(&world, &times)) {
        assert!((found - expected).abs() < 1e-5, "{found} m at {time} s, not {expected}");
    }
}

#[test]
fn an_actor_pushes_bodies_and_is_not_pushed() {
    let ball = "<model name='ball'><pose>5.8 0 1 0 0 0</pose><link name='l'><gravity>false</gravity><inertial><mass>5000</mass>
        </inertial><collision name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision></link></model>";
    let world = world_of(&format!("<actor name='a'>{BOX}{SCRIPT}</actor>{ball}"));
    let folder = Folder::new();
    let (world, _) = load(folder.write("w.world", &world).to_str().unwrap(), false);
    let mut simulation = Simulation::builder(world.unwrap()).build().unwrap();
    let at = |simulation: &Simulation, name: &str| {
        let id = simulation.find(name).unwrap();
        simulation.pose(id).unwrap().translation()
    };
    simulation.run_for(Duration::from_millis(2500));
    let (actor, ball) = (at(&simulation, "a"), at(&simulation, "ball"));
    assert!(actor.distance(DVec3::new(5.0, 0.0, 1.0)) < 1e-9, "{actor}");
    assert!(ball.x > 5.98, "{ball}");
    simulation.run_for(Duration::from_secs(2));
    let actor = at(&simulation, "a");
    assert!(actor.distance(DVec3::new(3.0, 0.0, 1.0)) < 1e-9, "{actor}");
    let moved = simulation.place(simulation.find("a").unwrap(), &Pose::IDENTITY, DVec3::ZERO, DVec3::ZERO);
    assert!(moved.unwrap_err().to_string().contains("'a' follows its script"));
}

/// A skin in inches that its bind shape raises by a metre and scales by a half, with an animation that Gazebo would
/// play.
const SKIN: &str = r##"<COLLADA version="1.4.1"><asset><unit meter="0.0254"/></asset>
    <library_geometries><geometry id="g"><mesh>
      <source id="p"><float_array id="pa" count="12">40 -40 -40 40 40 -40 40 0 40 80 0 0</float_array>
        <technique_common><accessor source="#pa" count="4" stride="3"/></technique_common></source>
      <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
      <triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 1 2 3</p></triangles>
    </mesh></geometry></library_geometries>
    <library_controllers><controller id="c"><skin source="#g">
      <bind_shape_matrix>0.5 0 0 0  0 0.5 0 0  0 0 0.5 39.3700787  0 0 0 1</bind_shape_matrix></skin></controller></library_controllers>
    <library_visual_scenes><visual_scene id="s"><node id="n"><translate>500 0 0</translate><instance_controller url="#c"/></node>
    </visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;

#[test]
fn a_skin_is_seen_in_its_bind_pose() {
    let folder = Folder::new();
    folder.write("walk.dae", SKIN);
    let actor =
        "<actor name='a'><skin><filename>walk.dae</filename><scale>2</scale></skin><animation name='walk'>
        <filename>walk.dae</filename></animation><script><trajectory id='0' type='walk'>
        <waypoint><time>0</time><pose>1 0 -1 0 0 0</pose></waypoint></trajectory></script></actor>";
    let path = folder.write("w.world", world_of(actor));
    let (world, problems) = load(path.to_str().unwrap(), false);
    let reported: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert!(
        reported.len() == 1 && reported[0].contains("skeleton animations are not played"),
        "{reported:#?}"
    );
    let mut simulation = Simulation::builder(world.unwrap()).build().unwrap();
    simulation.spawn(&load::model(LIDAR).unwrap(), SpawnOptions::default()).unwrap();
    let mut frame = FrameBuf::default();
    simulation.render("scan", &mut frame).unwrap();
    let range: &[f32] = bytemuck::cast_slice(frame.view().payload());
    // 40 inches, halved and doubled, a metre ahead; the middle is at 2 · 1 m − 1 m.
    assert!((f64::from(range[0]) - (1.0 + 40.0 * 0.0254)).abs() < 1e-5, "{range:?}");
}

#[test]
fn errors_of_an_actor_name_their_line() {
    let folder = Folder::new();
    let cases = [
        ("<actor>\n<link name='l'/></actor>", "w.world:1", "has no name"),
        ("<actor name='a'>\n<pose>0 0 0 0 0 0</pose></actor>", "w.world:1", "has nothing to show"),
        ("<actor name='a'>\n<skin/></actor>", "w.world:2", "<skin> has no <filename>"),
        ("<actor name='a'><skin>\n<filename>none.dae</filename></skin></actor>", "w.world:1", "none.dae"),
        (
            "<actor name='a'><link name='l'/><script><trajectory id='0' type='x'>\n<waypoint><time>-1</time>
             <pose>0 0 0 0 0 0</pose></waypoint></trajectory></script></actor>",
            "w.world:2",
            "the <time> of a waypoint is -1 s",
        ),
        (
            "<actor name='a'><link name='l'/><script>\n<trajectory id='0' type='x' tension='2'/></script></actor>",
            "w.world:2",
            "the tension of a trajectory is 2",
        ),
        (
            "<actor name='a'><link name='l'/>\n<script><auto_start>false</auto_start></script></actor>",
            "w.world:2",
            "nothing starts it",
        ),
    ];
    for (actor, place, what) in cases {
        let path = folder.write("w.world", world_of(actor));
        let (_, problems) = load(path.to_str().unwrap(), false);
        let reported: Vec<String> = problems.iter().map(ToString::to_string).collect();
        assert!(
            reported.iter().any(|reported| reported.contains(place) && reported.contains(what)),
            "{actor}: {reported:#?}"
        );
    }
}
