"""The layout against WIRE.md, and invalid headers."""

from __future__ import annotations

import random
import re
import struct
from pathlib import Path

import numpy as np
import pytest

from belvedere import BadFrameError, DistortionModel, Encoding, Kind, wire
from belvedere._layout import ELEMENTS

WIRE_MD = Path(__file__).parents[2] / "bridge" / "WIRE.md"


def test_every_encoding_is_that_of_wire_md() -> None:
    text = WIRE_MD.read_text()
    table = text[text.index("## Encodings") : text.index("## Structs")]
    rows = re.findall(r"^\| (\d+) \| (\w+) \| (.*) \|$", table, re.MULTILINE)
    assert len(rows) == len(Encoding)
    for number, name, element in rows:
        encoding = Encoding(int(number))
        # 32fc2 is F32C2, since Python's names begin with a letter.
        assert encoding.name.lower() == re.sub(
            r"^(\d+)([fsu])c", lambda m: f"{m[2].replace('s', 'i')}{m[1]}c", name
        )
        size = re.match(r"(\d+) bytes?|(?:(\d+) )?[ufi](\d+)", element)
        if size is not None and encoding is not Encoding.STRUCT:
            assert ELEMENTS[encoding].itemsize == int(size[1] or int(size[2] or 1) * int(size[3]) // 8)


def good_header() -> np.ndarray:
    header = np.zeros((), wire.HEADER)
    header["magic"], header["header_len"], header["schema"] = wire.MAGIC, wire.HEADER_LEN, wire.SCHEMA
    header["kind"], header["encoding"] = Kind.IMAGE, Encoding.RGB8
    header["width"], header["height"], header["row_stride"], header["elem_stride"] = 4, 3, 12, 3
    header["payload_len"] = 36
    return header


def test_every_offset_is_that_of_wire_md() -> None:
    text = WIRE_MD.read_text()
    table = text[text.index("## Header: 384 bytes") : text.index("### Block of image")]
    rows = re.findall(r"^\| (\d+) \| (?:[uf]\d+(?:\[\d+\])?|\d+ bytes) \| (\w+) \|", table, re.MULTILINE)
    assert len(rows) == 19
    assert [(name, int(offset)) for offset, name in rows] == [
        (name, wire.HEADER.fields[name][1]) for name in wire.HEADER.names
    ]
    assert wire.HEADER.itemsize == 384
    kinds = text[text.index("## Kinds") : text.index("## Encodings")]
    carried = re.findall(r"^\| (\d+) \| \w+ \| (?:one (\w+)|(\w+)\[\])", kinds, re.MULTILINE)
    structs = [(one or each, Kind(int(number))) for number, one, each in carried]
    assert {kind for _, kind in structs} == set(wire.STRUCTS)
    for name, kind in structs:
        found = re.search(rf"\*\*{name}\*\*, (\d+) bytes: (.*?)(?:\n\n|\Z)", text, re.DOTALL)
        assert found is not None
        assert wire.STRUCTS[kind].itemsize == int(found[1])
        named = dict(re.findall(r"(?:[iuf]\d+(?:\[\d+\])*|Setting) ([a-z_]+) (\d+)", found[2]))
        assert named
        for field, offset in named.items():
            assert wire.STRUCTS[kind].fields[field][1] == int(offset), (name, field)


def test_numbers_and_names_are_those_of_wire_md() -> None:
    text = WIRE_MD.read_text()
    kinds = text[text.index("## Kinds") : text.index("## Encodings")]
    encodings = text[text.index("## Encodings") : text.index("## Structs")]
    operations = text[text.index("| operation | name") :]
    models = text[text.index("| model | name") : text.index("### Block of laser_scan")]
    tables = ((kinds, Kind), (encodings, Encoding), (models, DistortionModel), (operations, wire.Operation))
    for table, enum in tables:
        rows = {int(number): name for number, name in re.findall(r"^\| (\d+) \| (\w+) \|", table, re.MULTILINE)}
        names = {"F32C1": "32fc1", "U16C1": "16uc1", "F32C2": "32fc2", "F32C3": "32fc3", "I32C1": "32sc1"}
        assert rows == {member.value: names.get(member.name, member.name.lower()) for member in enum}


def test_a_picture_has_all_coefficients_of_its_lens() -> None:
    text = WIRE_MD.read_text()
    block = text[text.index("### Block of image") : text.index("| model | name")]
    at = {
        name: int(offset)
        for offset, name in re.findall(r"^\| (\d+) \| [uf]\d+(?:\[\d+\])? \| (\w+) \|", block, re.MULTILINE)
    }
    coefficients = tuple(0.1 * index - 0.6 for index in range(14))
    header = bytearray(wire.HEADER_LEN)
    struct.pack_into("<5d", header, at["fx"], 381.5, 382.5, 319.5, 239.5, 0.25)
    struct.pack_into("<14d", header, at["distortion"], *coefficients)
    struct.pack_into("<3f2H", header, at["near"], 0.5, 8.0, -2.0, DistortionModel.RATIONAL_POLYNOMIAL, 14)
    lens = wire.intrinsics(np.frombuffer(header, wire.HEADER)[0])
    assert lens == wire.Intrinsics(381.5, 382.5, 319.5, 239.5, 0.25, coefficients, 0.5, 8.0, -2.0, 2)
    struct.pack_into("<2H", header, at["distortion_model"], DistortionModel.EQUIDISTANT, 4)
    assert wire.intrinsics(np.frombuffer(header, wire.HEADER)[0]).distortion == coefficients[:4]
    struct.pack_into("<H", header, at["distortion_len"], 65535)
    assert wire.intrinsics(np.frombuffer(header, wire.HEADER)[0]).distortion == coefficients


def test_a_good_header_passes() -> None:
    wire.check(good_header()[()], 36)


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("magic", 1, "magic"),
        ("schema", 1, "schema is 1"),
        ("header_len", 128, "header_len is 128"),
        ("payload_len", 37, "payload_len is 37, but 36"),
        ("width", 5, "row_stride"),
        ("height", 4, "byte 48 of a payload of 36"),
        ("row_stride", 2**32 - 1, "byte"),
        ("elem_stride", 2, "elem_stride 2"),
        ("flags", 1, "byte 72"),
    ],
)
def test_each_wrong_field_is_named(field: str, value: int, says: str) -> None:
    header = good_header()
    header[field] = value
    with pytest.raises(BadFrameError, match=says):
        wire.check(header[()], 36)


def test_no_header_leads_outside_the_payload() -> None:
    draw = random.Random(1)
    memory = np.zeros(4096, "u1")
    passed = 0
    for _ in range(20_000):
        header = good_header()
        for field in draw.sample(["flags", "width", "height", "row_stride", "elem_stride", "payload_len"], 3):
            bits = draw.choice([2, 4, 8, 12, 31, 32])
            header[field] = draw.getrandbits(bits)
        # 0 and the last number are unknown to this version.
        header["kind"] = draw.randrange(max(Kind) + 2)
        header["encoding"] = draw.randrange(max(Encoding) + 2)
        try:
            wire.check(header[()], memory.size)
        except BadFrameError:
            continue
        if not header["width"] or not header["height"]:
            continue
        element = wire.element(int(header["kind"]), int(header["encoding"]))
        size = element.itemsize if element is not None else 1
        planes = 2 if int(header["flags"]) & 1 else 1
        last = (
            (planes * int(header["height"]) - 1) * int(header["row_stride"])
            + (int(header["width"]) - 1) * int(header["elem_stride"])
            + size
        )
        assert last <= int(header["payload_len"]) <= memory.size
        passed += 1
    assert passed > 100
