//! The formats: how a file of each is read, and what it is mutated with.

use crate::{binary, documents};
use belvedere::dataset::Plan;
use belvedere::description::load::{LoadOptions, load_robot, load_world};
use belvedere::description::mesh::{UpAxis, load_mesh_parts};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules, Source, image_file, ogre_material};
use belvedere::recording::{RecordingReader, Timeline};
use glam::DVec3;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::time::Duration;

/// A format of files.
pub(crate) struct Format {
    pub(crate) name: &'static str,
    /// Name of the file that inputs are written to.
    pub(crate) file: &'static str,
    pub(crate) is_xml: bool,
    pub(crate) is_binary: bool,
    /// Words of the format.
    pub(crate) tokens: &'static [&'static str],
    /// Good files that are mutated.
    pub(crate) seeds: fn() -> Vec<Vec<u8>>,
    /// Writes the files that inputs refer to.
    pub(crate) beside: fn(&Path),
    /// Corrects checksums, so that not every mutation fails at them.
    pub(crate) repair: Option<fn(&mut [u8])>,
    /// Reads a file, and returns the messages about it.
    pub(crate) read: fn(&Path) -> Vec<String>,
}

const TEXT: Format = Format {
    name: "",
    file: "",
    is_xml: false,
    is_binary: false,
    tokens: &[],
    seeds: Vec::new,
    beside: |_| {},
    repair: None,
    read: |_| Vec::new(),
};
const XML: Format = Format { is_xml: true, ..TEXT };
const BINARY: Format = Format { is_binary: true, ..TEXT };

pub(crate) static ALL: &[Format] = &[
    Format {
        name: "xacro",
        file: "r.urdf.xacro",
        tokens: documents::XACRO_WORDS,
        seeds: documents::xacro,
        beside: documents::beside_xacro,
        read: read_robot,
        ..XML
    },
    Format {
        name: "yaml",
        file: "c.yaml",
        tokens: documents::YAML_WORDS,
        seeds: documents::yaml,
        beside: documents::beside_yaml,
        read: |path| read_robot(&path.with_file_name("r.urdf.xacro")),
        ..TEXT
    },
    Format {
        name: "urdf",
        file: "r.urdf",
        tokens: documents::URDF_WORDS,
        seeds: documents::urdf,
        beside: binary::beside_models,
        read: read_robot,
        ..XML
    },
    Format {
        name: "sdf",
        file: "w.world",
        tokens: documents::SDF_WORDS,
        seeds: documents::sdf,
        beside: binary::beside_models,
        read: read_world,
        ..XML
    },
    Format {
        name: "collada",
        file: "m.dae",
        tokens: documents::COLLADA_WORDS,
        seeds: documents::collada,
        read: read_mesh,
        ..XML
    },
    Format {
        name: "obj",
        file: "m.obj",
        tokens: &["v ", "vt ", "vn ", "f ", "o ", "g ", "usemtl ", "mtllib m.mtl", "\\\n", "/", "//"],
        seeds: documents::obj,
        beside: |folder| std::fs::write(folder.join("m.mtl"), &documents::mtl()[0]).unwrap(),
        read: read_mesh,
        ..TEXT
    },
    Format {
        name: "mtl",
        file: "m.mtl",
        tokens: &[
            "newmtl ",
            "Kd ",
            "Ka ",
            "Ks ",
            "Ns ",
            "d ",
            "Tr ",
            "map_Kd ",
            "-s ",
            "-o ",
            "m.mtl",
            "/dev/zero",
        ],
        seeds: documents::mtl,
        beside: |folder| std::fs::write(folder.join("m.obj"), &documents::obj()[0]).unwrap(),
        read: |path| read_mesh(&path.with_extension("obj")),
        ..TEXT
    },
    Format {
        name: "stl",
        file: "m.stl",
        is_binary: true,
        tokens: &["solid ", "facet normal ", "outer loop", "vertex ", "endloop", "endfacet", "endsolid"],
        seeds: binary::stl,
        read: read_mesh,
        ..TEXT
    },
    Format {
        name: "ply",
        file: "m.ply",
        tokens: documents::PLY_WORDS,
        seeds: binary::ply,
        read: read_mesh,
        ..TEXT
    },
    Format {
        name: "gltf",
        file: "m.gltf",
        tokens: documents::GLTF_WORDS,
        seeds: binary::gltf,
        read: read_mesh,
        ..TEXT
    },
    Format {
        name: "glb",
        file: "m.glb",
        tokens: documents::GLTF_WORDS,
        seeds: binary::glb,
        read: read_mesh,
        ..BINARY
    },
    Format {
        name: "png",
        file: "p.png",
        seeds: || binary::pictures(image::ImageFormat::Png),
        repair: Some(binary::repair_png),
        read: read_picture,
        ..BINARY
    },
    Format {
        name: "jpeg",
        file: "p.jpg",
        seeds: || binary::pictures(image::ImageFormat::Jpeg),
        read: read_picture,
        ..BINARY
    },
    Format {
        name: "tga",
        file: "p.tga",
        seeds: || binary::pictures(image::ImageFormat::Tga),
        read: read_picture,
        ..BINARY
    },
    Format {
        name: "bmp",
        file: "p.bmp",
        seeds: || binary::pictures(image::ImageFormat::Bmp),
        read: read_picture,
        ..BINARY
    },
    Format {
        name: "dds",
        file: "p.dds",
        seeds: binary::dds,
        tokens: &["DXT1", "DXT3", "DXT5", "DX10"],
        read: read_picture,
        ..BINARY
    },
    Format {
        name: "material",
        file: "m.material",
        tokens: documents::MATERIAL_WORDS,
        seeds: documents::material,
        read: read_material,
        ..TEXT
    },
    Format { name: "mcap", file: "r.mcap", seeds: binary::mcap, read: read_recording, ..BINARY },
    Format {
        name: "plan",
        file: "plan.toml",
        tokens: documents::PLAN_WORDS,
        seeds: documents::plan,
        beside: documents::beside_plan,
        read: read_plan,
        ..TEXT
    },
];

fn texts(diagnostics: &Diagnostics) -> Vec<String> {
    diagnostics.problems().iter().map(ToString::to_string).collect()
}

fn read_robot(path: &Path) -> Vec<String> {
    let options =
        LoadOptions { packages: package_path([], None), rules: Rules::default(), xacro_args: Vec::new() };
    let mut diagnostics = Diagnostics::default();
    load_robot(path.to_str().unwrap(), &options, &mut diagnostics);
    texts(&diagnostics)
}

fn read_world(path: &Path) -> Vec<String> {
    let mut diagnostics = Diagnostics::default();
    let packages = package_path([], None);
    load_world(path.to_str().unwrap(), &packages, Rules::default(), &mut diagnostics);
    texts(&diagnostics)
}

fn read_mesh(path: &Path) -> Vec<String> {
    let mut diagnostics = Diagnostics::default();
    let source = Source::new(path, 1);
    for up_axis in [UpAxis::Ignored, UpAxis::Applied] {
        load_mesh_parts(path, None, DVec3::ONE, up_axis, &source, &mut diagnostics);
    }
    texts(&diagnostics)
}

fn read_picture(path: &Path) -> Vec<String> {
    match image_file::open(path) {
        Ok(picture) => vec![format!("{:?}", picture.into_rgba8().dimensions().0 > 100)],
        Err(error) => vec![error.to_string()],
    }
}

fn read_material(path: &Path) -> Vec<String> {
    let mut diagnostics = Diagnostics::default();
    match ogre_material::parse_file(path) {
        Ok(materials) => {
            let library = ogre_material::Library::new(materials);
            for name in library.names() {
                library.inherited(name, &mut diagnostics);
            }
        }
        Err(problem) => diagnostics.add(problem),
    }
    texts(&diagnostics)
}

fn read_recording(path: &Path) -> Vec<String> {
    let open = || BufReader::new(File::open(path).unwrap());
    let mut said = Vec::new();
    for start in [0, 1] {
        match RecordingReader::starting_at(open(), Duration::from_secs(start)) {
            Ok(reader) => items(reader, &mut said),
            Err(error) => said.push(error.to_string()),
        }
    }
    items(RecordingReader::new(open()), &mut said);
    said.extend(Timeline::of(open()).err().map(|error| error.to_string()));
    said
}

fn items<R: Read>(mut reader: RecordingReader<R>, said: &mut Vec<String>) {
    loop {
        match reader.next_item() {
            Ok(Some(_)) => {}
            Ok(None) => return,
            Err(error) => return said.push(error.to_string()),
        }
    }
}

fn read_plan(path: &Path) -> Vec<String> {
    match Plan::read(path, &package_path([], None)) {
        Ok(plan) => {
            // Any sample can be described.
            let most = plan.samples().min(3);
            (0..most).map(|index| format!("{:?}", plan.sample(index).seed > 0)).collect()
        }
        Err(error) => vec![error.to_string()],
    }
}
