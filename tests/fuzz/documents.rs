//! Small files of the formats that are text, and the words of these formats.

use std::path::Path;

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/models/");

fn files(names: &[&str]) -> Vec<Vec<u8>> {
    names.iter().map(|name| std::fs::read(format!("{MODELS}{name}")).unwrap()).collect()
}

fn texts<const N: usize>(texts: [&str; N]) -> Vec<Vec<u8>> {
    texts.map(|text| text.as_bytes().to_vec()).to_vec()
}

pub(crate) const XACRO_WORDS: &[&str] = &[
    "${",
    "}",
    "$(find turtlebot_description)",
    "$(arg a)",
    "$(eval 1 + 1)",
    "$(env HOME)",
    "$$",
    "**",
    "//",
    "%",
    "<<",
    "range(9)",
    "[i for i in range(9)]",
    "lambda x: x",
    "'%09d' % 3",
    "'{:>9.3f}'.format(2)",
    "10**300",
    "2**64",
    "1e308 * 10",
    "-1",
    "sin(0)",
    "sqrt(-1)",
    "log(0)",
    "a[0]",
    "a[::-1]",
    "d['k']",
    "{}",
    "[]",
    "None",
    "True if a else b",
    "xacro.load_yaml('c.yaml')",
    "'a' * 9",
    "'a'.join(['b'])",
    "int('9')",
    "x and y",
    "not x",
    "max(1, 2)",
    "round(2.5)",
    "chr(65)",
    "<xacro:insert_block name='b'/>",
    "params='a:=^|2 *b **c'",
    "scope='parent'",
    "<xacro:include filename='part.xacro'/>",
    "default='1'",
    "remove_first='1'",
    "ns='n'",
    "/dev/zero",
    "\u{1F600}",
    "'a'.rjust(9)",
    "'a b'.split()",
    "0x1F",
    "1_000",
    "~1",
    "1 << 62",
    "a.b.c",
    "'a' in 'ab'",
    "sorted([2, 1])",
];

/// A file that uses what the expression language and the directives have.
const XACRO: &str = r#"<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
<xacro:arg name="a" default="2"/>
<xacro:property name="p" value="${[x.strip() for x in 'a : b'.split(':') if x]}"/>
<xacro:property name="n" value="${2 ** 3 + 7 // 2 - 7 % 3}"/>
<xacro:property name="d" value="${dict(k=1, j=[1, 2, 3])}"/>
<xacro:property name="y" value="${xacro.load_yaml('c.yaml')}"/>
<xacro:property name="blk"><origin xyz="0 0 ${n}"/></xacro:property>
<xacro:macro name="m" params="name x:=1 y:=^|2 *block **blocks">
<link name="${name}_${'%02d' % x}_${'{:.2f}'.format(y)}"><visual><xacro:insert_block name="block"/><geometry><sphere radius="${0.1 * x}"/></geometry></visual></link>
<joint name="j_${name}" type="fixed"><parent link="base"/><child link="${name}_${'%02d' % x}_${'{:.2f}'.format(y)}"/><xacro:insert_block name="blk"/></joint>
<xacro:if value="${x > 1 and not (y == 3) or x in [4, 5]}"><xacro:m name="${name}n" x="${x - 1}"><xacro:insert_block name="block"/><b/></xacro:m></xacro:if>
<xacro:unless value="$(arg a)"><link name="none"/></xacro:unless>
</xacro:macro>
<xacro:include filename="part.xacro" ns="q"/>
<link name="base"/>
<xacro:m name="one" x="3"><origin xyz="1 2 ${sin(pi / 6) + max(1, 2) + d['j'][-1]}" rpy="0 0 ${radians(90)}"/><b/></xacro:m>
<link name="l_${p[1]}_${p[0].upper().replace('A', 'z')}_${len(p) if p else 0}_$(eval 1 + arg('a'))_${q.part}_${y.b}"/>
<xacro:element xacro:name="gazebo" reference="base"><material>Gazebo/Red</material></xacro:element>
</robot>
"#;

pub(crate) fn xacro() -> Vec<Vec<u8>> {
    let mut seeds = texts([XACRO]);
    seeds.extend(files(&[
        "turtlebot_description/urdf/turtlebot_library.urdf.xacro",
        "turtlebot_description/urdf/stacks/circles.urdf.xacro",
        "kobuki_description/urdf/kobuki.urdf.xacro",
        "turtlebot_description/urdf/sensors/d435.urdf.xacro",
    ]));
    // Each expression of the words in a file of its own.
    seeds.extend(XACRO_WORDS.iter().map(|word| {
        format!("<robot name='r' xmlns:xacro='http://x'><link name=\"l${{{word}}}\"/></robot>").into_bytes()
    }));
    seeds
}

pub(crate) fn beside_xacro(folder: &Path) {
    std::fs::write(folder.join("c.yaml"), &yaml()[0]).unwrap();
    let part = "<robot xmlns:xacro='http://x'><xacro:property name='part' value='4'/></robot>";
    std::fs::write(folder.join("part.xacro"), part).unwrap();
}

pub(crate) const YAML_WORDS: &[&str] = &[
    "&a ",
    "*a",
    "<<: *a",
    "!degrees ",
    "!millimeters ",
    "!!float ",
    "!!binary ",
    "!!set",
    "!!omap",
    "!!str ",
    "!<tag:yaml.org,2002:int> ",
    "- ",
    "? ",
    ": ",
    "|\n",
    ">-\n",
    "---\n",
    "...\n",
    "%YAML 1.1\n",
    "{",
    "}",
    "[",
    "]",
    "0x1F",
    "0b11",
    "1:30:00",
    "2001-12-14",
    ".inf",
    ".nan",
    "~",
    "null",
    "yes",
    "\"\\x41\\u263A\\N\"",
    "# c",
];

pub(crate) fn yaml() -> Vec<Vec<u8>> {
    texts([
        "a: 1\nb: !millimeters 2\nc: [1, 2.5, .inf, yes, ~]\nd:\n  e: &x {k: v, 'q r': \"s\\n\\u263a\"}\n  f: *x\n  g:\n\
         \x20   <<: *x\n    h: !degrees 90\n",
        "- - 1\n  - 0x1F\n- |\n  text\n  more\n- >-\n  folded\n  text\n- 1:30:00\n- 2001-12-14\n- !!str 5\n- !!float 5\n",
        "base: &base {a: 1}\nmore: &more {b: 2}\nboth: {<<: [*base, *more], c: 3}\n? [1, 2]\n: x\n? 5\n: 0b11\n# end\n",
    ])
}

pub(crate) fn beside_yaml(folder: &Path) {
    let robot = "<robot name='r' xmlns:xacro='http://x'><xacro:property name='y' value=\"${xacro.load_yaml('c.yaml')}\"/>\
                 <link name='${y}'/></robot>";
    std::fs::write(folder.join("r.urdf.xacro"), robot).unwrap();
}

pub(crate) const URDF_WORDS: &[&str] = &[
    "fixed",
    "revolute",
    "continuous",
    "prismatic",
    "planar",
    "floating",
    "<mimic joint='a'/>",
    "<box size='1 1 1'/>",
    "<mesh filename='m.stl' scale='1 1 1'/>",
    "<cylinder radius='1' length='1'/>",
    "<capsule radius='1' length='1'/>",
    "<limit lower='-1' upper='1' effort='1' velocity='1'/>",
    "<dynamics damping='1' friction='1'/>",
    "world",
    "base",
    "<gazebo reference='base'>",
    "<selfCollide>1</selfCollide>",
    "<texture filename='p.png'/>",
    "rgba='1 0 0 1'",
    "<sensor name='s' type='camera'>",
    "<plugin name='p' filename='libgazebo_ros_diff_drive.so'>",
    "xyz='0 0 1'",
];

const URDF: &str = r#"<robot name="r">
<material name="blue"><color rgba="0 0 1 1"/><texture filename="p.png"/></material>
<link name="base"><inertial><origin xyz="0 0 0.1"/><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual name="v"><origin xyz="1 0 0" rpy="0 1 0"/><geometry><mesh filename="m.stl" scale="1 1 2"/></geometry><material name="blue"/></visual>
<collision><geometry><cylinder radius="0.1" length="0.3"/></geometry></collision></link>
<link name="a"><visual><geometry><capsule radius="0.1" length="0.3"/></geometry></visual></link>
<link name="b"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 1" rpy="0 0 1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5" velocity="2"/><dynamics damping="0.1" friction="0.1"/></joint>
<joint name="k" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/><limit lower="0" upper="1" effort="5" velocity="2"/><mimic joint="j" multiplier="2" offset="0.1"/></joint>
<transmission name="t"><joint name="j"/></transmission>
<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so"><leftJoint>j</leftJoint><rightJoint>k</rightJoint><wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.1</wheelDiameter></plugin></gazebo>
<gazebo reference="a"><mu1>0.5</mu1><material>Gazebo/Red</material><sensor name="c" type="camera"><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>4</width><height>4</height><format>R8G8B8</format></image><clip><near>0.1</near><far>10</far></clip></camera></sensor></gazebo>
<gazebo reference="b"><sensor name="l" type="ray"><ray><scan><horizontal><samples>9</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan><range><min>0.1</min><max>9</max></range></ray></sensor></gazebo>
<gazebo reference="j"><implicitSpringDamper>1</implicitSpringDamper><springStiffness>9</springStiffness></gazebo>
</robot>
"#;

pub(crate) fn urdf() -> Vec<Vec<u8>> {
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/");
    let mut seeds = texts([URDF]);
    seeds.extend(
        ["instruments.urdf", "lenses.urdf", "rangefinders.urdf", "lidars/lidar.urdf"]
            .map(|name| std::fs::read(format!("{tests}{name}")).unwrap()),
    );
    seeds
}

pub(crate) const SDF_WORDS: &[&str] = &[
    "world",
    "__model__",
    "a::b",
    "m::l",
    "relative_to='f'",
    "attached_to='f'",
    "placement_frame='f'",
    "merge='1'",
    "<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 1</pose>",
    "degrees='true'",
    "<static>1</static>",
    "1.4",
    "1.12",
    "<include><uri>model://sun</uri></include>",
    "<include><uri>model://m</uri><name>n</name></include>",
    "<mesh><uri>m.stl</uri></mesh>",
    "<heightmap><uri>p.png</uri><size>9 9 1</size></heightmap>",
    "revolute2",
    "<polyline><point>0 0</point><point>1 0</point><point>0 1</point><height>1</height></polyline>",
    "universal",
    "<plane><normal>0 0 1</normal></plane>",
    "<ellipsoid><radii>1 1 1</radii></ellipsoid>",
    "screw",
    "gearbox",
    "ball",
    "<experimental:params>",
    "<mimic joint='j'><multiplier>1</multiplier></mimic>",
    "<inertial auto='true'/>",
    "<joint name='j2' type='revolute'><parent>l</parent><child>k</child><axis><xyz>0 0 1</xyz></axis></joint>",
];

const SDF: &str = r#"<sdf version="1.9"><world name="w">
<physics type="ode"><max_step_size>0.002</max_step_size></physics><gravity>0 0 -9.8</gravity>
<include><uri>model://ground_plane</uri></include><include><uri>model://m</uri><name>n</name><pose relative_to="f">1 0 0 0 0 0</pose><placement_frame>l</placement_frame></include>
<frame name="f" attached_to="a"><pose>0 0 1 0 0 1</pose></frame>
<light name="s" type="spot"><pose>0 0 5 0 0 0</pose><diffuse>1 1 1 1</diffuse><attenuation><range>9</range><linear>0.1</linear></attenuation><direction>0 0 -1</direction><spot><inner_angle>0.1</inner_angle><outer_angle>0.5</outer_angle><falloff>1</falloff></spot></light>
<model name="a" placement_frame="l"><pose degrees="true">0 0 0 0 0 90</pose>
<link name="l"><inertial auto="true"><density>100</density></inertial><visual name="v"><geometry><mesh><uri>m.stl</uri><scale>1 1 2</scale></mesh></geometry><material><ambient>1 0 0 1</ambient><diffuse>1 0 0 1</diffuse><pbr><metal><albedo_map>p.png</albedo_map></metal></pbr></material></visual>
<collision name="c"><geometry><box><size>1 2 3</size></box></geometry><surface><friction><ode><mu>0.5</mu></ode></friction></surface></collision></link>
<link name="k"><pose relative_to="j">0 0 1 0 0 0</pose><collision name="c"><geometry><polyline><point>0 0</point><point>1 0</point><point>1 1</point><point>0.5 0.2</point><point>0 1</point><height>1</height></polyline></geometry></collision></link>
<joint name="j" type="revolute"><parent>l</parent><child>k</child><pose relative_to="l">0 0 1 0 0 0</pose><axis><xyz expressed_in="__model__">0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit><dynamics><damping>0.1</damping><spring_stiffness>3</spring_stiffness></dynamics></axis></joint>
<model name="b"><link name="m"><sensor name="cam" type="depth_camera"><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>4</width><height>4</height></image><clip><near>0.1</near><far>10</far></clip><noise><type>gaussian</type><stddev>0.1</stddev></noise><distortion><k1>0.1</k1></distortion></camera></sensor></link></model>
<plugin name="p" filename="libgazebo_ros_planar_move.so"><commandTopic>cmd_vel</commandTopic></plugin>
</model>
<model name="h"><static>true</static><link name="l"><collision name="c"><geometry><heightmap><uri>p.png</uri><size>9 9 1</size></heightmap></geometry></collision><sensor name="imu" type="imu"><imu><angular_velocity><x><noise type="gaussian"><stddev>0.1</stddev></noise></x></angular_velocity></imu></sensor></link></model>
<actor name="q"><pose>0 0 1 0 0 0</pose><link name="l"><visual name="v"><geometry><sphere><radius>1</radius></sphere></geometry></visual></link><script><trajectory id="0" type="s"><waypoint><time>0</time><pose>0 0 0 0 0 0</pose></waypoint><waypoint><time>2</time><pose>1 0 0 0 0 1</pose></waypoint></trajectory></script></actor>
<spherical_coordinates><latitude_deg>47</latitude_deg><longitude_deg>8</longitude_deg><elevation>400</elevation></spherical_coordinates>
</world></sdf>
"#;

pub(crate) fn sdf() -> Vec<Vec<u8>> {
    let mut seeds = texts([SDF]);
    seeds.extend(files(&["worlds/playground.world", "worlds/corridor.world", "tag_room/model.sdf"]));
    seeds
}

pub(crate) const COLLADA_WORDS: &[&str] = &[
    "<triangles count='1'>",
    "<polylist count='1'>",
    "<polygons count='1'>",
    "<tristrips count='1'>",
    "<trifans count='1'>",
    "<lines count='1'>",
    "<ph><p>0 1 2</p><h>0 1 2</h></ph>",
    "<vcount>3</vcount>",
    "VERTEX",
    "NORMAL",
    "TEXCOORD",
    "POSITION",
    "#g",
    "#v",
    "#s",
    "#n",
    "<instance_node url='#n'/>",
    "<instance_geometry url='#g'/>",
    "offset='0'",
    "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>",
    "<rotate>0 0 1 90</rotate>",
    "stride='0'",
    "set='0'",
    "<instance_controller url='#c'/>",
    "<up_axis>Y_UP</up_axis>",
    "<unit meter='0.01'/>",
    "count='999999999'",
];

const COLLADA: &str = r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_images><image id="i"><init_from>p.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><newparam sid="f"><surface type="2D"><init_from>i</init_from></surface></newparam><newparam sid="p"><sampler2D><source>f</source></sampler2D></newparam><technique sid="t"><phong><diffuse><texture texture="p" texcoord="U"/></diffuse><specular><color>1 1 1 1</color></specular><shininess><float>9</float></shininess></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="18">2 1 1 1 1 1 1 2 1 0 2 1 0 0 1 2 0 1</float_array><technique_common><accessor source="#a" count="6" stride="3"/></technique_common></source>
<source id="u"><float_array id="b" count="12">0 0 1 0 1 1 0 1 0 0 1 0</float_array><technique_common><accessor source="#b" count="6" stride="2"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<polylist count="2" material="x"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="TEXCOORD" source="#u" offset="1" set="0"/><vcount>3 4</vcount><p>0 0 1 1 2 2 0 0 2 2 3 3 4 4</p></polylist>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
<tristrips count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3 4</p></tristrips>
<polygons count="1"><input semantic="VERTEX" source="#v" offset="0"/><ph><p>0 1 2 3 4 5</p><h>1 2 3</h></ph></polygons>
</mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix></skin></controller></library_controllers>
<library_nodes><node id="n"><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="z"><node name="o"><translate>1 0 0</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="x" target="#m"/></technique_common></bind_material></instance_geometry>
<node><instance_node url="#n"/><instance_controller url="#c"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#z"/></scene></COLLADA>
"##;

pub(crate) fn collada() -> Vec<Vec<u8>> {
    texts([COLLADA])
}

pub(crate) fn obj() -> Vec<Vec<u8>> {
    texts([
        "mtllib m.mtl\no one\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
         f 1/1/1 2/2/1 3/3/1\nf -4//1 -2//1 -1//1\ng two\nusemtl blue\nv 0.5 0.2 0\nf 1 2 5 3 4\ns off\nl 1 2\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3\n# end\n",
    ])
}

pub(crate) fn mtl() -> Vec<Vec<u8>> {
    texts([
        "newmtl red\nKa 1 0 0\nKd 1 0 0\nKs 1 1 1\nNs 10\nd 0.5\nillum 2\nmap_Kd -s 2 2 1 -o 0 0 0 p.png\nnewmtl blue\n\
         Kd 0 0 1\nTr 0.2\nKe 1 1 1\nmap_d p.png\n",
    ])
}

pub(crate) const PLY_WORDS: &[&str] = &[
    "ply\n",
    "format ascii 1.0\n",
    "format binary_little_endian 1.0\n",
    "format binary_big_endian 1.0\n",
    "element vertex 4\n",
    "element face 4000000000\n",
    "property float x\n",
    "property double y\n",
    "property list uchar int vertex_indices\n",
    "property list double double vertex_index\n",
    "property list char uint64 q\n",
    "property uchar red\n",
    "end_header\n",
    "comment TextureFile p.png\n",
    "obj_info a\n",
];

pub(crate) const GLTF_WORDS: &[&str] = &[
    "\"byteOffset\":4",
    "\"byteStride\":255",
    "\"count\":4000000000",
    "\"componentType\":5121",
    "\"type\":\"MAT4\"",
    "\"mode\":5",
    "\"mode\":6",
    "\"children\":[0]",
    "\"mesh\":0",
    "\"skin\":0",
    "\"normalized\":true",
    "\"matrix\":[0]",
    "\"sparse\":{\"count\":1}",
    "\"uri\":\"data:application/octet-stream;base64,AAAA\"",
    "\"uri\":\"/dev/zero\"",
    "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
    "null",
    "[[[[",
    "{\"a\":",
    "1e999",
    "-1",
    "0.5",
];

pub(crate) const MATERIAL_WORDS: &[&str] = &[
    "material ",
    "technique",
    "pass",
    "texture_unit",
    "{",
    "}",
    "texture p.png",
    "scale 0 0",
    "ambient vertexcolour",
    "scene_blend alpha_blend",
    "alpha_rejection greater 128",
    "import * from \"a\"",
    "abstract ",
    ": ",
    "*",
    "//",
    "/*",
    "set_texture_alias a b",
    "set $a 1",
    "$a",
    "fragment_program f glsl",
    "specular 1 1 1 1 5",
    "\"",
];

pub(crate) fn material() -> Vec<Vec<u8>> {
    texts([
        "material A\n{\n  technique\n  {\n    pass\n    {\n      ambient 1 0 0\n      diffuse 1 0 0 0.5\n      specular 1 1 1 1 9\n\
         \x20     emissive 0 0 0\n      scene_blend alpha_blend\n      alpha_rejection greater 128\n      texture_unit\n      {\n\
         \x20       texture p.png\n        scale 0.5 0.25\n      }\n    }\n  }\n}\n// next\nmaterial B : A { technique { pass { ambient \
         0 1 0 } } }\nvertex_program v glsl\n{\n  source v.glsl /* c */\n}\n",
    ])
}

pub(crate) const PLAN_WORDS: &[&str] = &[
    "[[sensors]]\n",
    "[poses]\n",
    "[poses.random]\n",
    "[poses.path]\n",
    "[randomize]\n",
    "[randomize.lamps]\n",
    "[randomize.looks]\n",
    "count = 100000000",
    "seeds = [1, 2]",
    "clearance_m = 0.1",
    "min = [0, 0, 0]",
    "true",
    "labels = true",
    "truth = [\"depth\"]",
    "samples_per_shard = 1",
    "topic = \"rgb\"",
    "[classes]\n1 = \"a\"\n",
    "[[",
    "]]",
];

pub(crate) fn plan() -> Vec<Vec<u8>> {
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/");
    let text = std::fs::read_to_string(format!("{tests}dataset/plan.toml")).unwrap();
    // A small world is loaded for each input.
    vec![text.replace("\"playground\", \"tag_ceiling\"", "\"w.sdf\"").into_bytes()]
}

pub(crate) fn beside_plan(folder: &Path) {
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/");
    std::fs::copy(format!("{tests}dataset/eyes.sdf"), folder.join("eyes.sdf")).unwrap();
    let world = "<sdf version='1.9'><world name='w'><model name='m'><static>1</static><link name='l'><visual name='v'>\
                 <geometry><box><size>1 1 1</size></box></geometry></visual></link></model></world></sdf>";
    std::fs::write(folder.join("w.sdf"), world).unwrap();
}
