"""Compares `belvedere urdf` with ROS's xacro on random expressions, in attributes, texts, properties, conditions and
parameters of macros.

    python3 tests/xacro/compare.py BELVEDERE COUNT

The files must have the same canonical XML, and what xacro refuses must be refused."""

import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as etree
from xml.dom import minidom
from xml.sax.saxutils import quoteattr

import xacro

# A number with a fraction.
NUMBER = re.compile(r"\d+\.\d+(?:e[-+]\d+)?")
# A share of expressions of the wrong type, which are mostly errors.
WRONG = 0.03
KINDS = ("int", "float", "bool", "str", "list", "dict")
PROPERTIES = {
    "width": "0.35", "count": "3", "label": "'left'", "on": "true", "sizes": "${[1, 2.5, -3]}",
    "table": "${dict(mass=1.5, joints=['a', 'b'], n=4)}", "twice": "${2 * width}",
}  # fmt: skip


class Grammar:
    def __init__(self, seed):
        self.random = random.Random(seed)

    def any_of(self, *choices):
        return self.random.choice(choices)

    def make(self, kind, depth=0):
        """An expression of a kind."""
        if self.random.random() < WRONG:
            kind = self.random.choice(KINDS)
        simple = depth > 2 or self.random.random() < 0.25
        text = getattr(self, f"simple_{kind}" if simple else kind)(depth + 1)
        return f"({text})" if self.random.random() < 0.15 else text

    def number(self, depth):
        return self.make(self.any_of("int", "float"), depth)

    def simple_int(self, _):
        return self.any_of("count", "table['n']", "0", "1", "-2", "7", "0x1f", "1_000", "12345678901234567890",
                           str(self.random.randrange(-50, 50)))  # fmt: skip

    def int(self, depth):
        make = self.make
        return self.any_of(
            lambda: f"{make('int', depth)} {self.any_of('+', '-', '*', '//', '%')} {make('int', depth)}",
            lambda: f"{self.any_of('-', '+', '~', 'python.abs', 'int', 'round')}({self.number(depth)})",
            lambda: f"{make('int', depth)} {self.any_of('<<', '>>', '&', '|', '^')} {self.random.randrange(9)}",
            lambda: f"({make('int', depth)}) ** {self.random.randrange(4)}",
            lambda: f"len({make(self.any_of('str', 'list', 'dict'), depth)})",
            lambda: f"{self.any_of('min', 'max')}({make('int', depth)}, {make('int', depth)})",
            lambda: f"{make('int', depth)} if {make('bool', depth)} else {make('int', depth)}",
            lambda: f"python.sum([{make('int', depth)}, {make('int', depth)}])",
            lambda: f"{make('str', depth)}.{self.any_of('count', 'find')}('e')",
            lambda: f"python.sum(x * {make('int', depth)} for x in python.range({self.random.randrange(5)}))",
        )()

    def simple_float(self, _):
        return self.any_of("width", "twice", "pi", "0.1", "2.", ".5", "1e-3", "-3.75", "table['mass']", "1e22", "sizes[1]",
                           repr(self.random.uniform(-10, 10)))  # fmt: skip

    def float(self, depth):
        number = self.number
        return self.any_of(
            lambda: f"{number(depth)} {self.any_of('+', '-', '*', '/')} {number(depth)}",
            lambda: f"{self.any_of('sin', 'cos', 'tan', 'atan', 'radians', 'degrees', 'float')}({number(depth)})",
            lambda: f"sqrt(fabs({number(depth)}))",
            lambda: f"atan2({number(depth)}, {number(depth)})",
            lambda: f"{self.any_of('fmod', 'hypot')}({number(depth)}, {number(depth)})",
            # A remainder magnifies differences in the last digit.
            lambda: f"{self.simple_int(depth)} {self.any_of('//', '%')} {self.simple_float(depth)}",
            lambda: f"fabs({number(depth)}) ** {self.any_of('0.5', '2', '-1', 'width')}",
            lambda: f"round({self.make('float', depth)}, {self.random.randrange(5)})",
            lambda: f"{self.make('float', depth)} if {self.make('bool', depth)} else {number(depth)}",
            lambda: f"{self.any_of('floor', 'ceil')}({self.make('float', depth)}) * 0.5",
        )()

    def simple_bool(self, _):
        return self.any_of("True", "False", "on", "not on", "1 == 1.0")

    def bool(self, depth):
        make, number = self.make, self.number
        return self.any_of(
            lambda: f"{number(depth)} {self.any_of('<', '<=', '==', '!=', '>', '>=')} {number(depth)}",
            lambda: f"{number(depth)} < {number(depth)} <= {number(depth)}",
            lambda: f"{make('bool', depth)} {self.any_of('and', 'or')} {make('bool', depth)}",
            lambda: f"not {make(self.random.choice(KINDS), depth)}",
            lambda: f"{make('str', depth)} {self.any_of('in', 'not in', '==', '<')} {make('str', depth)}",
            lambda: f"{make('int', depth)} in {make('list', depth)}",
            lambda: f"{self.any_of('python.any', 'python.all')}({make('list', depth)})",
            lambda: f"{make('str', depth)}.{self.any_of('startswith', 'endswith')}('l')",
        )()

    def simple_str(self, _):
        return self.any_of("label", "'wheel'", "'a_b'", "''", "'Ä x'", "table['joints'][0]", "'7'", "str(count)")

    def str(self, depth):
        make, number = self.make, self.number
        return self.any_of(
            lambda: f"{make('str', depth)} + {make('str', depth)}",
            lambda: f"str({make(self.random.choice(KINDS), depth)})",
            lambda: f"{make('str', depth)}.{self.any_of('upper', 'lower', 'title', 'strip', 'capitalize')}()",
            lambda: f"{make('str', depth)} * {self.random.randrange(4)}",
            lambda: f"{make('str', depth)}[{self.any_of('0:2', '-1:', '::-1', '1:', ':9:2')}]",
            lambda: f"'{self.any_of('%d', '%.3f', '%5.1f|', '%g', '%e', '%s', '%03d')}' % ({number(depth)})",
            lambda: f"'%s %s' % ({number(depth)}, {make('str', depth)})",
            lambda: f"'{self.any_of('_', ', ')}'.join([{make('str', depth)}, {make('str', depth)}])",
            lambda: f"{make('str', depth)}.replace('e', {make('str', depth)})",
            lambda: f"{make('str', depth)}.{self.any_of('zfill', 'ljust', 'rjust', 'center')}(6) + '|'",
        )()

    def simple_list(self, _):
        return self.any_of("sizes", "[]", "[1, 2, 3]", "table['joints']", "list(python.range(4))", "(1, 2)", "[0.5]")

    def list(self, depth):
        make, number = self.make, self.number
        return self.any_of(
            lambda: f"[{make(self.random.choice(KINDS), depth)}, {number(depth)}]",
            lambda: f"{make('list', depth)} + [{number(depth)}]",
            lambda: f"python.sorted([{number(depth)}, {number(depth)}, {number(depth)}])",
            lambda: (
                f"[x * {number(depth)} for x in {self.any_of('sizes', '[1, 2]', 'python.range(3)')} if x > {number(depth)}]"
            ),
            lambda: f"{make('list', depth)}[{self.any_of('::-1', '1:', ':2', '-2:')}]",
            lambda: f"{make('str', depth)}.split('{self.any_of('e', '_')}')",
            lambda: f"list(python.zip([{number(depth)}, 1], ['a', {make('str', depth)}]))",
            lambda: f"list(map(lambda v: v + {number(depth)}, [1, {number(depth)}]))",
        )()

    def simple_dict(self, _):
        return self.any_of("table", "dict()", "dict(a=1)", "dict([('k', 2.0), (1, 'x')])")

    def dict(self, depth):
        # The braces of a dictionary end an expression of xacro.
        make = self.make
        return f"dict([({make('str', depth)}, {make(self.random.choice(KINDS), depth)}), ('n', {self.number(depth)})])"


def used(number, kind, expression):
    """An element with the expression in one of the places where it may be."""
    value, name = quoteattr("${" + expression + "}"), f"e{number}"
    place = number % 4 if kind in ("int", "float", "bool") else number % 3
    if place == 0:
        return f"<link name={value[:-1]}_{number}{value[-1]}/>" if kind == "int" else f'<x n="{name}" v={value}/>'
    if place == 1:
        return f'<xacro:property name="{name}" value={value}/><x n="{name}" v="[${{{name}}}] $(arg a)">${{{name}}}</x>'
    if place == 2:
        return f'<xacro:shown name="{name}" v={value}/>'
    return (
        f'<xacro:if value={value}><x n="{name}"/></xacro:if><xacro:unless value={value}><y n="{name}"/></xacro:unless>'
    )


def robot(content):
    properties = "".join(f"<xacro:property name={quoteattr(n)} value={quoteattr(v)}/>" for n, v in PROPERTIES.items())
    return f"""<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="a" default="1"/>{properties}
<xacro:macro name="shown" params="name v w:=3"><x n="${{name}}" v="${{v}}" w="${{[w, v]}}"/></xacro:macro>
<link name="base">
{content}
</link></robot>"""


def by_xacro(text):
    """The file that xacro makes of a text, or None if it refuses it."""
    xacro.stack, xacro.filestack = [], None
    document = minidom.parseString(text)
    try:
        xacro.init_stacks("robot.xacro")
        xacro.process_doc(document)
    except Exception:  # xacro lets through what the expression raises
        return None
    return document.toxml()


def canonical(text):
    return etree.canonicalize(text, strip_text=True).replace("><", ">\n<").splitlines()


def is_same(theirs, ours):
    """Compares lines. CPython takes sines and logarithms from the C library, whose last digit may be another one."""
    if theirs == ours:
        return True
    if NUMBER.sub("#", theirs) != NUMBER.sub("#", ours):
        return False
    pairs = zip(NUMBER.findall(theirs), NUMBER.findall(ours))
    return all(a == b or abs(float(a) - float(b)) <= 1e-15 * abs(float(a)) for a, b in pairs)


def is_equal(theirs, ours):
    theirs, ours = canonical(theirs), canonical(ours)
    return len(theirs) == len(ours) and all(map(is_same, theirs, ours))


def main():
    belvedere, count = sys.argv[1], int(sys.argv[2])
    seed = os.environ.get("BELVEDERE_SEED", "1")
    if seed == "new":
        seed = time.time_ns() % 10**9
        print(f"BELVEDERE_SEED={seed}")
    grammar = Grammar(int(seed))
    good, bad, faults = [], [], []
    for number in range(count):
        kind = grammar.random.choice(KINDS)
        expression = grammar.make(kind)
        part = used(number, kind, expression)
        (good if by_xacro(robot(part)) is not None else bad).append((expression, part))
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "robot.xacro")

        def ours(parts):
            file.write_text(robot("\n".join(part for _, part in parts)))
            done = subprocess.run([belvedere, "urdf", file], capture_output=True, text=True, check=False)
            return done.stdout if done.returncode == 0 else None, done.stderr

        def compare(parts):
            """Appends the faults; divides the parts until each fault is alone."""
            theirs, (found, said) = by_xacro(robot("\n".join(part for _, part in parts))), ours(parts)
            if theirs is None or (found is not None and is_equal(theirs, found)):
                return
            if len(parts) > 1:
                half = len(parts) // 2
                compare(parts[:half])
                compare(parts[half:])
                return
            if found is not None:
                lines = set(canonical(theirs)) - set(canonical(found)), set(canonical(found)) - set(canonical(theirs))
                said = "{} is here {}".format(*lines)
            faults.append(f"{parts[0][0]}: {said.strip()}")

        compare(good)
        for part in bad:
            if ours([part])[0] is not None:
                faults.append(f"{part[0]}: xacro refuses it")
    print(f"{len(good)} expressions, and {len(bad)} that are refused")
    if len(good) < count / 2 or not bad:
        faults.append("too few expressions of one kind")
    if faults:
        sys.exit("\n".join(faults))


main()
