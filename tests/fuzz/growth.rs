//! The time to read a file grows in proportion to its size, for each kind of thing that a file can have many of.

mod meshes;

use crate::{Reader, processor_time};
use std::time::Duration;

/// A file that grows: its beginning, a part that is repeated with each `#` replaced by the number of the repetition, and
/// its end. If there is a closing part, it is repeated as often after the middle. In the beginning and the middle, the
/// number of repetitions replaces `{count}`.
struct Shape {
    format: &'static str,
    head: &'static str,
    part: &'static str,
    middle: &'static str,
    close: &'static str,
    tail: &'static str,
}

const fn row(format: &'static str, head: &'static str, part: &'static str, tail: &'static str) -> Shape {
    pair(format, head, [part, "", ""], tail)
}

const fn nest(
    format: &'static str,
    head: &'static str,
    [part, close]: [&'static str; 2],
    tail: &'static str,
) -> Shape {
    pair(format, head, [part, "", close], tail)
}

/// A file with many of two things.
const fn pair(
    format: &'static str,
    head: &'static str,
    [part, middle, close]: [&'static str; 3],
    tail: &'static str,
) -> Shape {
    Shape { format, head, part, middle, close, tail }
}

const XACRO: &str = "<robot name='r' xmlns:xacro='http://x'><link name='base'/>";
const LINKS: &str =
    "<link name='l#'/><joint name='j#' type='fixed'><parent link='base'/><child link='l#'/></joint>";
const WORLD: &str = "<sdf version='1.9'><world name='w'>";
const MODEL: &str = "<sdf version='1.9'><world name='w'><model name='m'><static>1</static><link name='l'>";
const WORLD_END: &str = "</world></sdf>";
const MODEL_END: &str = "</link></model></world></sdf>";
const PLAN: &str =
    "worlds = ['w.sdf']\nrobot = 'eyes.sdf'\nseeds = [1]\n[[sensors]]\nname = 'rgb'\ntopic = 'rgb'\n";

const SHAPES: &[Shape] = &[
    row("xacro", XACRO, LINKS, "</robot>"),
    row("xacro", XACRO, "<xacro:property name='p#' value='${1 + 2}'/>", "</robot>"),
    row("xacro", XACRO, "<xacro:macro name='m#' params='a'><b/></xacro:macro>", "</robot>"),
    row("xacro", XACRO, "<xacro:unknown#/>", "</robot>"),
    row("xacro", XACRO, "<link name='${undefined#}'/>", "</robot>"),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='${1", " + 1", "}'/></robot>"),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='${[1", ", #", "]}'/></robot>"),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'><link name=\"${'", "a'  'b", "'}\"/></robot>"),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='l", "${1}$(arg a)", "'/></robot>"),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='l'", " a#='1'", "/></robot>"),
    row(
        "xacro",
        "<robot name='r' xmlns:xacro='http://x'><link name='l'>",
        "<xacro:attribute name='a#' value='1'/>",
        "</link></robot>",
    ),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='l'/>", "<!-- c -->\n", "</robot>"),
    row("xacro", "<robot name='r' xmlns:xacro='http://x'>", "&amp;&lt;", "</robot>"),
    nest("xacro", XACRO, ["<a>", "</a>"], "</robot>"),
    nest("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='${", ["(", ")"], "}'/></robot>"),
    nest("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='${", ["[", "]"], "}'/></robot>"),
    nest("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='${", ["-", " "], "1}'/></robot>"),
    nest("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='${1 ", ["** 2", " "], "}'/></robot>"),
    nest(
        "xacro",
        "<robot name='r' xmlns:xacro='http://x'><link name='${",
        ["a if b else ", " "],
        "1}'/></robot>",
    ),
    nest("xacro", "<robot name='r' xmlns:xacro='http://x'><link name='", ["${", "}"], "'/></robot>"),
    row("yaml", "", "k#: [1, 2, {a: b}]\n", ""),
    row("yaml", "a: &a {x: 1}\n", "k#: {<<: *a, y: 2}\n", ""),
    row("yaml", "", "- !degrees 90\n", ""),
    row("yaml", "a: |\n", "  text\n", ""),
    row("yaml", "a: \"", "\\u263a ", "\""),
    nest("yaml", "", ["[", "]"], ""),
    nest("yaml", "", ["{a: ", "}"], ""),
    row("yaml", "", "- ", "1"),
    row("yaml", "", "? ", "1"),
    row("urdf", "<robot name='r'><link name='base'/>", LINKS, "</robot>"),
    row(
        "urdf",
        "<robot name='r'><link name='l0'/>",
        "<joint name='j#' type='fixed'><parent link='l0'/><child link='l0'/></joint>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<material name='m#'><color rgba='1 0 0 1'/></material>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<link name='l#'/><joint name='j#' type='continuous'><parent link='base'/><child link='l#'/><mimic joint='none#'/></joint><material name='m#'><color rgba='1 0 0 1'/></material><link name='k#'><visual><geometry><sphere radius='1'/></geometry><material name='none#'/></visual></link>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<gazebo reference='base'><mu1>#</mu1></gazebo>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'>",
        "<visual><geometry><box size='1 1 1'/></geometry></visual>",
        "</link></robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<gazebo reference='no#'><a/></gazebo><transmission name='t#'/>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<link name='l#'/><joint name='j#' type='prismatic'><parent link='base'/><child link='l#'/><limit lower='0' upper='1' effort='1' velocity='1'/><mimic joint='j#'/></joint><gazebo reference='j#'><springStiffness>1</springStiffness></gazebo>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<link name='l#'/><joint name='j#' type='fixed'><parent link='none#'/><child link='l#'/></joint><gazebo reference='x#'/>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/>",
        "<gazebo reference='base'><sensor name='s#' type='imu'/></gazebo>",
        "</robot>",
    ),
    row(
        "urdf",
        "<robot name='r'><link name='base'/><link name='base",
        "e",
        "'/><joint name='j' type='fixed'><parent link='basee'/><child link='base'/></joint></robot>",
    ),
    row("sdf", WORLD, "<model name='m#'><static>1</static><link name='l'/></model>", WORLD_END),
    row("sdf", WORLD, "<frame name='f#'/>", WORLD_END),
    row("sdf", WORLD, "<light name='s#' type='point'/>", WORLD_END),
    row("sdf", WORLD, "<unknown#/>", WORLD_END),
    row("sdf", WORLD, "<include><uri>model://sun</uri><name>n#</name></include>", WORLD_END),
    row("sdf", WORLD, "<include><uri>model://none#</uri></include>", WORLD_END),
    row(
        "sdf",
        MODEL,
        "<visual name='v#'><geometry><box><size>1 1 1</size></box></geometry></visual>",
        MODEL_END,
    ),
    row(
        "sdf",
        MODEL,
        "<collision name='v#'><geometry><box><size>1 1 1</size></box></geometry></collision>",
        MODEL_END,
    ),
    row("sdf", MODEL, "<sensor name='s#' type='imu'/>", MODEL_END),
    row(
        "sdf",
        "<sdf version='1.9'><world name='w'><model name='m'><link name='l'/>",
        "<link name='l#'/><joint name='j#' type='fixed'><parent>l</parent><child>l#</child></joint>",
        "</model></world></sdf>",
    ),
    row(
        "sdf",
        "<sdf version='1.9'><world name='w'><model name='m'><link name='l'/>",
        "<link name='l#'/><joint name='j#' type='revolute'><parent>world</parent><child>l#</child><axis><xyz>0 0 1</xyz><mimic joint='j#'/></axis></joint>",
        "</model></world></sdf>",
    ),
    row(
        "sdf",
        WORLD,
        "<model name='n#'><static>1</static><link name='l'/></model><state world_name='w'><model name='n#'/></state>",
        WORLD_END,
    ),
    row(
        "sdf",
        "<sdf version='1.9'><world name='w'><model name='m'><link name='l'/>",
        "<frame name='f#' attached_to='none#'/><joint name='j#' type='fixed'><parent>l</parent><child>none#</child></joint>",
        "</model></world></sdf>",
    ),
    row(
        "sdf",
        "<sdf version='1.9'><world name='w'><model name='m'><static>1</static><link name='l'><visual name='v'><geometry><polyline>",
        "<point>0.# 1</point>",
        "<height>1</height></polyline></geometry></visual></link></model></world></sdf>",
    ),
    row(
        "sdf",
        "<sdf version='1.9'><world name='w'><actor name='a'><link name='l'/><script><trajectory id='0' type='a'>",
        "<waypoint><time>#</time><pose>0 0 # 0 0 0</pose></waypoint>",
        "</trajectory></script></actor></world></sdf>",
    ),
    nest("sdf", WORLD, ["<model name='m'><link name='l'/>", "</model>"], WORLD_END),
    row("material", "", "material M# : M { technique { pass { ambient 1 0 0 } } }\n", ""),
    nest("material", "material A ", ["{ a ", "}"], ""),
    row("material", "material A {", "x ", "}"),
    row("plan", PLAN, "[[sensors]]\nname = 's#'\ntopic = 'rgb'\n", ""),
    row("plan", "robot = 'eyes.sdf'\nworlds = ['w.sdf'", ", 'w.sdf'", "]\n"),
    row(
        "plan",
        "worlds = ['w.sdf']\nrobot = 'eyes.sdf'\n[poses]\nlist = [[0, 0, 0, 0, 0, 0]",
        ", [0, 0, 0, 0, 0, 0]",
        "]\n",
    ),
    nest("plan", "worlds = ", ["[", "]"], ""),
    nest("plan", "", ["a.", ""], "b = 1"),
];

impl Shape {
    fn grown(&self, bytes: usize) -> Vec<u8> {
        let count = bytes / (self.part.len() + self.close.len());
        let number = |at: usize| {
            // In Collada, a source is named with a `#`.
            if self.part.contains("='#") { None } else { Some(at.to_string()) }
        };
        let filled = |text: &str| text.replace("{count}", &count.to_string());
        let mut text = filled(self.head);
        for at in 0..count {
            match number(at) {
                Some(number) => text.push_str(&self.part.replace('#', &number)),
                None => text.push_str(self.part),
            }
        }
        text.push_str(&filled(self.middle));
        text.push_str(&self.close.repeat(count));
        text.push_str(self.tail);
        text.into_bytes()
    }
}

/// The greatest factor by which the time may grow if the size grows by 8; the time of a square would grow by 64.
const MOST: u32 = 24;
/// A pair of times is measured until the factor is small enough, at most this many times. On a virtual machine whose host
/// is busy, processor time often has 10 ms in which others ran; three tries were too few there.
const TRIES: usize = 20;
/// Shorter times are not compared.
const LEAST: Duration = Duration::from_micros(500);

/// Reads growing sizes of each shape of the reader's format and compares the times.
pub(crate) fn check(reader: &mut Reader<'_>, is_full: bool) {
    let largest = if is_full { 1 << 22 } else { 1 << 17 };
    for shape in SHAPES.iter().chain(meshes::SHAPES).filter(|shape| shape.format == reader.format.name) {
        // After a size that took too long, a larger one would take minutes.
        for bytes in [largest / 64, largest / 8] {
            if let Some(times) = grows_too_much(reader, shape, bytes) {
                let what = format!("'{}' in {bytes} bytes, and in 8 times as many: {times:?}", shape.part);
                reader.fault(&format!("growth {} {}", shape.part, shape.head), &what);
                break;
            }
        }
    }
}

/// Returns the times of a size and of eight times that size, if the factor is too great each time it is measured.
fn grows_too_much(reader: &mut Reader<'_>, shape: &Shape, bytes: usize) -> Option<[[Duration; 2]; TRIES]> {
    let [small, large] = [bytes, 8 * bytes].map(|bytes| shape.grown(bytes));
    let mut measured = [[Duration::ZERO; 2]; TRIES];
    for times in &mut measured {
        *times = [&small, &large].map(|input| {
            let start = processor_time();
            reader.read(input);
            processor_time().saturating_sub(start)
        });
        let [least, most] = *times;
        if most < MOST * least.max(LEAST) {
            return None;
        }
    }
    Some(measured)
}
