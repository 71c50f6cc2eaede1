"""Writes files that have every element and attribute of a version of SDF, with its default value. `belvedere check`
must know all of them.

    python3 tests/sdformat/schema.py /usr/share/sdformat12 OUT

OUT/VERSION.sdf is written for each version from 1.4."""

import pathlib
import sys
import xml.etree.ElementTree as xml

folder, out = map(pathlib.Path, sys.argv[1:])
# Deeper than a model in a model, everything repeats.
DEPTH = 2


def load(version, name):
    path = folder / version / name
    # 1.7 names a file navsat.sdf that it does not have.
    return xml.parse(path).getroot() if path.exists() else None


def write(spec, version, inside, indent):
    """The text of an element: its attributes, and all elements inside it."""
    if spec is not None and spec.get("ref"):
        spec = load(version, spec.get("ref") + ".sdf")
    if spec is None or inside.count(spec.get("name")) >= DEPTH:
        return ""
    name = spec.get("name")
    attributes = "".join(
        f' {attribute.get("name")}="{attribute.get("default") or ""}"' for attribute in spec.findall("attribute")
    )
    content = ""
    for child in spec:
        if child.tag == "include":
            content += write(load(version, child.get("filename")), version, [*inside, name], indent + " ")
        elif child.tag == "element" and child.get("name"):
            content += write(child, version, [*inside, name], indent + " ")
    default = (spec.get("default") or "").replace("__default__", "x").replace("&", "&amp;").replace("<", "&lt;")
    return f"{indent}<{name}{attributes}>{default}\n{content}{indent}</{name}>\n"


out.mkdir(parents=True, exist_ok=True)
for path in sorted(folder.iterdir()):
    if path.is_dir() and tuple(map(int, path.name.split("."))) >= (1, 4):
        text = write(load(path.name, "root.sdf"), path.name, [], "")
        (out / f"{path.name}.sdf").write_text(text)
        print(f"{path.name}: {text.count('</')} elements")
