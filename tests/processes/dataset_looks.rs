//! Random looks of a plan, from outside: the drawn values are visible, nothing else changes, the bytes do not depend on
//! how the data set is made, and the inputs of a folder's shards must not change between runs.

use crate::dataset::{files, floats, make, plan, refused, untar};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Plates that face the camera, in the light of a lamp behind it and in ambient light.
const WORLD: &str = r#"<sdf version="1.6"><world name="studio">
  <scene><ambient>0.1 0.1 0.1 1</ambient><background>0 0 0 1</background></scene>
  <light name="sun" type="directional"><direction>1 0 0</direction><diffuse>0.4 0.4 0.4 1</diffuse>
    <specular>0 0 0 1</specular><cast_shadows>false</cast_shadows></light>
  <model name="wall"><static>true</static><link name="link"><visual name="face"><pose>4 0 1 0 0 0</pose>
    <geometry><box><size>0.01 20 20</size></box></geometry>
    <material><ambient>0.3 0.5 0.4 1</ambient><diffuse>0.3 0.5 0.4 1</diffuse></material></visual></link></model>
  <model name="block"><static>true</static><link name="link"><visual name="front"><pose>2 0.5 1 0 0 0</pose>
    <geometry><box><size>0.001 0.4 0.4</size></box></geometry>
    <material><diffuse>0.5 0.5 0.5 1</diffuse></material></visual></link></model>
  <model name="panel"><static>true</static><link name="link"><visual name="sheet"><pose>2 -0.5 1 0 0 0</pose>
    <geometry><mesh><uri>panel.obj</uri></mesh></geometry></visual></link></model>
</world></sdf>"#;

const EYE: &str = r#"<sdf version="1.6"><model name="eye"><static>true</static><link name="link">
  <sensor name="rgb" type="camera"><topic>rgb</topic><update_rate>10</update_rate>
    <camera><horizontal_fov>1.1</horizontal_fov><image><width>64</width><height>48</height></image></camera></sensor>
</link></model></sdf>"#;

const PANEL: &str = "mtllib panel.mtl\nusemtl sheet\nv 0 -0.2 -0.2\nv 0 0.2 -0.2\nv 0 0.2 0.2\nv 0 -0.2 0.2\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 4/4 3/3\nf 1/1 3/3 2/2\n";

const PLAN: &str = r#"
worlds = ["studio.world"]
robot = "eye.sdf"
seeds = [3, 4]
samples_per_shard = 3

[[sensors]]
name = "rgb"
topic = "rgb"
truth = ["depth", "instance", "class"]
labels = true

[poses]
list = [[0, 0, 1, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 1, 0, 0, 0]]
"#;

const RANDOMIZE: &str = r#"
[randomize]
ambient = [0.5, 1.5]

[[randomize.lights]]
names = ["sun"]
intensity = [0.5, 2.0]
color = [0.7, 1.0]
tilt_deg = [0, 50]

[[randomize.materials]]
hue_deg = [-180, 180]
saturation = [0.5, 1.5]
brightness = [0.6, 1.4]

[[randomize.materials]]
bodies = ["block"]
colors = [[1, 0, 0], [0, 1, 0.5], [0.2, 0.2, 1]]

[[randomize.materials]]
bodies = ["panel::link"]
color = [[0.5, 0.5, 0.5], [1, 1, 1]]
textured = 0.5
"#;

/// The uniform colour of the panel's picture.
const TEXEL: [u8; 3] = [204, 51, 102];

fn studio(folder: &Path) {
    fs::write(folder.join("studio.world"), WORLD).unwrap();
    fs::write(folder.join("eye.sdf"), EYE).unwrap();
    fs::write(folder.join("panel.obj"), PANEL).unwrap();
    fs::write(folder.join("panel.mtl"), "newmtl sheet\nmap_Kd panel.png\n").unwrap();
    image::RgbImage::from_pixel(4, 4, image::Rgb(TEXEL)).save(folder.join("panel.png")).unwrap();
}

/// The files of all samples, in whichever shard they are.
fn samples(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let shards = files(out).into_keys().filter(|name| name.starts_with("shard-"));
    shards.flat_map(|shard| untar(&out.join(shard))).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|part| part.as_f64().unwrap()).collect()
}

#[test]
fn drawn_looks_are_visible_and_nothing_else_changes() {
    let folder = tempfile::tempdir().unwrap();
    studio(folder.path());
    let path = plan(folder.path(), PLAN);
    let plain = folder.path().join("plain");
    make(&path, &plain, &[]);
    let path = plan(folder.path(), &format!("{PLAN}{RANDOMIZE}"));
    let [one, three] = ["one", "three"].map(|out| folder.path().join(out));
    make(&path, &one, &["--workers", "1"]);
    make(&path, &three, &["--workers", "3", "--shards", "1..3"]);
    make(&path, &three, &["--workers", "3"]);
    assert!(files(&one) == files(&three), "the bytes depend on the number of workers");

    let (plain, drawn) = (samples(&plain), samples(&one));
    let (mut pictures, mut textured) = (Vec::new(), Vec::new());
    for index in 0..8 {
        let of = |from: &BTreeMap<String, Vec<u8>>, name: &str| from[&format!("{index:08}.{name}")].clone();
        for truth in ["rgb.depth.npy", "rgb.instance.npy", "rgb.class.npy"] {
            assert!(of(&plain, truth) == of(&drawn, truth), "{index}: {truth}");
        }
        let mut json: Value = serde_json::from_slice(&of(&drawn, "json")).unwrap();
        let looks = json.as_object_mut().unwrap().remove("looks").unwrap();
        assert_eq!(json, serde_json::from_slice::<Value>(&of(&plain, "json")).unwrap(), "labels");

        let [sun] = looks["lights"].as_array().unwrap().as_slice() else { panic!("{looks}") };
        let intensity = sun["intensity"].as_f64().unwrap();
        assert!(sun["name"] == "sun" && (0.5..2.0).contains(&intensity), "{sun}");
        let light = numbers(&sun["color"]);
        assert!(light.iter().all(|part| (0.7..1.0).contains(&(part / 0.4 / intensity))), "{sun}");
        let across = numbers(&sun["direction"])[0];
        assert!((0.642..=1.0).contains(&across), "a tilt of at most 50°: {sun}");

        let ambient = numbers(&looks["ambient"]);
        assert!(ambient.iter().all(|part| (0.05..0.15).contains(part)), "{looks}");

        let picture = image::load_from_memory(&of(&drawn, "rgb.png")).unwrap().into_rgb8();
        let instances: Vec<u32> =
            floats(&of(&drawn, "rgb.instance.npy")).iter().map(|n| n.to_bits()).collect();
        for material in looks["materials"].as_array().unwrap() {
            let body = material["body"].as_str().unwrap();
            let color = numbers(&material["color"]);
            let of_block = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.5], [0.2, 0.2, 1.0]];
            assert!(body != "block::link" || of_block.iter().any(|one| is_near(&color, one)), "{material}");
            let is_textured = material["textured"].as_bool().unwrap();
            if body == "panel::link" {
                textured.push(is_textured);
            }
            // The middle of a body has its colour by Lambert's law: colour times light times the cosine between the
            // light and the plate, which faces −x, plus ambient light. Rounding to integers loses at most a half.
            let mut seen = 0;
            for (x, y, pixel) in picture.enumerate_pixels() {
                let at = |x: u32, y: u32| instances[(y * 64 + x) as usize];
                let (rows, columns) =
                    (y.saturating_sub(1)..(y + 2).min(48), x.saturating_sub(1)..(x + 2).min(64));
                let is_inside = rows.clone().all(|y| {
                    columns.clone().all(|x| u64::from(at(x, y)) == material["instance"].as_u64().unwrap())
                });
                for channel in (0..3).filter(|_| is_inside) {
                    let texel = if is_textured { f64::from(TEXEL[channel]) / 255.0 } else { 1.0 };
                    let expected =
                        (255.0 * color[channel] * texel * (light[channel] * across + ambient[channel]))
                            .min(255.0);
                    let found = f64::from(pixel.0[channel]);
                    assert!((found - expected).abs() <= 0.51, "{index} {body}: {found} {expected}");
                    seen += 1;
                }
            }
            assert!(seen > 30, "{body} is hardly seen");
        }
        assert_eq!(looks["materials"].as_array().unwrap().len(), 3);
        pictures.push(of(&drawn, "rgb.png"));
    }
    // All samples differ, including those of the other seed, and both of two alternatives occur.
    assert!((1..8).all(|index| !pictures[..index].contains(&pictures[index])));
    assert!(textured.contains(&true) && textured.contains(&false), "{textured:?}");
}

fn is_near(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-6)
}

#[test]
fn a_partial_folder_is_refused_if_any_input_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    studio(folder.path());
    let path = plan(folder.path(), PLAN);
    let out = folder.path().join("out");
    make(&path, &out, &["--shards", "0..1"]);
    let change = |name: &str, bytes: &[u8]| {
        let file = folder.path().join(name);
        let before = fs::read(&file).unwrap();
        fs::write(&file, bytes).unwrap();
        let error = refused(&path, &out, &[]);
        assert!(error.contains("holds shards of another plan"), "{error}");
        assert!(
            error.contains(&format!("these files have changed: {name}; choose another folder")),
            "{error}"
        );
        assert!(!out.join("manifest.json").exists(), "nothing is made");
        fs::write(&file, before).unwrap();
    };
    change("panel.obj", PANEL.replace("v 0 0.2 0.2", "v 0 0.3 0.2").as_bytes());
    change("panel.mtl", b"newmtl sheet\nKd 1 0 0\nmap_Kd panel.png\n");
    let mut picture = Vec::new();
    let other = image::RgbImage::from_pixel(2, 2, image::Rgb([1, 2, 3]));
    other.write_to(&mut std::io::Cursor::new(&mut picture), image::ImageFormat::Png).unwrap();
    change("panel.png", &picture);
    change("eye.sdf", EYE.replace("1.1", "1.2").as_bytes());
    change("studio.world", WORLD.replace("0.3 0.5 0.4", "0.3 0.5 0.5").as_bytes());

    // With the original files, also in another folder, it continues.
    let moved = folder.path().join("moved");
    fs::create_dir(&moved).unwrap();
    studio(&moved);
    let said = make(&plan(&moved, PLAN), &out, &[]);
    assert!(said.contains("1 of which existed already"), "{said}");
}

#[test]
fn invalid_ranges_are_named_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    studio(folder.path());
    let out = folder.path().join("out");
    for (old, new, says) in [
        (
            "intensity = [0.5, 2.0]",
            "intensity = [2.0, 0.5]",
            "plan.toml:21: error: intensity = [2.0, 0.5] is not a range; write two numbers from 0 to 1000, the lower first",
        ),
        (
            "intensity = [0.5,",
            "intensity = [-0.5,",
            "plan.toml:21: error: intensity = [-0.5, 2.0] is not a range",
        ),
        (
            "intensity = [0.5,",
            "intensity = [nan,",
            "plan.toml:21: error: intensity = [NaN, 2.0] is not a range",
        ),
        (
            "ambient = [0.5, 1.5]",
            "ambient = [0.5, inf]",
            "plan.toml:17: error: ambient = [0.5, inf] is not a range",
        ),
        ("[0, 50]", "[0, 500]", "plan.toml:23: error: tilt_deg = [0.0, 500.0] is not a range"),
        (r#"["sun"]"#, r#"["son"]"#, "plan.toml:20: error: no world has a light 'son'; did you mean 'sun'?"),
        (
            r#"["block"]"#,
            r#"["blok"]"#,
            "plan.toml:31: error: no world has a body 'blok'; did you mean 'block'?",
        ),
        (
            "brightness",
            "brighness",
            "plan.toml:28: error: unknown field `brighness`, expected one of `bodies`",
        ),
        ("[[1, 0, 0],", "[[2, 0, 0],", "plan.toml:32: error: colors = [[2.0, 0.0, 0.0]"),
        (
            "[[0.5, 0.5, 0.5]",
            "[[0.5, 2, 0.5]",
            "plan.toml:36: error: color = [[0.5, 2.0, 0.5], [1.0, 1.0, 1.0]]",
        ),
        (
            "textured = 0.5",
            "textured = 5",
            "plan.toml:37: error: textured = 5; write a probability from 0 to 1",
        ),
    ] {
        let text = format!("{PLAN}{RANDOMIZE}").replace(old, new);
        let error = refused(&plan(folder.path(), &text), &out, &[]);
        assert!(error.contains(says) && error.lines().count() == 1, "{new}: {error}");
        assert!(!out.exists(), "nothing is made");
    }
}
