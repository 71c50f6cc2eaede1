//! World files: what SDF and Gazebo mean by them, and everything that can be wrong with one.

use belvedere::description::Diagnostics;
use belvedere::description::mesh::{load_mesh, load_mesh_parts};
use belvedere::description::model::{Geometry, JointKind, LightKind, Mesh, World};
use belvedere::description::package::PackagePath;
use belvedere::description::world::{load_world, world_names};
use belvedere::description::{Problem, Severity, Source};
use glam::DVec3;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with a world file and whatever it refers to.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    fn path(&self, relative: &str) -> PathBuf {
        self.0.path().join(relative)
    }

    fn write(&self, relative: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(relative);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Loads `<world>` content of an SDF version.
    fn load(&self, version: &str, content: &str, gazebo_compat: bool) -> (Option<World>, Vec<Problem>) {
        let text = format!("<sdf version='{version}'><world name='w'>\n{content}\n</world></sdf>");
        let path = self.write("test.world", text);
        load(path.to_str().unwrap(), gazebo_compat)
    }
}

fn load(file_or_name: &str, gazebo_compat: bool) -> (Option<World>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let world = load_world(file_or_name, &PackagePath::new([], None), gazebo_compat, &mut diagnostics);
    (world, diagnostics.problems().to_vec())
}

/// Loads what must be without fault.
fn good(version: &str, content: &str) -> World {
    let (world, problems) = Folder::new().load(version, content, false);
    assert!(problems.is_empty(), "{problems:#?}");
    world.unwrap()
}

/// The only problem, which must be an error at `test.world:line` with all of `words`, and a remedy.
#[track_caller]
fn assert_one_error(problems: &[Problem], line: u32, words: &[&str]) {
    let [problem] = problems else { panic!("expected one error, got {problems:#?}") };
    let text = problem.to_string();
    assert_eq!(problem.severity, Severity::Error, "{text}");
    assert_eq!(problem.source.line, line, "{text}");
    assert!(problem.source.file.ends_with("test.world"), "{text}");
    assert!(!problem.remedy.is_empty(), "no remedy: {text}");
    for word in words {
        assert!(text.contains(word), "'{word}' is not in: {text}");
    }
}

/// One error from faulty content; its line is counted from 1 at the content's first line.
#[track_caller]
fn assert_bad(version: &str, content: &str, line: u32, words: &[&str]) {
    let (_, problems) = Folder::new().load(version, content, false);
    assert_one_error(&problems, line + 1, words);
}

/// A static model of one link.
fn model(inner: &str) -> String {
    format!("<model name='m'><static>true</static><link name='l'>\n{inner}\n</link></model>")
}

fn visual(inner: &str) -> String {
    model(&format!("<visual name='v'>{inner}</visual>"))
}

fn box_visual(more: &str) -> String {
    visual(&format!("<geometry><box><size>1 1 1</size></box></geometry>\n{more}"))
}

const BOX: &str = "<geometry><box><size>1 1 1</size></box></geometry>";

fn close(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-9, "{a} is not {b}");
}

// ---------------------------------------------------------------------------------------------- our own worlds

#[test]
fn every_world_of_ours_loads_without_a_word() {
    let names = world_names(&PackagePath::new([], None));
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
fn the_playground_is_that_of_the_articles() {
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
fn the_corridors_walls_stand_where_its_state_puts_them() {
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
    let packages = PackagePath::new([folder.path("")], None);
    let mut diagnostics = Diagnostics::default();
    for name in ["playground", "playground.world"] {
        assert_eq!(load_world(name, &packages, false, &mut diagnostics).unwrap().name, "mine");
    }
    assert!(load_world("corridor", &packages, false, &mut diagnostics).is_some());
    assert!(diagnostics.problems().is_empty());
}

// ------------------------------------------------------------------------------------------- meaning of elements

#[test]
fn scene_physics_and_gravity() {
    let world = good(
        "1.6",
        "<scene><ambient>0.1 0.2 0.3 1</ambient><background>0.4 0.5 0.6</background><shadows>0</shadows></scene>
         <physics type='ode'><max_step_size>0.002</max_step_size></physics><gravity>0 0 -1.6</gravity>
         <light type='point' name='p'><cast_shadows>1</cast_shadows></light>",
    );
    assert_eq!((world.ambient, world.background), ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]));
    assert!(!world.shadows && !world.lights[0].cast_shadows);
    assert_eq!((world.max_step_size_s, world.gravity), (0.002, DVec3::new(0.0, 0.0, -1.6)));
    // SDF 1.4 has gravity in <physics>; defaults are those of the format.
    let world = good("1.4", "<physics type='ode'><gravity>0 0 -3</gravity></physics>");
    assert_eq!((world.max_step_size_s, world.gravity.z), (0.001, -3.0));
    assert_eq!((world.ambient, world.background, world.shadows), ([0.4; 3], [0.7; 3], true));
}

#[test]
fn lights() {
    let world = good(
        "1.6",
        "<light type='spot' name='s'><pose>1 2 3 0 0 0</pose><diffuse>0.5 0.4 0.3 1</diffuse><direction>0 0 -2</direction>
           <attenuation><range>7</range><constant>0.5</constant><linear>0.1</linear><quadratic>0.2</quadratic></attenuation>
           <spot><inner_angle>0.3</inner_angle><outer_angle>0.6</outer_angle><falloff>1</falloff></spot></light>
         <model name='m'><static>1</static><pose>0 0 5 0 0 1.5707963267948966</pose><link name='l'><pose>1 0 0 0 0 0</pose>
           <light type='point' name='on_link'><pose>1 0 0 0 0 0</pose></light></link></model>",
    );
    let [spot, on_link] = &world.lights[..] else { panic!() };
    assert_eq!(spot.kind, LightKind::Spot { inner_angle: 0.3, outer_angle: 0.6, falloff: 1.0 });
    assert_eq!((spot.range_m, spot.attenuation, spot.diffuse), (7.0, [0.5, 0.1, 0.2], [0.5, 0.4, 0.3]));
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
    // b is turned by 90° about z: the model's x is its −y.
    close(model.joints[0].axis, DVec3::NEG_Y);
    assert_eq!(model.joints[0].kind, JointKind::Continuous);
    // Before 1.7 a frame's name changes nothing, and we say so.
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
}

fn visual_with_frame() -> String {
    box_visual("<pose frame='x'>1 0 0 0 0 0</pose>")
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
    // A hinge beside the child's origin turns a link of its own, and the child hangs on that.
    let door = joint("revolute", "<pose>0 -0.5 0 0 0 0</pose>");
    let [turning, mount] = &door.joints[..] else { panic!("{:?}", door.joints) };
    close(turning.parent_from_child.translation(), DVec3::new(1.0, -0.5, 0.0));
    close((turning.parent_from_child * mount.parent_from_child).translation(), DVec3::X);
    assert_eq!((turning.child, mount.child, mount.kind), (mount.parent, 1, JointKind::Fixed));
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
fn materials() {
    let folder = Folder::new();
    folder.write("tags/materials/textures/a.png", b"");
    folder.write(
        "tags/materials/scripts/tags.material",
        "material Base { technique { pass { ambient 0.5 0.5 0.5\n diffuse 1 0 0\n } } }
         material Tag : Base { technique { pass { texture_unit { texture a.png\n scale 0.25 0.5\n } } } }",
    );
    let script =
        "<script><uri>model://tags/materials/scripts</uri><uri>model://tags/materials/textures</uri>";
    let look = |material: String| {
        let content = box_visual(&format!("<material>{material}</material>"));
        let (world, problems) = folder.load("1.6", &content, false);
        assert!(problems.is_empty(), "{problems:#?}");
        world.unwrap().models[0].links[0].visuals[0].material.clone()
    };
    let tag = look(format!("{script}<name>Tag</name></script>"));
    assert_eq!((tag.ambient, tag.diffuse, tag.texture_repeat), ([0.5; 3], [1.0, 0.0, 0.0], [4.0, 2.0]));
    assert!(tag.texture.unwrap().is_absolute());
    // Colours override the script's; a colour alone stands for both lights.
    let blue = look(format!("{script}<name>Tag</name></script><diffuse>0 0 1 1</diffuse>"));
    assert_eq!((blue.ambient, blue.diffuse), ([0.5; 3], [0.0, 0.0, 1.0]));
    let green = look("<diffuse>0 1 0 1</diffuse><emissive>0.1 0 0 1</emissive>".into());
    assert_eq!(
        (green.ambient, green.diffuse, green.emissive),
        ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.0, 0.0])
    );
    let pbr = look("<pbr><metal><albedo_map>tags/materials/textures/a.png</albedo_map></metal></pbr>".into());
    assert!(pbr.texture.unwrap().ends_with("a.png") && pbr.diffuse == [1.0; 3]);
    let grey = look(
        "<script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Grey</name></script>"
            .into(),
    );
    assert_eq!(grey.diffuse, [0.7; 3]);
}

#[test]
fn what_is_ignored_is_said() {
    for content in [
        "<plugin name='p' filename='libfoo.so'/>",
        "<model name='m'><link name='l'/><plugin name='p' filename='libfoo.so'/></model>",
        "<actor name='a'/>",
        &visual("<geometry><heightmap><uri>x.png</uri></heightmap></geometry>"),
        &box_visual("<transparency>0.5</transparency>"),
        "<scene><sky/></scene>",
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

// ------------------------------------------------------------------------------------------------- bad input

#[test]
fn files_that_are_no_worlds() {
    let folder = Folder::new();
    let (world, problems) = load(folder.path("missing.world").to_str().unwrap(), false);
    assert!(world.is_none() && problems[0].to_string().contains("missing.world: error: no such file"));
    for (text, line, words) in [
        ("<sdf version='1.6'>\n<world>\n</sdf>", 3, "broken XML"),
        ("<robot name='r'/>", 1, "<robot>"),
        ("\n<sdf version='2.0'><world name='w'/></sdf>", 2, "version '2.0'"),
        ("<sdf version='1.6'><model name='m'/></sdf>", 1, "no <world>"),
        ("", 1, "broken XML"),
    ] {
        let path = folder.write("test.world", text);
        let (world, problems) = load(path.to_str().unwrap(), false);
        assert!(world.is_none());
        assert_one_error(&problems, line, &[words]);
    }
    folder.write("test.world", [0xff, 0xfe, 0x00]);
    let (_, problems) = load(folder.path("test.world").to_str().unwrap(), false);
    assert_one_error(&problems, 0, &["UTF-8"]);
}

#[test]
fn bad_numbers() {
    let shape = |shape: &str| visual(&format!("<geometry>{shape}</geometry>"));
    assert_bad(
        "1.6",
        &shape("<box><size>1 -2 3</size></box>"),
        2,
        &["<size> of a box is '1 -2 3'", "above 0"],
    );
    assert_bad("1.6", &shape("<box><size>1 2</size></box>"), 2, &["too few numbers"]);
    assert_bad("1.6", &shape("<box/>"), 2, &["no <size>"]);
    assert_bad("1.6", &shape("<sphere><radius>0</radius></sphere>"), 2, &["<radius> of a sphere is '0'"]);
    assert_bad("1.6", &shape("<cylinder><radius>1</radius><length>nan</length></cylinder>"), 2, &["'nan'"]);
    assert_bad("1.6", &shape("<plane><normal>0 0 0</normal></plane>"), 2, &["<normal>"]);
    assert_bad(
        "1.6",
        &model("<pose>0 0 nan 0 0 0</pose>"),
        2,
        &["<pose> is '0 0 nan 0 0 0'", "not a finite number"],
    );
    assert_bad("1.6", &model("<pose>0 0 0 0 0</pose>"), 2, &["too few"]);
    assert_bad("1.6", &model("<inertial><mass>-1</mass></inertial>"), 2, &["-1 kg"]);
    assert_bad(
        "1.6",
        &model("<inertial><inertia><ixx>0</ixx></inertia></inertial>"),
        2,
        &["moments of inertia"],
    );
    assert_bad(
        "1.6",
        "<physics type='ode'><max_step_size>0</max_step_size></physics>",
        1,
        &["<max_step_size> is 0"],
    );
    assert_bad("1.6", "<scene><ambient>-1 0 0 1</ambient></scene>", 1, &["negative"]);
    assert_bad("1.6", "<scene><ambient>red</ambient></scene>", 1, &["'red'"]);
    assert_bad("1.6", "<light type='lamp' name='x'/>", 1, &["'lamp'"]);
    assert_bad(
        "1.6",
        "<light type='point' name='x'><attenuation><range>-1</range></attenuation></light>",
        1,
        &["-1"],
    );
    assert_bad("1.6", "<light type='spot' name='x'/>", 1, &["no <spot>"]);
    assert_bad(
        "1.6",
        "<light type='directional' name='x'><direction>0 0 0</direction></light>",
        1,
        &["no length"],
    );
    assert_bad("1.6", "<model name='m'><static>maybe</static><link name='l'/></model>", 1, &["'maybe'"]);
}

#[test]
fn bad_models() {
    assert_bad("1.6", "<model><link name='l'/></model>", 1, &["<model> has no name"]);
    assert_bad("1.6", "<model name='m'/>", 1, &["'m' has no link"]);
    assert_bad(
        "1.6",
        "<model name='m'><link name='l'/>\n<link name='l'/></model>",
        2,
        &["two links", "test.world:2"],
    );
    let joint = |joint: &str| format!("<model name='m'><link name='left'/><link name='b'/>\n{joint}</model>");
    assert_bad(
        "1.6",
        &joint("<joint name='j' type='fixed'><parent>lift</parent><child>b</child></joint>"),
        2,
        &["'lift', which is no link", "did you mean 'left'?"],
    );
    assert_bad("1.6", &joint("<joint name='j' type='fixed'><parent>b</parent></joint>"), 2, &["no <child>"]);
    assert_bad(
        "1.6",
        &joint("<joint name='j' type='ball'><parent>left</parent><child>b</child></joint>"),
        2,
        &["'ball'", "revolute"],
    );
    assert_bad(
        "1.6",
        &joint(
            "<joint name='j' type='revolute'><parent>left</parent><child>b</child><axis><xyz>0 0 0</xyz></axis></joint>",
        ),
        2,
        &["0 0 0"],
    );
    assert_bad(
        "1.6",
        &joint(
            "<joint name='j' type='revolute'><parent>left</parent><child>b</child><axis><xyz>0 0 1</xyz>\
                <limit><lower>2</lower><upper>1</upper></limit></axis></joint>",
        ),
        2,
        &["<lower> is 2 and <upper> is 1"],
    );
    let (world, problems) = Folder::new().load(
        "1.6",
        "<model name='m'><link name='l'/></model><model name='m'><link name='l'/></model>",
        false,
    );
    assert_eq!((problems[0].severity, world.unwrap().models[1].name.as_str()), (Severity::Warning, "m_0"));
}

#[test]
fn bad_includes() {
    assert_bad(
        "1.6",
        "<include><uri>model://tag_cieling</uri></include>",
        1,
        &["model://tag_cieling", "did you mean 'model://tag_ceiling'?"],
    );
    assert_bad("1.6", "<include/>", 1, &["no <uri>"]);
    assert_bad("1.6", "<include><uri>https://fuel.gazebosim.org/x</uri></include>", 1, &["https://"]);
    // Gazebo goes on without the model.
    let (world, problems) = Folder::new().load("1.6", "<include><uri>model://none</uri></include>", true);
    assert!(world.is_some() && problems[0].severity == Severity::Warning);
    // A circle of two files.
    let folder = Folder::new();
    for (name, other) in [("ping", "pong"), ("pong", "ping")] {
        let text = format!(
            "<sdf version='1.6'><model name='{name}'><link name='l'/><include><uri>model://{other}</uri></include></model></sdf>"
        );
        folder.write(&format!("{name}/model.sdf"), text);
    }
    let (_, problems) = folder.load("1.6", "<include><uri>model://ping</uri></include>", false);
    let text = problems[0].to_string();
    assert!(text.contains("pong/model.sdf:1") && text.contains("includes itself"), "{text}");
    assert_eq!(problems.len(), 1);
}

#[test]
fn bad_materials_and_textures() {
    let folder = Folder::new();
    folder.write(
        "t/scripts/a.material",
        "material A { technique { pass { texture_unit {\n texture gone.png\n } } } }",
    );
    folder.write("t/b.gif", b"");
    let load = |material: &str| {
        folder.load("1.6", &box_visual(&format!("<material>{material}</material>")), false).1
    };
    let problems = load("<script><uri>model://t/scripts</uri><name>A</name></script>");
    let text = problems[0].to_string();
    assert!(text.contains("a.material:2: error: there is no texture 'gone.png': looked for"), "{text}");
    let problems = load("<script><uri>model://t/scripts</uri><name>AA</name></script>");
    assert!(problems[0].to_string().contains("did you mean 'A'?"), "{problems:#?}");
    assert_one_error(&load("<script><name>Gazebo/Gray5</name></script>"), 4, &["no material 'Gazebo/Gray5'"]);
    let albedo = |file: &str| load(&format!("<pbr><metal><albedo_map>{file}</albedo_map></metal></pbr>"));
    assert_one_error(&albedo("nowhere.png"), 4, &["no texture 'nowhere.png': looked for"]);
    assert_one_error(&albedo("t/b.gif"), 4, &["b.gif", "convert it"]);
    folder.write("t/scripts/a.material", "material A {\n technique {");
    let text = load("<script><uri>model://t/scripts</uri><name>A</name></script>")[0].to_string();
    assert!(text.contains("a.material:2"), "{text}");
}

#[test]
fn bad_meshes_of_a_world() {
    let folder = Folder::new();
    folder.write("part.step", b"ISO");
    let load =
        |uri: &str| folder.load("1.6", &visual(&format!("<geometry><mesh>{uri}</mesh></geometry>")), false).1;
    assert_one_error(&load("<uri>part.step</uri>"), 3, &["part.step", "stl, obj, dae"]);
    assert_one_error(
        &load("<uri>model://no/mesh.dae</uri>"),
        3,
        &["no mesh 'model://no/mesh.dae': looked for"],
    );
    assert_one_error(&load(""), 3, &["no <uri>"]);
}

// ----------------------------------------------------------------------------------------------------- meshes

/// Corners of the box from (0, 0, 0) to (1, 2, 3); corner i has bit 0 for x, 1 for y, 2 for z.
fn corner(index: usize) -> [f32; 3] {
    [(index & 1) as f32, (index >> 1 & 1) as f32 * 2.0, (index >> 2) as f32 * 3.0]
}

/// Its faces, counter-clockwise from outside.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn triangles() -> impl Iterator<Item = [usize; 3]> {
    FACES.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
}

fn obj() -> String {
    let vertices = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = FACES.iter().map(|f| format!("f {} {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1, f[3] + 1));
    vertices.chain(faces).collect()
}

fn ascii_stl() -> String {
    let facet = |triangle: [usize; 3]| {
        let [a, b, c] = triangle.map(|i| {
            let [x, y, z] = corner(i);
            format!("vertex {x} {y} {z}\n")
        });
        format!("facet normal 0 0 0\nouter loop\n{a}{b}{c}endloop\nendfacet\n")
    };
    format!("solid box\n{}endsolid box\n", triangles().map(facet).collect::<String>())
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(12u32.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|i| corner(*i)).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The box in Collada with an asset, the inside of a node, and `<p>` made from index pairs (position, texture).
fn dae(asset: &str, node: &str, positions: impl Fn([f32; 3]) -> [f32; 3]) -> String {
    let numbers: Vec<String> = (0..8).flat_map(|i| positions(corner(i))).map(|v| v.to_string()).collect();
    let numbers = numbers.join(" ");
    let p: Vec<String> = FACES.iter().flatten().enumerate().map(|(n, i)| format!("{i} {}", n % 4)).collect();
    let p = p.join(" ");
    format!(
        "<?xml version='1.0'?>
<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'><asset>{asset}</asset>
<library_images><image id='pic'><init_from>paint.png</init_from></image></library_images>
<library_effects><effect id='fx'><profile_COMMON>
  <newparam sid='surf'><surface type='2D'><init_from>pic</init_from></surface></newparam>
  <newparam sid='samp'><sampler2D><source>surf</source></sampler2D></newparam>
  <technique sid='c'><phong><emission><color>0 0 0 1</color></emission><diffuse><texture texture='samp' texcoord='UV'/></diffuse></phong></technique>
</profile_COMMON></effect><effect id='red_fx'><profile_COMMON><technique sid='c'><lambert><diffuse><color>1 0 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id='mat'><instance_effect url='#fx'/></material><material id='red'><instance_effect url='#red_fx'/></material></library_materials>
<library_geometries><geometry id='box'><mesh>
  <source id='pos'><float_array id='pos-a' count='24'>{numbers}</float_array><technique_common><accessor source='#pos-a' count='8' stride='3'/></technique_common></source>
  <source id='uv'><float_array id='uv-a' count='8'>0 0 1 0 1 1 0 1</float_array><technique_common><accessor source='#uv-a' count='4' stride='2'/></technique_common></source>
  <vertices id='ver'><input semantic='POSITION' source='#pos'/></vertices>
  <polylist material='sym' count='6'><input semantic='VERTEX' source='#ver' offset='0'/><input semantic='TEXCOORD' source='#uv' offset='1' set='0'/>
    <vcount>4 4 4 4 4 4</vcount><p>{p}</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id='scene'><node id='n'>{node}</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url='#scene'/></scene></COLLADA>"
    )
}

fn instance(material: &str) -> String {
    format!(
        "<instance_geometry url='#box'><bind_material><technique_common><instance_material symbol='sym' target='#{material}'/>\
         </technique_common></bind_material></instance_geometry>"
    )
}

fn mesh(folder: &Folder, name: &str, content: impl AsRef<[u8]>, scale: DVec3) -> Mesh {
    let path = folder.write(name, content);
    let mut diagnostics = Diagnostics::default();
    let mesh = load_mesh(&path, scale, &Source::new("test.world", 1), &mut diagnostics);
    assert!(diagnostics.problems().is_empty(), "{name}: {:#?}", diagnostics.problems());
    std::sync::Arc::unwrap_or_clone(mesh.unwrap())
}

/// Bounds, and the volume that the surface encloses: positive when its triangles face outwards.
fn bounds_and_volume(mesh: &Mesh) -> (DVec3, DVec3, f64) {
    let point = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
    let low = mesh.positions.iter().fold(DVec3::INFINITY, |m, p| m.min(DVec3::from_array(p.map(f64::from))));
    let high =
        mesh.positions.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(DVec3::from_array(p.map(f64::from))));
    let volume =
        mesh.triangles.iter().map(|t| point(t[0]).dot(point(t[1]).cross(point(t[2]))) / 6.0).sum::<f64>();
    (low, high, volume)
}

#[track_caller]
fn assert_box(mesh: &Mesh, low: [f64; 3], high: [f64; 3], volume: f64) {
    let (mesh_low, mesh_high, mesh_volume) = bounds_and_volume(mesh);
    assert!((mesh_low - DVec3::from(low)).length() < 1e-6, "{mesh_low}");
    assert!((mesh_high - DVec3::from(high)).length() < 1e-6, "{mesh_high}");
    assert!((mesh_volume - volume).abs() < 1e-5, "{mesh_volume}");
    assert_eq!(mesh.triangles.len(), 12);
}

#[test]
fn a_box_in_every_format() {
    let folder = Folder::new();
    for (name, content) in
        [("b.obj", obj().into_bytes()), ("a.stl", ascii_stl().into_bytes()), ("B.STL", binary_stl())]
    {
        assert_box(&mesh(&folder, name, &content, DVec3::ONE), [0.0; 3], [1.0, 2.0, 3.0], 6.0);
        assert_box(&mesh(&folder, name, &content, DVec3::splat(0.5)), [0.0; 3], [0.5, 1.0, 1.5], 0.75);
        // Mirrored, it still faces outwards.
        let mirrored = mesh(&folder, name, &content, DVec3::new(-1.0, 1.0, 1.0));
        assert_box(&mirrored, [-1.0, 0.0, 0.0], [0.0, 2.0, 3.0], 6.0);
    }
}

#[test]
fn collada_units_axes_and_nodes() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let load = |asset: &str, node: &str| {
        mesh(&folder, "b.dae", dae(asset, &format!("{node}{}", instance("mat")), |p| p), DVec3::ONE)
    };
    let plain = load("<unit meter='1'/><up_axis>Z_UP</up_axis>", "");
    assert_box(&plain, [0.0; 3], [1.0, 2.0, 3.0], 6.0);
    assert_eq!(plain.uvs.len(), plain.positions.len());
    let material = plain.material.unwrap();
    assert!(material.texture.unwrap().ends_with("paint.png") && material.diffuse == [1.0; 3]);
    assert_box(&load("", ""), [0.0; 3], [1.0, 2.0, 3.0], 6.0);
    // Centimetres, y up: y becomes z, z becomes −y.
    let centimetres = load("<unit meter='0.01'/><up_axis>Y_UP</up_axis>", "");
    assert_box(&centimetres, [0.0, -0.03, 0.0], [0.01, 0.0, 0.02], 6e-6);
    assert_box(&load("<up_axis>X_UP</up_axis>", ""), [-2.0, -3.0, 0.0], [0.0, 0.0, 1.0], 6.0);
    // The first transform is the outermost.
    let moved = load("", "<translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>");
    assert_box(&moved, [8.0, 0.0, 0.0], [10.0, 2.0, 3.0], 12.0);
    let matrix = load("", "<matrix>0 -1 0 10 1 0 0 0 0 0 1 0 0 0 0 1</matrix>");
    assert_box(&matrix, [8.0, 0.0, 0.0], [10.0, 1.0, 3.0], 6.0);
    let mirrored = load("", "<scale>1 1 -1</scale>");
    assert_box(&mirrored, [0.0, 0.0, -3.0], [1.0, 2.0, 0.0], 6.0);
}

#[test]
fn collada_instances_and_materials() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let node = format!("{}<node><translate>5 0 0</translate>{}</node>", instance("mat"), instance("red"));
    let path = folder.write("b.dae", dae("", &node, |p| p));
    let mut diagnostics = Diagnostics::default();
    let parts = load_mesh_parts(&path, DVec3::ONE, &Source::new("w", 1), &mut diagnostics).unwrap();
    let [textured, red] = &parts[..] else { panic!("{}", parts.len()) };
    assert!(textured.material.as_ref().unwrap().texture.is_some());
    assert_eq!(red.material.as_ref().unwrap().diffuse, [1.0, 0.0, 0.0]);
    assert_box(red, [5.0, 0.0, 0.0], [6.0, 2.0, 3.0], 6.0);
    // In a world: a visual for each material, one collision.
    let geometry = "<geometry><mesh><uri>b.dae</uri></mesh></geometry>";
    let content =
        model(&format!("<visual name='v'>{geometry}</visual><collision name='c'>{geometry}</collision>"));
    let (world, problems) = folder.load("1.6", &content, false);
    assert!(problems.is_empty(), "{problems:#?}");
    let link = &world.unwrap().models[0].links[0];
    assert_eq!((link.visuals.len(), link.collisions.len()), (2, 1));
    assert_eq!(link.visuals[1].material.diffuse, [1.0, 0.0, 0.0]);
}

#[test]
fn bad_meshes() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let plain = || dae("", &instance("mat"), |p| p);
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty.obj", b"# nothing\n".to_vec(), "no triangles"),
        ("empty.stl", b"".to_vec(), "cannot be read"),
        ("cut.stl", binary_stl()[..200].to_vec(), "cannot be read"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n".to_vec(), "cannot be read"),
        ("nan.obj", b"v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n".to_vec(), "nan.obj"),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec(), "no triangles"),
        ("broken.dae", b"<COLLADA>\n<asset>".to_vec(), "broken XML"),
        ("other.dae", b"<html/>".to_vec(), "<html>"),
        ("unit.dae", plain().replace("<asset>", "<asset><unit meter='-1'/>").into(), "unit"),
        ("axis.dae", plain().replace("<asset>", "<asset><up_axis>W_UP</up_axis>").into(), "W_UP"),
        ("index.dae", plain().replace("<p>0 0", "<p>99 0").into(), "entry 99"),
        ("short.dae", plain().replace("<vcount>4 4", "<vcount>4 400").into(), "<vcount>"),
        ("word.dae", plain().replace("<vcount>4", "<vcount>four").into(), "'four'"),
        ("nan.dae", dae("", &instance("mat"), |[x, y, _]| [x, y, f32::NAN]).into(), "vertex 0 is not finite"),
        ("link.dae", plain().replace("url='#box'", "url='#bax'").into(), "'#bax'"),
        (
            "loop.dae",
            plain().replace("<node id='n'>", "<node id='n'><instance_node url='#n'/>").into(),
            "without end",
        ),
        ("picture.dae", plain().replace("paint.png", "gone.png").into(), "gone.png"),
        ("part.ply", b"ply".to_vec(), "stl, obj, dae"),
    ];
    for (name, content, words) in cases {
        let path = folder.write(name, content);
        let mut diagnostics = Diagnostics::default();
        load_mesh(&path, DVec3::ONE, &Source::new("test.world", 7), &mut diagnostics);
        let [problem] = diagnostics.problems() else { panic!("{name}: {:#?}", diagnostics.problems()) };
        let text = problem.to_string();
        assert_eq!(problem.severity, Severity::Error);
        assert!(text.contains(words) && text.contains(name), "{name}: {text}");
        assert!(!problem.remedy.is_empty(), "{text}");
    }
    let mut diagnostics = Diagnostics::default();
    load_mesh(Path::new("x.stl"), DVec3::ZERO, &Source::new("w", 1), &mut diagnostics);
    assert!(diagnostics.problems()[0].what.contains("scale"));
}
