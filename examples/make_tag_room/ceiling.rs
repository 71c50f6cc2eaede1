//! The ceiling: a slab with a plate for each code below it, and the list of the codes' corners.

use super::codes::{Code, Kind};
use super::output::{Content, Generated};
use super::room::{HEIGHT_M, LENGTH_M, WALL_M, WIDTH_M};
use super::sdf::{self, Part};
use belvedere_sensors::Pose;
use glam::DVec3;
use serde_json::{Value, json};
use std::fmt::Write;

/// Thickness of a plate.
const PLATE_M: f64 = 0.001;
/// Distance of a plate's printed face below the ceiling.
const DROP_M: f64 = 0.002;

pub(crate) fn files(codes: &[Code]) -> Vec<Generated> {
    let file = |path: &str, text| Generated { path: path.into(), content: Content::Text(text) };
    let mut files = vec![
        file(
            "tag_ceiling/model.config",
            sdf::config("tag_ceiling", "A ceiling of AprilTags 36h11 and QR codes, its lower face at z = 0."),
        ),
        file("tag_ceiling/model.sdf", model(codes)),
        file("tag_ceiling/materials/scripts/tags.material", materials(codes)),
        file("worlds/tag_ceiling.tags.json", list(codes)),
    ];
    files.extend(codes.iter().map(|code| {
        let (edge, pixels) = code.texture();
        Generated {
            path: format!("tag_ceiling/materials/textures/{}.png", code.name).into(),
            content: Content::Gray { width: edge, height: edge, pixels },
        }
    }));
    files
}

fn model(codes: &[Code]) -> String {
    let mut content = String::new();
    Part {
        name: "slab".into(),
        place: [0.0, 0.0, 0.05, 0.0],
        shape: sdf::cuboid([LENGTH_M + 2.0 * WALL_M, WIDTH_M + 2.0 * WALL_M, 0.1]),
        material: sdf::paint([0.8, 0.8, 0.78]),
        laser_retro: 0,
    }
    .write(&mut content);
    for code in codes {
        let Code { name, center: [x, y], yaw, .. } = code;
        let z = PLATE_M / 2.0 - DROP_M;
        let shape = sdf::cuboid([plate(code), plate(code), PLATE_M]);
        let fiducial = fiducial(code);
        let _ = write!(
            content,
            "      <visual name=\"{name}\">\n\
             \x20       <pose>{x} {y} {z} 0 0 {yaw}</pose>\n\
             \x20       <geometry>{shape}</geometry>\n\
             \x20       {fiducial}\n\
             \x20       <material>\n\
             \x20         <script>\n\
             \x20           <uri>model://tag_ceiling/materials/scripts</uri>\n\
             \x20           <uri>model://tag_ceiling/materials/textures</uri>\n\
             \x20           <name>TagCeiling/{name}</name>\n\
             \x20         </script>\n\
             \x20         <pbr><metal><albedo_map>model://tag_ceiling/materials/textures/{name}.png</albedo_map>\
             <metalness>0</metalness><roughness>1</roughness></metal></pbr>\n\
             \x20       </material>\n\
             \x20     </visual>\n"
        );
    }
    sdf::model("tag_ceiling", "ceiling", &content)
}

/// Returns the simulator's description of a code. Its centre is that of the plate's lower face. Read from below, right is
/// +x and up is −y: exactly half a turn about x.
fn fiducial(code: &Code) -> String {
    let (family, id) = match code.kind {
        Kind::AprilTag { id } => ("tag36h11", id),
        Kind::Qr { number, .. } => ("qr", number),
    };
    format!(
        "<fiducial><family>{family}</family><id>{id}</id><size>{}</size><pose>0 0 {} {} 0 0</pose></fiducial>",
        super::codes::round(code.edge_m()),
        -PLATE_M / 2.0,
        std::f64::consts::PI,
    )
}

/// Returns the edge of the plate, rounded as in the SDF file.
fn plate(code: &Code) -> f64 {
    super::codes::round(code.plate_m())
}

fn materials(codes: &[Code]) -> String {
    let mut script = String::from(
        "// Made by: cargo run --example make_tag_room\n\
         material TagCeiling/plate\n{\n  technique\n  {\n    pass\n    {\n      ambient 1 1 1 1\n      \
         diffuse 1 1 1 1\n      specular 0 0 0 1 0\n    }\n  }\n}\n",
    );
    for Code { name, .. } in codes {
        let _ = write!(
            script,
            "\nmaterial TagCeiling/{name} : TagCeiling/plate\n{{\n  technique\n  {{\n    pass\n    {{\n      \
             texture_unit\n      {{\n        texture {name}.png\n        filtering anisotropic\n        \
             max_anisotropy 16\n      }}\n    }}\n  }}\n}}\n"
        );
    }
    script
}

/// Returns the corners of a code in the world: bottom left, bottom right, top right, top left of its upright image, which
/// is the order of `p[0..3]` in the AprilTag library. The corners are those of the square without its margin.
fn corners(code: &Code) -> [DVec3; 4] {
    let [x, y] = code.center;
    let world_from_plate =
        Pose::from_xyz_rpy(DVec3::new(x, y, HEIGHT_M - DROP_M), DVec3::new(0.0, 0.0, code.yaw));
    // The lower face of a box, seen from below: right is +x, up is −y.
    let half = code.edge_m() / 2.0;
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(right, up)| world_from_plate.transform_point(DVec3::new(right * half, -up * half, 0.0)))
}

fn list(codes: &[Code]) -> String {
    let micrometres = |value: f64| super::codes::round(value) + 0.0;
    let entries: Vec<String> = codes
        .iter()
        .map(|code| {
            let (family, content): (&str, (&str, Value)) = match &code.kind {
                Kind::AprilTag { id } => ("tag36h11", ("id", json!(id))),
                Kind::Qr { text, .. } => ("qr", ("text", json!(text))),
            };
            let corners = corners(code).map(|corner| corner.to_array().map(micrometres));
            format!(
                "    {{\"name\": \"{}\", \"family\": \"{family}\", \"{}\": {}, \"module_m\": {}, \"edge_m\": {}, \
                 \"corners_m\": {}}}",
                code.name,
                content.0,
                content.1,
                code.module_m,
                micrometres(code.edge_m()),
                json!(corners),
            )
        })
        .collect();
    format!(
        "{{\n  \"about\": \"Codes on the ceiling of tag_ceiling.world. corners_m: x y z in the world of the \
         bottom left, bottom right, top right and top left corner of the code's upright picture (the order of \
         p[0..3] in the AprilTag library), without the white margin; edge_m is their distance.\",\n  \
         \"codes\": [\n{}\n  ]\n}}\n",
        entries.join(",\n")
    )
}
