//! World files: all errors that they can have.

use crate::sdf::*;
use belvedere::description::Severity;
use belvedere::description::model::Geometry;
use glam::DVec3;

#[test]
fn files_that_are_not_worlds() {
    let folder = Folder::new();
    let (world, problems) = load(folder.path("missing.world").to_str().unwrap(), false);
    assert!(world.is_none() && problems[0].to_string().contains("missing.world: error: no such file"));
    for (text, line, words) in [
        ("<sdf version='1.6'>\n<world>\n</sdf>", 3, "broken XML"),
        ("<robot name='r'/>", 1, "<robot>"),
        ("\n<sdf version='2.0'><world name='w'/></sdf>", 2, "version '2.0'"),
        ("<sdf version='1.6'/>", 1, "no <world>"),
        ("", 1, "broken XML: the file is empty; restore its content"),
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
    // Gazebo continues with 0.
    let (world, problems) = Folder::new().load("1.6", &shape("<box><size>1 0 3</size></box>"), false);
    assert!(world.unwrap().models[0].links[0].visuals.is_empty());
    assert_eq!(problems[0].severity, Severity::Warning, "{problems:?}");
    assert!(problems[0].to_string().contains("so the shape is left out"), "{problems:?}");
    let look = |look: &str| visual(&format!("<geometry><box><size>1 1 1</size></box></geometry>{look}"));
    for (element, words) in [
        ("<transparency>1.5</transparency>", "<transparency> is 1.5"),
        ("<material><shininess>-1</shininess></material>", "<shininess> is -1"),
        ("<material><shininess>1e5</shininess></material>", "<shininess> is 100000"),
        ("<material><specular>1 -1 1 1</specular></material>", "<specular> is '1 -1 1 1'"),
    ] {
        assert_bad("1.6", &look(element), 2, &[words]);
    }
    let tag = |parts: &str| box_visual(&format!("<fiducial>{parts}</fiducial>"));
    let [family, id, size] = ["<family>tag36h11</family>", "<id>3</id>", "<size>0.16</size>"];
    for (parts, words) in [
        (format!("{id}{size}"), "a <fiducial> has no <family>"),
        (format!("{family}{size}"), "a <fiducial> has no <id>"),
        (format!("{family}{id}"), "a <fiducial> has no <size>"),
        (format!("<family> </family>{id}{size}"), "<family> of a <fiducial> is ''"),
        (format!("<family>{}</family>{id}{size}", "f".repeat(32)), "1 to 31 bytes"),
        (format!("{family}<id>-1</id>{size}"), "<id> of a <fiducial> is -1; write a whole number"),
        (format!("{family}<id>1.5</id>{size}"), "<id> of a <fiducial> is 1.5"),
        (format!("{family}<id>x</id>{size}"), "<id> is 'x'"),
        (format!("{family}{id}<size>0</size>"), "<size> of a <fiducial> is 0; write metres above 0"),
        (format!("{family}{id}<size>-0.1</size>"), "<size> of a <fiducial> is -0.1"),
        (format!("{family}{id}{size}<pose>0 0 0</pose>"), "<pose> is '0 0 0': too few numbers"),
        (format!("{family}{id}{size}<pose degrees='1'>0 0 0 0 0 0</pose>"), "has attributes"),
    ] {
        assert_bad("1.6", &tag(&parts), 3, &[words]);
    }
    assert_bad("1.6", &shape("<sphere><radius>-1</radius></sphere>"), 2, &["<radius> of a sphere is '-1'"]);
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
        &model("<inertial><inertia><ixx>-1</ixx></inertia></inertial>"),
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
    assert_bad(
        "1.6",
        "<light type='directional' name='x'><direction>0 0 0</direction></light>",
        1,
        &["no length"],
    );
    assert_bad("1.6", "<model name='m'><static>maybe</static><link name='l'/></model>", 1, &["'maybe'"]);
}

#[test]
fn errors_that_gazebo_tolerates_are_warnings() {
    let link = |inside: &str, words: &str| {
        let (world, problems) = Folder::new().load(
            "1.6",
            &format!("<model name='m'><link name='l'>{inside}</link></model>"),
            false,
        );
        assert!(problems.len() == 1 && problems[0].severity == Severity::Warning, "{problems:#?}");
        assert!(problems[0].what.contains(words), "{}", problems[0]);
        world.unwrap().models.remove(0).links.remove(0)
    };
    let inertial =
        |inside: &str, words| link(&format!("<inertial>{inside}</inertial>"), words).inertial.unwrap();
    assert_eq!(inertial("<mass>0</mass>", "is 0 kg").mass_kg, 1.0);
    let shape = |shape: &str, words| {
        let visual = format!("<visual name='v'><geometry>{shape}</geometry></visual>");
        link(&visual, words).visuals.remove(0).geometry
    };
    assert!(matches!(
        shape("<box/>", "<box> has no <size>: 1 1 1 is assumed"),
        Geometry::Box { size: DVec3::ONE }
    ));
    assert!(matches!(
        shape("<sphere/>", "<sphere> has no <radius>: 1 is assumed"),
        Geometry::Sphere { radius: 1.0 }
    ));
    let geometry = "<geometry><box><size>1 1 1</size></box></geometry>";
    let surface = "<surface><friction><ode><mu>-1</mu></ode></friction></surface>";
    let l = link(&format!("<collision name='c'>{geometry}{surface}</collision>"), "<mu> is -1");
    assert!(l.collisions[0].friction.unwrap() >= 1e6);
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
        &joint("<joint name='j' type='hinge'><parent>left</parent><child>b</child></joint>"),
        2,
        &["'hinge'", "revolute"],
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
    // Models of Gazebo classic replace their copies on Fuel, but no models of other owners.
    let fuel = |owner: &str, name: &str| {
        let uri = format!("https://fuel.gazebosim.org/1.0/{owner}/models/{name}");
        let include = format!("<include><uri>{uri}</uri></include>");
        let (world, problems) = Folder::new().load("1.9", &include, false);
        (world.map_or(0, |world| world.models.len()), problems)
    };
    let (models, problems) = fuel("OpenRobotics", "Ground Plane");
    assert_eq!((models, problems.len()), (1, 0), "{problems:#?}");
    for (owner, name) in [("Somebody", "Ground Plane"), ("OpenRobotics", "Ground Plain")] {
        let (_, problems) = fuel(owner, name);
        assert!(problems[0].to_string().contains("cannot be fetched"), "{problems:#?}");
    }
    // Gazebo continues without the model.
    let (world, problems) = Folder::new().load("1.6", "<include><uri>model://none</uri></include>", true);
    assert!(world.is_some() && problems[0].severity == Severity::Warning);
    // gz-sim looks among the models whatever the scheme.
    let folder = Folder::new();
    folder.write("ball/model.sdf", "<sdf version='1.6'><model name='b'><link name='l'/></model></sdf>");
    let (world, problems) = folder.load("1.6", "<include><uri>models://ball</uri></include>", false);
    assert_eq!((world.unwrap().models.len(), problems.len()), (1, 0), "{problems:#?}");
    let (_, problems) = folder.load("1.6", "<include><uri>models://bal</uri></include>", false);
    assert_one_error(
        &problems,
        2,
        &["there is no model 'models://bal': looked for ", "did you mean 'model://ball'?"],
    );
    // Two files that include each other.
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
    assert!(text.contains("a.material:2: warning: there is no texture 'gone.png': looked for"), "{text}");
    let problems = load("<script><uri>model://t/scripts</uri><name>AA</name></script>");
    assert!(problems[0].to_string().contains("did you mean 'A'?"), "{problems:#?}");
    // As in a URDF, an unknown name of Gazebo's own materials only costs the colour.
    let unknown = &load("<script><name>Gazebo/Gray5</name></script>")[..];
    let [problem] = unknown else { panic!("{unknown:#?}") };
    let text = problem.to_string();
    assert!(text.contains(":4: warning: Gazebo has no material 'Gazebo/Gray5'"), "{text}");
    assert!(text.contains("did you mean 'Gazebo/Gr"), "{text}");
    assert_one_error(&load("<script><name>Gray5</name></script>"), 4, &["no material 'Gray5'"]);
    let remote =
        "<script><uri>https://fuel.gazebosim.org/1.0/a/models/b/files/materials</uri><name>C</name></script>";
    assert_one_error(
        &load(remote),
        4,
        &["no material 'C': 'https://fuel.gazebosim.org", "cannot be fetched"],
    );
    // gz-sim reads no scripts: a surface that has a <pbr> is complete.
    let (world, problems) = folder.load(
        "1.9",
        &box_visual(&format!(
            "<material>{remote}<pbr><metal><roughness>0.1</roughness></metal></pbr></material>"
        )),
        false,
    );
    let [problem] = &problems[..] else { panic!("{problems:#?}") };
    assert_eq!(problem.severity, Severity::Warning, "{problem}");
    assert!(problem.to_string().contains("its <pbr> is drawn"), "{problem}");
    let look = world.unwrap().models[0].links[0].visuals[0].material.pbr;
    assert_eq!(look.map(|look| look.roughness), Some(0.1));
    let albedo = |file: &str| load(&format!("<pbr><metal><albedo_map>{file}</albedo_map></metal></pbr>"));
    // Gazebo continues without the image; the surface stays in its place.
    for (file, words) in [
        ("nowhere.png", "no texture 'nowhere.png': looked for"),
        ("t/b.gif", "b.gif has an unsupported format"),
        ("t", "the texture 't' is a folder"),
        ("https://example.org/a.png", "cannot be fetched"),
    ] {
        let problems = albedo(file);
        let [problem] = &problems[..] else { panic!("{problems:#?}") };
        let text = problem.to_string();
        assert!(text.contains(":4: warning: ") && text.contains(words), "{text}");
        assert!(text.contains("; the surface is drawn without it"), "{text}");
    }
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

/// Each message goes on in lower case after its semicolon, whether or not something near is suggested.
#[test]
fn remedies_begin_in_lower_case() {
    let folder = Folder::new();
    folder.write("a.obj", "usemtl gone\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("a.mtl", "newmtl other\nKd 1 0 0\n");
    let mesh = "<geometry><mesh><uri>a.obj</uri></mesh></geometry>";
    let script =
        |name: &str| box_visual(&format!("<material><script><name>{name}</name></script></material>"));
    let include = "<include><uri>model://qqqqqqq</uri></include>".to_owned();
    for content in [visual(mesh), script("Gazebo/Qqqqqqq"), script("Qqqqqqq"), include] {
        let problems = folder.load("1.6", &content, false).1;
        assert!(!problems.is_empty(), "{content}");
        for problem in problems {
            assert!(!problem.remedy.starts_with(char::is_uppercase), "{problem}");
        }
    }
}

/// A pipe that nobody writes into is an error at once. Opening it in the usual way would wait for a writer.
#[cfg(target_os = "linux")]
#[test]
fn a_mesh_that_is_a_pipe_without_a_writer_is_an_error() {
    let folder = Folder::new();
    let path = folder.path("pipe.stl");
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    let content = visual("<geometry><mesh><uri>pipe.stl</uri></mesh></geometry>");
    assert_one_error(
        &folder.load("1.6", &content, false).1,
        3,
        &["pipe.stl", "a pipe that nobody writes into"],
    );
}
