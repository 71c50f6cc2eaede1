//! What killed processes left, spoilt since in every way: the next start works, soon, and leaves nothing.

mod world;

use std::{
    fs,
    os::unix::{
        fs::{FileTypeExt as _, PermissionsExt as _},
        net::UnixDatagram,
    },
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use world::{Actor, PATIENCE, ROOT, files_of};

#[test]
fn in_a_role() {
    world::play();
}

#[test]
fn in_the_world() {
    match world::scenario().as_deref() {
        Some("spoilt_remains") => spoilt_remains(),
        Some("directories_in_the_way") => directories_in_the_way(),
        Some(other) => panic!("{other}"),
        None => {}
    }
}

#[test]
fn spoilt_remains_do_not_hinder_the_next_start() {
    world::run("spoilt_remains", 64, false);
}

#[test]
fn what_lies_where_directories_belong_is_named() {
    world::run("directories_in_the_way", 64, false);
}

/// A file as it was left.
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
}

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

    let garbage = |len: usize| (0..len).map(|index| (index * 151 + 89) as u8).collect::<Vec<u8>>();
    let mut slowest = (Duration::ZERO, String::new());
    for spoilt in &remains {
        let path = &spoilt.path;
        for way in ["gone", "empty", "cut", "overwritten", "replaced"] {
            for remnant in &remains {
                remnant.restore();
            }
            let len = spoilt.bytes.as_ref().map_or(0, Vec::len);
            fs::set_permissions(path, fs::Permissions::from_mode(0o600)).unwrap();
            match way {
                "gone" => fs::remove_file(path).unwrap(),
                _ if spoilt.bytes.is_none() => continue,
                "empty" => fs::write(path, []).unwrap(),
                "cut" => fs::write(path, &spoilt.bytes.as_ref().unwrap()[..len / 2]).unwrap(),
                "overwritten" => fs::write(path, garbage(len)).unwrap(),
                _ => fs::write(path, garbage(100_000)).unwrap(),
            }
            if way != "gone" {
                fs::set_permissions(path, spoilt.permissions.clone()).unwrap();
            }
            let start = Instant::now();
            let mut next = Actor::start("simulate", "default", ROOT, &[]);
            next.says("ready");
            let case = format!("{way}: {}", path.display());
            if start.elapsed() > slowest.0 {
                slowest = (start.elapsed(), case.clone());
            }
            assert!(next.leave().success(), "{case}");
            assert_eq!(files_of("default"), [] as [&Path; 0], "{case}");
        }
    }
    println!("{} files spoilt in 5 ways; slowest start {slowest:?}", remains.len());
    assert!(slowest.0 < Duration::from_secs(3), "{slowest:?}");
}

fn directories_in_the_way() {
    let attempt = || {
        let start = Instant::now();
        let told = Actor::start("try", "default", ROOT, &[]).says("open ");
        assert!(start.elapsed() < PATIENCE / 2);
        told
    };
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
