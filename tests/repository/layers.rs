//! The dependencies in ARCHITECTURE.md: each layer uses only those below it, and no two files use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The layers of the simulator, bottom up.
const SIMULATOR: &[&str] = &[
    "colours",
    "gltf",
    "world",
    "robot",
    "entities",
    "rig",
    "simulation",
    "randomize",
    "dataset",
    "server",
    "recording",
    "ros2",
    "link",
    "view",
    "picture",
    "cli",
];

/// The layers of the bridge.
const BRIDGE: &[&str] = &[
    "clock",
    "session",
    "open_files",
    "own",
    "wire",
    "consumer",
    "error",
    "topic",
    "spec",
    "domain",
    "node",
    "stream",
    "publisher",
    "subscriber",
    "synchronizer",
    "control",
];

/// The layers of the sensors.
const SENSORS: &[&str] = &[
    "simd",
    "pose",
    "pose_convert",
    "memory",
    "parameter",
    "srgb",
    "execution",
    "noise",
    "moment",
    "scene",
    "optics",
    "trace",
    "shade",
    "device",
    "sensor",
    "parry",
    "rapier",
];

/// The layers of xacro.
const XACRO: &[&str] = &[
    "shorten",
    "file",
    "shell",
    "encoding",
    "suggestion",
    "diagnostics",
    "xml",
    "budget",
    "model_index",
    "package",
    "fault",
    "value",
    "text",
    "expression",
    "limits",
    "functions",
    "evaluate",
    "yaml",
    "names",
    "macros",
    "scope",
    "expand",
];

/// The layers of the packets of lidars.
const LIDAR_PACKETS: &[&str] = &["whole", "column", "velodyne", "ouster", "pcap"];

/// The layers of the wire of ROS 2.
const RTPS: &[&str] = &[
    "guid",
    "lock",
    "bytes",
    "numbers",
    "parameters",
    "message",
    "answer",
    "spdp",
    "peer",
    "pacing",
    "writer",
    "assembly",
    "reader",
    "requests",
    "sedp",
    "ros",
    "sockets",
    "mailbox",
    "engine",
    "participant",
    "service",
    "exchange",
    "mutated",
];

/// A path of modules, without `crate`.
type Module = Vec<String>;

/// The modules of a crate by their paths, with the text of each file without comments and tests.
struct Crate {
    texts: BTreeMap<Module, String>,
}

impl Crate {
    fn read(source: &Path) -> Self {
        let mut texts = BTreeMap::new();
        read_folder(source, &[], &mut texts);
        Self { texts }
    }

    /// The module to which a path leads from another module, through re-exports of the modules in between.
    fn resolve(&self, from: &[String], path: &[String], hops: usize) -> Module {
        let mut at = from.to_vec();
        for (place, name) in path.iter().enumerate() {
            let inner = [&at[..], std::slice::from_ref(name)].concat();
            if self.texts.contains_key(&inner) {
                at = inner;
                continue;
            }
            // An item of this module, or of a module from which it re-exports the item.
            let exported = self.texts.get(&at).into_iter().flat_map(|text| exports(text));
            let via = exported.into_iter().find(|export| export.last() == Some(name));
            return match via {
                Some(via) if hops > 0 && via.len() > 1 => {
                    let rest = [&via[..], &path[place + 1..]].concat();
                    self.resolve(&at, &rest, hops - 1)
                }
                _ => at,
            };
        }
        at
    }

    /// The uses between modules, with one path as an example. A module and its own children do not count.
    fn uses(&self) -> BTreeMap<(Module, Module), String> {
        let mut uses = BTreeMap::new();
        for (own, text) in &self.texts {
            for (root, path) in paths(text) {
                let from: &[String] = match root {
                    "crate" => &[],
                    _ => &own[..own.len().saturating_sub(1)],
                };
                let used = self.resolve(from, &path, 4);
                let is_own = used.starts_with(own) || own.starts_with(&used);
                if !is_own {
                    uses.entry((own.clone(), used)).or_insert_with(|| format!("{root}::{}", path.join("::")));
                }
            }
        }
        uses
    }
}

fn read_folder(folder: &Path, module: &[String], texts: &mut BTreeMap<Module, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let inner = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            read_folder(&path, &inner, texts);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            // Tests of a file may use any module.
            let is_tests = |line: &&str| {
                line.starts_with("#[cfg(") && line.contains("test") && !line.contains("doctest")
            };
            let code: Vec<&str> = text.lines().collect();
            let tests = code.windows(2).position(|two| is_tests(&two[0]) && two[1].starts_with("mod "));
            let code = code[..tests.unwrap_or(code.len())].iter();
            let lines = code.map(|line| line.split("//").next().unwrap_or_default());
            let own = if ["lib", "main", "mod"].contains(&name.as_str()) { module.to_vec() } else { inner };
            *texts.entry(own).or_default() += &lines.collect::<Vec<_>>().join("\n");
        }
    }
}

/// The modules that a module re-exports from its children.
fn exports(text: &str) -> Vec<Module> {
    ["pub use ", "pub(crate) use ", "pub(super) use "]
        .iter()
        .flat_map(|words| text.split(words).skip(1))
        .flat_map(|rest| tree(rest).0)
        .collect()
}

/// The paths that begin at the crate or the parent.
fn paths(text: &str) -> Vec<(&'static str, Module)> {
    let mut found = Vec::new();
    for root in ["crate", "super"] {
        let begin = format!("{root}::");
        for (at, _) in text.match_indices(&begin) {
            // `$crate`, or the end of a longer name.
            let before = text[..at].chars().next_back();
            if before.is_none_or(|c| !c.is_alphanumeric() && !"_$:".contains(c)) {
                found.extend(tree(&text[at + begin.len()..]).0.into_iter().map(|path| (root, path)));
            }
        }
    }
    found
}

/// The paths of a tree `a::{b, c::d}`, and the length of its text.
fn tree(text: &str) -> (Vec<Module>, usize) {
    let mut at = text.len() - text.trim_start().len();
    if text[at..].starts_with('{') {
        let mut paths = Vec::new();
        at += 1;
        loop {
            let rest = &text[at..];
            at += rest.len() - rest.trim_start_matches(|c: char| c.is_whitespace() || c == ',').len();
            if at >= text.len() || text[at..].starts_with('}') {
                return (paths, at + 1);
            }
            let (inner, len) = tree(&text[at..]);
            paths.extend(inner);
            at += len.max(1);
        }
    }
    let rest = &text[at..];
    let name = &rest[..rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())];
    at += name.len();
    if name.is_empty() || !text[at..].starts_with("::") {
        let last = if ["", "self"].contains(&name) { Vec::new() } else { vec![name.to_owned()] };
        return (vec![last], at);
    }
    let (inner, len) = tree(&text[at + 2..]);
    let paths = inner.into_iter().map(|path| [&[name.to_owned()], &path[..]].concat()).collect();
    (paths, at + 2 + len)
}

/// The modules that use themselves through others.
fn circles(uses: &BTreeMap<(Module, Module), String>) -> BTreeSet<String> {
    let mut next: BTreeMap<&Module, Vec<&Module>> = BTreeMap::new();
    for (own, used) in uses.keys() {
        next.entry(own).or_default().push(used);
    }
    let comes_back = |start: &Module| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![start]);
        while let Some(module) = open.pop() {
            for &used in next.get(module).into_iter().flatten() {
                if used == start {
                    return true;
                }
                if seen.insert(used) {
                    open.push(used);
                }
            }
        }
        false
    };
    next.keys().filter(|start| comes_back(start)).map(|start| start.join("::")).collect()
}

/// The uses of a layer by one below it.
fn upward(layers: &[&str], uses: &BTreeMap<(Module, Module), String>) -> Vec<String> {
    let place =
        |module: &Module| module.first().and_then(|name| layers.iter().position(|layer| layer == name));
    let is_upward = |(own, used): &(Module, Module)| match (place(own), place(used)) {
        (Some(own), Some(used)) => used > own,
        _ => false,
    };
    let upward = uses.iter().filter(|(ends, _)| is_upward(ends));
    upward.map(|((own, _), path)| format!("{}: {path}", own.join("::"))).collect()
}

fn check_layers(folder: &str, layers: &[&str]) -> BTreeMap<(Module, Module), String> {
    let read = Crate::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
    let missing: BTreeSet<&String> = read.texts.keys().filter_map(|module| module.first()).collect();
    let missing: Vec<_> = missing.into_iter().filter(|name| !layers.contains(&name.as_str())).collect();
    assert!(missing.is_empty(), "{folder}: in no layer, give it one here: {missing:?}");
    let uses = read.uses();
    let least = read.texts.len();
    assert!(uses.len() >= least, "hardly any uses were found: has the form of `use` changed? {uses:#?}");
    let upward = upward(layers, &uses);
    assert!(upward.is_empty(), "{folder}: used from below:\n{upward:#?}");
    uses
}

#[test]
fn each_layer_of_the_simulator_uses_only_those_below_it() {
    let uses = check_layers("src", SIMULATOR);
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn no_two_files_of_the_descriptions_use_each_other() {
    // The model contains the data of sensors, which is defined beside their parsers: files are ordered, folders are
    // not.
    let uses = Crate::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/description/src")).uses();
    assert!(uses.len() > 50, "{uses:#?}");
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn each_layer_of_xacro_uses_only_those_below_it() {
    let uses = check_layers("crates/xacro/src", XACRO);
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn each_layer_of_the_packets_of_lidars_uses_only_those_below_it() {
    let uses = check_layers("crates/lidar-packets/src", LIDAR_PACKETS);
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn each_layer_of_the_wire_of_ros_2_uses_only_those_below_it() {
    let uses = check_layers("crates/rtps/src", RTPS);
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn each_layer_of_the_sensors_uses_only_those_below_it() {
    let uses = check_layers("sensors/src", SENSORS);
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn each_layer_of_the_bridge_uses_only_those_below_it_and_no_two_files_use_each_other() {
    let uses = check_layers("bridge/src", BRIDGE);
    assert_eq!(circles(&uses), BTreeSet::new(), "{uses:#?}");
}

#[test]
fn a_cycle_is_found() {
    let texts = [
        ("a", "use crate::{b::{c, D}, e};"),
        ("b", "pub use c::D;"),
        ("b::c", "super::super::x();"),
        ("e", ""),
    ];
    let module = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
    let mut texts: BTreeMap<_, _> = texts.map(|(path, text)| (module(path), text.to_owned())).into();
    let uses = Crate { texts: texts.clone() }.uses();
    let found: Vec<String> =
        uses.keys().map(|(own, used)| format!("{}>{}", own.join("."), used.join("."))).collect();
    assert_eq!(found, ["a>b.c", "a>e"]);
    assert_eq!((circles(&uses), upward(&["a", "b", "e"], &uses).len()), (BTreeSet::new(), 2));
    texts.insert(module("e"), "fn f() { crate::a::g(); }".to_owned());
    let uses = Crate { texts }.uses();
    assert_eq!(circles(&uses), ["a", "e"].map(str::to_owned).into());
}
