//! Frames of models and worlds: what their names mean, and where they are. A hundred files drawn at random, whose poses are
//! composed while they are written, are the measure of it.

use crate::sdf::*;
use belvedere::description::model::{Model, World};
use belvedere::description::{Problem, Severity};
use glam::DVec3;
use std::time::{Duration, Instant};

fn of_name<'w>(world: &'w World, name: &str) -> &'w Model {
    world.models.iter().find(|model| model.name == name).unwrap()
}

/// Where the origin of a link is in the world.
fn place(model: &Model, link: &str) -> DVec3 {
    let link = &model.links[model.link_named(link).unwrap_or_else(|| panic!("{link}"))];
    (model.world_from_model * link.model_from_link).translation()
}

fn one_model(inside: &str) -> String {
    format!("<model name='m'>{inside}</model>")
}

/// A model inside another one. It is pitched by a quarter turn: its x points down, its z along the outer x.
const ARM: &str = "<model name='arm'><pose>1 0 0 0 1.5707963267948966 0</pose><link name='b'><pose>0 0 1 0 0 0</pose></link>\
    <link name='c'/><joint name='J' type='fixed'><pose>0 2 0 0 0 0</pose><parent>b</parent><child>c</child></joint>\
    <frame name='F'><pose relative_to='b'>1 0 0 0 0 0</pose></frame><frame name='G' attached_to='J'/></model>";

#[test]
fn poses_are_relative_to_what_is_inside_of_a_model_beside_them() {
    let beside = |name: &str, frame: &str| {
        format!("<model name='{name}'><pose relative_to='{frame}'>5 0 0 0 0 0</pose><link name='L'/></model>")
    };
    let model = format!(
        "<static>1</static><link name='L'><visual name='v'><pose relative_to='arm::F'/>{BOX}</visual></link>\
         <link name='by_link'><pose relative_to='arm::G'>0 0 1 0 0 0</pose></link>\
         <frame name='H' attached_to='arm::J'/>{ARM}{}{}{}{}",
        beside("by_frame", "arm::F"),
        beside("by_joint", "arm::J"),
        beside("by_own_frame", "H"),
        beside("by_model", "arm::__model__"),
    );
    let world = good("1.8", &one_model(&model));
    let model = &world.models[0];
    close(place(model, "by_frame::L"), DVec3::new(2.0, 0.0, -6.0));
    close(place(model, "by_joint::L"), DVec3::new(1.0, 2.0, -5.0));
    close(place(model, "by_own_frame::L"), DVec3::new(1.0, 2.0, -5.0));
    close(place(model, "by_model::L"), DVec3::new(1.0, 0.0, -5.0));
    close(place(model, "by_link"), DVec3::new(2.0, 2.0, 0.0));
    close(model.links[0].visuals[0].link_from_visual.translation(), DVec3::new(2.0, 0.0, -1.0));
}

#[test]
fn a_placement_frame_may_be_a_frame_or_a_joint_however_deep() {
    for (frame, at) in [
        ("arm::F", [-2.0, 0.0, 1.0]),
        ("arm::J", [-1.0, -2.0, 0.0]),
        ("arm::G", [-1.0, -2.0, 0.0]),
        ("arm", [-1.0, 0.0, 0.0]),
        ("K", [0.0, 0.0, -3.0]),
    ] {
        let inside = format!(
            "<link name='L'/>{ARM}<joint name='K' type='fixed'><pose>0 0 3 0 0 0</pose><parent>arm::b</parent>\
             <child>L</child></joint>"
        );
        let model = format!("<model name='m' placement_frame='{frame}'>{inside}</model>");
        let here = good("1.8", &model);
        let folder = Folder::new();
        folder.write("m/model.sdf", format!("<sdf version='1.8'>{}</sdf>", one_model(&inside)));
        let include = format!(
            "<include><uri>model://m</uri><pose>0 0 0 0 0 0</pose><placement_frame>{frame}</placement_frame></include>"
        );
        let (there, problems) = folder.load("1.8", &include, false);
        assert!(problems.is_empty(), "{problems:#?}");
        for world in [&here, &there.unwrap()] {
            let place = world.models[0].world_from_model;
            if frame.starts_with("arm") {
                // The axes of the arm are the world's.
                close(place.transform_vector(DVec3::NEG_Z), DVec3::X);
                close(place.transform_vector(DVec3::X), DVec3::Z);
                let turned = DVec3::new(-at[2], at[1], at[0]);
                close(place.translation(), turned);
            } else {
                close(place.translation(), DVec3::from_array(at));
            }
        }
    }
    let without_pose = "<include>\n<uri>model://sun</uri><placement_frame>l</placement_frame></include>";
    assert_bad("1.8", without_pose, 2, &["<placement_frame>", "<pose>"]);
}

#[test]
fn joints_end_at_links_frames_joints_and_models_inside() {
    for (end, link) in [
        ("arm::b", "arm::b"),
        ("arm::F", "arm::c"),
        ("arm::J", "arm::c"),
        ("arm::G", "arm::c"),
        ("arm", "arm::c"),
        ("arm::__model__", "arm::c"),
        ("hand", "arm::c"),
    ] {
        let arm = ARM.replace("name='arm'", "name='arm' canonical_link='c'");
        let model = format!(
            "<link name='L'/>{arm}<frame name='hand' attached_to='arm::F'/>\
             <joint name='j' type='ball'><parent>__model__</parent><child>{end}</child></joint>\
             <joint name='k' type='ball'><parent>{end}</parent><child>L</child></joint>"
        );
        let world = good("1.8", &one_model(&model));
        let model = &world.models[0];
        let ends = |name: &str| {
            let joint = model.joints.iter().find(|joint| joint.name == name).unwrap();
            (model.links[joint.parent].name.as_str(), model.links[joint.child].name.as_str())
        };
        assert_eq!(ends("j"), ("L", link), "{end}");
        assert_eq!(ends("k"), (link, "L"), "{end}");
    }
}

#[test]
fn the_canonical_link_may_be_inside_a_nested_model() {
    for (attribute, expected) in [
        ("", "arm::b"),
        ("canonical_link='arm::c'", "arm::c"),
        ("canonical_link='deep::arm::c'", "deep::arm::c"),
    ] {
        let deep = format!("<model name='deep'>{ARM}</model>");
        let world = good("1.8", &format!("<model name='m' {attribute}>{ARM}{deep}</model>"));
        let model = &world.models[0];
        assert_eq!(model.links[model.canonical_link].name, expected);
    }
    // It is that of the first nested model, whatever that says itself.
    let arm = ARM.replace("name='arm'", "name='arm' canonical_link='c'");
    let world = good("1.8", &one_model(&arm));
    assert_eq!(world.models[0].links[world.models[0].canonical_link].name, "arm::c");
    assert_bad(
        "1.8",
        &format!("<model name='m' canonical_link='arm::F'>{ARM}</model>"),
        1,
        &["canonical_link", "arm::F"],
    );
}

#[test]
fn frames_that_libsdformat_refuses_are_one_error() {
    let pair = "<link name='a'/><link name='b'/>";
    let joint = |parent: &str, child: &str| {
        format!(
            "{pair}\n<joint name='j' type='fixed'><parent>{parent}</parent><child>{child}</child></joint>"
        )
    };
    for (inside, line, words) in [
        (joint("a", "world"), 2, &["the joint 'j' has the world as its <child>"][..]),
        (joint("a", "a"), 2, &["<parent> and <child> of the joint 'j' both belong to the link 'a'"]),
        (
            format!("<frame name='f' attached_to='a'/>{}", joint("f", "a")),
            2,
            &["both belong to the link 'a'"],
        ),
        (joint("a", "arm::b"), 2, &["the child 'arm::b', which is no link"]),
        (
            format!("{ARM}<link name='L'>\n<pose relative_to='arm::nowhere'/></link>"),
            2,
            &["there is no frame 'arm::nowhere' here"],
        ),
        (
            format!("{ARM}<link name='L'>\n<pose relative_to='arm::FF'/></link>"),
            2,
            &["did you mean 'arm::F'?"],
        ),
        (
            format!("{ARM}<link name='L'>\n<pose relative_to='leg::F'/></link>"),
            2,
            &["there is no frame 'leg::F' here"],
        ),
        (
            format!("{pair}\n<frame name='a'/>"),
            2,
            &["the frame 'a' has the name of a link here (at", "test.world:2)"],
        ),
        (
            format!("{ARM}<link name='L'/>\n<frame name='arm'/>"),
            2,
            &["the frame 'arm' has the name of a model here"],
        ),
        (format!("{ARM}\n<link name='arm'/>"), 2, &["the link 'arm' has the name of a model here"]),
        (
            format!("{pair}\n<joint name='a' type='fixed'><parent>a</parent><child>b</child></joint>"),
            2,
            &["the joint 'a' has the name of a link here"],
        ),
        (format!("{pair}<frame name='f'/>\n<frame name='f'/>"), 2, &["has the name of another frame here"]),
        (
            format!(
                "{}\n<joint name='j' type='fixed'><parent>a</parent><child>b</child></joint>",
                joint("a", "b")
            ),
            3,
            &["two joints of this model are called 'j'", "test.world:3"],
        ),
        (format!("{pair}\n<frame name='__f__'/>"), 2, &["'__f__', which SDF keeps for frames of its own"]),
        // A model that is relative to something inside itself.
        (
            format!(
                "<link name='L'/>\n{}",
                ARM.replace("<pose>1 0 0 0", "<pose relative_to='arm::F'>1 0 0 0")
            ),
            2,
            &["the frame 'arm' is relative to itself"],
        ),
        (
            format!(
                "<link name='L'/><model name='p'>\n<pose relative_to='arm::F'/><link name='l'/></model>{}",
                ARM.replace("<pose>1 0 0 0", "<pose relative_to='p'>1 0 0 0")
            ),
            2,
            &["is relative to itself"],
        ),
    ] {
        assert_bad("1.8", &one_model(&inside), line, words);
    }
    for (line, inside, words) in [
        // Frames that nothing refers to.
        (2, "<link name='a'/>\n<frame name='f' attached_to='nobody'/>", "there is no frame 'nobody'"),
        (
            2,
            "<link name='a'/>\n<frame name='f' attached_to='world'><pose relative_to='a'/></frame>",
            "no frame 'world'",
        ),
        (
            2,
            "<link name='a'/>\n<frame name='f' attached_to='g'><pose relative_to='a'/></frame>\
             <frame name='g' attached_to='f'><pose relative_to='a'/></frame>",
            "is attached to itself",
        ),
        (
            2,
            "<link name='a'/><frame name='f' attached_to='a'>\n<pose relative_to='x'/></frame>",
            "there is no frame 'x'",
        ),
        (2, "<link name='a'/>\n<frame/>", "<frame> has no name"),
        (2, "\n<link name='a::b'/>", "the link is called 'a::b', and no name may contain ::"),
        (
            2,
            "<link name='a'>\n<visual name='__v__'><geometry><plane/></geometry></visual></link>",
            "the visual is called '__v__'",
        ),
        (
            2,
            "<link name='a'/>\n<model name='world'><link name='b'/></model>",
            "the model is called 'world', which SDF keeps",
        ),
        (
            2,
            "<link name='a'>\n<visual name='a::b'><geometry><plane/></geometry></visual></link>",
            "the visual is called 'a::b'",
        ),
        (
            2,
            "<link name='a'>\n<pose rotation_format='euler'/></link>",
            "rotation_format 'euler' is not known",
        ),
    ] {
        assert_bad("1.8", &one_model(inside), line, &[words]);
    }
    good("1.9", &one_model("<link name='a'><pose rotation_format=''>1 0 0 0 0 0</pose></link>"));
    let world_frame = "<frame name='f'>\n<pose relative_to='nobody'/></frame>";
    assert_bad("1.8", world_frame, 2, &["there is no frame 'nobody'"]);
    assert_bad(
        "1.8",
        "<model name='m'><link name='l'/></model>\n<frame name='m'/>",
        2,
        &["the frame 'm' has the name of a model here"],
    );
}

#[test]
fn the_model_of_a_file_is_relative_to_nothing() {
    let folder = Folder::new();
    folder.write(
        "m/model.sdf",
        "<sdf version='1.7'><model name='m'><link name='l'/>\n<pose relative_to='l'>1 0 0 0 0 0</pose></model></sdf>",
    );
    let (_, problems) = folder.load("1.7", "<include><uri>model://m</uri></include>", false);
    let [problem] = &problems[..] else { panic!("{problems:#?}") };
    assert_eq!((problem.severity, problem.source.line), (Severity::Error, 2), "{problem}");
    assert!(problem.to_string().contains("the <pose> of a file's own model is relative to 'l'"), "{problem}");
}

#[test]
fn names_that_old_files_share_mean_the_link() {
    let shared = "<link name='a'/><link name='b'><pose>1 0 0 0 0 0</pose></link>\
        <joint name='b' type='revolute'><pose>0 0 2 0 0 0</pose><parent>a</parent><child>b</child></joint>";
    let world = good("1.6", &one_model(shared));
    close(world.models[0].joints[0].pivot, DVec3::new(0.0, 0.0, 2.0));
    // With --gazebo-compat, a joint that comes again keeps its place.
    let again = format!(
        "{shared}<link name='c'/><joint name='b' type='revolute'><pose>0 3 0 0 0 0</pose><parent>a</parent><child>c</child></joint>"
    );
    let (world, problems) = Folder::new().load("1.6", &one_model(&again), true);
    assert!(matches!(&problems[..], [only] if only.severity == Severity::Warning), "{problems:#?}");
    let [first, second] = &world.as_ref().unwrap().models[0].joints[..] else { panic!() };
    assert_eq!((first.name.as_str(), second.name.as_str()), ("b", "b_0"));
    close(first.pivot, DVec3::new(0.0, 0.0, 2.0));
    close(second.pivot, DVec3::new(0.0, 3.0, 0.0));
}

#[test]
fn frames_of_a_merged_model_are_those_of_the_outer_one() {
    let folder = Folder::new();
    folder.write("arm/model.sdf", format!("<sdf version='1.8'>{ARM}</sdf>"));
    let toy = |more: &str| {
        one_model(&format!(
            "<link name='L'/><include merge='true'><uri>arm</uri><pose>1 0 0 0 1.5707963267948966 0</pose></include>\
             <link name='by_frame'><pose relative_to='F'>5 0 0 0 0 0</pose></link>\
             <link name='by_joint'><pose relative_to='J'>0 0 0 0 0 0</pose></link>\
             <joint name='j' type='ball'><parent>L</parent><child>G</child></joint>{more}"
        ))
    };
    let (world, problems) = folder.load("1.10", &toy(""), false);
    assert!(problems.is_empty(), "{problems:#?}");
    let world = world.unwrap();
    let model = of_name(&world, "m");
    close(place(model, "by_frame"), DVec3::new(2.0, 0.0, -6.0));
    close(place(model, "by_joint"), DVec3::new(1.0, 2.0, 0.0));
    let joint = model.joints.iter().find(|joint| joint.name == "j").unwrap();
    assert_eq!(model.links[joint.child].name, "c");
    assert_eq!(model.links[model.canonical_link].name, "L");
    let (_, problems) = folder.load("1.10", &toy("\n<link name='c'/>"), false);
    let errors: Vec<&Problem> =
        problems.iter().filter(|problem| problem.severity == Severity::Error).collect();
    assert!(
        matches!(&errors[..], [only] if only.to_string().contains("the merged model 'arm' has a part called 'c'")),
        "{problems:#?}"
    );
}

/// A watchdog for costs that grow faster than the file; speed is not tested.
const PATIENCE: Duration = Duration::from_secs(60);

#[test]
fn the_canonical_link_is_the_first_in_the_order_of_the_file_with_those_of_merged_models() {
    let folder = Folder::new();
    let inner = format!("<sdf version='1.9'><model name='inner'>{ARM}<link name='first'/></model></sdf>");
    folder.write("inner/model.sdf", inner);
    folder.write(
        "outer/model.sdf",
        "<sdf version='1.9'><model name='outer'><include merge='true'><uri>model://inner</uri></include>\
         <link name='second'/></model></sdf>",
    );
    let include = "<include merge='true'><uri>model://outer</uri></include>";
    for (content, expected) in
        [(format!("{include}<link name='own'/>"), "first"), (format!("<link name='own'/>{include}"), "own")]
    {
        let (world, problems) = folder.load("1.9", &one_model(&content), false);
        assert!(problems.is_empty(), "{problems:#?}");
        let model = &world.unwrap().models[0];
        assert_eq!(model.links[model.canonical_link].name, expected);
    }
}

#[test]
fn chains_of_eight_thousand() {
    const COUNT: usize = 8000;
    let start = Instant::now();
    let chain = |element: &dyn Fn(usize) -> String| (1..COUNT).map(element).collect::<String>();
    let frames =
        chain(&|i| format!("<frame name='f{i}' attached_to='f{}'><pose>1 0 0 0 0 0</pose></frame>", i - 1));
    let links = chain(&|i| {
        format!(
            "<link name='l{i}'><pose relative_to='l{}'>1 0 0 0 0 0</pose></link><joint name='j{i}' type='fixed'>\
             <parent>l{}</parent><child>l{i}</child></joint>",
            i - 1,
            i - 1
        )
    });
    let model = format!(
        "<link name='l0'/>{links}<frame name='f0' attached_to='l0'/>{frames}<link name='end'>\
         <pose relative_to='f{}'/></link><joint name='last' type='fixed'><parent>l1</parent><child>end</child></joint>",
        COUNT - 1
    );
    let far = DVec3::new((COUNT - 1) as f64, 0.0, 0.0);
    let world = good("1.8", &one_model(&model));
    close(place(&world.models[0], "end"), far);
    close(place(&world.models[0], &format!("l{}", COUNT - 1)), far);
    // Each model stands on what is inside the one before it.
    let models = chain(&|i| {
        format!(
            "<model name='m{i}'><static>1</static><pose relative_to='m{}::f'/><link name='l'/><frame name='f' attached_to='l'>\
             <pose>1 0 0 0 0 0</pose></frame></model>",
            i - 1
        )
    });
    let world = good(
        "1.8",
        &format!(
            "{models}<model name='m0'><static>1</static><link name='l'/><frame name='f' attached_to='l'><pose>1 0 0 0 0 0</pose></frame></model>"
        ),
    );
    close(of_name(&world, &format!("m{}", COUNT - 1)).world_from_model.translation(), far);
    // One circle, on which all the others hang.
    let circle = format!("<link name='l0'><pose relative_to='l{}'/></link>{links}", COUNT - 1);
    let (_, problems) = Folder::new().load("1.8", &one_model(&circle), false);
    assert!(
        matches!(&problems[..], [only] if only.to_string().contains("relative to itself")),
        "{problems:#?}"
    );
    let unknown = chain(&|i| format!("\n<link name='l{i}'><pose relative_to='k{i}'/></link>"));
    let (_, problems) = Folder::new().load("1.8", &one_model(&unknown), false);
    assert_eq!(problems.len(), COUNT - 1);
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}

/// libsdformat reads `frame` of SDF 1.5 and 1.6 as `relative_to` since Gazebo 11, and older ones ignore it.
#[test]
fn poses_of_old_files_are_relative_to_the_frame_that_they_name() {
    let inside = format!(
        "<link name='base'><pose>1 0 0 0 0 0</pose></link>\
         <link name='a'><pose frame='base'>0 2 0 0 0 0</pose>\
         <visual name='v'><pose frame='base'>0 0 3 0 0 0</pose>{BOX}</visual></link>\
         <link name='b'><pose relative_to='base'>0 2 0 0 0 0</pose></link>\
         <link name='c'><pose frame=''>0 2 0 0 0 0</pose></link>\
         <joint name='ab' type='fixed'><parent>base</parent><child>a</child></joint>\
         <joint name='bb' type='fixed'><parent>base</parent><child>b</child></joint>\
         <joint name='cb' type='fixed'><parent>base</parent><child>c</child></joint>"
    );
    let world = good("1.6", &one_model(&inside));
    let model = &world.models[0];
    close(place(model, "a"), DVec3::new(1.0, 2.0, 0.0));
    close(place(model, "b"), DVec3::new(1.0, 2.0, 0.0));
    close(place(model, "c"), DVec3::new(0.0, 2.0, 0.0));
    close(model.links[1].visuals[0].link_from_visual.translation(), DVec3::new(0.0, -2.0, 3.0));
    // What does not exist is ignored.
    let inside = format!(
        "<link name='a'><pose frame='nothing'>0 2 0 0 0 0</pose><visual name='v'><pose frame='no'>0 0 3 0 0 0</pose>\
         {BOX}</visual></link>"
    );
    let (world, problems) = Folder::new().load("1.6", &one_model(&inside), false);
    let model = &world.unwrap().models[0];
    close(place(model, "a"), DVec3::new(0.0, 2.0, 0.0));
    close(model.links[0].visuals[0].link_from_visual.translation(), DVec3::new(0.0, 0.0, 3.0));
    assert!(
        problems.len() == 2 && problems.iter().all(|it| it.severity == Severity::Warning),
        "{problems:#?}"
    );
    assert!(
        problems[0].to_string().contains("no frame 'no") && problems[1].to_string().contains("no frame 'no")
    );
}

/// libsdformat knows no `relative_to` there.
#[test]
fn the_pose_of_an_inertial_is_in_the_link() {
    let content = one_model(
        "<link name='a'><pose>1 0 0 0 0 0</pose><inertial><pose relative_to='__model__'>0 0 1 0 0 0</pose><mass>1</mass>\
         </inertial></link>",
    );
    let (world, problems) = Folder::new().load("1.9", &content, false);
    let inertial = world.unwrap().models[0].links[0].inertial;
    close(inertial.unwrap().link_from_inertial.translation(), DVec3::new(0.0, 0.0, 1.0));
    assert!(
        problems.len() == 1 && problems[0].to_string().contains("is ignored, as in Gazebo"),
        "{problems:#?}"
    );
}
