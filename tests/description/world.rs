//! World files: the semantics of SDF and Gazebo.

use crate::sdf::*;
use belvedere::description::Severity;
use belvedere::description::load::{load_world, world_names};
use belvedere::description::model::{Geometry, JointKind, LightKind, ModelPlugin, SensorKind};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use belvedere_sensors::Pose;
use glam::DVec3;

#[test]
fn all_our_worlds_load_without_messages() {
    let names = world_names(&package_path([], None));
    for expected in ["corridor", "empty", "playground", "tag_ceiling"] {
        assert!(names.iter().any(|name| name == expected), "{names:?}");
    }
    for name in names {
        let (world, problems) = load(&name, false);
        assert!(problems.is_empty(), "{name}: {problems:#?}");
        assert_eq!(world.unwrap().name, name);
    }
}

#[test]
fn tags_of_a_visual_and_of_the_ceiling() {
    let tag = "<fiducial><family>tag36h11</family><id>3</id><size>0.16</size>\
               <pose>0 0.1 0.5 0 0 1.5707963267948966</pose></fiducial>";
    let world = good(
        "1.6",
        &box_visual(&format!("{tag}<fiducial><family>qr</family><id>0</id><size>1</size></fiducial>")),
    );
    let [first, second] = &world.models[0].links[0].visuals[0].fiducials[..] else { panic!("two tags") };
    assert_eq!((first.family.as_str(), first.id, first.size_m), ("tag36h11", 3, 0.16));
    close(first.visual_from_fiducial.transform_point(DVec3::X), DVec3::new(0.0, 1.1, 0.5));
    assert_eq!((second.family.as_str(), second.id, second.visual_from_fiducial), ("qr", 0, Pose::IDENTITY));
    let ceiling = load("tag_ceiling", false).0.unwrap();
    let visuals = || ceiling.models.iter().flat_map(|model| &model.links).flat_map(|link| &link.visuals);
    let count =
        |family| visuals().flat_map(|visual| &visual.fiducials).filter(|tag| tag.family == family).count();
    assert_eq!((count("tag36h11"), count("qr")), (32, 31));
}

#[test]
fn the_playground_matches_the_articles() {
    let world = load("playground", false).0.unwrap();
    assert_eq!(world.max_step_size_s, 0.01);
    let [sun] = &world.lights[..] else { panic!("{:?}", world.lights) };
    assert_eq!(sun.kind, LightKind::Directional);
    close(sun.direction, DVec3::new(0.5, 0.1, -0.9).normalize());
    assert!(sun.range_m.is_infinite() && sun.cast_shadows);
    let bounds = |name: &str| {
        let model = world.models.iter().find(|model| model.name == name).unwrap();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for collision in &model.links[0].collisions {
            let half = match collision.geometry {
                Geometry::Box { size } => size / 2.0,
                Geometry::Cylinder { radius, length } => DVec3::new(radius, radius, length / 2.0),
                ref other => panic!("{other:?}"),
            };
            let at = collision.link_from_collision.translation();
            (low, high) = (low.min(at - half), high.max(at + half));
        }
        (high - low, model.world_from_model.translation(), model.world_from_model.rpy().z)
    };
    let (size, at, _) = bounds("bookshelf");
    close(size, DVec3::new(0.9, 0.4, 1.2));
    close(at, DVec3::new(0.0, 1.53, 0.0));
    let (size, at, yaw) = bounds("jersey_barrier");
    close(size, DVec3::new(4.065, 0.811, 1.143));
    close(at, DVec3::new(-4.0, -1.0, 0.0));
    assert!((yaw + 0.7).abs() < 1e-9);
    close(bounds("cylinder").0, DVec3::ONE);
}

#[test]
fn the_corridors_walls_have_the_poses_of_its_state() {
    let world = load("corridor", false).0.unwrap();
    let at = |name: &str| {
        let model = world.models.iter().find(|model| model.name == name).unwrap();
        (model.world_from_model.translation(), model.world_from_model.rpy().z)
    };
    assert_eq!(world.max_step_size_s, 0.001);
    close(at("wall_0").0, DVec3::new(0.0, 2.0, 1.4));
    close(at("wall_4").0, DVec3::new(11.25, -1.75, 1.4));
    assert!((at("wall_4").1 - std::f64::consts::FRAC_PI_2).abs() < 1e-5);
}

#[test]
fn an_unknown_name_lists_the_names() {
    let (world, problems) = load("playgroud", false);
    assert!(world.is_none());
    let text = problems[0].to_string();
    for word in ["no such world", "did you mean 'playground'?", "corridor, empty, playground, tag_ceiling"] {
        assert!(text.contains(word), "{text}");
    }
}

#[test]
fn names_are_found_in_the_users_turtlebot_gazebo_first() {
    let folder = Folder::new();
    let text = "<sdf version='1.6'><world name='mine'/></sdf>";
    folder.write("turtlebot_gazebo/worlds/playground.world", text);
    let packages = package_path([folder.path("")], None);
    let mut diagnostics = Diagnostics::default();
    for name in ["playground", "playground.world"] {
        assert_eq!(load_world(name, &packages, Rules::default(), &mut diagnostics).unwrap().name, "mine");
    }
    assert!(load_world("corridor", &packages, Rules::default(), &mut diagnostics).is_some());
    assert!(diagnostics.problems().is_empty());
}

/// The worlds of `turtlebot_gazebo` use meshes from Gazebo's model database.
#[test]
fn a_users_world_that_lacks_models_is_replaced_by_ours() {
    let folder = Folder::new();
    let model = "<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>model://dumpster/meshes/dumpster.dae</uri>
        </mesh></geometry></visual></link></model>";
    let world = format!("<sdf version='1.4'><world name='theirs'>{model}</world></sdf>");
    folder.write("turtlebot_gazebo/worlds/playground.world", &world);
    let packages = package_path([folder.path("")], None);
    let load = |name: &str, rules| {
        let mut diagnostics = Diagnostics::default();
        let name = load_world(name, &packages, rules, &mut diagnostics).unwrap().name;
        let problems: Vec<String> = diagnostics.problems().iter().map(ToString::to_string).collect();
        (name, diagnostics.has_errors(), problems.join("\n"))
    };
    let (name, fails, said) = load("playground", Rules::default());
    assert_eq!((name.as_str(), fails), ("playground", false), "{said}");
    assert!(said.contains("our own world of its name is used instead"), "{said}");
    let path = folder.path("turtlebot_gazebo/worlds/playground.world");
    let path = path.to_str().unwrap();
    assert!(load(path, Rules::default()).1, "a path refers to exactly that file");
    let (name, fails, said) = load(path, Rules { skip_missing: true, ..Rules::default() });
    assert_eq!((name.as_str(), fails), ("theirs", false), "{said}");
    assert!(said.contains("dumpster"), "{said}");
    // Errors in the file itself are reported.
    folder.write(
        "turtlebot_gazebo/worlds/playground.world",
        world.replace("<visual name='v'>", "<visual name='v'><pose>a</pose>"),
    );
    assert!(load("playground", Rules::default()).1);
}

// ------------------------------------------------------------------------------------------- meaning of elements

#[test]
fn scene_physics_and_gravity() {
    let world = good(
        "1.6",
        "<scene><ambient>0.1 0.2 0.3 1</ambient><background>0.4 0.5 0.6</background><shadows>0</shadows><linear_light>1</linear_light></scene>
         <physics type='ode'><max_step_size>0.002</max_step_size></physics><gravity>0 0 -1.6</gravity>
         <light type='point' name='p'><cast_shadows>1</cast_shadows></light>",
    );
    assert_eq!((world.ambient, world.background), ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]));
    assert!(world.linear_light && !world.shadows && !world.lights[0].cast_shadows);
    assert_eq!((world.max_step_size_s, world.gravity), (0.002, DVec3::new(0.0, 0.0, -1.6)));
    // In SDF 1.4, gravity is in <physics>; the defaults are those of the format.
    let world = good("1.4", "<physics type='ode'><gravity>0 0 -3</gravity></physics>");
    assert_eq!((world.max_step_size_s, world.gravity.z), (0.001, -3.0));
    assert_eq!((world.ambient, world.background, world.shadows), ([0.4; 3], [0.7; 3], true));
}

#[test]
fn lights() {
    let world = good(
        "1.6",
        "<light type='spot' name='s'><pose>1 2 3 0 0 0</pose><diffuse>0.5 0.4 0.3 1</diffuse><specular>0.3 0.2 0.1 1</specular>
           <intensity>2</intensity><direction>0 0 -2</direction>
           <attenuation><range>7</range><constant>0.5</constant><linear>0.1</linear><quadratic>0.2</quadratic></attenuation>
           <spot><inner_angle>0.3</inner_angle><outer_angle>0.6</outer_angle><falloff>1.5</falloff></spot></light>
         <model name='m'><static>1</static><pose>0 0 5 0 0 1.5707963267948966</pose><link name='l'><pose>1 0 0 0 0 0</pose>
           <light type='point' name='on_link'><pose>1 0 0 0 0 0</pose></light></link></model>",
    );
    let [spot, on_link] = &world.lights[..] else { panic!() };
    assert_eq!(spot.kind, LightKind::Spot { inner_angle: 0.3, outer_angle: 0.6, falloff: 1.5 });
    assert_eq!((spot.range_m, spot.attenuation, spot.diffuse), (7.0, [0.5, 0.1, 0.2], [1.0, 0.8, 0.6]));
    assert_eq!((spot.specular, on_link.specular), ([0.6, 0.4, 0.2], [0.1; 3]));
    close(spot.direction, DVec3::NEG_Z);
    close(on_link.world_from_light.translation(), DVec3::new(0.0, 2.0, 5.0));
}

#[test]
fn poses_nest() {
    let world = good(
        "1.6",
        &format!(
            "<model name='m'><static>1</static><pose>1 0 0 0 0 1.5707963267948966</pose>
               <link name='l'><pose>1 0 0 0 0 0</pose><collision name='c'><pose>0 0 2 0 0 0</pose>{BOX}
                 <laser_retro>7</laser_retro><surface><friction><ode><mu>0.3</mu></ode></friction></surface></collision></link>
             </model>"
        ),
    );
    let model = &world.models[0];
    let collision = &model.links[0].collisions[0];
    let pose = model.world_from_model * model.links[0].model_from_link * collision.link_from_collision;
    close(pose.translation(), DVec3::new(1.0, 1.0, 2.0));
    assert_eq!((collision.laser_retro, collision.friction), (7.0, Some(0.3)));
    assert!(model.is_static && model.links[0].inertial.is_none());
}

#[test]
fn relative_to_from_1_7_on() {
    let content = format!(
        "<frame name='corner'><pose>10 0 0 0 0 0</pose></frame>
         <model name='m'><pose relative_to='corner'>0 1 0 0 0 0</pose>
           <frame name='f' attached_to='a'><pose>0 0 1 0 0 1.5707963267948966</pose></frame>
           <link name='b'><pose relative_to='f'>1 0 0 0 0 0</pose>
             <visual name='v'><pose relative_to='a'>0 0 0 0 0 0</pose>{BOX}</visual></link>
           <link name='a'><pose>1 0 0 0 0 0</pose></link>
           <joint name='j' type='revolute'><parent>a</parent><child>b</child>
             <axis><xyz expressed_in='__model__'>1 0 0</xyz></axis></joint>
         </model>"
    );
    let world = good("1.7", &content);
    let model = &world.models[0];
    close(model.world_from_model.translation(), DVec3::new(10.0, 1.0, 0.0));
    let b = &model.links[0];
    close(b.model_from_link.translation(), DVec3::new(1.0, 1.0, 1.0));
    let visual = b.model_from_link * b.visuals[0].link_from_visual;
    close(visual.translation(), DVec3::X);
    // b is rotated by 90° about z: the model's x is its −y.
    close(model.joints[0].axis, DVec3::NEG_Y);
    assert_eq!(model.joints[0].kind, JointKind::Continuous);
    // Before 1.7, the name of a frame has no effect, which gives a note.
    let (_, problems) = Folder::new().load("1.6", &visual_with_frame(), false);
    assert!(matches!(&problems[..], [only] if only.severity == Severity::Warning), "{problems:#?}");
    assert_bad(
        "1.7",
        "<model name='m'><pose relative_to='nowhere'/><link name='l'/></model>",
        1,
        &["nowhere"],
    );
    let circle = "<model name='m'>\n<link name='a'><pose relative_to='b'/></link>\n<link name='b'><pose relative_to='a'/></link></model>";
    let (_, problems) = Folder::new().load("1.7", circle, false);
    assert!(problems[0].to_string().contains("relative to itself"), "{problems:#?}");
    // A circle is reported once, at its first frame, wherever other frames enter it.
    let circle = "<model name='m'>\n<link name='p'><pose relative_to='c'/></link>\n<link name='c'><pose relative_to='a'/></link>
        <link name='a'><pose relative_to='b'/></link>\n<link name='b'><pose relative_to='c'/></link>
        <link name='q'><pose relative_to='b'/></link></model>";
    let (_, problems) = Folder::new().load("1.7", circle, false);
    let [only] = &problems[..] else { panic!("{problems:#?}") };
    assert!(only.to_string().contains(":4: error: the frame 'c' is relative to itself"), "{only}");
}

fn visual_with_frame() -> String {
    box_visual("<pose frame='x'>1 0 0 0 0 0</pose>")
}

#[test]
fn a_spot_light_without_a_cone_lights_nothing() {
    for (inside, why) in [
        ("", "it has no <spot>"),
        ("<spot><falloff>1</falloff></spot>", "its <outer_angle> is 0"),
        ("<spot><inner_angle>0</inner_angle><outer_angle>0</outer_angle></spot>", "its <outer_angle> is 0"),
    ] {
        let light = format!("<light type='spot' name='lamp'>\n{inside}</light>");
        let (world, problems) = Folder::new().load("1.6", &light, false);
        let [only] = &problems[..] else { panic!("{problems:#?}") };
        let says = format!("the light 'lamp' of type spot lights nothing, because {why}");
        assert!(only.severity == Severity::Warning && only.what == says, "{only}");
        let [lamp] = &world.as_ref().unwrap().lights[..] else { panic!("{world:?}") };
        assert!(
            matches!(lamp.kind, LightKind::Spot { inner_angle: 0.0, outer_angle: 0.0, .. }),
            "{:?}",
            lamp.kind
        );
    }
}

#[test]
fn a_model_alone_is_a_world_with_a_warning() {
    let folder = Folder::new();
    let path = folder.write(
        "alone.sdf",
        "<sdf version='1.9'>\n<model name='crate'><pose>1 2 3 0 0 0</pose><link name='l'/></model></sdf>",
    );
    let (world, problems) = load(path.to_str().unwrap(), false);
    let [only] = &problems[..] else { panic!("{problems:#?}") };
    assert!(
        only.severity == Severity::Warning
            && only.source.line == 2
            && only.what == "this file has no <world>: the world contains only its model 'crate'"
            && only.remedy.contains("--robot"),
        "{only}"
    );
    let world = world.unwrap();
    let [model] = &world.models[..] else { panic!("{:?}", world.models) };
    assert_eq!((world.name.as_str(), model.name.as_str()), ("default", "crate"));
    close(model.world_from_model.translation(), DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn a_light_or_an_actor_alone_is_a_world() {
    let folder = Folder::new();
    let load_alone = |inside: &str| {
        let path = folder.write("alone.sdf", format!("<sdf version='1.9'>{inside}</sdf>"));
        let (world, problems) = load(path.to_str().unwrap(), false);
        assert!(problems.is_empty(), "{problems:#?}");
        world.unwrap()
    };
    let world = load_alone("<light name='lamp' type='point'><pose>0 0 3 0 0 0</pose></light>");
    let [lamp] = &world.lights[..] else { panic!("{:?}", world.lights) };
    assert_eq!((world.name.as_str(), lamp.name.as_str(), world.models.len()), ("default", "lamp", 0));
    close(lamp.world_from_light.translation(), DVec3::new(0.0, 0.0, 3.0));
    let actor = "<actor name='walker'><link name='l'><visual name='v'><geometry><sphere><radius>1</radius></sphere></geometry>\
        </visual></link><script><trajectory id='0' type='walk'><waypoint><time>0</time><pose>0 0 1 0 0 0</pose></waypoint>\
        <waypoint><time>1</time><pose>1 0 1 0 0 0</pose></waypoint></trajectory></script></actor>";
    let world = load_alone(actor);
    let [walker] = &world.models[..] else { panic!("{:?}", world.models) };
    assert!(walker.name == "walker" && walker.trajectory.is_some() && world.lights.is_empty());
}

#[test]
fn degrees_and_quaternions_of_1_9() {
    let world = good(
        "1.9",
        "<model name='a'><pose degrees='true'>0 0 0 0 0 90</pose><link name='l'/></model>
         <model name='b'><pose rotation_format='quat_xyzw'>0 0 0 0 0 0.7071067811865476 0.7071067811865476</pose><link name='l'/></model>",
    );
    for model in &world.models {
        assert!((model.world_from_model.rpy().z - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    }
}

#[test]
fn joints() {
    let joint = |kind: &str, more: &str| {
        let content = format!(
            "<model name='m'><link name='a'/><link name='b'><pose>1 0 0 0 0 0</pose></link>
             <joint name='j' type='{kind}'>{more}<parent>a</parent><child>b</child><axis><xyz>0 0 2</xyz>
             <limit><lower>-1</lower><upper>2</upper></limit></axis></joint></model>"
        );
        good("1.6", &content).models.remove(0)
    };
    let model = joint("revolute", "");
    assert_eq!(model.joints[0].kind, JointKind::Revolute { lower: -1.0, upper: 2.0 });
    close(model.joints[0].parent_from_child.translation(), DVec3::X);
    close(model.joints[0].axis, DVec3::Z);
    assert_eq!(joint("prismatic", "").joints[0].kind, JointKind::Prismatic { lower: -1.0, upper: 2.0 });
    assert_eq!(joint("fixed", "").joints[0].kind, JointKind::Fixed);
    // A hinge beside the origin of the child.
    let door = joint("revolute", "<pose>0 -0.5 0 0 0 0</pose>");
    close(door.joints[0].parent_from_child.translation(), DVec3::X);
    close(door.joints[0].pivot, DVec3::new(0.0, -0.5, 0.0));
    assert_eq!((door.links.len(), door.joints.len()), (2, 1));
}

#[test]
fn a_saved_state_moves_models() {
    let content = "<model name='m'><pose>1 1 1 0 0 0</pose><link name='l'/></model>
        <state world_name='w'><model name='m'><pose>5 6 7 0 0 0</pose><link name='l'><pose>9 9 9 0 0 0</pose></link></model></state>";
    close(good("1.4", content).models[0].world_from_model.translation(), DVec3::new(5.0, 6.0, 7.0));
    let unknown = "<model name='m'><link name='l'/></model><state world_name='w'><model name='n'/></state>";
    let (_, problems) = Folder::new().load("1.4", unknown, false);
    assert!(problems[0].to_string().contains("did you mean 'm'?"), "{problems:#?}");
}

#[test]
fn includes_take_name_pose_and_static() {
    let folder = Folder::new();
    folder.write(
        "models/thing/model.config",
        "<model><sdf version='1.4'>old.sdf</sdf><sdf version='1.6'>new.sdf</sdf></model>",
    );
    let model =
        "<sdf version='1.6'><model name='thing'><pose>1 1 1 0 0 0</pose><link name='l'/></model></sdf>";
    folder.write("models/thing/new.sdf", model);
    let content = "<include><uri>model://thing</uri></include>
        <include><uri>model://thing</uri><name>second</name><static>true</static><pose>4 5 6 0 0 0</pose></include>
        <model name='outer'><pose>1 0 0 0 0 0</pose><include><uri>model://thing</uri><pose>0 2 0 0 0 0</pose></include></model>";
    let (world, problems) = folder.load("1.6", content, false);
    assert!(problems.is_empty(), "{problems:#?}");
    let world = world.unwrap();
    let [first, second, outer] = &world.models[..] else { panic!() };
    close(first.world_from_model.translation(), DVec3::ONE);
    assert!(!first.is_static && first.links[0].inertial.is_some());
    assert_eq!((second.name.as_str(), second.is_static), ("second", true));
    close(second.world_from_model.translation(), DVec3::new(4.0, 5.0, 6.0));
    assert_eq!(outer.links[0].name, "thing::l");
    close(outer.links[0].model_from_link.translation(), DVec3::Y * 2.0);
}

#[test]
fn ignored_elements_are_reported() {
    for content in [
        "<plugin name='p' filename='libfoo.so'/>",
        "<model name='m'><link name='l'/><plugin name='p' filename='libfoo.so'/></model>",
        "<actor name='a'/>",
        &box_visual("<material><lighting>0</lighting></material>"),
        &box_visual("<material><double_sided>1</double_sided></material>"),
        &box_visual(
            "<material><pbr><metal><environment_map>e.dds</environment_map></metal></pbr></material>",
        ),
        "<scene><sky><clouds/></sky></scene>",
        "<scene><sky><time>22</time></sky></scene>",
        "<scene><fog><type>constant</type></fog></scene>",
    ] {
        let (world, problems) = Folder::new().load("1.6", content, false);
        assert!(world.is_some());
        assert!(
            matches!(&problems[..], [only] if only.severity == Severity::Warning),
            "{content}: {problems:#?}"
        );
    }
    good("1.6", "<gui><camera name='c'/></gui><audio/><wind/><spherical_coordinates/>");
}

/// libsdformat also searches the models for a name without a folder, and for `file://NAME`.
#[test]
fn models_are_found_by_name() {
    let folder = Folder::new();
    let text = "<sdf version='1.6'><model name='crate'><link name='l'/></model></sdf>";
    folder.write("models/crate/model.sdf", text);
    for uri in ["crate", "file://crate", "model:///crate", "model://crate"] {
        let (world, problems) = folder.load("1.6", &format!("<include><uri>{uri}</uri></include>"), false);
        assert!(problems.is_empty(), "{uri}: {problems:#?}");
        assert_eq!(world.unwrap().models[0].name, "crate");
    }
}

#[test]
fn poses_are_relative_to_frames_and_joints_of_nested_models() {
    let model = |name: &str, inside: &str| {
        format!("<model name='{name}'><static>1</static>{inside}<link name='L'/></model>")
    };
    let arm = "<model name='arm'><pose>1 0 0 0 1.5707963267948966 0</pose><link name='b'><pose>0 0 1 0 0 0</pose></link>\
               <link name='c'/><joint name='J' type='fixed'><pose>0 2 0 0 0 0</pose><parent>b</parent><child>c</child></joint>\
               <frame name='F'><pose relative_to='b'>1 0 0 0 0 0</pose></frame>\
               <frame name='G' attached_to='J'/></model>";
    let world = format!(
        "{}{}{}{}",
        model("p", arm),
        model("by_frame", "<pose relative_to='p::arm::F'>5 0 0 0 0 0</pose>"),
        model("by_joint", "<pose relative_to='p::arm::J'>0 0 0 0 0 0</pose>"),
        "<model name='outer' placement_frame='in::G'><pose>9 9 9 0 0 0</pose><static>1</static><model name='in'>\
         <link name='c'/><link name='d'/><joint name='J' type='fixed'><pose>0 0 3 0 0 0</pose><parent>d</parent>\
         <child>c</child></joint><frame name='G' attached_to='J'/></model></model>",
    );
    let world = good("1.8", &world);
    let at = |name: &str| world.models.iter().find(|model| model.name == name).unwrap().world_from_model;
    // The arm is pitched by a quarter turn: its x points down, its z along the world's x.
    for (name, expected) in [
        ("by_frame", DVec3::new(2.0, 0.0, -6.0)),
        ("by_joint", DVec3::new(1.0, 2.0, 0.0)),
        ("outer", DVec3::new(9.0, 9.0, 6.0)),
    ] {
        assert!((at(name).translation() - expected).length() < 1e-12, "{name}: {:?}", at(name));
    }
}

#[test]
fn sensors_without_a_topic_publish_under_gz_sims_names() {
    let sensor = |name: &str, kind: &str, inside: &str| {
        format!("<sensor name='{name}' type='{kind}'>{inside}</sensor>")
    };
    let range = "<lidar><range><min>0.1</min><max>9</max></range></lidar>";
    let world = good(
        "1.9",
        &format!(
            "<model name='m m'><static>1</static><link name='l'>{}{}{}{}</link><model name='inner'><link name='k'>{}{}\
             </link></model></model>",
            sensor("s", "gpu_lidar", range),
            sensor("é/..", "camera", "<camera/>"),
            sensor("d", "rgbd_camera", "<camera/>"),
            sensor("s", "imu", ""),
            sensor("s", "imu", ""),
            sensor("s", "air_pressure", "<topic>p</topic>"),
        ),
    );
    let mut model = world.models[0].clone();
    let problems = model.name_sensor_topics("");
    let topics = model.sensors.iter().map(|sensor| match &sensor.kind {
        SensorKind::Ray(lidar) => lidar.plugin.as_ref().unwrap().topic.clone(),
        SensorKind::Camera(camera) => camera.plugin.as_ref().unwrap().camera_info_topic.clone(),
        SensorKind::Depth(depth) => depth.plugin.as_ref().unwrap().depth_image_topic.clone(),
        SensorKind::Imu(imu) => imu.plugin.as_ref().unwrap().topic.clone(),
        SensorKind::AirPressure(barometer) => barometer.plugin.as_ref().unwrap().topic.clone(),
        _ => panic!("{sensor:?}"),
    });
    // A world without a name, and names with characters that are invalid in topics: every topic is valid and unique.
    assert_eq!(
        topics.collect::<Vec<_>>(),
        [
            "/world/_/model/m_m/link/l/sensor/s/scan",
            "/world/_/model/m_m/link/l/sensor/____/camera_info",
            "/world/_/model/m_m/link/l/sensor/d/depth_image",
            "/world/_/model/m_m/link/l/sensor/s/2/imu",
            "/world/_/model/m_m/model/inner/link/k/sensor/s/imu",
            "/p",
        ]
    );
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert!(problem.to_string().contains("sensor 's' has the same name as another one"), "{problem}");
}

#[test]
fn plugins_of_nested_models_name_the_joints_as_the_outer_model_does() {
    let joint = "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>";
    let plugin = "<plugin filename='gz-sim8-joint-state-publisher-system' name='gz::sim::systems::JointStatePublisher'>\
                  <joint_name>j</joint_name></plugin>";
    let world = good(
        "1.9",
        &format!(
            "<model name='m'><model name='inner'><link name='a'/><link name='b'/>{joint}{plugin}</model></model>"
        ),
    );
    let model = &world.models[0];
    let [ModelPlugin::JointStates(states)] = &model.plugins[..] else { panic!("{:?}", model.plugins) };
    assert_eq!(
        (states.joints.as_slice(), model.joints[0].name.as_str()),
        (&["inner::j".to_owned()][..], "inner::j")
    );
}
