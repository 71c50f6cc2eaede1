//! Collada.

use super::{Files, L, area, assert_l, bounds, hits};

/// A file with a geometry of these primitives over 6 positions; by default, those of the L.
fn dae(positions: &str, primitives: &str, nodes: &str) -> String {
    let count = positions.split_whitespace().count();
    format!(
        "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>\n<library_geometries>\
         <geometry id='g'><mesh>\n<source id='s'><float_array id='a' count='{count}'>{positions}</float_array><technique_common>\
         <accessor source='#a' count='{}' stride='3'/></technique_common></source>\n<vertices id='v'><input semantic='POSITION' \
         source='#s'/></vertices>\n{primitives}</mesh></geometry></library_geometries>\n<library_visual_scenes>\
         <visual_scene id='scene'>{nodes}</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene url='#scene'/>\
         </scene></COLLADA>",
        count / 3
    )
}

fn l() -> String {
    L.as_flattened().iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + " "
}

const INPUT: &str = "<input semantic='VERTEX' source='#v' offset='0'/>";
const NODE: &str = "<node><instance_geometry url='#g'/></node>";

#[test]
fn concave_faces_keep_their_notch() {
    let files = Files::new();
    for primitive in [
        format!("<polylist count='1'>{INPUT}<vcount>6</vcount><p>0 1 2 3 4 5</p></polylist>"),
        format!("<polylist count='1'>{INPUT}<vcount>6</vcount><p>4 5 0 1 2 3</p></polylist>"),
        format!("<polygons count='1'>{INPUT}<p>5 0 1 2 3 4</p></polygons>"),
    ] {
        files.write("l.dae", dae(&l(), &primitive, NODE));
        assert_l(&files.meshes("l.dae"));
    }
}

/// A square of 16 with two holes of 1, one of which is half filled again.
pub(super) fn with_a_hole() -> String {
    let square =
        |low: f64, high: f64| format!("{low} {low} 0 {high} {low} 0 {high} {high} 0 {low} {high} 0 ");
    let positions = square(0.0, 4.0) + &square(1.0, 2.0) + &square(2.5, 3.5) + "9 9 0";
    let polygons = format!(
        "<polygons count='2'>{INPUT}<ph><p>0 1 2 3</p><h>4 7 6 5</h><h>8 9 10 11</h><h>12</h></ph><p>4 5 6</p></polygons>"
    );
    dae(&positions, &polygons, NODE)
}

#[test]
fn polygons_with_holes() {
    let files = Files::new();
    files.write("h.dae", with_a_hole());
    let meshes = files.meshes("h.dae");
    assert!((area(&meshes) - 14.5).abs() < 1e-6, "{}", area(&meshes));
    let down = [0.0, 0.0, -1.0];
    for (x, y, count) in [(3.0, 3.1, 0), (1.2, 1.7, 0), (1.7, 1.2, 1), (2.3, 2.1, 1), (3.8, 0.3, 1)] {
        assert_eq!(hits(&meshes, [x, y, 1.0], down), count, "{x} {y}");
    }
}

/// A part of a node without a name has the name of the nearest ancestor that has one.
#[test]
fn unnamed_nodes_have_the_name_of_their_ancestor() {
    let files = Files::new();
    let at = |x: i32| format!("<translate>{x} 0 0</translate><instance_geometry url='#g'/>");
    let nodes = format!(
        "<node name='arm'><node>{}</node><node name='hand'>{}<node><node>{}</node></node></node></node><node>{}</node>",
        at(10),
        at(20),
        at(3),
        at(40)
    );
    let primitive = format!("<triangles count='1'>{INPUT}<p>4 5 3</p></triangles>");
    files.write("n.dae", dae(&l(), &primitive, &nodes));
    assert_eq!(bounds(&files.part("n.dae", "arm")), [[10.0, 0.0, 1.0], [12.0, 2.0, 1.0]]);
    assert_eq!(bounds(&files.part("n.dae", "hand")), [[20.0, 0.0, 1.0], [25.0, 2.0, 1.0]]);
    assert_eq!(bounds(&files.part("n.dae", "g")), [[10.0, 0.0, 1.0], [42.0, 2.0, 1.0]]);
}

#[test]
fn the_first_of_an_id_counts_and_the_second_is_a_warning() {
    let files = Files::new();
    let primitive = format!("<triangles count='1'>{INPUT}<p>4 5 3</p></triangles>");
    let text = dae(&l(), &primitive, &format!("{NODE}{NODE}"));
    let second =
        "<library_geometries>\n<geometry id='g'/><geometry id='x'/><geometry id='x'/></library_geometries>";
    files
        .write("i.dae", text.replace("<library_visual_scenes>", &format!("{second}<library_visual_scenes>")));
    let (meshes, problems) = files.load("i.dae");
    assert!((area(&meshes.unwrap()) - 4.0).abs() < 1e-6);
    // Nothing refers to x.
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    let words = "i.dae:7: warning: the id 'g' occurs again: the element at i.dae:2 is used";
    assert!(problem.starts_with(words), "{problem}");
}

#[test]
fn faces_of_fewer_than_three_corners_are_a_warning() {
    let files = Files::new();
    let faces = format!("<polylist count='2'>{INPUT}<vcount>6 2</vcount><p>0 1 2 3 4 5 0 1</p></polylist>");
    files.write("e.dae", dae(&l(), &faces, "<node name='n'><instance_geometry url='#g'/></node>"));
    let (meshes, problems) = files.load("e.dae");
    assert!((area(&meshes.unwrap()) - 3.0).abs() < 1e-9);
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert!(problem.contains("warning: a face of fewer than three corners: it is left out"), "{problem}");
}

/// A material that many instances bind is read once, and so is what is wrong with it.
#[test]
fn a_damaged_effect_is_reported_once() {
    let files = Files::new();
    let bound = "<instance_material symbol='red' target='#m'/>";
    let node = format!(
        "<node name='n'><skew>0 1 0 0 0 1 0</skew><instance_geometry url='#g'><bind_material><technique_common>{bound}{bound}\
         </technique_common></bind_material></instance_geometry></node>"
    );
    let nodes = format!("{}<node id='k'>{node}</node><node><instance_node url='#k'/></node>", node.repeat(3));
    let primitive = format!("<triangles material='red'>{INPUT}<p>0 1 2</p></triangles>");
    let materials = |color: &str| {
        format!(
            "<library_materials><material id='m'>\n<instance_effect url='#e'/></material></library_materials>\n\
             <library_effects><effect id='e'><profile_COMMON><technique><phong><diffuse><color>{color}</color></diffuse>\
             </phong></technique></profile_COMMON></effect></library_effects><library_geometries>"
        )
    };
    for (color, looks, count) in [("1 0 0 1", Some([1.0, 0.0, 0.0]), 1), ("red", None, 2)] {
        let file = dae(&l(), &primitive, &nodes).replacen("<library_geometries>", &materials(color), 1);
        files.write("e.dae", file);
        let (meshes, problems) = files.load("e.dae");
        // One of them is about <skew>.
        assert_eq!(problems.len(), count, "{problems:?}");
        let meshes = meshes.unwrap();
        let [mesh] = &meshes[..] else { panic!("one material is one mesh") };
        assert_eq!(mesh.material.as_ref().map(|look| look.diffuse), looks);
        assert_eq!(mesh.triangles.len(), 5);
    }
}

/// Returns the time for which this thread has been running on a processor, in s.
fn processor_s() -> f64 {
    let numbers = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    numbers.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}

/// Many primitives share a source, and many instances share a geometry: each is read once.
#[test]
fn sources_are_read_in_linear_time() {
    let files = Files::new();
    let file = |primitives: usize, nodes: usize| {
        let positions = l().repeat(20 * (primitives + nodes));
        let primitive = format!("<triangles count='1'>{INPUT}<p>4 5 3</p></triangles>");
        dae(&positions, &primitive.repeat(primitives), &NODE.repeat(nodes))
    };
    let seconds = |primitives, nodes| {
        files.write("t.dae", file(primitives, nodes));
        let start = processor_s();
        // The system counts in steps of up to 4 ms.
        for _ in 0..20 {
            assert_eq!(super::triangles(&files.meshes("t.dae")).len(), primitives * nodes);
        }
        processor_s() - start
    };
    // A file four times as large takes four times as long, not sixteen times.
    for many in [|count| (count, 1), |count| (1, count)] {
        let ((a, b), (c, d)): ((usize, usize), (usize, usize)) = (many(100), many(400));
        let mut ratios = (0..8).map(|_| seconds(c, d) / seconds(a, b));
        assert!(ratios.any(|ratio| ratio < 8.0), "sixteen times as long, or so");
    }
}
