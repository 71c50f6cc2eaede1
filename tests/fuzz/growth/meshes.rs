//! Meshes that grow.

use super::{Shape, nest, pair, row};

const DAE: &str = "<COLLADA xmlns='http://x' version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
    <float_array id='a' count='9'>0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source='#a' count='3' stride='3'/>\
    </technique_common></source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices>";
const DAE_END: &str = "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='z'><node>\
    <instance_geometry url='#g'/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url='#z'/></scene></COLLADA>";
/// Collada with normals of the vertices, and further sources, up to the primitives.
const SMOOTH_DAE: &str = "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
    <float_array count='9'>0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source='#a' count='3' stride='3'/>\
    </technique_common></source><source id='n'><float_array count='3'>0 0 1</float_array><technique_common>\
    <accessor source='#b' count='1' stride='3'/></technique_common></source>\
    <vertices id='v'><input semantic='POSITION' source='#s'/></vertices>";
/// The normals that primitives name are an array that grows.
const NORMALS_DAE: &str = "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
    <float_array count='9'>0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source='#a' count='3' stride='3'/>\
    </technique_common></source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices>\
    <source id='n'><float_array>";
const SMOOTH_TRIANGLE: &str = "<triangles count='1'><input semantic='VERTEX' source='#v' offset='0'/>\
    <input semantic='NORMAL' source='#n' offset='1'/><p>0 0 1 0 2 0</p></triangles>";
const DAE_MESH_END: &str = "</mesh></geometry></library_geometries></COLLADA>";
/// A triangle in the plane of x and y, with the accessors 0 of its positions and 1 of its normals.
const SMOOTH_GLTF: &str = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":72,\"uri\":\"data:;base64,\
    AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/\"}],\
    \"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36}],\
    \"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3},\
    {\"bufferView\":1,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3}],\
    \"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[";
const SMOOTH_PRIMITIVE: &str = "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}},";
const FLAT_PRIMITIVES_END: &str = "{\"attributes\":{\"POSITION\":0}}]}]}";
const SMOOTH_PLY: &str = "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face {count}\n\
    property list uchar int vertex_indices\nend_header\n";
/// The corners of its faces have texture coordinates of their own.
const TEXTURED_PLY: &str = "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face {count}\n\
    property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n";
const EFFECT_END: &str = "<technique><phong><diffuse><color>1 0 0 1</color></diffuse></phong></technique></profile_COMMON>\
    </effect></library_effects><library_geometries><geometry id='g'/></library_geometries>\
    <library_visual_scenes><visual_scene id='z'><node><instance_geometry url='#g'><bind_material><technique_common>";
const DAMAGED_EFFECT_END: &str = "damaged</color></diffuse></phong></technique></profile_COMMON>\
    </effect></library_effects><library_geometries><geometry id='g'/></library_geometries>\
    <library_visual_scenes><visual_scene id='z'><node><instance_geometry url='#g'><bind_material><technique_common>";
const BINDING_END: &str = "</technique_common></bind_material></instance_geometry></node></visual_scene>\
    </library_visual_scenes><scene><instance_visual_scene url='#z'/></scene></COLLADA>";
const INSTANCES: &str =
    "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='z'><node>";
const NODES: &str = "</node></library_nodes><library_visual_scenes><visual_scene id='z'><node>";
const BOUND_NODES: &str = "</technique_common></bind_material></instance_geometry></node></library_nodes>\
    <library_visual_scenes><visual_scene id='z'><node>";
const INSTANCES_END: &str = "</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url='#z'/></scene></COLLADA>";
/// The accessors 0 of three indices and 1 of positions that grow.
const SHARED_POSITIONS: &str = "\"}],\"bufferViews\":[{\"buffer\":0,\"byteStride\":10,\"byteLength\":{count}0}],\
    \"accessors\":[{\"componentType\":5121,\"type\":\"SCALAR\",\"count\":3},\
    {\"bufferView\":0,\"componentType\":5120,\"type\":\"VEC3\",\"count\":{count}}],\"meshes\":[{\"primitives\":[";
const SPARSE_POSITIONS: &str = "\"}],\"bufferViews\":[{\"buffer\":0,\"byteStride\":10,\"byteLength\":{count}0}],\
    \"accessors\":[{\"componentType\":5121,\"type\":\"SCALAR\",\"count\":3},\
    {\"componentType\":5120,\"type\":\"VEC3\",\"count\":3,\"sparse\":{\"count\":{count},\
    \"indices\":{\"bufferView\":0,\"componentType\":5121},\"values\":{\"bufferView\":0}}}],\
    \"meshes\":[{\"primitives\":[";

pub(super) const SHAPES: &[Shape] = &[
    row(
        "collada",
        DAE,
        "<triangles count='1'><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles>",
        DAE_END,
    ),
    row(
        "collada",
        "<COLLADA version='1.4.1'><library_effects>",
        "<effect id='e#'/>",
        "</library_effects></COLLADA>",
    ),
    row(
        "collada",
        "<COLLADA xmlns='http://x' version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'><float_array id='a' count='9'>",
        "0 1 ",
        "</float_array></source></mesh></geometry></library_geometries></COLLADA>",
    ),
    nest(
        "collada",
        "<COLLADA version='1.4.1'><library_visual_scenes><visual_scene id='z'>",
        ["<node>", "</node>"],
        "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#z'/></scene></COLLADA>",
    ),
    row("collada", SMOOTH_DAE, SMOOTH_TRIANGLE, DAE_MESH_END),
    // Every second primitive has no normals.
    row(
        "collada",
        SMOOTH_DAE,
        "<triangles><input semantic='VERTEX' source='#v'/><input semantic='NORMAL' source='#n'/><p>0 0 0</p></triangles>\
         <triangles><input semantic='VERTEX' source='#v'/><p>0 1 2</p></triangles>",
        DAE_MESH_END,
    ),
    // Many primitives name many normals: good ones, and damaged ones.
    pair("collada", NORMALS_DAE, ["0 0 1 ", "</float_array></source>", SMOOTH_TRIANGLE], DAE_MESH_END),
    pair("collada", NORMALS_DAE, ["0 0 1 ", "damaged</float_array></source>", SMOOTH_TRIANGLE], DAE_MESH_END),
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
         <float_array>0 0 0 1 0 0 0 1 0</float_array></source><vertices id='v'><input semantic='POSITION' source='#s'/>",
        [
            "<input semantic='NORMAL' source='#s'/>",
            "</vertices>",
            "<triangles><input semantic='VERTEX' source='#v'/><p>0 1 2</p></triangles>",
        ],
        DAE_MESH_END,
    ),
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
         <float_array>0 0 0 1 0 0 0 1 0</float_array></source><vertices id='v'><input semantic='POSITION' source='#s'/>\
         </vertices><polylist><input semantic='VERTEX' source='#v'/><vcount>",
        ["0 ", "</vcount>", "<p/>"],
        "</polylist></mesh></geometry></library_geometries></COLLADA>",
    ),
    // Many instances bind the same material, whose effect is long: good, and damaged.
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_materials><material id='m'><instance_effect url='#e'/></material>\
         </library_materials><library_effects><effect id='e'><profile_COMMON>",
        ["<newparam/>", EFFECT_END, "<instance_material symbol='s' target='#m'/>"],
        BINDING_END,
    ),
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_materials><material id='m'><instance_effect url='#e'/></material>\
         </library_materials><library_effects><effect id='e'><profile_COMMON><technique><phong><diffuse><color>",
        ["1 ", DAMAGED_EFFECT_END, "<instance_material symbol='s' target='#m'/>"],
        BINDING_END,
    ),
    // Many primitives name the same damaged positions.
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh>\
         <vertices id='v'><input semantic='POSITION' source='#s'/></vertices><source id='s'><float_array>",
        [
            "0 0 1 ",
            "damaged</float_array></source>",
            "<triangles><input semantic='VERTEX' source='#v'/><p>0 1 2</p></triangles>",
        ],
        DAE_MESH_END,
    ),
    // Many instances of many primitives without triangles.
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
         <float_array>0 0 0</float_array></source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices>",
        [
            "<triangles><input semantic='VERTEX' source='#v'/></triangles>",
            INSTANCES,
            "<instance_geometry url='#g'/>",
        ],
        INSTANCES_END,
    ),
    // Many instances of a node with many transforms, and with many materials.
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_nodes><node id='n'><node/>",
        ["<translate>0 0 0</translate>", NODES, "<instance_node url='#n'/>"],
        INSTANCES_END,
    ),
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'/></library_geometries>\
         <library_materials><material id='m'/></library_materials><library_nodes><node id='n'><node/>\
         <instance_geometry url='#g'><bind_material><technique_common>",
        ["<instance_material symbol='s' target='#m'/>", BOUND_NODES, "<instance_node url='#n'/>"],
        INSTANCES_END,
    ),
    // Many instances of a node with much that is not read, of a skin, and of a geometry without primitives.
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_nodes><node id='n'><node/>",
        ["<extra/>", NODES, "<instance_node url='#n'/>"],
        INSTANCES_END,
    ),
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'/></library_geometries>\
         <library_controllers><controller id='c'>",
        [
            "<extra/>",
            "<skin source='#g'/></controller></library_controllers><library_visual_scenes><visual_scene id='z'><node>",
            "<instance_controller url='#c'/>",
        ],
        INSTANCES_END,
    ),
    // Many parts have the same long name.
    pair(
        "collada",
        "<COLLADA version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='s'>\
         <float_array>0 0 0</float_array></source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices>\
         <triangles><input semantic='VERTEX' source='#v'/></triangles></mesh></geometry></library_geometries>\
         <library_visual_scenes><visual_scene id='z'><node name='",
        ["name", "'>", "<instance_geometry url='#g'/>"],
        INSTANCES_END,
    ),
    row("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n", ""),
    row("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "o n#\nusemtl m#\nf 1 2 3\n", ""),
    // Many parts have the same long name.
    pair(
        "obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\no ",
        ["name", "\n", "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"],
        "",
    ),
    row("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n", "o n#\nf 1//1 2//1 3//1\n", ""),
    row("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n", "o n#\nf 1//1 2//1 3//1\no m#\nf 1 2 3\n", ""),
    row("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mtllib m.mtl\n", ""),
    row("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf", " 1 2 3", "\n"),
    row("obj", "v 0 0 0\n", "\\\n", "f 1 1 1\n"),
    row("obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3", "e", "\n"),
    row("mtl", "", "newmtl red\nKd 1 0 0\n", ""),
    row("mtl", "", "newmtl m#\nKd 1 0 0\nmap_Kd none#.png\n", ""),
    row(
        "stl",
        "solid a\n",
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 #\nendloop\nendfacet\n",
        "endsolid a\n",
    ),
    row("ply", "ply\nformat ascii 1.0\n", "comment c #\n", "end_header\n"),
    row("ply", "ply\nformat ascii 1.0\nelement vertex 1\n", "property float x#\n", "end_header\n"),
    row("ply", "ply\nformat ascii 1.0\n", "element e# 0\n", "end_header\n"),
    nest("ply", SMOOTH_PLY, ["0 1 # 0 0 1\n", "3 0 1 2\n"], ""),
    nest("ply", SMOOTH_PLY, ["0 1 # 0 0 0\n", "3 0 1 2\n"], ""),
    nest("ply", TEXTURED_PLY, ["0 1 # 0 0 1\n", "3 0 1 2 6 0 0 1 0 1 1\n"], ""),
    row("gltf", SMOOTH_GLTF, SMOOTH_PRIMITIVE, FLAT_PRIMITIVES_END),
    // Every second primitive has no normals.
    row(
        "gltf",
        SMOOTH_GLTF,
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}},{\"attributes\":{\"POSITION\":0}},",
        FLAT_PRIMITIVES_END,
    ),
    // Many primitives name many normals, which are not theirs.
    pair(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"buffers\":[{\"uri\":\"data:;base64,",
        [
            "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
            "\"}],\"bufferViews\":[{\"buffer\":0,\"byteStride\":10,\"byteLength\":{count}0}],\"accessors\":[\
             {\"componentType\":5126,\"type\":\"VEC3\",\"count\":3},\
             {\"bufferView\":0,\"componentType\":5120,\"type\":\"VEC3\",\"count\":{count}}],\
             \"meshes\":[{\"primitives\":[",
            SMOOTH_PRIMITIVE,
        ],
        FLAT_PRIMITIVES_END,
    ),
    // Many nodes have the same skin of many joints.
    pair(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"componentType\":5126,\"type\":\"VEC3\",\"count\":3},\
         {\"componentType\":5126,\"type\":\"VEC4\",\"count\":3}],\"meshes\":[{\"primitives\":[{\"attributes\":{\
         \"POSITION\":0,\"NORMAL\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":1}}]}],\"skins\":[{\"joints\":[0",
        [",0", "]}],\"nodes\":[{}", ",{\"mesh\":0,\"skin\":0}"],
        "]}",
    ),
    row("gltf", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}", ",{\"children\":[0]}", "]}"),
    row(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1",
        ",1",
        "]},{}]}",
    ),
    nest("gltf", "{\"asset\":", ["[", "]"], "}"),
    nest("gltf", "{\"asset\":", ["{\"a\":", "}"], "1}"),
    // Many primitives of few triangles share many positions.
    pair(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"buffers\":[{\"uri\":\"data:;base64,",
        [
            "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
            SHARED_POSITIONS,
            "{\"attributes\":{\"POSITION\":1,\"NORMAL\":1},\"indices\":0},",
        ],
        FLAT_PRIMITIVES_END,
    ),
    // Their positions are sparse.
    pair(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"buffers\":[{\"uri\":\"data:;base64,",
        [
            "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
            SPARSE_POSITIONS,
            "{\"attributes\":{\"POSITION\":1},\"indices\":0},",
        ],
        FLAT_PRIMITIVES_END,
    ),
    // Many nodes have a mesh of many primitives that have no triangles.
    pair(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{}",
        [",{\"mode\":0}", "]}],\"nodes\":[{}", ",{\"mesh\":0}"],
        "]}",
    ),
    // Many primitives have the same long name.
    pair(
        "gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"componentType\":5126,\"type\":\"VEC3\",\"count\":0}],\
         \"nodes\":[{\"mesh\":0}],\"meshes\":[{\"name\":\"",
        ["name", "\",\"primitives\":[", "{\"attributes\":{\"POSITION\":0}},"],
        FLAT_PRIMITIVES_END,
    ),
];
