"""Makes a package of messages and services for rclpy, with the generators of ROS 2 and a C++ compiler.

interfaces.py DEFINITIONS: DEFINITIONS is a file PACKAGE.txt with the definitions of a package that PyPI does not have, each
below its name, such as msg/Result, and separated by empty lines. The package is installed in the environment of this
Python, unless it is there already. All sources are compiled as a few large ones, and the only library has everything,
because each C++ file would otherwise read the same large headers.
"""

import hashlib
import json
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import numpy
from ament_index_python import get_package_share_directory
from rosidl_adapter import convert_to_idl
from rosidl_generator_c import generate_c
from rosidl_generator_py import generate_py
from rosidl_generator_type_description import generate_type_hash
from rosidl_typesupport_c import generate_c as generate_dispatch
from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
from rosidl_typesupport_introspection_c import generate_c as generate_introspection

DEFINITIONS = Path(sys.argv[1])
PACKAGE = DEFINITIONS.stem
PREFIX = Path(sys.prefix)
# How messages are encoded, and how their fields are found. Topics of rmw_fastrtps need both.
SUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]
# Packages whose messages may be used.
USED = ("builtin_interfaces", "geometry_msgs", "service_msgs", "std_msgs")


def write_definitions(folder):
    """Writes a file for each definition, and returns their names."""
    names = []
    for text in DEFINITIONS.read_text().strip().split("\n\n"):
        name, _, fields = text.partition("\n")
        file = Path(f"{name}.{name[:3]}")
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(fields + "\n")
        names.append(file)
    return names


def generate(folder):
    """Generates the sources in C and C++, and the package in Python."""
    idl = []
    for file in write_definitions(folder):
        convert_to_idl(folder, PACKAGE, file, folder)
        idl.append(file.with_suffix(".idl"))
    dependencies = [f"{package}:{file}" for package in USED for file in (PREFIX / "share" / package).glob("*/*.idl")]

    def arguments(generator, into, **more):
        into.mkdir(parents=True, exist_ok=True)
        file = folder / f"{generator}.json"
        common = {
            "package_name": PACKAGE,
            "output_dir": str(into),
            "template_dir": str(Path(get_package_share_directory(generator), "resource")),
            "idl_tuples": [f"{folder}:{name}" for name in idl],
            "ros_interface_dependencies": dependencies,
            "target_dependencies": [],
        }
        file.write_text(json.dumps({**common, **more}))
        return str(file)

    shares = [f"{package}:{PREFIX / 'share' / package}" for package in USED]
    generate_type_hash(arguments("rosidl_generator_type_description", folder, include_paths=shares))
    hashes = [f"{name}:{(folder / name).with_suffix('.json')}" for name in idl]
    sources = folder / "include" / PACKAGE
    generate_c(arguments("rosidl_generator_c", sources, type_description_tuples=hashes))
    generate_typesupport_fastrtps_c(arguments("rosidl_typesupport_fastrtps_c", sources))
    # Its files have the names of others.
    introspection = folder / "introspection" / PACKAGE
    generate_introspection(arguments("rosidl_typesupport_introspection_c", introspection))
    generate_dispatch(arguments("rosidl_typesupport_c", sources), SUPPORTS)
    generate_py(arguments("rosidl_generator_py", folder / "python" / PACKAGE), ["rosidl_typesupport_c"])
    # Their build writes these headers.
    for part in ("generator_c", "typesupport_fastrtps_c", "typesupport_introspection_c"):
        names = (f"#define ROSIDL_{part.upper()}_{what}_{PACKAGE}\n" for what in ("PUBLIC", "EXPORT", "IMPORT"))
        (sources / "msg" / f"rosidl_{part}__visibility_control.h").write_text("#pragma once\n" + "".join(names))


def compile_package(folder):
    """Compiles the sources into one library, which the package in Python loads."""
    include = [folder, folder / "include", folder / "include" / PACKAGE, folder / "introspection", PREFIX / "include"]
    include += [path for path in (PREFIX / "include").iterdir() if path.is_dir()]
    include += [sysconfig.get_path("include"), numpy.get_include()]
    objects = []

    def build(compiler, name, files):
        one = folder / name
        one.write_text("".join(f'#include "{file}"\n' for file in sorted(files)))
        objects.append(str(one) + ".o")
        words = [compiler, "-O0", "-w", "-fPIC", *(f"-I{path}" for path in include), "-c", str(one), "-o", objects[-1]]
        subprocess.run(words, check=True)

    sources = list((folder / "include").rglob("*.c"))
    # Descriptions have the same names in every file.
    descriptions = [file for file in sources if file.name.endswith("__description.c")]
    build("gcc", "sources.c", set(sources) - set(descriptions))
    build("gcc", "introspection.c", (folder / "introspection").rglob("*.c"))
    build("g++", "support.cpp", (folder / "include").rglob("*.cpp"))
    build("gcc", "python.c", (folder / "python").rglob("*.c"))
    for number, file in enumerate(descriptions):
        build("gcc", f"description{number}.c", [file])
    parts = ("rosidl_generator_c", "rosidl_generator_py", "rosidl_typesupport_c", *SUPPORTS)
    libraries = [f"{package}__{part}" for package in USED for part in parts]
    libraries += ["fastcdr", "rcutils", "rosidl_runtime_c", "rosidl_typesupport_c"]
    libraries += [*SUPPORTS, "rosidl_typesupport_fastrtps_cpp"]
    library = folder / "python" / PACKAGE / f"{PACKAGE}_s__rosidl_typesupport_c.so"
    words = ["g++", "-shared", "-o", str(library), *objects, f"-L{PREFIX}/lib", f"-Wl,-rpath,{PREFIX}/lib"]
    subprocess.run(words + [f"-l{name}" for name in libraries], check=True)


digest = hashlib.sha256(DEFINITIONS.read_bytes() + Path(__file__).read_bytes()).hexdigest()
installed = Path(sysconfig.get_path("purelib"), PACKAGE)
stamp = installed / "made_of"
if not stamp.is_file() or stamp.read_text() != digest:
    with tempfile.TemporaryDirectory() as made:
        generate(Path(made))
        compile_package(Path(made))
        package = Path(made, "python", PACKAGE)
        (package / "__init__.py").touch()
        described = (json.loads(file.read_text())["type_hashes"] for file in Path(made).glob("[ms]*/*.json"))
        hashes = {each["type_name"]: each["hash_string"] for of in described for each in of}
        (package / "hashes.json").write_text(json.dumps(hashes))
        (package / "made_of").write_text(digest)
        shutil.rmtree(installed, ignore_errors=True)
        shutil.copytree(package, installed)
        # The dispatcher looks for a library of each.
        for support in SUPPORTS:
            link = PREFIX / "lib" / f"lib{PACKAGE}__{support}.so"
            link.unlink(missing_ok=True)
            link.symlink_to(installed / f"{PACKAGE}_s__rosidl_typesupport_c.so")
