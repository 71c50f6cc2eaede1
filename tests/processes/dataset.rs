//! `belvedere dataset` from outside: the bytes do not depend on how it is run, shards are complete, and errors name
//! their line.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_sensors::Pose;
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const PLAN: &str = r#"
worlds = ["playground", "empty"]
robot = "kobuki_hexagons_kinect"
seeds = [7, 1000000000007]
samples_per_shard = 2

[[sensors]]
name = "rgb"
topic = "camera/rgb/image_raw"
truth = ["depth", "instance", "class", "flow_back"]
labels = true

[[sensors]]
name = "kinect"
topic = "camera/depth/image_raw"

[poses]
list = [[0, 0, 30]]

[poses.path]
points = [[-0.5, 0, 0], [0, 0, 0], [0, 0.5, 0]]
count = 2

[poses.random]
count = 2
min = [-3, -3, 0]
max = [3, 3, 0]
clearance_m = 0.05
"#;

/// Two small flying cameras.
const EYES: &str = r#"<sdf version="1.6"><model name="eyes"><static>true</static><link name="link">
  <sensor name="rgb" type="camera"><topic>rgb</topic><update_rate>10</update_rate>
    <camera><horizontal_fov>1.2</horizontal_fov><image><width>80</width><height>60</height></image>
    <noise><type>gaussian</type><mean>0</mean><stddev>0.01</stddev></noise></camera></sensor>
  <sensor name="depth" type="depth_camera"><topic>depth</topic><update_rate>10</update_rate>
    <camera><horizontal_fov>1.2</horizontal_fov><image><width>40</width><height>30</height></image></camera></sensor>
</link></model></sdf>"#;

/// The same plan with these cameras instead of the Kobuki.
fn small_plan(folder: &Path) -> PathBuf {
    fs::write(folder.join("eyes.sdf"), EYES).unwrap();
    let topics = PLAN.replace("camera/rgb/image_raw", "rgb").replace("camera/depth/image_raw", "depth");
    plan(folder, &topics.replace("kobuki_hexagons_kinect", "eyes.sdf").replace("3, 0]", "3, 0.4]"))
}

pub(crate) fn plan(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("plan.toml");
    fs::write(&path, text).unwrap();
    path
}

fn command(plan: &Path, out: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_belvedere"));
    command.arg("dataset").arg(plan).arg("-o").arg(out).args(args);
    command
}

pub(crate) fn make(plan: &Path, out: &Path, args: &[&str]) -> String {
    let Output { status, stdout, stderr } = command(plan, out, args).output().unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

pub(crate) fn refused(plan: &Path, out: &Path, args: &[&str]) -> String {
    let Output { status, stderr, .. } = command(plan, out, args).output().unwrap();
    assert_eq!(status.code(), Some(1));
    String::from_utf8(stderr).unwrap()
}

/// All files of a folder except temporary ones.
pub(crate) fn files(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = fs::read_dir(out)
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| !name.starts_with('.'))
        .map(|name| (name.clone(), fs::read(out.join(name)).unwrap()))
        .collect()
}

/// The files of a tar archive, by name.
pub(crate) fn untar(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut tar = tar::Archive::new(fs::File::open(path).unwrap());
    let read = |entry: std::io::Result<tar::Entry<'_, fs::File>>| {
        let mut entry = entry.unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        (entry.path().unwrap().to_string_lossy().into_owned(), bytes)
    };
    tar.entries().unwrap().map(read).collect()
}

/// The numbers of an npy file, after its header.
pub(crate) fn floats(npy: &[u8]) -> Vec<f32> {
    let begin = 10 + usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    npy[begin..].chunks_exact(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect()
}

#[test]
fn the_bytes_do_not_depend_on_workers_order_or_kills() {
    let folder = tempfile::tempdir().unwrap();
    let plan = small_plan(folder.path());
    let one = folder.path().join("one");
    let said = make(&plan, &one, &["--workers", "1"]);
    assert!(said.contains("20 samples in 10 shards"), "{said}");
    let expected = files(&one);
    assert_eq!(expected.len(), 13, "{:?}", expected.keys());
    let manifest: Value = serde_json::from_slice(&expected["manifest.json"]).unwrap();
    assert_eq!(manifest["samples"], 20);

    // The poses of a path are the same for each seed, and the noise differs.
    let of = |shard: &str, name: &str| untar(&one.join(shard))[name].clone();
    let pictures = [of("shard-000001.tar", "00000002.rgb.png"), of("shard-000003.tar", "00000007.rgb.png")];
    assert!(pictures[0] != pictures[1], "noise of another seed");

    let several = folder.path().join("several");
    make(&plan, &several, &["--workers", "2", "--shards", "6..9"]);
    assert!(
        refused(&plan, &several, &["--shards", "9..11"]).contains("10 shards, numbered from 0, not 9..11")
    );
    make(&plan, &several, &["--workers", "3", "--shard", "1/2"]);
    assert!(!several.join("manifest.json").exists());
    let said = make(&plan, &several, &["--workers", "3"]);
    assert!(said.contains("7 of which existed already"), "{said}");
    assert!(files(&several) == expected, "the bytes depend on the number of workers");

    // Killed repeatedly, slightly later each time, until a run finishes.
    let killed = folder.path().join("killed");
    let mut kills = 0;
    for wait_ms in (40..).step_by(90) {
        let mut run = command(&plan, &killed, &["--workers", "2"]).stdout(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait_ms));
        run.kill().unwrap();
        let is_done = run.wait().unwrap().success();
        for (name, bytes) in files(&killed) {
            assert!(expected[&name] == bytes, "{name} is not whole after {wait_ms} ms");
        }
        kills += u32::from(!is_done);
        if is_done {
            break;
        }
    }
    assert!(kills > 0 && files(&killed) == expected, "{kills} kills");
    let left: Vec<_> = fs::read_dir(&killed).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), expected.len(), "something is left over: {left:?}");

    // A shard that has been changed since is reported.
    let shard = killed.join("shard-000003.tar");
    let mut bytes = fs::read(&shard).unwrap();
    bytes[5000] ^= 1;
    fs::write(&shard, bytes).unwrap();
    let error = refused(&plan, &killed, &[]);
    assert!(error.contains("shard-000003.tar") && error.contains("remove it"), "{error}");
    fs::remove_file(shard).unwrap();
    make(&plan, &killed, &[]);
    assert!(files(&killed) == expected);

    // Another plan is refused in the same folder.
    let other = fs::read_to_string(&plan).unwrap().replace("[0, 0, 30]", "[0, 0, 31]");
    fs::write(&plan, other).unwrap();
    let error = refused(&plan, &killed, &[]);
    assert!(error.contains("another plan") && error.contains("plan.toml has changed"), "{error}");
}

#[test]
fn samples_follow_the_plan() {
    let folder = tempfile::tempdir().unwrap();
    let text = PLAN.replace(r#""playground", "empty""#, r#""empty""#).replace("[7, 1000000000007]", "[7, 8]");
    let text = text.replace("samples_per_shard = 2", "samples_per_shard = 100\nclasses = { 1 = \"floor\" }");
    let plan = plan(folder.path(), &text);
    let out = folder.path().join("out");
    make(&plan, &out, &[]);
    let files = untar(&out.join("shard-000000.tar"));
    let names: Vec<&str> = files.keys().filter_map(|name| name.strip_prefix("00000002.")).collect();
    assert_eq!(
        names,
        [
            "json",
            "kinect.npy",
            "rgb.class.npy",
            "rgb.depth.npy",
            "rgb.flow_back.npy",
            "rgb.instance.npy",
            "rgb.png"
        ]
    );
    let json =
        |index: usize| -> Value { serde_json::from_slice(&files[&format!("{index:08}.json")]).unwrap() };
    let sample = json(2);
    assert_eq!((&sample["world"], &sample["seed"], &sample["pose"]), (&"empty".into(), &7.into(), &2.into()));
    let position = |sample: &Value| -> Vec<f64> {
        let position = sample["world_from_robot"]["position"].as_array().unwrap();
        position.iter().map(|part| part.as_f64().unwrap()).collect()
    };
    assert_eq!(position(&sample), [0.0, 0.5, 0.0], "the end of the path");
    let rgb = &sample["sensors"]["rgb"];
    let [width, height] = [&rgb["width"], &rgb["height"]].map(|size| size.as_u64().unwrap() as u32);
    let picture = image::load_from_memory(&files["00000002.rgb.png"]).unwrap();
    assert_eq!((picture.width(), picture.height()), (width, height));

    // Only the floor is visible, and its depth below the horizon follows from geometry: h·f / (v − cy).
    let object = &rgb["objects"][0];
    assert_eq!((&object["category"], rgb["objects"].as_array().unwrap().len()), (&"floor".into(), 1));
    let depth = floats(&files["00000002.rgb.depth.npy"]);
    let number = |name: &str| rgb["intrinsics"][name].as_f64().unwrap();
    let camera_m = rgb["world_from_sensor"]["position"][2].as_f64().unwrap();
    let row = height as usize - 1;
    let expected = camera_m * number("fy") / (row as f64 - number("cy"));
    let found = f64::from(depth[row * width as usize + width as usize / 2]);
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");

    // Flow leads to the previous pose of the path, and there is none for other samples; random places differ between
    // seeds.
    let flow = |index: usize| floats(&files[&format!("{index:08}.rgb.flow_back.npy")]);
    assert!(flow(2).iter().filter(|part| part.is_finite()).count() > 1000);
    assert!([0, 1, 3].into_iter().all(|index| flow(index).iter().all(|part| part.is_nan())));
    let field = |index: usize, name: &str| &files[&format!("{index:08}.{name}")];
    assert!(field(2, "rgb.depth.npy") == field(7, "rgb.depth.npy"));
    assert!(position(&json(3)) != position(&json(8)), "places of another seed");
}

#[test]
fn random_places_keep_their_clearance() {
    let folder = tempfile::tempdir().unwrap();
    let world = r#"<sdf version="1.6"><world name="w"><model name="wall"><static>true</static><link name="link">
        <collision name="c"><pose>2 0 0.5 0 0 0</pose><geometry><box><size>3 10 1</size></box></geometry></collision>
        <collision name="floor"><geometry><box><size>20 20 0.001</size></box></geometry></collision>
        </link></model></world></sdf>"#;
    fs::write(folder.path().join("w.world"), world).unwrap();
    let text = r#"
        worlds = ["w.world"]
        robot = "kobuki_nostack_rplidar"
        sensors = [{ name = "scan", topic = "scan" }]
        [poses.random]
        count = 60
        min = [-1, -1, 0]
        max = [2, 1, 0]
        clearance_m = 0.2
    "#;
    let path = plan(folder.path(), text);
    let out = folder.path().join("out");
    make(&path, &out, &[]);
    let files = untar(&out.join("shard-000000.tar"));
    let of = |name: &str| {
        files.iter().filter(|(file, _)| file.ends_with(name)).map(|(_, bytes)| bytes).collect::<Vec<_>>()
    };
    let places = of(".json").into_iter().map(|bytes| {
        let sample: Value = serde_json::from_slice(bytes).unwrap();
        sample["world_from_robot"]["position"][0].as_f64().unwrap()
    });
    let places: Vec<f64> = places.collect();
    // The wall begins at 0.5 m and the base has a radius of 0.176 m, so its centre stays at least 0.376 m away.
    assert_eq!(places.len(), 60);
    assert!(places.iter().all(|x| (-1.0..0.13).contains(x)), "{places:?}");
    assert!(places.iter().any(|x| *x > 0.0), "{places:?}");
    // The lidar measures nothing nearer than the clearance allows.
    let ranges = of("scan.npy").into_iter().flat_map(|npy| floats(npy));
    let nearest = ranges.fold(f32::INFINITY, f32::min);
    assert!(nearest > 0.2, "{nearest}");

    let inside = text.replace("min = [-1", "min = [1");
    let error = refused(&plan(folder.path(), &inside), &folder.path().join("none"), &[]);
    assert!(error.contains("plan.toml:5: error: no place for the robot in 1000 tries"), "{error}");
}

#[test]
fn a_numbered_frame_equals_that_of_a_run() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Simulation::builder(load::world("playground")?).seed(9).build()?;
    let robot = simulation.spawn(&load::model(EYES)?, SpawnOptions::default())?;
    let pose = Pose::from_translation(DVec3::new(-2.0, 0.0, 0.5));
    simulation.set_down(robot, &pose)?;
    let mut expected = vec![FrameBuf::default(); 4];
    for frame in &mut expected {
        simulation.render("rgb", frame)?;
    }
    let mut frames = vec![FrameBuf::default(); 3];
    let topics = ["/rgb", "/rgb/truth/depth", "rgb/truth/flow_back"];
    for number in [2, 0, 3, 2] {
        simulation.set_down(robot, &Pose::from_translation(DVec3::new(0.1, 0.2, number as f64)))?;
        simulation.render_numbered(&topics, 77, false, &mut frames)?;
        simulation.set_down(robot, &pose)?;
        let filled = simulation.render_numbered(&topics, number, false, &mut frames)?;
        assert_eq!(filled, [true, true, false], "there is no flow without a previous frame");
        assert!(frames[0].payload() == expected[number as usize].payload(), "{number}");
    }
    assert!(expected[0].payload() != expected[1].payload(), "noise");
    let filled = simulation.render_numbered(&topics, 5, true, &mut frames)?;
    let flow = frames[2].view();
    let still = flow.numbers::<[f32; 2]>(flow.rows()).flatten().filter(|part| part.is_finite());
    assert!(filled[2] && still.fold(0.0_f32, |most, part| most.max(part.abs())) < 1e-3);
    let error = simulation.render_numbered(&["rgb", "rgd"], 0, false, &mut frames).unwrap_err().to_string();
    assert!(error.contains("no sensor sends /rgd; did you mean '/rgb'?"), "{error}");
    Ok(())
}

#[test]
fn invalid_exports_are_refused_before_rendering() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, out) = (small_plan(folder.path()), folder.path().join("out"));
    for export in [["--kitti", "nosuch"], ["--coco", "nosuch"]] {
        let error = refused(&plan, &out, &export);
        assert!(error.contains("the plan has no sensor 'nosuch'; it has "), "{error}");
        assert!(!out.exists(), "{export:?}");
    }
}

#[test]
fn errors_of_a_plan_name_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for (old, new, says) in [
        (
            "samples_per_shard = 2",
            "samples_per_shard = 0",
            "plan.toml:5: error: samples_per_shard = 0; write 1 or more",
        ),
        ("samples_per_shard", "shard_size", "plan.toml:5: error: unknown field `shard_size`"),
        ("seeds = [7, 1000000000007]", "seeds = [7, 7]", "plan.toml:4: error: seeds = [7, 7]"),
        (r#""playground", "empty""#, r#""playgruond""#, "playgruond"),
        (r#""playground", "empty""#, "", "plan.toml:2: error: worlds is empty"),
        ("[[0, 0, 30]]", "[[0, 0]]", "plan.toml:18: error: [0.0, 0.0] is not a pose; write [x, y, yaw]"),
        ("[[0, 0, 30]]", "[[0, nan, 0]]", "plan.toml:18: error: [0.0, NaN, 0.0] is not a pose"),
        (
            "rgb/image_raw",
            "rgb/image_row",
            "plan.toml:8: error: no sensor sends /camera/rgb/image_row; did you mean '/camera/rgb/image_raw'?",
        ),
        (r#""class""#, r#""klass""#, "plan.toml:8: error: no sensor sends /camera/rgb/image_raw/truth/klass"),
        (
            "camera/depth/image_raw",
            "odom",
            "plan.toml:14: error: /odom is not an image, depth image, scan or cloud",
        ),
        (
            r#""flow_back""#,
            r#""flow_forward""#,
            "plan.toml:10: error: flow_forward is known only after the next frame; use flow_back",
        ),
        (r#"name = "kinect""#, r#"name = "rgb""#, "plan.toml:14: error: two sensors are called 'rgb'"),
        (r#"name = "kinect""#, r#"name = "a.b""#, "plan.toml:14: error: the sensor's name 'a.b'"),
        ("count = 2\nmin", "count = 99999999999\nmin", "samples; request 1 to 99999999"),
        ("max = [3", "max = [-4", "plan.toml:24: error: the region from"),
        (
            "clearance_m = 0.05",
            "clearance_m = -1",
            "plan.toml:24: error: clearance_m = -1; write 0 to 100 metres",
        ),
        (
            "[-0.5, 0, 0], [0, 0, 0], [0, 0.5, 0]",
            "[0, 0, 0]",
            "plan.toml:20: error: a path of 1 point and 2 poses",
        ),
        ("worlds =", "worlds", "plan.toml:2: error:"),
    ] {
        let text = PLAN.replace(old, new);
        assert!(text != PLAN, "{old}");
        let error = refused(&plan(folder.path(), &text), &out, &[]);
        assert!(error.contains(says), "{new}: {error}");
        assert!(files(&out).keys().all(|name| name == "plan.json"), "nothing is made");
        let _ = fs::remove_dir_all(&out);
    }
    let error = refused(&folder.path().join("none.toml"), &out, &[]);
    assert!(error.contains("cannot read") && error.contains("none.toml"), "{error}");
}

#[test]
fn a_shard_that_cannot_be_written_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let plan = small_plan(folder.path());
    let out = folder.path().join("out");
    // Files of at most 100 KiB (in POSIX blocks of 512 bytes), so that a write fails, as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 200; exec \"$0\" dataset \"$1\" -o \"$2\"";
    let run = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_belvedere")])
        .args([&plan, &out])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{error}");
    assert!(error.contains("cannot write") && error.contains("make room"), "{error}");
    let there: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(there, ["plan.json"], "nothing is left");
}
