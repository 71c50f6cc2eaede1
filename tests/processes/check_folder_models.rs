//! `check --all` finds the models of `model://` wherever they are in the folder.

use crate::live::belvedere;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn write(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

/// Writes a model of as many links as `links`, by which models of one name are told apart.
fn write_model(folder: &Path, place: &str, links: usize) {
    let links: Vec<String> = (0..links).map(|number| format!("<link name='l{number}'/>")).collect();
    let links = links.concat();
    let name = place.rsplit('/').next().unwrap();
    let model = format!("<sdf version='1.6'><model name='{name}'><static>1</static>{links}</model></sdf>");
    write(folder, &format!("{place}/model.sdf"), &model);
    write(folder, &format!("{place}/model.config"), "<model><name>m</name><sdf>model.sdf</sdf></model>");
}

fn world(uris: &[&str]) -> String {
    let includes: Vec<String> =
        uris.iter().map(|uri| format!("<include><uri>{uri}</uri></include>")).collect();
    let includes = includes.concat();
    format!("<sdf version='1.6'><world name='w'>{includes}</world></sdf>")
}

/// Returns the output of `check --all` in a folder, with `GAZEBO_MODEL_PATH`.
fn checked(folder: &Path, options: &[&str], model_path: &str) -> (String, Option<i32>) {
    let mut command = belvedere();
    command
        .current_dir(folder)
        .args(["check", "--all", "."])
        .args(options)
        .env("GAZEBO_MODEL_PATH", model_path);
    let done = command.output().unwrap();
    (String::from_utf8(done.stdout).unwrap(), done.status.code())
}

/// In gz-sim, the installed packages of a workspace are models, too.
#[test]
fn the_first_word_of_a_uri_may_be_a_package_of_a_deeper_folder() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let package = "<package format='3'><name>arm_description</name></package>";
    write(at, "src/vendor/arm/description/package.xml", package);
    write(at, "src/vendor/arm/description/meshes/board.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let robot = "<robot name='r'><link name='l'><visual><geometry>
        <mesh filename='model://arm_description/meshes/board.obj'/></geometry></visual></link></robot>";
    write(at, "src/arm.urdf", robot);
    let mesh = "<mesh><uri>model://arm_description/meshes/board.obj</uri></mesh>";
    let visual = format!("<visual name='v'><geometry>{mesh}</geometry></visual>");
    let model = format!("<model name='m'><static>1</static><link name='l'>{visual}</link></model>");
    write(at, "worlds/one.world", &format!("<sdf version='1.9'><world name='w'>{model}</world></sdf>"));
    let gone = model.replace("board.obj", "gone.obj");
    write(at, "worlds/gone.world", &format!("<sdf version='1.9'><world name='w'>{gone}</world></sdf>"));
    let (said, code) = checked(at, &[], "");
    let line =
        |name: &str| said.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{said}"));
    assert!(!line("src/arm.urdf").contains("error"), "{said}");
    assert!(!line("worlds/one.world").contains("error"), "{said}");
    assert!(line("worlds/gone.world").contains("model://arm_description/meshes/gone.obj"), "{said}");
    assert_eq!(code, Some(1), "{said}");
}

#[test]
fn models_in_deeper_folders_are_found() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_model(at, "src/tugbot_gazebo/models/warehouse/shelf", 1);
    // A model without a model.config, one beside its meshes, and one inside another model.
    write(
        at,
        "deep/er/jar/model.sdf",
        "<sdf version='1.6'><model name='jar'><link name='l'><visual name='v'><geometry><mesh>
         <uri>model://board/meshes/board.obj</uri></mesh></geometry></visual></link></model></sdf>",
    );
    write(at, "other/board/model.config", "<model><name>board</name></model>");
    write(at, "other/board/meshes/board.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_model(at, "other/board/parts/screw", 1);
    write(at, "src/worlds/one.world", &world(&["model://shelf", "model://jar", "model://screw"]));
    write(at, "src/worlds/two.sdf", &world(&["https://fuel.gazebosim.org/1.0/openrobotics/models/Shelf"]));
    write(at, "src/worlds/gone.world", &world(&["model://shelv"]));
    let (said, code) = checked(at, &[], "");
    assert_eq!(code, Some(1));
    let line = |file: &str| said.lines().find(|line| line.starts_with(file)).unwrap();
    assert!(line("src/worlds/one.world").ends_with("ok"), "{said}");
    assert!(line("src/worlds/gone.world").contains("did you mean 'model://shelf'?"), "{said}");
    assert!(!said.contains("note: model://"), "{said}");
}

#[test]
fn of_models_with_one_name_the_first_is_used_and_this_is_said_once() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_model(at, "z/models/crate", 1);
    write_model(at, "b/models/crate", 2);
    write_model(at, "c/models/unused", 1);
    write_model(at, "d/models/unused", 1);
    write(at, "worlds/one.world", &world(&["model://crate"]));
    write(at, "worlds/two.world", &world(&["model://crate"]));
    let note =
        "note: model://crate is b/models/crate, the first in alphabetical order, and not z/models/crate; ";
    let (said, code) = checked(at, &[], "");
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(said.matches("note: model://").count(), 1, "{said}");
    assert!(said.contains(note), "{said}");
    // A folder that is named goes before, and there is no choice then.
    let chosen = at.join("z/models");
    for (options, path) in
        [(&[][..], chosen.to_str().unwrap()), (&["--package-path", chosen.to_str().unwrap()], "")]
    {
        let (said, code) = checked(at, options, path);
        assert_eq!(code, Some(0), "{said}");
        assert!(!said.contains("note: model://"), "{said}");
    }
    // So does a folder that a package exports to Gazebo.
    let export = "<gazebo_ros gazebo_model_path='${prefix}/models'/>";
    let package = format!("<package><name>z</name><export>{export}</export></package>");
    write(at, "z/package.xml", &package);
    let (said, code) = checked(at, &[], "");
    assert!(code == Some(0) && !said.contains("note: model://"), "{said}");
}

/// Each folder is read once, however many models and worlds there are.
#[test]
fn a_thousand_models_are_found_as_fast_as_they_are_listed() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    for number in 0..1000 {
        write_model(at, &format!("group{}/models/m{number}", number % 40), 1);
    }
    let uris: Vec<String> = (0..1000).map(|number| format!("model://m{number}")).collect();
    let uris: Vec<&str> = uris.iter().map(String::as_str).collect();
    write(at, "worlds/all.world", &world(&uris[..200]));
    let (said, code) = checked(at, &[], "");
    assert_eq!(code, Some(0), "{}", said.lines().last().unwrap_or_default());
    assert!(said.contains("1001 files: "), "{}", said.lines().last().unwrap_or_default());
}
