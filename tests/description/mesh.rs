//! Mesh files: the same box in every format, and all errors that a file can have.

use crate::sdf::*;
use belvedere::description::mesh::{UpAxis, load_mesh, load_mesh_parts};
use belvedere::description::model::{Geometry, Mesh};
use belvedere::description::{Diagnostics, Severity, Source};
use glam::DVec3;
use std::path::Path;

/// The corners of the box from (0, 0, 0) to (1, 2, 3); corner i has bit 0 for x, 1 for y, 2 for z.
fn corner(index: usize) -> [f32; 3] {
    [(index & 1) as f32, (index >> 1 & 1) as f32 * 2.0, (index >> 2) as f32 * 3.0]
}

/// Its faces, counter-clockwise from outside.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn triangles() -> impl Iterator<Item = [usize; 3]> {
    FACES.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
}

fn obj() -> String {
    let vertices = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = FACES.iter().map(|f| format!("f {} {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1, f[3] + 1));
    vertices.chain(faces).collect()
}

fn ascii_stl() -> String {
    let facet = |triangle: [usize; 3]| {
        let [a, b, c] = triangle.map(|i| {
            let [x, y, z] = corner(i);
            format!("vertex {x} {y} {z}\n")
        });
        format!("facet normal 0 0 0\nouter loop\n{a}{b}{c}endloop\nendfacet\n")
    };
    format!("solid box\n{}endsolid box\n", triangles().map(facet).collect::<String>())
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(12u32.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|i| corner(*i)).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The box in Collada with an asset, the inside of a node, and `<p>` made from index pairs (position, texture).
fn dae(asset: &str, node: &str, positions: impl Fn([f32; 3]) -> [f32; 3]) -> String {
    let numbers: Vec<String> = (0..8).flat_map(|i| positions(corner(i))).map(|v| v.to_string()).collect();
    let numbers = numbers.join(" ");
    let p: Vec<String> = FACES.iter().flatten().enumerate().map(|(n, i)| format!("{i} {}", n % 4)).collect();
    let p = p.join(" ");
    format!(
        "<?xml version='1.0'?>
<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'><asset>{asset}</asset>
<library_images><image id='pic'><init_from>paint.png</init_from></image></library_images>
<library_effects><effect id='fx'><profile_COMMON>
  <newparam sid='surf'><surface type='2D'><init_from>pic</init_from></surface></newparam>
  <newparam sid='samp'><sampler2D><source>surf</source></sampler2D></newparam>
  <technique sid='c'><phong><emission><color>0 0 0 1</color></emission><diffuse><texture texture='samp' texcoord='UV'/></diffuse></phong></technique>
</profile_COMMON></effect><effect id='red_fx'><profile_COMMON><technique sid='c'><phong><diffuse><color>1 0 0 1</color></diffuse><specular><color>.2 .3 .4 1</color></specular><shininess><float>50</float></shininess><transparent opaque='A_ONE'><color>1 1 1 0.5</color></transparent><transparency><float>0.5</float></transparency></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id='mat'><instance_effect url='#fx'/></material><material id='red'><instance_effect url='#red_fx'/></material></library_materials>
<library_geometries><geometry id='box'><mesh>
  <source id='pos'><float_array id='pos-a' count='24'>{numbers}</float_array><technique_common><accessor source='#pos-a' count='8' stride='3'/></technique_common></source>
  <source id='uv'><float_array id='uv-a' count='8'>0 0 1 0 1 1 0 1</float_array><technique_common><accessor source='#uv-a' count='4' stride='2'/></technique_common></source>
  <vertices id='ver'><input semantic='POSITION' source='#pos'/></vertices>
  <polylist material='sym' count='6'><input semantic='VERTEX' source='#ver' offset='0'/><input semantic='TEXCOORD' source='#uv' offset='1' set='0'/>
    <vcount>4 4 4 4 4 4</vcount><p>{p}</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id='scene'><node id='n'>{node}</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url='#scene'/></scene></COLLADA>"
    )
}

fn instance(material: &str) -> String {
    format!(
        "<instance_geometry url='#box'><bind_material><technique_common><instance_material symbol='sym' target='#{material}'/>\
         </technique_common></bind_material></instance_geometry>"
    )
}

fn mesh(folder: &Folder, name: &str, content: impl AsRef<[u8]>, scale: DVec3) -> Mesh {
    let path = folder.write(name, content);
    let mut diagnostics = Diagnostics::default();
    let mesh = load_mesh(&path, scale, UpAxis::Ignored, &Source::new("test.world", 1), &mut diagnostics);
    assert!(diagnostics.problems().is_empty(), "{name}: {:#?}", diagnostics.problems());
    std::sync::Arc::unwrap_or_clone(mesh.unwrap())
}

/// The bounds, and the volume that the surface encloses: positive if its triangles face outwards.
fn bounds_and_volume(mesh: &Mesh) -> (DVec3, DVec3, f64) {
    let point = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
    let low = mesh.positions.iter().fold(DVec3::INFINITY, |m, p| m.min(DVec3::from_array(p.map(f64::from))));
    let high =
        mesh.positions.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(DVec3::from_array(p.map(f64::from))));
    let volume =
        mesh.triangles.iter().map(|t| point(t[0]).dot(point(t[1]).cross(point(t[2]))) / 6.0).sum::<f64>();
    (low, high, volume)
}

#[track_caller]
fn assert_box(mesh: &Mesh, low: [f64; 3], high: [f64; 3], volume: f64) {
    let (mesh_low, mesh_high, mesh_volume) = bounds_and_volume(mesh);
    assert!((mesh_low - DVec3::from(low)).length() < 1e-6, "{mesh_low}");
    assert!((mesh_high - DVec3::from(high)).length() < 1e-6, "{mesh_high}");
    assert!((mesh_volume - volume).abs() < 1e-5, "{mesh_volume}");
    assert_eq!(mesh.triangles.len(), 12);
}

#[test]
fn a_box_in_every_format() {
    let folder = Folder::new();
    for (name, content) in
        [("b.obj", obj().into_bytes()), ("a.stl", ascii_stl().into_bytes()), ("B.STL", binary_stl())]
    {
        assert_box(&mesh(&folder, name, &content, DVec3::ONE), [0.0; 3], [1.0, 2.0, 3.0], 6.0);
        assert_box(&mesh(&folder, name, &content, DVec3::splat(0.5)), [0.0; 3], [0.5, 1.0, 1.5], 0.75);
        // Mirrored, it still faces outwards.
        let mirrored = mesh(&folder, name, &content, DVec3::new(-1.0, 1.0, 1.0));
        assert_box(&mirrored, [-1.0, 0.0, 0.0], [0.0, 2.0, 3.0], 6.0);
    }
}

/// The header begins like a text file, and a byte of the number of triangles is a new line.
#[test]
fn a_binary_stl_that_looks_like_text() {
    for count in [10_u32, 12] {
        let mut bytes = binary_stl();
        bytes[..9].copy_from_slice(b"solid box");
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        bytes.truncate(84 + 50 * count as usize);
        let mesh = mesh(&Folder::new(), "box.stl", &bytes, DVec3::ONE);
        assert_eq!(mesh.triangles.len(), count as usize);
    }
}

#[test]
fn collada_units_axes_and_nodes() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let load = |asset: &str, node: &str| {
        mesh(&folder, "b.dae", dae(asset, &format!("{node}{}", instance("mat")), |p| p), DVec3::ONE)
    };
    let plain = load("<unit meter='1'/><up_axis>Z_UP</up_axis>", "");
    assert_box(&plain, [0.0; 3], [1.0, 2.0, 3.0], 6.0);
    assert_eq!(plain.uvs.len(), plain.positions.len());
    let material = plain.material.unwrap();
    assert!(material.texture.unwrap().ends_with("paint.png") && material.diffuse == [1.0; 3]);
    assert_box(&load("", ""), [0.0; 3], [1.0, 2.0, 3.0], 6.0);
    // Centimetres. As in Gazebo, an up axis has no effect unless it is requested.
    let y_up = "<unit meter='0.01'/><up_axis>Y_UP</up_axis>";
    assert_box(&load(y_up, ""), [0.0; 3], [0.01, 0.02, 0.03], 6e-6);
    let turned = |asset: &str| {
        let path = folder.write("up.dae", dae(asset, &instance("red"), |p| p));
        let mut diagnostics = Diagnostics::default();
        let source = Source::new("w", 1);
        let mesh = load_mesh(&path, DVec3::ONE, UpAxis::Applied, &source, &mut diagnostics);
        std::sync::Arc::unwrap_or_clone(mesh.unwrap())
    };
    // y becomes z, z becomes −y.
    assert_box(&turned(y_up), [0.0, -0.03, 0.0], [0.01, 0.0, 0.02], 6e-6);
    assert_box(&turned("<up_axis>X_UP</up_axis>"), [-2.0, -3.0, 0.0], [0.0, 0.0, 1.0], 6.0);
    // From (8, 0, 0) towards the origin with z up: x goes to y, y to z, and z to x.
    let seen = load("", "<lookat>8 0 0 0 0 0 0 0 1</lookat>");
    assert_box(&seen, [8.0, 0.0, 0.0], [11.0, 1.0, 2.0], 6.0);
    // The first transform is the outermost.
    let moved = load("", "<translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>");
    assert_box(&moved, [8.0, 0.0, 0.0], [10.0, 2.0, 3.0], 12.0);
    let matrix = load("", "<matrix>0 -1 0 10 1 0 0 0 0 0 1 0 0 0 0 1</matrix>");
    assert_box(&matrix, [8.0, 0.0, 0.0], [10.0, 1.0, 3.0], 6.0);
    let mirrored = load("", "<scale>1 1 -1</scale>");
    assert_box(&mirrored, [0.0, 0.0, -3.0], [1.0, 2.0, 0.0], 6.0);
}

#[test]
fn collada_instances_and_materials() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let node = format!("{}<node><translate>5 0 0</translate>{}</node>", instance("mat"), instance("red"));
    let path = folder.write("b.dae", dae("", &node, |p| p));
    let mut diagnostics = Diagnostics::default();
    let parts =
        load_mesh_parts(&path, None, DVec3::ONE, UpAxis::Ignored, &Source::new("w", 1), &mut diagnostics)
            .unwrap();
    let [textured, red] = &parts[..] else { panic!("{}", parts.len()) };
    assert!(textured.material.as_ref().unwrap().texture.is_some());
    let look = red.material.as_ref().unwrap();
    assert_eq!(look.diffuse, [1.0, 0.0, 0.0]);
    assert_eq!((look.specular, look.shininess, look.alpha), ([0.2, 0.3, 0.4], 50.0, 0.25));
    assert_box(red, [5.0, 0.0, 0.0], [6.0, 2.0, 3.0], 6.0);
    // In a world: one visual per material, and one collision.
    let geometry = "<geometry><mesh><uri>b.dae</uri></mesh></geometry>";
    let content =
        model(&format!("<visual name='v'>{geometry}</visual><collision name='c'>{geometry}</collision>"));
    let (world, problems) = folder.load("1.6", &content, false);
    assert!(problems.is_empty(), "{problems:#?}");
    let link = &world.unwrap().models[0].links[0];
    assert_eq!((link.visuals.len(), link.collisions.len()), (2, 1));
    assert_eq!(link.visuals[1].material.diffuse, [1.0, 0.0, 0.0]);
}

/// `<submesh>` selects a part by the name of its node, its geometry or its group, and can move its centre to the
/// origin.
#[test]
fn parts_of_a_mesh() {
    let folder = Folder::new();
    let here = instance("red");
    let node = format!("{here}<node name='far'><translate>5 0 0</translate>{here}</node>");
    folder.write("two.dae", dae("", &node, |p| p));
    let object = |name: &str, first: usize, x: f64| {
        format!("g {name}\nv {x} 0 0\nv {} 0 0\nv {x} 3 0\nf {first} {} {}\n", x + 2.0, first + 1, first + 2)
    };
    folder.write("two.obj", object("one", 1, 0.0) + &object("other", 4, 7.0));
    let visual = |uri: &str, part: &str| {
        model(&format!("<visual name='v'><geometry><mesh><uri>{uri}</uri>{part}</mesh></geometry></visual>"))
    };
    let load = |uri, part: &str| {
        let (world, problems) = folder.load("1.6", &visual(uri, part), false);
        assert!(problems.is_empty(), "{problems:#?}");
        let Geometry::Mesh(mesh) = &world.unwrap().models[0].links[0].visuals[0].geometry else { panic!() };
        bounds_and_volume(mesh)
    };
    let far = "<submesh><name>far</name></submesh>";
    assert_eq!(load("two.dae", far).0, DVec3::new(5.0, 0.0, 0.0));
    assert_eq!(load("two.dae", far).1, DVec3::new(6.0, 2.0, 3.0));
    let centred = "<submesh><name>far</name><center>true</center></submesh>";
    assert_eq!(load("two.dae", centred).1, DVec3::new(0.5, 1.0, 1.5));
    // Both have the same geometry.
    assert_eq!(load("two.dae", "<submesh><name>box</name></submesh>").1, DVec3::new(6.0, 2.0, 3.0));
    let other = "<submesh><name>other</name><center>1</center></submesh><scale>2 2 2</scale>";
    assert_eq!(load("two.obj", other).0, DVec3::new(-2.0, -3.0, 0.0));
    for (part, words) in [
        ("<submesh><name>fra</name></submesh>", "did you mean 'far'"),
        ("<submesh/>", "<submesh> has no <name>"),
    ] {
        let (_, problems) = folder.load("1.6", &visual("two.dae", part), false);
        assert!(matches!(&problems[..], [only] if only.to_string().contains(words)), "{problems:#?}");
    }
}

/// Errors outside the triangles give at most a warning.
#[test]
fn errors_in_details_do_not_prevent_loading() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let plain = || dae("", &instance("mat"), |p| p);
    let camera = "<node id='eye'><matrix>nan nan nan 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_camera url='#c'/></node>";
    for (name, content, words) in [
        ("camera.dae", plain().replace("<node id='n'>", &format!("{camera}<node id='n'>")), ""),
        ("lookat.dae", plain().replace(camera, "<node><lookat>1</lookat></node>"), ""),
        ("material.dae", plain().replace("target='#mat'", "target='#mud'"), "nothing with the id '#mud'"),
        ("effect.dae", plain().replace("url='#fx'", "url='#fog'"), "nothing with the id '#fog'"),
        ("color.dae", dae("", &instance("red"), |p| p).replace(">1 0 0 1<", ">1 0<"), "three finite numbers"),
        ("skew.dae", dae("", &format!("<skew>1 2 3 4 5 6 7</skew>{}", instance("mat")), |p| p), "<skew>"),
        ("picture.dae", plain().replace("paint.png", "gone.png"), "no texture gone.png"),
    ] {
        let path = folder.write(name, content);
        let mut diagnostics = Diagnostics::default();
        let source = Source::new("test.world", 7);
        let mesh = load_mesh(&path, DVec3::ONE, UpAxis::Ignored, &source, &mut diagnostics).unwrap();
        assert_box(&mesh, [0.0; 3], [1.0, 2.0, 3.0], 6.0);
        assert!(
            mesh.material
                .as_ref()
                .is_none_or(|material| { material.texture.as_ref().is_none_or(|texture| texture.is_file()) })
        );
        let problems: Vec<String> = diagnostics.problems().iter().map(ToString::to_string).collect();
        assert!(!diagnostics.has_errors(), "{name}: {problems:?}");
        assert_eq!(problems.len(), usize::from(!words.is_empty()), "{name}: {problems:?}");
        assert!(
            problems.iter().all(|problem| problem.contains(words) && problem.contains(name)),
            "{problems:?}"
        );
    }
}

#[test]
fn pictures_are_found_in_the_model() {
    let folder = Folder::new();
    let texture = folder.write("bin/materials/textures/bin.png", b"");
    let look = |path: &Path| {
        let mut diagnostics = Diagnostics::default();
        let mesh = load_mesh(path, DVec3::ONE, UpAxis::Ignored, &Source::new("w", 1), &mut diagnostics);
        assert!(diagnostics.problems().is_empty(), "{:#?}", diagnostics.problems());
        mesh.unwrap().material.clone().unwrap()
    };
    for name in ["bin.png", "../materials/textures/bin.png", "C:\\maps\\bin.png", "file:///tmp/maps/bin.png"]
    {
        let content = dae("", &instance("mat"), |p| p).replace("paint.png", name);
        let found = look(&folder.write("bin/meshes/bin.dae", content)).texture.unwrap();
        assert_eq!(found.canonicalize().unwrap(), texture.canonicalize().unwrap(), "{name}");
    }
    // An OBJ and its .mtl, indented like exporters do.
    folder.write(
        "bin/meshes/bin.mtl",
        "newmtl tin\n\tNs nan\n\tKd 0.5 0.25 1\n  d 0.5\nnewmtl foil\n\tmap_Kd bin.png\n",
    );
    let obj = |material: &str| {
        let content = format!("mtllib bin.mtl\n  usemtl {material}\n{}", obj().replace('v', " v"));
        look(&folder.write("bin/meshes/bin.obj", content))
    };
    let tin = obj("tin");
    assert_eq!((tin.diffuse, tin.alpha, tin.texture), ([0.5, 0.25, 1.0], 0.5, None));
    assert_eq!(obj("foil").texture.unwrap().canonicalize().unwrap(), texture.canonicalize().unwrap());
}

#[test]
fn nested_instances_are_limited() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    // Each node contains the next one twice: 2^40 boxes.
    let nodes: Vec<String> = (0..40)
        .map(|i| {
            format!("<node id='n{i}'><instance_node url='#n{0}'/><instance_node url='#n{0}'/></node>", i + 1)
        })
        .collect();
    let nodes = nodes.concat();
    let library = format!("<library_nodes>{nodes}<node id='n40'>{}</node></library_nodes>", instance("mat"));
    let content = dae("", "<instance_node url='#n0'/>", |p| p)
        .replace("<library_visual_scenes>", &format!("{library}<library_visual_scenes>"));
    let path = folder.write("many.dae", content);
    let mut diagnostics = Diagnostics::default();
    let source = Source::new("w", 1);
    assert!(load_mesh(&path, DVec3::ONE, UpAxis::Ignored, &source, &mut diagnostics).is_none());
    let problem = diagnostics.problems()[0].to_string();
    assert!(
        problem.contains("more than 500000 elements") || problem.contains("more than 256 MB"),
        "{problem}"
    );
}

#[test]
fn bad_meshes() {
    let folder = Folder::new();
    folder.write("paint.png", b"");
    let plain = || dae("", &instance("mat"), |p| p);
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty.obj", b"# nothing\n".to_vec(), "no triangles"),
        ("empty.stl", b"".to_vec(), "cannot be read"),
        ("cut.stl", binary_stl()[..200].to_vec(), "cannot be read"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n".to_vec(), "cannot be read"),
        ("nan.obj", b"v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n".to_vec(), "nan.obj"),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec(), "no triangles"),
        ("broken.dae", b"<COLLADA>\n<asset>".to_vec(), "broken XML"),
        ("other.dae", b"<html/>".to_vec(), "<html>"),
        ("unit.dae", plain().replace("<asset>", "<asset><unit meter='-1'/>").into(), "unit"),
        ("axis.dae", plain().replace("<asset>", "<asset><up_axis>W_UP</up_axis>").into(), "W_UP"),
        ("index.dae", plain().replace("<p>0 0", "<p>99 0").into(), "entry 99"),
        ("short.dae", plain().replace("<vcount>4 4", "<vcount>4 400").into(), "<vcount>"),
        ("word.dae", plain().replace("<vcount>4", "<vcount>four").into(), "'four'"),
        ("nan.dae", dae("", &instance("mat"), |[x, y, _]| [x, y, f32::NAN]).into(), "vertex 0 is not finite"),
        ("link.dae", plain().replace("url='#box'", "url='#bax'").into(), "'#bax'"),
        (
            "loop.dae",
            plain().replace("<node id='n'>", "<node id='n'><instance_node url='#n'/>").into(),
            "more than 300 deep",
        ),
        ("part.step", b"ISO-10303-21;".to_vec(), "stl, obj, dae"),
    ];
    for (name, content, words) in cases {
        let path = folder.write(name, content);
        let mut diagnostics = Diagnostics::default();
        load_mesh(&path, DVec3::ONE, UpAxis::Applied, &Source::new("test.world", 7), &mut diagnostics);
        let [problem] = diagnostics.problems() else { panic!("{name}: {:#?}", diagnostics.problems()) };
        let text = problem.to_string();
        assert_eq!(problem.severity, Severity::Error);
        assert!(text.contains(words) && text.contains(name), "{name}: {text}");
        assert!(!problem.remedy.is_empty(), "{text}");
    }
    let mut diagnostics = Diagnostics::default();
    load_mesh(Path::new("x.stl"), DVec3::ZERO, UpAxis::Ignored, &Source::new("w", 1), &mut diagnostics);
    assert!(diagnostics.problems()[0].what.contains("scale"));
}
