"""Writes meshes in all formats that Belvedere reads, in the ways that exporters write them.

Each function of CASES returns the content of a file and its name's ending, and the triangles that the file has, as an
array of corners, or None if trimesh is to say it."""

import base64
import io
import json
import struct

import numpy as np
import trimesh


def stone(random, subdivisions=2, centre=(0, 0, 0)):
    """A bumpy, closed solid that is not convex, with coordinates that are exact in f32."""
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions)
    vertices = mesh.vertices * random.uniform(0.4, 1.6, (len(mesh.vertices), 1)) * random.uniform(0.5, 2, 3)
    return (vertices + centre).astype(np.float32), np.asarray(mesh.faces, dtype=np.uint32)


def numbers(values):
    return " ".join(repr(float(value)) for value in np.ravel(values))


def exported(random, kind, **options):
    vertices, faces = stone(random)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    return mesh.export(file_type=kind, **options), kind.replace("_ascii", ""), vertices[faces]


def stl_with_solid(random):
    """A binary file whose header begins as an ASCII one does."""
    vertices, faces = stone(random)
    body = b"".join(struct.pack("<12fH", *[0] * 3, *vertices[face].ravel(), 0) for face in faces)
    return b"solid but binary".ljust(80) + struct.pack("<I", len(faces)) + body, "stl", vertices[faces]


def star(random, points, z):
    """The corners of a concave polygon, counter-clockwise."""
    angle = np.linspace(0, 2 * np.pi, 2 * points, endpoint=False)
    radius = np.where(np.arange(2 * points) % 2, 0.4, 1.0) * random.uniform(0.8, 1.2, 2 * points)
    flat = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(2 * points, z)], axis=1)
    return flat.astype(np.float32)


def obj_prism(random):
    """Two concave faces and a ring of quads, in groups, with negative indices, with texture and normal indices, and
    with lines that continue on the next one."""
    bottom = star(random, 5, 0)
    top = bottom + np.array([0, 0, 1.5], dtype=np.float32)
    count = len(top)
    lines = ["# a prism", "o prism", "mtllib nothing.mtl"]
    lines += [f"v {numbers(corner)}" for corner in bottom]
    lines += ["vt 0 0", "vn 0 0 1", "g lid bottom", "s off", "usemtl x"]
    lines.append("f " + " ".join(f"{-index}/1/1" for index in range(1, count + 1)))
    lines += ["g side"] + [f"v {numbers(corner)} 1.0" for corner in top]
    lines.append("f \\\n " + " \\\n ".join(f"{index}//1" for index in range(count + 1, 2 * count + 1)))
    for index in range(count):
        after = (index + 1) % count
        lines.append(f"f {index + 1}/1 {after + 1}/1 {count + after + 1}/1 {index - count}/1")
    triangles = []
    for index in range(count):
        after = (index + 1) % count
        quad = [bottom[index], bottom[after], top[after], top[index]]
        triangles += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    polygon = trimesh.creation.Polygon(top[:, :2])
    flat, faces = trimesh.creation.triangulate_polygon(polygon, engine="earcut")
    for z in (0, 1.5):
        triangles += [[[*flat[corner], z] for corner in face] for face in faces]
    return "\n".join(lines) + "\n", "obj", np.array(triangles, dtype=np.float32)


def ply(random, kind):
    """With properties before and after the position, double coordinates, quads, and an element that is not known."""
    vertices, faces = stone(random, 1)
    mark = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[kind]
    corner = np.array([[0, 0, 3], [1, 0, 3], [1, 1, 3], [0, 1, 3]], dtype=np.float32)
    vertices = np.concatenate([vertices, corner])
    quad = np.arange(len(vertices) - 4, len(vertices))
    header = f"""ply
format {kind} 1.0
comment made by a test
element vertex {len(vertices)}
property uchar quality
property double x
property double y
property double z
property short other
element face {len(faces) + 1}
property uchar flags
property list uchar int vertex_indices
element edge 1
property int vertex1
property int vertex2
end_header
"""
    rows = [("BdddH", (7, *corner, 9)) for corner in vertices]
    rows += [(f"BB{len(face)}i", (1, len(face), *face)) for face in [*faces, quad]]
    rows.append(("ii", (0, 1)))
    if kind == "ascii":
        body = "".join(" ".join(repr(float(v) if "d" in form else int(v)) for v in row) + "\n" for form, row in rows)
        content = (header + body.replace(".0 ", " ")).encode()
    else:
        content = header.encode() + b"".join(struct.pack(mark + form, *row) for form, row in rows)
    triangles = np.concatenate([vertices[faces], vertices[quad[[0, 1, 2]]][None], vertices[quad[[0, 2, 3]]][None]])
    return content, "ply", triangles


def turned(axis, degrees):
    return trimesh.transformations.rotation_matrix(np.radians(degrees), axis)


def placed(triangles, matrix):
    return trimesh.transform_points(triangles.reshape(-1, 3), matrix).reshape(-1, 3, 3)


def collada(random, unit, up):
    """Nodes with all kinds of transforms, one of them used twice, with polygons and triangles."""
    vertices, faces = stone(random, 1)
    square = np.array([[0, 0, 2], [1, 0, 2], [1, 1, 2], [0, 1, 2]], dtype=np.float32)
    matrix = turned([1, 2, 3], 40) @ np.diag([1.5, 0.5, 1, 1])
    matrix[:3, 3] = [3, -1, 0.5]

    def geometry(name, points, primitive):
        return f"""<geometry id="{name}"><mesh><source id="{name}-p"><float_array id="{name}-a" count="{points.size}">
{numbers(points)}</float_array><technique_common><accessor source="#{name}-a" count="{len(points)}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
</source><vertices id="{name}-v"><input semantic="POSITION" source="#{name}-p"/></vertices>{primitive}</mesh></geometry>"""

    entry = '<input semantic="VERTEX" source="#{0}-v" offset="{1}"/>'
    of_stone = f"""<triangles count="{len(faces)}">{entry.format("stone", 0)}<p>{" ".join(map(str, faces.ravel()))}</p>
</triangles>"""
    of_square = f"""<polylist count="1">{entry.format("square", 0)}<vcount>4</vcount><p>0 1 2 3</p></polylist>"""
    text = f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified><unit name="u" meter="{unit}"/>
<up_axis>{up}</up_axis></asset>
<library_geometries>{geometry("stone", vertices, of_stone)}{geometry("square", square, of_square)}</library_geometries>
<library_nodes><node id="kept"><translate>0 0 1</translate><instance_geometry url="#square"/></node></library_nodes>
<library_visual_scenes><visual_scene id="scene">
<node id="first"><translate>1 2 3</translate><rotate>0 0 1 30</rotate><rotate>1 0 0 -50</rotate><scale>1 2 0.5</scale>
<instance_geometry url="#stone"/>
<node id="inner"><matrix>{numbers(matrix)}</matrix><instance_geometry url="#square"/></node></node>
<node id="second"><matrix>{numbers(matrix)}</matrix><instance_node url="#kept"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>"""
    outer = np.eye(4)
    outer[:3, 3] = [1, 2, 3]
    outer = outer @ turned([0, 0, 1], 30) @ turned([1, 0, 0], -50) @ np.diag([1, 2, 0.5, 1])
    lift = np.eye(4)
    lift[2, 3] = 1
    quad = np.stack([square[[0, 1, 2]], square[[0, 2, 3]]])
    triangles = [placed(vertices[faces], outer), placed(quad, outer @ matrix), placed(quad, matrix @ lift)]
    return text, "dae", np.concatenate(triangles) * unit


def gltf(random, is_binary):
    """Instances in a tree of nodes, strips, fans, sparse and quantized accessors."""
    vertices, faces = stone(random, 1)
    buffer, views, accessors = io.BytesIO(), [], []

    def view(content, **more):
        buffer.write(b"\0" * (-buffer.tell() % 4))
        views.append({"buffer": 0, "byteOffset": buffer.tell(), "byteLength": len(content), **more})
        buffer.write(content)
        return len(views) - 1

    def accessor(values, kind, component, stride=0, **more):
        content = values.tobytes()
        if stride:
            content = b"".join(row.tobytes().ljust(stride, b"\xff") for row in values)
            more_of_view = {"byteStride": stride}
        else:
            more_of_view = {}
        bounds = {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()} if kind == "VEC3" else {}
        accessors.append(
            {
                "bufferView": view(content, **more_of_view),
                "componentType": component,
                "type": kind,
                "count": len(values),
                **bounds,
                **more,
            }
        )
        return len(accessors) - 1

    def primitive(positions, indices=None, **more):
        found = {"attributes": {"POSITION": positions}, **more}
        if indices is not None:
            found["indices"] = indices
        return {"primitives": [found]}

    plain = primitive(
        accessor(vertices, "VEC3", 5126, stride=20), accessor(faces.astype(np.uint16).ravel(), "SCALAR", 5123)
    )
    # A ribbon: each corner makes a triangle with the two before it.
    ribbon = np.array([[i // 2, i % 2, 0.1 * i * i] for i in range(8)], dtype=np.float32)
    strip = primitive(accessor(ribbon, "VEC3", 5126), mode=5)
    disc = np.array([[0, 0, 0.3]] + [[np.cos(a), np.sin(a), 0] for a in np.arange(7)], dtype=np.float32)
    fan = primitive(accessor(disc, "VEC3", 5126), accessor(np.arange(8, dtype=np.uint8), "SCALAR", 5121), mode=6)
    sparse_at = accessor(vertices, "VEC3", 5126)
    moved = vertices.copy()
    moved[[2, 5]] = [[3, 0, 0], [0, 3, 1]]
    accessors[sparse_at]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": view(np.array([2, 5], dtype=np.uint16).tobytes()), "componentType": 5123},
        "values": {"bufferView": view(moved[[2, 5]].tobytes())},
    }
    sparse = primitive(sparse_at, accessor(faces.ravel(), "SCALAR", 5125))
    quanta = np.round(vertices / np.abs(vertices).max() * 32767).astype(np.int16)
    quantized = primitive(
        accessor(quanta, "VEC3", 5122, stride=8, normalized=True), accessor(faces.ravel(), "SCALAR", 5125)
    )
    half = np.sqrt(0.5)
    nodes = [
        {"children": [1, 2], "translation": [1, 0, 0], "rotation": [0, 0, half, half]},
        {"mesh": 0, "scale": [1, 2, 0.5]},
        {"mesh": 0, "matrix": (turned([0, 1, 1], 70) + np.diag([0, 0, 0, 0])).T.ravel().tolist()},
        {"mesh": 1, "translation": [0, 4, 0]},
        {"mesh": 2, "translation": [0, -4, 0]},
        {"mesh": 3, "translation": [6, 0, 0]},
        {"mesh": 4, "translation": [-6, 0, 0]},
        {"mesh": 0, "translation": [99, 0, 0]},
    ]
    content = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 3, 4, 5, 6]}], "nodes": nodes,
        "meshes": [plain, strip, fan, sparse, quantized], "accessors": accessors, "bufferViews": views,
        "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
    }  # fmt: skip

    def moved_by(offset):
        matrix = np.eye(4)
        matrix[:3, 3] = offset
        return matrix

    outer = moved_by([1, 0, 0]) @ turned([0, 0, 1], 90)
    triangles = [
        placed(vertices[faces], outer @ np.diag([1, 2, 0.5, 1])),
        placed(vertices[faces], outer @ turned([0, 1, 1], 70)),
        placed(np.stack([ribbon[i : i + 3] for i in range(6)]), moved_by([0, 4, 0])),
        placed(np.stack([disc[[0, i, i + 1]] for i in range(1, 7)]), moved_by([0, -4, 0])),
        placed(moved[faces], moved_by([6, 0, 0])),
        placed((quanta / 32767)[faces], moved_by([-6, 0, 0])),
    ]
    data = buffer.getvalue()
    data += b"\0" * (-len(data) % 4)
    if not is_binary:
        uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        content["buffers"] = [{"byteLength": len(data), "uri": uri}]
        return json.dumps(content), "gltf", np.concatenate(triangles)
    content["buffers"] = [{"byteLength": len(data)}]
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks, "glb", np.concatenate(triangles)


CASES = {
    "stl": lambda random: exported(random, "stl"),
    "stl_ascii": lambda random: exported(random, "stl_ascii"),
    "stl_solid": stl_with_solid,
    "obj": lambda random: exported(random, "obj"),
    "obj_prism": obj_prism,
    "ply": lambda random: exported(random, "ply"),
    "ply_ascii": lambda random: ply(random, "ascii"),
    "ply_little": lambda random: ply(random, "binary_little_endian"),
    "ply_big": lambda random: ply(random, "binary_big_endian"),
    "dae": lambda random: exported(random, "dae"),
    "dae_metres": lambda random: collada(random, 1, "Z_UP"),
    "dae_inches": lambda random: collada(random, 0.0254, "Y_UP"),
    "glb": lambda random: exported(random, "glb"),
    "gltf_all": lambda random: gltf(random, False),
    "glb_all": lambda random: gltf(random, True),
}
