//! Files of killed processes, damaged in every way: the next start succeeds, quickly, and leaves nothing.

use std::{
    fs,
    os::unix::{
        fs::{FileTypeExt as _, PermissionsExt as _},
        net::UnixDatagram,
    },
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crate::world::{self, Actor, ROOT, files_of};

#[test]
fn spoilt_remains_do_not_hinder_the_next_start() {
    world::run(64, false, spoilt_remains);
}

#[test]
fn a_file_in_place_of_a_directory_is_named() {
    world::run(64, false, directories_in_the_way);
}

/// A file that was left, with its content.
struct Remnant {
    path: PathBuf,
    permissions: fs::Permissions,
    /// `None` for a socket.
    bytes: Option<Vec<u8>>,
}

impl Remnant {
    fn of(path: PathBuf) -> Self {
        let metadata = fs::symlink_metadata(&path).unwrap();
        let bytes = (!metadata.file_type().is_socket()).then(|| fs::read(&path).unwrap());
        Self { permissions: metadata.permissions(), path, bytes }
    }

    fn restore(&self) {
        let _ = fs::remove_file(&self.path);
        fs::create_dir_all(self.path.parent().unwrap()).unwrap();
        match &self.bytes {
            Some(bytes) => fs::write(&self.path, bytes).unwrap(),
            None => drop(UnixDatagram::bind(&self.path).unwrap()),
        }
        fs::set_permissions(&self.path, self.permissions.clone()).unwrap();
    }

    /// Damages the file in one of [`WAYS`]; a socket has only one.
    fn spoil(&self, way: &str) {
        if way == "gone" {
            return fs::remove_file(&self.path).unwrap();
        }
        let bytes = self.bytes.as_ref().expect("a file");
        let garbage = |len: usize| (0..len).map(|index| (index * 151 + 89) as u8).collect::<Vec<u8>>();
        fs::set_permissions(&self.path, fs::Permissions::from_mode(0o600)).unwrap();
        let written = match way {
            "empty" => Vec::new(),
            "cut" => bytes[..bytes.len() / 2].to_vec(),
            "overwritten" => garbage(bytes.len()),
            _ => garbage(100_000),
        };
        fs::write(&self.path, written).unwrap();
        fs::set_permissions(&self.path, self.permissions.clone()).unwrap();
    }
}

const WAYS: [&str; 5] = ["gone", "empty", "cut", "overwritten", "replaced"];

fn spoilt_remains() {
    let mut simulator = Actor::start("simulate", "default", ROOT, &[]);
    simulator.says("ready");
    let mut driver = Actor::start("drive", "default", ROOT, &[]);
    driver.says("frame 3");
    simulator.says("command ");
    simulator.kill();
    driver.kill();
    let remains: Vec<Remnant> = files_of("default").into_iter().map(Remnant::of).collect();
    assert!(remains.len() > 20, "{}", remains.len());

    let mut slowest = (Duration::ZERO, String::new());
    for spoilt in &remains {
        for way in WAYS.into_iter().filter(|way| spoilt.bytes.is_some() || *way == "gone") {
            let case = format!("{way}: {}", spoilt.path.display());
            let mut took = start_among(&remains, Some((spoilt, way)), &case);
            // A start that waits for a timeout does so each time, and takes longer than a start among undamaged files.
            let waits = |took| took > 20 * start_among(&remains, None, "whole");
            for attempt in 1.. {
                if took < Duration::from_secs(1) || !waits(took) {
                    break;
                }
                assert!(attempt < 4, "{case}: {took:?}");
                took = start_among(&remains, Some((spoilt, way)), &case);
            }
            if took > slowest.0 {
                slowest = (took, case);
            }
        }
    }
    println!("{} files spoilt in 5 ways; slowest start {slowest:?}", remains.len());
}

/// Restores the files, damages one of them, and starts a simulator, which leaves nothing. Returns the duration of the
/// start.
fn start_among(remains: &[Remnant], spoilt: Option<(&Remnant, &str)>, case: &str) -> Duration {
    remains.iter().for_each(Remnant::restore);
    if let Some((spoilt, way)) = spoilt {
        spoilt.spoil(way);
    }
    let start = Instant::now();
    let mut next = Actor::start("simulate", "default", ROOT, &[]);
    next.says("ready");
    let took = start.elapsed();
    assert!(next.leave().success(), "{case}");
    assert_eq!(files_of("default"), [] as [&Path; 0], "{case}");
    took
}

fn directories_in_the_way() {
    let attempt = || Actor::start("try", "default", ROOT, &[]).says("open ");
    fs::write("/tmp/blvd~0", "").unwrap();
    let told = attempt();
    assert!(told.contains("/tmp/blvd~0") && told.contains("not a directory"), "{told}");
    fs::remove_file("/tmp/blvd~0").unwrap();
    fs::create_dir("/tmp/blvd~0").unwrap();
    fs::write("/tmp/blvd~0/nodes", "").unwrap();
    let told = attempt();
    assert!(told.contains("/tmp/blvd~0/nodes") && told.contains("not a directory"), "{told}");
    fs::remove_file("/tmp/blvd~0/nodes").unwrap();
    assert_eq!(attempt(), "ok");
}
