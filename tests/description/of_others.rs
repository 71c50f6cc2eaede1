//! Worlds and models by other people: saved by Gazebo, nested, with parts that are not available.

use crate::sdf::*;
use belvedere::description::load::{Described, LoadOptions, load};
use belvedere::description::model::{JointKind, LightKind};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Problem, Rules, Severity};

/// Loads a model file from a folder with others, with these rules.
fn described(folder: &Folder, file: &str, rules: Rules) -> (Option<Described>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let options = LoadOptions { packages: package_path([], None), rules, xacro_args: Vec::new() };
    let described = load(folder.path(file).to_str().unwrap(), &options, &mut diagnostics);
    (described, diagnostics.problems().to_vec())
}

fn skip_missing() -> Rules {
    Rules { skip_missing: true, ..Rules::default() }
}

fn warnings(problems: &[Problem], words: &[&str]) {
    assert!(problems.iter().all(|problem| problem.severity == Severity::Warning), "{problems:#?}");
    assert_eq!(problems.len(), words.len(), "{problems:#?}");
    for (problem, words) in problems.iter().zip(words) {
        assert!(problem.to_string().contains(words), "{problem} lacks {words}");
    }
}

const BALL: &str = "<sdf version='1.7'><model name='ball'><link name='core'><pose>0 0 1 0 0 0</pose></link>\
    <link name='skin'/><joint name='glue' type='fixed'><parent>core</parent><child>skin</child></joint></model></sdf>";

#[test]
fn a_model_around_a_missing_one_is_left_out_with_it() {
    let folder = Folder::new();
    let text = "<sdf version='1.6'><world name='w'><model name='shelf_1'><include><uri>model://nobodys_shelf</uri>\
        </include></model><model name='kept'><link name='l'/></model></world></sdf>";
    folder.write("test.world", text);
    let (world, problems) = described(&folder, "test.world", skip_missing());
    warnings(&problems, &["no model 'model://nobodys_shelf'"]);
    let Some(Described::World(world)) = world else { panic!("{world:?}") };
    assert_eq!(world.models.iter().map(|model| model.name.as_str()).collect::<Vec<_>>(), ["kept"]);
    // Without the rule there is one error, not two.
    let (_, problems) = described(&folder, "test.world", Rules::default());
    assert_one_error(&problems, 1, &["nobodys_shelf"]);
    // Nothing is left of a model file.
    folder.write(
        "b.sdf",
        "<sdf version='1.6'><model name='b'><include><uri>model://nobodys_shelf</uri></include></model></sdf>",
    );
    let (model, problems) = described(&folder, "b.sdf", skip_missing());
    assert!(model.is_none() && problems[1].to_string().contains("error: the model 'b' has no parts left"));
}

#[test]
fn an_included_model_of_missing_parts_is_left_out_of_the_world() {
    let folder = Folder::new();
    let shelf = "<include><uri>model://nobodys_shelf</uri></include>";
    folder.write("shelf/model.sdf", format!("<sdf version='1.9'><model name='shelf'>{shelf}</model></sdf>"));
    folder.write("alias/model.sdf", format!("<sdf version='1.9'>{shelf}</sdf>"));
    for name in ["shelf", "alias"] {
        let text = format!(
            "<sdf version='1.9'><world name='w'><include><uri>model://{name}</uri></include>\
             <model name='kept'><link name='l'/></model></world></sdf>"
        );
        folder.write("test.world", text);
        let (world, problems) = described(&folder, "test.world", skip_missing());
        warnings(&problems, &["no model 'model://nobodys_shelf'"]);
        let Some(Described::World(world)) = world else { panic!("{world:?}") };
        assert_eq!(world.models.iter().map(|model| model.name.as_str()).collect::<Vec<_>>(), ["kept"]);
    }
    // The error about a file that is one <include> says what it includes.
    let (_, problems) = described(&folder, "alias/model.sdf", skip_missing());
    assert!(
        problems[1].to_string().contains("the model 'model://nobodys_shelf' has no parts left"),
        "{problems:#?}"
    );
}

/// A model that is an extension of the one with its name on Fuel.
#[test]
fn a_model_of_fuel_is_not_the_one_that_includes_it() {
    let folder = Folder::new();
    folder.write(
        "models/cube/model.sdf",
        "<sdf version='1.9'><model name='cube'><include merge='true'>\
         <uri>https://fuel.gazebosim.org/1.0/nobody/models/cube</uri></include><link name='l'/></model></sdf>",
    );
    let text = "<sdf version='1.9'><world name='w'><include><uri>model://cube</uri></include></world></sdf>";
    folder.write("test.world", text);
    let (_, problems) = described(&folder, "test.world", Rules::default());
    let fetched = |problems: &[Problem], place: &str| {
        let [problem] = problems else { panic!("{problems:#?}") };
        let text = problem.to_string();
        for words in [place, "' cannot be fetched", "gz fuel download"] {
            assert!(text.contains(words), "'{words}' is not in: {text}");
        }
    };
    fetched(&problems, "cube/model.sdf:1: error: 'https://fuel.gazebosim.org/1.0/nobody/models/cube");
    let (world, problems) = described(&folder, "test.world", skip_missing());
    warnings(&problems, &["nobody/models/cube' cannot be fetched"]);
    assert!(matches!(world, Some(Described::World(world)) if world.models[0].links.len() == 1));
    // A mesh of such a model has the same remedy.
    let text = "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'><geometry><mesh>\
        <uri>https://fuel.gazebosim.org/1.0/nobody/models/cone/tip/files/meshes/a.dae</uri></mesh></geometry></visual>\
        </link></model></sdf>";
    folder.write("cone.sdf", text);
    let (_, problems) = described(&folder, "cone.sdf", Rules::default());
    fetched(
        &problems,
        "cone.sdf:1: error: the mesh 'https://fuel.gazebosim.org/1.0/nobody/models/cone/tip/files",
    );
}

/// What gz-sim leaves to systems, such as physics and the data of an inertial unit, is done without them.
#[test]
fn systems_of_gz_whose_work_is_done_anyway_give_no_warning() {
    let folder = Folder::new();
    let plugin = |file: &str| format!("<plugin filename='{file}' name='x'/>");
    let world = |of_world: &str, of_model: &str| {
        let (of_world, of_model) = (plugin(of_world), plugin(of_model));
        let model = format!("<model name='m'><link name='l'/>{of_model}</model>");
        folder.load("1.9", &format!("{of_world}\n{model}"), false).1
    };
    for (of_world, of_model) in [
        ("gz-sim-physics-system", "gz-sim-imu-system"),
        ("libignition-gazebo-sensors-system.so", "ignition-gazebo-navsat-system"),
        ("libgazebo_ros_init.so", "gz-sim-forcetorque-system"),
    ] {
        assert_eq!(world(of_world, of_model), []);
    }
    warnings(
        &world("gz-sim-wind-effects-system", "gz-sim-buoyancy-system"),
        &["plugins of a world are not run", "'gz-sim-buoyancy-system' of model 'm' is not simulated"],
    );
}

/// Packages for gz-sim add their own root to the folders of `model://`.
#[test]
fn a_path_of_model_may_begin_in_the_package_of_its_file() {
    let folder = Folder::new();
    folder.write("my_rovers/package.xml", "<package><name>my_rovers</name></package>");
    folder.write("my_rovers/meshes/rover/board.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write(
        "my_rovers/description/rover/model.sdf",
        "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'><geometry><mesh>\
         <uri>model://meshes/rover/board.obj</uri></mesh></geometry></visual></link></model></sdf>",
    );
    let (model, problems) = described(&folder, "my_rovers/description/rover/model.sdf", Rules::default());
    assert!(problems.is_empty(), "{problems:#?}");
    assert!(matches!(model, Some(Described::Model(model)) if model.links[0].visuals.len() == 1));
}

/// A model in a folder of models, wherever that is, names its files by its own folder.
#[test]
fn a_model_finds_its_meshes_and_neighbouring_models() {
    let folder = Folder::new();
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (file, text) in [
        ("shop/shelf/model.config", "<model><name>shelf</name><sdf>model.sdf</sdf></model>"),
        ("shop/shelf/meshes/board.obj", triangle),
        ("shop/jar/model.config", "<model><name>jar</name><sdf>model.sdf</sdf></model>"),
        ("shop/jar/model.sdf", "<sdf version='1.6'><model name='jar'><link name='glass'/></model></sdf>"),
        (
            "shop/shelf/model.sdf",
            "<sdf version='1.6'><model name='shelf'><link name='l'><visual name='v'><geometry><mesh>\
             <uri>model://shelf/meshes/board.obj</uri></mesh></geometry></visual></link>\
             <include><uri>model://jar</uri></include></model></sdf>",
        ),
    ] {
        folder.write(file, text);
    }
    let (model, problems) = described(&folder, "shop/shelf/model.sdf", Rules::default());
    let Some(Described::Model(model)) = model else { panic!("{problems:#?}") };
    assert!(model.links.iter().any(|link| link.name.ends_with("glass")), "{:?}", model.links);
    assert!(problems.iter().all(|problem| problem.severity < Severity::Error), "{problems:#?}");
}

#[test]
fn joints_to_missing_links_are_left_out() {
    let folder = Folder::new();
    let text = "<sdf version='1.6'><model name='plane'><include><uri>model://nobodys_wing</uri></include>\
        <link name='pad'/><joint name='j' type='fixed'><parent>wing::spar</parent><child>pad</child></joint>\
        </model></sdf>";
    folder.write("plane.sdf", text);
    let (model, problems) = described(&folder, "plane.sdf", skip_missing());
    warnings(&problems, &["nobodys_wing", "the joint 'j' is left out with its parent 'wing::spar'"]);
    assert!(
        matches!(model, Some(Described::Model(model)) if model.joints.is_empty() && model.links.len() == 1)
    );
}

#[test]
fn merged_models_keep_the_names_of_their_parts() {
    let folder = Folder::new();
    folder.write("ball/model.sdf", BALL);
    let world = |merge: &str, core: &str| {
        format!(
            "<model name='toy'><link name='base'/><include{merge}><uri>ball</uri><pose>2 0 0 0 0 0</pose></include>\
             <frame name='grip' attached_to='{core}'/><frame name='tip' attached_to='grip'/>\
             <joint name='j' type='fixed'><parent>__model__</parent><child>tip</child></joint></model>"
        )
    };
    for (merge, core, glue) in [(" merge='true'", "core", "glue"), ("", "ball::core", "ball::glue")] {
        let (world, problems) = folder.load("1.10", &world(merge, core), false);
        assert!(problems.is_empty(), "{problems:#?}");
        let toy = &world.unwrap().models[0];
        let joints: Vec<_> =
            toy.joints.iter().map(|j| (j.name.as_str(), toy.links[j.child].name.as_str())).collect();
        let skin = core.replace("core", "skin");
        assert_eq!(joints, [(glue, skin.as_str()), ("j", core)]);
        let core = &toy.links[toy.link_named(core).unwrap()];
        assert_eq!(core.model_from_link.translation(), glam::DVec3::new(2.0, 0.0, 1.0));
        assert_eq!(toy.joints[1].parent, 0, "the canonical link");
    }
}

#[test]
fn a_joint_to_a_nested_model_is_to_its_first_link() {
    let folder = Folder::new();
    folder.write("ball/model.sdf", BALL);
    let toy = "<model name='toy'><link name='base'/><include><uri>ball</uri></include>\
        <joint name='j' type='fixed'><parent>base</parent><child>ball</child></joint></model>";
    let (world, problems) = folder.load("1.8", toy, false);
    assert!(problems.is_empty(), "{problems:#?}");
    let toy = &world.unwrap().models[0];
    assert_eq!(toy.links[toy.joints[1].child].name, "ball::core");
}

#[test]
fn limits_may_be_infinite() {
    let model = "<model name='m'><link name='a'/><link name='b'/><joint name='j' type='revolute'>\
        <parent>a</parent><child>b</child><axis><limit><lower>-inf</lower><upper>inf</upper></limit></axis></joint>\
        <joint name='k' type='prismatic'><parent>a</parent><child>b</child><axis><limit><lower>-1</lower>\
        <upper>inf</upper></limit></axis></joint></model>";
    let world = good("1.9", model);
    let [j, k] = &world.models[0].joints[..] else { panic!() };
    assert_eq!(j.kind, JointKind::Continuous);
    assert_eq!(k.kind, JointKind::Prismatic { lower: -1.0, upper: f64::INFINITY });
}

#[test]
fn errors_that_gazebo_tolerates_are_warnings_in_its_mode() {
    let load = |content: &str| {
        let (world, problems) = Folder::new().load("1.6", content, true);
        assert!(problems.iter().all(|problem| problem.severity == Severity::Warning), "{problems:#?}");
        (world.unwrap(), problems.iter().map(ToString::to_string).collect::<String>())
    };
    // Saved worlds contain links with the same name; each keeps its saved pose.
    let twice = "<model name='m'><link name='door'><pose>1 0 0 0 0 0</pose></link>\
        <link name='door'><pose>2 0 0 0 0 0</pose></link></model>";
    let (world, said) = load(twice);
    let at = world.models[0].links.iter().map(|l| (l.name.as_str(), l.model_from_link.translation().x));
    assert_eq!(at.collect::<Vec<_>>(), [("door", 1.0), ("door_0", 2.0)]);
    assert!(said.contains("two links of this model are called 'door'"), "{said}");
    // Models that only have plugins.
    let (world, said) =
        load("<model name='m'><static>1</static><plugin name='p' filename='libp.so'/></model>");
    assert!(world.models.is_empty() && said.contains("'m' has no link"), "{said}");
    for (pose, x, z) in [("1 2 3 0 0", 1.0, 3.0), ("1 2 3 0 0 0 -0 7", 1.0, 3.0), ("1", 1.0, 0.0)] {
        let (world, said) =
            load(&format!("<model name='m'><link name='l'><pose>{pose}</pose></link></model>"));
        let place = world.models[0].links[0].model_from_link.translation();
        assert_eq!((place.x, place.z), (x, z));
        assert!(said.contains(&format!("<pose> is '{pose}'")), "{said}");
    }
}

#[test]
fn lights_wider_than_half_a_turn_and_without_direction() {
    let light = |kind: &str, inside: &str| format!("<light name='l' type='{kind}'>{inside}</light>");
    let spot = "<spot><inner_angle>4</inner_angle><outer_angle>9</outer_angle><falloff>1</falloff></spot>";
    let (world, problems) = Folder::new().load("1.6", &light("spot", spot), false);
    warnings(&problems, &["<outer_angle> is 9: the cone is a half space"]);
    let pi = std::f64::consts::PI;
    let kind = LightKind::Spot { inner_angle: pi, outer_angle: pi, falloff: 1.0 };
    assert_eq!(world.unwrap().lights[0].kind, kind);
    let nowhere = "<direction>0 0 0</direction>";
    assert_eq!(good("1.6", &light("point", nowhere)).lights.len(), 1);
    let (world, problems) = Folder::new().load("1.6", &light("directional", nowhere), true);
    warnings(&problems, &["it has no length"]);
    assert_eq!(world.unwrap().lights[0].direction, glam::DVec3::NEG_Z);
}

#[test]
fn a_robots_lights_are_left_out_with_a_warning() {
    let folder = Folder::new();
    let lamp = "<light name='lamp' type='point'/>";
    for (file, root) in [("a.sdf", "sdf version='1.6'"), ("b.sdf", "gazebo version='1.3'")] {
        let text = format!(
            "<{root}><model name='m'><link name='l'>{lamp}</link></model></{}>",
            &root[..root.find(' ').unwrap()]
        );
        folder.write(file, text);
        let (model, problems) = described(&folder, file, Rules::default());
        warnings(&problems, &["the light 'lamp' is left out"]);
        assert!(matches!(model, Some(Described::Model(model)) if model.links.len() == 1));
    }
}

/// PX4 ships models that are one `<include>` of another file.
#[test]
fn a_file_that_is_one_include_is_the_model_that_it_includes() {
    let folder = Folder::new();
    folder.write("ball/model.sdf", BALL);
    let alias = |more: &str| {
        format!(
            "<sdf version='1.9'><include><pose>0 0 3 0 0 0</pose><uri>model://ball</uri></include>{more}</sdf>"
        )
    };
    folder.write("alias/model.sdf", alias(""));
    folder.write("alias/model.config", "<model><name>alias</name><sdf>model.sdf</sdf></model>");
    let (model, problems) = described(&folder, "alias/model.sdf", Rules::default());
    let Some(Described::Model(model)) = model else { panic!("{model:?} {problems:#?}") };
    assert_eq!((model.name.as_str(), model.links.len(), problems.len()), ("ball", 2, 0), "{problems:#?}");
    assert_eq!(model.world_from_model.translation().z, 3.0);
    // As a world of its own, and in another world by its name.
    let (world, problems) = load_of(&folder, "alias/model.sdf");
    assert_eq!((world, problems.len()), (vec![("ball".to_owned(), 3.0)], 0), "{problems:#?}");
    let included = |more: &str| {
        let text = format!(
            "<sdf version='1.9'><world name='w'><include>{more}<uri>model://alias</uri></include></world></sdf>"
        );
        folder.write("test.world", text);
        load_of(&folder, "test.world").0
    };
    assert_eq!(included(""), [("ball".to_owned(), 3.0)]);
    assert_eq!(included("<name>b</name><pose>0 0 1 0 0 0</pose>"), [("b".to_owned(), 1.0)]);
    folder.write("test.world", alias("<world name='w'/>"));
    let (world, problems) = load_of(&folder, "test.world");
    assert!(world.is_empty() && problems.len() == 1, "{problems:#?}");
    assert!(
        problems[0].to_string().contains("<include> is ignored: it stands beside the <world>"),
        "{problems:#?}"
    );
    // One that includes itself, and two that are one file.
    folder.write("alias/model.sdf", alias("").replace("ball", "alias"));
    let (_, problems) = described(&folder, "alias/model.sdf", Rules::default());
    assert!(problems.len() == 1 && problems[0].to_string().contains("includes itself"), "{problems:#?}");
    folder.write("alias/model.sdf", alias("<include><uri>model://ball</uri></include>"));
    let (_, problems) = described(&folder, "alias/model.sdf", Rules::default());
    assert!(problems[0].to_string().contains("this file has 2 <model> elements"), "{problems:#?}");
}

/// The names and heights of the models of a world.
fn load_of(folder: &Folder, file: &str) -> (Vec<(String, f64)>, Vec<Problem>) {
    let (world, problems) = crate::sdf::load(folder.path(file).to_str().unwrap(), false);
    let models = world.map(|world| world.models).unwrap_or_default();
    (models.into_iter().map(|model| (model.name, model.world_from_model.translation().z)).collect(), problems)
}
