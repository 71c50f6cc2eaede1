//! Lights and fog with values that Gazebo tolerates, and what is told of them.

use crate::sdf::*;
use belvedere::description::model::LightKind;
use belvedere_sensors::scene::FogLaw;

fn told(content: &str) -> Vec<String> {
    Folder::new().load("1.6", content, false).1.iter().map(ToString::to_string).collect()
}

#[test]
fn a_light_without_a_type_is_a_point_light() {
    let content = "<light name='lamp'>\n<pose>0 0 3 0 0 0</pose></light>";
    let (world, problems) = Folder::new().load("1.6", content, false);
    let [problem] = &problems[..] else { panic!("{problems:#?}") };
    let says = ":2: warning: the light 'lamp' has no type: it is a point light, as in Gazebo; write type=";
    assert!(problem.to_string().contains(says), "{problem}");
    let world = world.unwrap();
    assert!(
        matches!(world.lights[0].kind, LightKind::Point)
            && world.lights[0].world_from_light.translation().z == 3.0
    );
    // A type that there is not is an error still.
    let problems = told("<light name='lamp' type='laser'/>");
    assert!(
        problems.len() == 1 && problems[0].contains(":2: error: the type of <light> is 'laser'"),
        "{problems:?}"
    );
}

#[test]
fn the_inner_cone_of_a_spot_is_at_most_the_outer_one() {
    let light = |inner: &str, outer: &str| {
        let cone = format!("<inner_angle>{inner}</inner_angle><outer_angle>{outer}</outer_angle>");
        Folder::new().load(
            "1.6",
            &format!("<light name='l' type='spot'>\n<spot>{cone}</spot></light>"),
            false,
        )
    };
    let (world, problems) = light("0.7", "0.5");
    let [problem] = &problems[..] else { panic!("{problems:#?}") };
    let says = ":3: warning: <inner_angle> is 0.7, above <outer_angle>: it is 0.5, too; write";
    assert!(problem.to_string().contains(says), "{problem}");
    let kind = world.unwrap().lights[0].kind;
    assert_eq!(kind, LightKind::Spot { inner_angle: 0.5, outer_angle: 0.5, falloff: 0.0 });
    assert!(light("0.5", "0.5").1.is_empty());
    let (_, problems) = light("-0.1", "0.5");
    assert!(
        problems.len() == 1 && problems[0].to_string().contains(":3: error: <spot> has"),
        "{problems:#?}"
    );
}

/// After an error in one of its values, nothing is told of the fog that would follow from a default.
#[test]
fn a_fog_with_an_error_is_told_once() {
    for wrong in
        ["<start>-1</start><end>0.5</end>", "<start>x</start><end>1</end>", "<start>2</start><end>-1</end>"]
    {
        let problems = told(&format!("<scene><fog><type>linear</type>\n{wrong}</fog></scene>"));
        assert!(problems.len() == 1 && problems[0].contains(":3: error: "), "{wrong}: {problems:?}");
    }
    let fog = good("1.6", "<scene><fog><type>linear</type><end>9</end></fog></scene>").air.fog.unwrap();
    assert_eq!(fog.law, FogLaw::Linear { start_m: 1.0, end_m: 9.0 });
}
