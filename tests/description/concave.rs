//! A concave collision mesh that moves touches as its convex hull, and that is told.

use crate::sdf::*;
use belvedere::description::Severity;

/// A pyramid whose floor is pushed in.
const HOLLOW: &str = "v 1 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\nv 0 0 2\nv 0 0 1\n\
    f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n";

fn told(model: &str) -> Vec<String> {
    let folder = Folder::new();
    folder.write("hollow.obj", HOLLOW);
    folder.write("full.obj", HOLLOW.replace("v 0 0 1", "v 0 0 -1"));
    let (world, problems) = folder.load("1.6", model, false);
    assert!(
        world.is_some() && problems.iter().all(|problem| problem.severity == Severity::Warning),
        "{problems:#?}"
    );
    problems.iter().map(ToString::to_string).collect()
}

#[test]
fn a_moving_concave_mesh_is_told_once_a_model() {
    let collision = |name: &str, file: &str| {
        format!("\n<collision name='{name}'><geometry><mesh><uri>{file}</uri></mesh></geometry></collision>")
    };
    let model = |more: &str, collisions: &str| {
        format!("<model name='m'>{more}<link name='l'>{collisions}</link></model>")
    };
    let problems = told(&model("", &(collision("a", "full.obj") + &collision("b", "hollow.obj"))));
    let [only] = &problems[..] else { panic!("{problems:#?}") };
    assert!(
        only.contains(
            "test.world:4: warning: the collision 'b' of the link 'l' is a concave mesh that moves"
        ),
        "{only}"
    );
    let problems = told(&model("", &(collision("a", "hollow.obj") + &collision("b", "hollow.obj"))));
    assert!(problems.len() == 1 && problems[0].contains("so do 1 more of the model 'm'"), "{problems:#?}");
    assert_eq!(told(&model("<static>1</static>", &collision("a", "hollow.obj"))), [""; 0]);
    assert_eq!(told(&model("", &collision("a", "full.obj"))), [""; 0]);
    let fixed = "<joint name='j' type='fixed'><parent>world</parent><child>l</child></joint>";
    assert_eq!(told(&model(fixed, &collision("a", "hollow.obj"))), [""; 0]);
}
