//! Cameras of robot files as other processes see them: what `check` says of them, classes.

mod live;

use live::{Simulator, next_frame, output};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A robot that stands, with sensors on its mast, in a file of its own.
fn robot(folder: &TempDir, extensions: &str) -> PathBuf {
    let path = folder.path().join("robot.urdf");
    let text = format!(
        "<robot name='robot'>
  <link name='base_link'>
    <inertial><mass value='5'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>
    <collision><geometry><box size='0.2 0.2 0.1'/></geometry></collision>
    <visual><geometry><box size='0.2 0.2 0.1'/></geometry></visual>
  </link>
  <link name='mast'><visual><geometry><box size='0.02 0.02 0.02'/></geometry></visual></link>
  <joint name='mount' type='fixed'>
    <parent link='base_link'/><child link='mast'/><origin xyz='0 0 0.5'/>
  </joint>
{extensions}
</robot>"
    );
    std::fs::write(&path, text).unwrap();
    path
}

/// A camera on the mast, which publishes under its name.
fn camera(name: &str, sensor: &str, inside: &str) -> String {
    format!(
        "<gazebo reference='mast'><sensor type='camera' name='{name}'>{sensor}<camera>{inside}</camera>
<plugin name='{name}' filename='libgazebo_ros_camera.so'><cameraName>{name}</cameraName></plugin>
</sensor></gazebo>"
    )
}

fn check(path: &Path) -> String {
    let output = output(&["check", path.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn check_says_which_share_of_a_picture_a_lens_maps() {
    let image = "<image><width>200</width><height>200</height></image>";
    let folder = TempDir::new().unwrap();
    // Up to 1 rad from the axis, at 50 pixels a radian: a disc of radius 50 in a square of 200, 19.6 %.
    let disc = "<horizontal_fov>4</horizontal_fov><lens><type>equidistant</type><cutoff_angle>1</cutoff_angle></lens>";
    let sensors = [
        camera("all", "", image),
        camera("bent", "", &format!("{image}<distortion><k1>-0.02</k1></distortion>")),
        camera("disc", "", &format!("{image}{disc}")),
    ];
    let said = check(&robot(&folder, &sensors.concat()));
    let maps: Vec<&str> = said.lines().filter(|line| line.trim_start().starts_with("maps")).collect();
    let [of_disc] = maps[..] else { panic!("{said}") };
    let share: f64 = of_disc.split_whitespace().nth(1).unwrap().parse().unwrap();
    let exact = 100.0 * std::f64::consts::PI * 50.0 * 50.0 / (200.0 * 200.0);
    assert!((share - exact).abs() < 0.3, "{of_disc}: {exact}");
    assert!(of_disc.ends_with(" % of the pixels, the others are black"), "{of_disc}");
}

#[test]
fn labels_of_a_robots_links_are_classes() {
    let folder = TempDir::new().unwrap();
    // Down onto the base, past the mast: the base fills the middle, the ground the rest.
    let looks_down = camera(
        "down",
        "<pose>0 0 -0.05 0 1.5707963 0</pose>",
        "<image><width>64</width><height>64</height></image>",
    );
    let label =
        "<plugin filename='gz-sim-label-system' name='gz::sim::systems::Label'><label>77</label></plugin>";
    let path = robot(&folder, &format!("{looks_down}<gazebo reference='base_link'>{label}</gazebo>"));
    let simulator = Simulator::start(&[
        "--robot",
        path.to_str().unwrap(),
        "--world",
        "empty",
        "--drive",
        "still",
        "--truth",
    ]);
    let frame = next_frame(&mut simulator.subscribe("/down/image_raw/truth/class"));
    let classes: Vec<i32> =
        frame.payload().as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes)).collect();
    let (labelled, others) = classes.iter().partition::<Vec<i32>, _>(|class| **class == 77);
    assert_eq!(classes[32 * 64 + 32], 77);
    // 0.2 m at a distance of 0.4 m, of a picture that is 0.4617 m wide there.
    let side = 64.0 * 0.2 / (2.0 * 0.4 * (0.5 * 1.047_f64).tan());
    assert!((labelled.len() as f64).sqrt() - side < 1.0 && (labelled.len() as f64).sqrt() - side > -1.0);
    assert!(others.iter().all(|class| (0..77).contains(class)), "{others:?}");
}
