//! `<experimental:params>`: an `<include>` that alters what it includes.

use crate::sdf::*;
use belvedere::description::model::{Geometry, Link, Model, SensorKind};
use belvedere::description::{Problem, Severity};

const EYEBOX: &str = "<sdf version='1.7'><model name='eyebox'><static>1</static>
    <link name='body'><sensor name='cam' type='camera'><topic>cam</topic><update_rate>30</update_rate>
      <camera name='lens'><horizontal_fov>1</horizontal_fov><image><width>8</width><height>6</height></image></camera></sensor>
      <visual name='shell'><pose>0 0 1 0 0 0</pose><geometry><box><size>1 1 1</size></box></geometry><laser_retro>5</laser_retro>
        <material><diffuse>1 0 0 1</diffuse></material></visual>
      <collision name='shell'><geometry><box><size>1 1 1</size></box></geometry></collision></link>
    <link name='body::lid'/>
    <model name='arm'><link name='hand'><visual name='v'><geometry><sphere><radius>1</radius></sphere></geometry></visual></link></model>
    <include><uri>model://lamp</uri><name>torch</name></include><include><uri>model://lamp</uri></include>
  </model></sdf>";
const LAMP: &str = "<sdf version='1.9'><model name='lamp'><link name='bulb'><visual name='glass'><geometry><sphere>\
    <radius>1</radius></sphere></geometry></visual></link></model></sdf>";

fn altered(params: &str, in_model: bool) -> (Option<Model>, Vec<Problem>) {
    let folder = Folder::new();
    folder.write("eyebox/model.sdf", EYEBOX);
    folder.write("lamp/model.sdf", LAMP);
    let include = format!(
        "<include><uri>model://eyebox</uri><experimental:params>\n{params}\n</experimental:params></include>"
    );
    let content = if in_model { format!("<model name='m'>{include}</model>") } else { include };
    let (world, problems) = folder.load("1.9", &content, false);
    (world.and_then(|mut world| world.models.pop()), problems)
}

#[track_caller]
fn good_model(params: &str) -> Model {
    let (model, problems) = altered(params, false);
    assert!(problems.is_empty(), "{problems:#?}");
    model.unwrap()
}

fn link<'m>(model: &'m Model, name: &str) -> &'m Link {
    &model.links[model.link_named(name).unwrap_or_else(|| panic!("{name}"))]
}

/// The radius of a sphere.
#[track_caller]
fn radius(geometry: &Geometry) -> f64 {
    let Geometry::Sphere { radius } = geometry else { panic!("{geometry:?}") };
    *radius
}

#[test]
fn modify() {
    let sensor = "<sensor element_id='body::cam' action='modify'><update_rate>5</update_rate><camera><image><width>16</width>\
        </image></camera></sensor>";
    for in_model in [false, true] {
        let (model, problems) = altered(sensor, in_model);
        // The <camera> of the included model has a name, and that here has none.
        let [only] = &problems[..] else { panic!("{problems:#?}") };
        assert!(only.severity == Severity::Warning && only.to_string().contains("'lens' is meant"), "{only}");
        let model = model.unwrap();
        assert_eq!(model.sensors[0].update_rate_hz, Some(5.0));
        let SensorKind::Camera(camera) = &model.sensors[0].kind else { panic!() };
        assert_eq!([camera.camera.width, camera.camera.height], [16, 6]);
    }
    let model = good_model(
        "<visual element_id='body::shell' action='modify'><pose relative_to='arm'>0 0 3 0 0 0</pose><laser_retro/></visual>
         <model element_id='arm' action='modify'><link name='hand'><visual name='v'><geometry><sphere><radius>2</radius>\
         </sphere></geometry></visual></link></model>
         <link element_id='body' action='modify' name='trunk'/>",
    );
    let trunk = link(&model, "trunk");
    assert_eq!((trunk.visuals[0].link_from_visual.translation().z, trunk.visuals[0].laser_retro), (3.0, 0.0));
    assert_eq!(radius(&link(&model, "arm::hand").visuals[0].geometry), 2.0);
}

#[test]
fn add_remove_and_replace() {
    let model = good_model(
        "<visual element_id='body' name='knob' action='add'><geometry><sphere><radius>3</radius></sphere></geometry></visual>
         <link element_id='' name='wheel' action='add'><pose relative_to='body'>0 2 0 0 0 0</pose></link>
         <sensor element_id='body::cam' action='remove'/>
         <visual element_id='body::shell' action='remove'><laser_retro/></visual>
         <collision element_id='body::shell' name='hull' action='replace'><geometry><sphere><radius>4</radius></sphere></geometry></collision>
         <visual element_id='arm::hand' name='w' action='add'><geometry><sphere><radius>5</radius></sphere></geometry></visual>",
    );
    let body = link(&model, "body");
    let shapes: Vec<_> =
        body.visuals.iter().map(|visual| (visual.name.as_str(), visual.laser_retro)).collect();
    assert_eq!(shapes, [("shell", 0.0), ("knob", 0.0)]);
    let [hull] = &body.collisions[..] else { panic!() };
    assert_eq!((hull.name.as_str(), radius(&hull.geometry)), ("hull", 4.0));
    assert!(model.sensors.is_empty());
    assert_eq!(link(&model, "wheel").model_from_link.translation().y, 2.0);
    assert_eq!(link(&model, "arm::hand").visuals.len(), 2);
}

#[test]
fn each_element_has_an_action_of_its_own() {
    let model = good_model(
        "<visual element_id='body::shell'><laser_retro action='modify'>7</laser_retro>
           <geometry action='replace'><sphere><radius>0.5</radius></sphere></geometry>
           <material action='remove'><diffuse/></material><transparency action='add'>0.5</transparency></visual>
         <link element_id='body'><collision name='shell' action='remove'/></link>",
    );
    let body = link(&model, "body");
    let [shell] = &body.visuals[..] else { panic!() };
    assert_eq!((shell.laser_retro, shell.material.alpha, radius(&shell.geometry)), (7.0, 0.5, 0.5));
    assert!(body.collisions.is_empty());
}

#[test]
fn what_the_included_file_includes_is_altered_too() {
    let model = good_model(
        "<visual element_id='torch::bulb::glass' action='modify'><geometry><sphere><radius>2</radius></sphere></geometry></visual>
         <visual element_id='lamp::bulb' name='frame' action='add'><geometry><box><size>1 1 1</size></box></geometry></visual>
         <visual element_id='lamp::bulb::glass' action='remove'/>",
    );
    assert_eq!(radius(&link(&model, "torch::bulb").visuals[0].geometry), 2.0);
    let [frame] = &link(&model, "lamp::bulb").visuals[..] else { panic!() };
    assert_eq!(frame.name, "frame");
}

#[test]
fn a_model_that_the_included_file_includes_is_altered_itself() {
    let model = good_model(
        "<model element_id='torch' action='modify' name='lantern'><pose>0 0 7 0 0 0</pose><link name='bulb'><visual name='glass'>\
         <geometry><sphere><radius>3</radius></sphere></geometry></visual></link></model>
         <visual element_id='lantern::bulb::glass' action='modify'><geometry><sphere><radius>4</radius></sphere></geometry></visual>
         <model element_id='lamp'><link name='bulb' action='remove'/><link name='wick' action='add'/></model>",
    );
    let bulb = link(&model, "lantern::bulb");
    assert_eq!((bulb.model_from_link.translation().z, radius(&bulb.visuals[0].geometry)), (7.0, 4.0));
    assert!(model.link_named("lamp::wick").is_some() && model.link_named("lamp::bulb").is_none());

    let model = good_model(
        "<model element_id='torch' action='remove'/>
         <model element_id='lamp' action='replace' name='candle'><link name='wick'/></model>",
    );
    let names: Vec<_> = model.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(names, ["body", "body::lid", "arm::hand", "candle::wick"]);

    let model = good_model(
        "<model element_id='torch' action='remove'><link name='bulb'><visual name='glass'/></link></model>
         <link element_id='torch' name='wick' action='add'/>",
    );
    assert!(model.link_named("torch::wick").is_some() && model.link_named("torch::bulb").is_none());
}

#[test]
fn a_message_quotes_little_of_a_long_id() {
    let id = "x".repeat(60_000);
    let (_, problems) = altered(&format!("<sensor element_id='{id}' action='modify'/>"), false);
    let [only] = &problems[..] else { panic!("{}", problems.len()) };
    assert!(only.what.contains("'xxx") && only.to_string().len() < 1000, "{}", only.to_string().len());
}

#[test]
fn what_cannot_be_altered_is_one_error_at_its_place() {
    for (params, words) in [
        ("<sensor action='modify'/>", &["<sensor> of <experimental:params>", "element_id"][..]),
        ("<sensor element_id='body::' action='modify'/>", &["'body::'", "::"]),
        (
            "<sensor element_id='body::cam' action='change'/>",
            &["the action 'change'", "add, modify, remove or replace"],
        ),
        ("<sensor element_id='body::came' action='modify'/>", &["'body::came'", "did you mean 'body::cam'?"]),
        ("<visual element_id='body::cam' action='remove'/>", &["<visual>", "'body::cam'", "does not have"]),
        ("<visual element_id='nobody' name='v' action='add'/>", &["'nobody'"]),
        ("<visual element_id='body' action='add'/>", &["has no name"]),
        ("<visual element_id='body' name='shell' action='add'/>", &["'body'", "there is one of that name"]),
        ("<link element_id='' name='body' action='add'/>", &["there is one of that name"]),
        (
            "<visual element_id='body::shell'><laser_retro>1</laser_retro></visual>",
            &["<laser_retro>", "has no action"],
        ),
        (
            "<visual element_id='body::shell'><laser_retro action='set'>1</laser_retro></visual>",
            &["the action 'set'"],
        ),
        (
            "<visual element_id='body::shell'><transparency action='remove'/></visual>",
            &["<transparency>", "does not have"],
        ),
        (
            "<visual element_id='body::shell' action='modify'><transparency>1</transparency></visual>",
            &["<transparency>"],
        ),
        ("<link element_id='body'><visual name='shel' action='remove'/></link>", &["did you mean 'shell'?"]),
        (
            "<visual element_id='body::shell' action='replace'><geometry/></visual>",
            &["replaces an element with a name"],
        ),
        (
            "<model element_id='lamp' action='remove'><link name='wick'/></model>",
            &["of the name 'wick'", "<model> 'lamp' does not have"],
        ),
        ("<model element_id='lamps' action='remove'/>", &["'lamps'", "does not have"]),
    ] {
        let (_, problems) = altered(params, false);
        assert_one_error(&problems, 3, words);
    }
    // What is added is looked at as if it stood in the file.
    let unknown = "<visual element_id='body' name='v' action='add'><geomtry/>\
        <geometry><sphere><radius>1</radius></sphere></geometry></visual>";
    let (_, problems) = altered(unknown, false);
    assert!(
        matches!(&problems[..], [only] if only.to_string().contains("did you mean 'geometry'?")),
        "{problems:#?}"
    );
}
