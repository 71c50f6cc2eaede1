//! glTF and GLB.

use super::{Files, UpAxis, area, bounds, hits, triangles, volume};
use serde_json::{Value, json};

/// Corner i of the box from (0, 0, 0) to (1, 2, 3) has bit 0 for x, 1 for y, 2 for z.
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 2.0, 0.0],
    [1.0, 2.0, 0.0],
    [0.0, 0.0, 3.0],
    [1.0, 0.0, 3.0],
    [0.0, 2.0, 3.0],
    [1.0, 2.0, 3.0],
];

/// Its faces, counter-clockwise from outside.
const FACES: [[u16; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// A file to which accessors are added.
pub(super) struct Model {
    pub(super) json: Value,
    bytes: Vec<u8>,
}

impl Model {
    pub(super) fn new() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "accessors": [], "bufferViews": [], "scene": 0 });
        Self { json, bytes: Vec::new() }
    }

    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        views.len() - 1
    }

    pub(super) fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors
            .push(json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }));
        accessors.len() - 1
    }

    pub(super) fn floats(&mut self, numbers: &[f32], kind: &str, count: usize) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, kind, count)
    }

    pub(super) fn shorts(&mut self, numbers: &[u16]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, "SCALAR", numbers.len())
    }

    /// The box as a primitive.
    pub(super) fn block() -> Self {
        let mut model = Self::new();
        let positions = model.floats(CORNERS.as_flattened(), "VEC3", 8);
        let corners: Vec<u16> = FACES.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
        let indices = model.shorts(&corners);
        model.json["meshes"] = json!([{ "name": "block", "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices }] }]);
        model.nodes(json!([{ "name": "n", "mesh": 0 }]), &[0]);
        model
    }

    fn nodes(&mut self, nodes: Value, roots: &[usize]) {
        self.json["nodes"] = nodes;
        self.json["scenes"] = json!([{ "nodes": roots }]);
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend((text.len() as u32 + self.bytes.len() as u32 + 28).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }

    pub(super) fn meshes(&self) -> Vec<std::sync::Arc<crate::model::Mesh>> {
        let files = Files::new();
        files.write("m.glb", self.glb());
        files.meshes("m.glb")
    }

    fn error(&self) -> String {
        let files = Files::new();
        files.write("m.glb", self.glb());
        files.error("m.glb")
    }
}

pub(super) fn encoded(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |three: &[u8]| {
        let bits =
            three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        let letter = |at: usize| {
            if at > three.len() { '=' } else { char::from(LETTERS[(bits >> (18 - 6 * at)) as usize & 63]) }
        };
        [0, 1, 2, 3].map(letter)
    };
    bytes.chunks(3).flat_map(group).collect()
}

/// Exporters write one accessor for all primitives. Each part has the vertices that its triangles use, in their order.
#[test]
fn primitives_that_share_an_accessor_have_their_own_vertices() {
    let mut model = Model::block();
    let away = [[9.0; 3]; 40];
    let positions = model.floats([&CORNERS[..], &away].concat().as_flattened(), "VEC3", 48);
    let normals: Vec<[f32; 3]> = (0..48).map(|at| [f32::from(at as u8), 1.0, 0.0]).collect();
    let normals = model.floats(normals.as_flattened(), "VEC3", 48);
    let [few, many] = [model.shorts(&[7, 4, 5]), model.shorts(&[3, 1, 0].repeat(30))];
    let attributes = json!({ "POSITION": positions, "NORMAL": normals });
    model.json["meshes"][0]["primitives"] =
        json!([{ "attributes": attributes, "indices": few }, { "attributes": attributes, "indices": many }]);
    let meshes = model.meshes();
    let [mesh] = &meshes[..] else { panic!("one material is one mesh") };
    let used = [4, 5, 7, 0, 1, 3];
    assert_eq!(mesh.positions, used.map(|at: usize| CORNERS[at]));
    assert_eq!((mesh.triangles.len(), &mesh.triangles[..2]), (31, &[[2, 0, 1], [5, 4, 3]][..]));
    for (normal, at) in mesh.normals.iter().zip(used) {
        assert!((normal[0] / normal[1] - at as f32).abs() < 1e-5, "{normal:?}");
    }
    // A vertex that does not exist is an error, however many there are.
    for corners in [[1, 2, 48].to_vec(), [0, 1, 48].repeat(30)] {
        let indices = model.shorts(&corners);
        model.json["meshes"][0]["primitives"] = json!([{ "attributes": attributes, "indices": indices }]);
        let error = model.error();
        assert!(error.contains("triangle 0 names a vertex that does not exist"), "{error}");
    }
}

#[test]
fn buffers_are_inside_beside_or_in_uris() {
    let files = Files::new();
    let model = Model::block();
    files.write("m.glb", model.glb());
    files.write("my buffer.bin", &model.bytes);
    let data = format!("data:application/octet-stream;base64,{}", encoded(&model.bytes));
    for uri in ["my%20buffer.bin", &data] {
        let mut json = model.json.clone();
        json["buffers"] = json!([{ "byteLength": model.bytes.len(), "uri": uri }]);
        files.write("m.gltf", json.to_string());
        for name in ["m.glb", "m.gltf"] {
            let meshes = files.meshes(name);
            assert_eq!(bounds(&meshes), [[0.0; 3], [1.0, 2.0, 3.0]]);
            assert!((volume(&meshes) - 6.0).abs() < 1e-5);
        }
    }
    for (uri, words) in
        [("gone.bin", "gone.bin"), ("https://example.org/m.bin", "is remote"), ("data:,%zz", "needs")]
    {
        let mut json = model.json.clone();
        json["buffers"] = json!([{ "byteLength": 1, "uri": uri }]);
        files.write("m.gltf", json.to_string());
        assert!(files.error("m.gltf").contains(words), "{}", files.error("m.gltf"));
    }
}

/// Gazebo uses the coordinates unchanged; upright, y becomes z and z becomes −y.
#[test]
fn the_up_axis_is_rotated_only_on_request() {
    let files = Files::new();
    files.write("m.glb", Model::block().glb());
    let (meshes, problems) = files.load_as("m.glb", None, UpAxis::Applied);
    let meshes = meshes.unwrap();
    assert!(problems.is_empty());
    assert_eq!(bounds(&meshes), [[0.0, -3.0, 0.0], [1.0, 0.0, 2.0]]);
    assert!((volume(&meshes) - 6.0).abs() < 1e-5);
}

#[test]
fn nodes_have_their_transforms() {
    let mut model = Model::block();
    let half = 0.5_f64.sqrt();
    let places = [
        // A quarter turn about z, twice the length in x, then moved: the last transform is the innermost.
        (
            json!({ "translation": [10, 0, 0], "rotation": [0, 0, half, half], "scale": [2, 1, 1] }),
            [[8.0, 0.0, 0.0], [10.0, 2.0, 3.0]],
            12.0,
        ),
        (
            json!({ "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1] }),
            [[8.0, 0.0, 0.0], [10.0, 1.0, 3.0]],
            6.0,
        ),
        // A mirroring scale keeps the outside outside.
        (json!({ "scale": [1, 1, -1] }), [[0.0, 0.0, -3.0], [1.0, 2.0, 0.0]], 6.0),
    ];
    for (mut node, corners, content) in places {
        node["mesh"] = 0.into();
        model.nodes(json!([node]), &[0]);
        let meshes = model.meshes();
        assert_eq!(bounds(&meshes), corners);
        assert!((volume(&meshes) - content).abs() < 1e-4, "{}", volume(&meshes));
    }
    // Instances below a node, and one that is in no scene.
    let nodes = json!([
        { "name": "a", "translation": [1, 0, 0], "children": [1, 2] },
        { "mesh": 0 },
        { "name": "b", "mesh": 0, "translation": [0, 5, 0] },
        { "mesh": 0, "translation": [0, 0, 50] }
    ]);
    model.nodes(nodes, &[0]);
    assert_eq!(bounds(&model.meshes()), [[1.0, 0.0, 0.0], [2.0, 7.0, 3.0]]);
    let files = Files::new();
    files.write("m.glb", model.glb());
    assert_eq!(bounds(&files.part("m.glb", "a")), [[1.0, 0.0, 0.0], [2.0, 2.0, 3.0]]);
    assert_eq!(bounds(&files.part("m.glb", "b")), [[1.0, 5.0, 0.0], [2.0, 7.0, 3.0]]);
    // Without a scene, all nodes at the top are shown.
    for key in ["scene", "scenes"] {
        model.json.as_object_mut().unwrap().remove(key);
    }
    assert_eq!(bounds(&model.meshes()), [[0.0, 0.0, 0.0], [2.0, 7.0, 53.0]]);
}

#[test]
fn strips_fans_and_lists_without_indices() {
    for (mode, points, expected) in [
        (5, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 2.0]][..], 1.5),
        (6, &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][..], 1.0),
        (4, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [5.0, 5.0]][..], 0.5),
    ] {
        let mut model = Model::block();
        let numbers: Vec<f32> = points.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
        let positions = model.floats(&numbers, "VEC3", points.len());
        model.json["meshes"] =
            json!([{ "primitives": [{ "attributes": { "POSITION": positions }, "mode": mode }] }]);
        let meshes = model.meshes();
        assert!((area(&meshes) - expected).abs() < 1e-6, "mode {mode}: {}", area(&meshes));
        assert!(triangles(&meshes).iter().all(|[a, b, c]| (b - a).cross(c - a).z > 0.0), "mode {mode}");
    }
}

#[test]
fn sparse_accessors_replace_entries() {
    let mut model = Model::block();
    // The top is raised to 5, in an accessor of the box's corners and then in one of zeros.
    let indices = model.view(&[4, 5, 6, 7]);
    let lifted: Vec<u8> =
        CORNERS[4..].iter().flat_map(|[x, y, _]| [*x, *y, 5.0]).flat_map(f32::to_le_bytes).collect();
    let values = model.view(&lifted);
    model.json["accessors"][0]["sparse"] = json!({ "count": 4, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values } });
    let meshes = model.meshes();
    assert_eq!(bounds(&meshes), [[0.0; 3], [1.0, 2.0, 5.0]]);
    assert!((volume(&meshes) - 10.0).abs() < 1e-5);
    model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let meshes = model.meshes();
    // A pyramid with its tip at the origin.
    assert!((volume(&meshes) - 10.0 / 3.0).abs() < 1e-5);
    assert_eq!(hits(&meshes, [0.9, 1.9, 9.0], [0.0, 0.0, -1.0]), 2);
    model.json["accessors"][0]["count"] = (1_u64 << 40).into();
    assert!(model.error().contains("entries and no bytes"));
    model.json["accessors"][0]["count"] = 7.into();
    assert!(model.error().contains("a sparse entry replaces 7, but there are 7"));
}

/// The upper half is bound to a joint that is 4 higher than in its bind pose; the lower half to one that is not moved.
#[test]
fn skins_are_in_their_rest_pose() {
    let files = Files::new();
    let mut model = Model::block();
    let joints: Vec<u8> = (0..8_u8).flat_map(|at| [at / 4, 0, 0, 0]).collect();
    let joints = model.accessor(&joints, 5121, "VEC4", 8);
    let weights = model.floats(&[1.0, 0.0, 0.0, 0.0].repeat(8), "VEC4", 8);
    let mut bound = [0.0_f32; 32];
    for at in [0, 5, 10, 15, 16, 21, 26, 31] {
        bound[at] = 1.0;
    }
    bound[30] = -3.0;
    let bound = model.floats(&bound, "MAT4", 2);
    let attributes = &mut model.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    model.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": bound }]);
    // The node of the skin itself has no effect.
    let nodes = json!([
        { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
        { "name": "low", "children": [2] },
        { "name": "high", "translation": [0, 0, 7] }
    ]);
    model.nodes(nodes, &[0, 1]);
    files.write("m.glb", model.glb());
    let (meshes, problems) = files.load("m.glb");
    assert_eq!(bounds(&meshes.unwrap()), [[0.0; 3], [1.0, 2.0, 7.0]]);
    assert!(
        problems.len() == 1 && problems[0].contains("warning: the mesh m.glb has a skin"),
        "{problems:?}"
    );
}

#[test]
fn extensions_that_are_not_read_are_named() {
    for (extension, words) in [
        ("KHR_draco_mesh_compression", "export it without Draco compression"),
        ("EXT_meshopt_compression", "export it without meshopt compression"),
        ("VENDOR_thing", "it needs the extension VENDOR_thing, which is not read"),
    ] {
        let mut model = Model::block();
        model.json["extensionsRequired"] = json!(["KHR_mesh_quantization", extension]);
        let error = model.error();
        assert!(error.starts_with("w.sdf:7: error: ") && error.contains(words), "{error}");
    }
    let mut model = Model::block();
    model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    model.json["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": {} });
    assert!(model.error().contains("Draco"));
}

#[test]
fn broken_files_are_one_error() {
    let files = Files::new();
    let whole = Model::block().glb();
    for (bytes, words) in [
        (&whole[..6], "ends within its header"),
        (&whole[..whole.len() - 1], "a chunk declares"),
        (b"glTF\x01\0\0\0....", "GLB of version 1"),
        (b"{\n\"asset\": }", "m.gltf:2: error: "),
        (b"{\"asset\": {\"version\": \"1.0\"}}", "version 1.0"),
        (b"[]", "version unknown"),
        (b"{\"asset\": {\"version\": \"2.0\"}}", "holds no triangles"),
    ] {
        files.write("m.gltf", bytes);
        let error = files.error("m.gltf");
        assert!(error.contains(words), "{error}");
    }
    let broken: [(&str, Value, &str); 12] = [
        ("/accessors/0/count", json!(9), "accessor 0: it needs 108 bytes, and its view has 96"),
        ("/accessors/0/count", json!(1_u64 << 60), "accessor 0: it needs"),
        ("/accessors/0/type", json!("VEC2"), "its type is 'VEC2'"),
        ("/accessors/0/componentType", json!(5124), "5124 is not a componentType"),
        ("/accessors/0/bufferView", json!(7), "there is no entry 7 in bufferViews"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "accessor 0"),
        ("/bufferViews/0/buffer", json!(1), "there is no entry 1 in buffers"),
        ("/nodes/0/mesh", json!(3), "there is no entry 3 in meshes"),
        ("/nodes/0/children", json!([0]), "more than 300 deep"),
        ("/nodes/0/scale", json!([1e300, 1e300, 1e300]), "is not finite"),
        ("/scene", json!(2), "there is no entry 2 in scenes"),
        ("/accessors/1/componentType", json!(5121), "names a vertex that does not exist"),
    ];
    for (place, value, words) in broken {
        let mut model = Model::block();
        model.json["nodes"][0]["children"] = json!([]);
        model.json["nodes"][0]["scale"] = json!([1, 1, 1]);
        model.json["bufferViews"][1]["byteOffset"] = json!(90);
        if !place.starts_with("/accessors/1") {
            model.json["bufferViews"][1]["byteOffset"] = json!(96);
        }
        *model.json.pointer_mut(place).unwrap() = value;
        let error = model.error();
        assert!(error.contains(words), "{place}: {error}");
    }
}
