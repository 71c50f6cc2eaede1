//! Tests of `<preset>`: depth cameras as devices on the market.

use super::{parse, parse_with};
use crate::model::{DepthCamera, SensorKind};
use crate::rules::{Rules, SensorModels};

const REAL: Rules = Rules {
    gazebo_compat: false,
    skip_missing: false,
    up_axis: crate::mesh::UpAxis::Ignored,
    sensor_models: SensorModels::Real,
};
const KINECT: &str =
    "<plugin filename='libgazebo_ros_openni_kinect.so'><cameraName>camera</cameraName></plugin>";

fn ours(inside: &str) -> String {
    format!("<plugin name='device' filename='belvedere'>{inside}</plugin>")
}

fn depth(name: &str, inside: &str, rules: Rules) -> (Option<DepthCamera>, Vec<String>) {
    let (sensor, problems) =
        parse_with(&format!("<sensor name='{name}' type='depth'>{inside}</sensor>"), rules);
    let depth = sensor.map(|sensor| match sensor.kind {
        SensorKind::Depth(depth) => depth,
        other => panic!("{other:?}"),
    });
    (depth, problems)
}

#[test]
fn a_preset_is_the_device_and_bounds_its_range() {
    for order in
        [[KINECT, &ours("<preset>kinect_v1</preset>")], [&ours("<preset>kinect_v1</preset>"), KINECT]]
    {
        let (depth, problems) = depth("s", &order.concat(), Rules::default());
        let depth = depth.unwrap();
        assert!(problems.is_empty(), "{problems:?}");
        assert_eq!(depth.preset.map(|preset| preset.name), Some("kinect_v1"));
        // The plugin's defaults are 0.4 to 5 m, which no Kinect supports.
        assert_eq!(depth.range_m(), [0.8, 4.0]);
    }
    // Without a preset it is as the file specifies.
    let (plain, _) = depth("s", KINECT, Rules::default());
    let plain = plain.unwrap();
    assert_eq!((plain.preset, plain.range_m()), (None, [0.4, 5.0]));
    // gz-sim's cameras need no other plugin.
    let (gz, problems) =
        depth("s", &format!("<topic>d</topic>{}", ours("<preset>azure_kinect</preset>")), Rules::default());
    let gz = gz.unwrap();
    assert!(problems.is_empty() && gz.plugin.is_some(), "{problems:?}");
    assert_eq!(gz.range_m(), [0.5, 3.86]);
}

#[test]
fn what_is_wrong_with_a_preset_is_said() {
    let problem = |inside: &str| {
        let (sensor, problems) = depth("s", &format!("{KINECT}{}", ours(inside)), Rules::default());
        assert_eq!(sensor.is_none(), problems[0].contains("error"), "{problems:?}");
        assert_eq!(problems.len(), 1, "{problems:?}");
        problems[0].clone()
    };
    let unknown = problem("<preset>kinect_1</preset>");
    assert!(unknown.contains("<preset> of sensor 's' is 'kinect_1', which does not exist"), "{unknown}");
    assert!(
        unknown.contains("did you mean 'kinect_v1'? choose from kinect_v1, xtion, redwood, d415"),
        "{unknown}"
    );
    let none = problem("");
    assert!(none.contains("the plugin 'belvedere' of sensor 's' has no <preset>"), "{none}");
    let beside = problem("<preset>d435</preset><noise>1</noise>");
    assert!(beside.contains("<noise> of sensor 's' is not simulated and is left out"), "{beside}");
    let kinect = KINECT.replace("</plugin>", "<pointCloudCutoffMax>0.6</pointCloudCutoffMax></plugin>");
    let (sensor, problems) =
        depth("s", &format!("{kinect}{}", ours("<preset>kinect_v1</preset>")), Rules::default());
    assert!(
        sensor.is_none() && problems[0].contains("no valid depth: a kinect_v1 measures 0.8 to 4 m"),
        "{problems:?}"
    );
    let dark = problem("<projector>false</projector><preset>xtion</preset>");
    assert!(
        dark.contains("<projector> of sensor 's' is off, but a xtion measures with its light")
            && dark.contains("choose one of d415, d435, d455"),
        "{dark}"
    );
    // A camera has its own presets.
    let (_, problems) =
        parse(&format!("<sensor name='c' type='camera'>{}</sensor>", ours("<preset>kinect_v1</preset>")));
    assert!(
        problems[0].contains("is 'kinect_v1', which does not exist; choose from webcam, "),
        "{problems:?}"
    );
}

#[test]
fn real_devices_are_known_by_plugin_and_name() {
    let found = |name: &str, inside: &str| {
        let (depth, problems) = depth(name, inside, REAL);
        assert!(problems.is_empty(), "{problems:?}");
        depth.unwrap().preset.map(|preset| preset.name)
    };
    assert_eq!(found("s", KINECT), Some("kinect_v1"));
    assert_eq!(found("front_D435_depth", KINECT), Some("d435"));
    assert_eq!(found("s", &KINECT.replace(">camera<", ">xtion_pro<")), Some("xtion"));
    assert_eq!(found("d455", "<topic>d</topic>"), Some("d455"));
    assert_eq!(found("s", "<topic>d</topic>"), None);
    // A given preset takes precedence.
    assert_eq!(found("d455", &format!("{KINECT}{}", ours("<preset>kinect_v2</preset>"))), Some("kinect_v2"));
}
