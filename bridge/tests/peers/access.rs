//! Access to a domain: only its owner has it, or a named group; files that other users put in its place are reported.
//! `users.rs` has several users at the same time.

use std::{
    fs,
    os::unix::{
        fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _, chown, lchown, symlink},
        process::CommandExt as _,
    },
    path::Path,
    process::Command,
    time::Duration,
};

use belvedere_bridge::{Node, StreamSpec, payload::VelocityCommand};

use crate::{
    processes_kit::{self, this_test},
    world::{self, Actor, ROOT, User, files_of, image},
};

const ANNA: User = User { uid: 4001, gid: 4100 };
const BERT: User = User { uid: 4002, gid: 4100 };
const CARL: User = User { uid: 4003, gid: 4003 };
const GROUP: &[(&str, &str)] = &[("BELVEDERE_GROUP", "4100")];

#[test]
fn a_file_of_another_user_is_reported() {
    world::run(64, true, opened_directories);
}

#[test]
fn a_group_shares_a_domain_through_kills_of_either_side() {
    world::run(64, true, a_group);
}

#[test]
fn a_group_shares_many_streams() {
    world::run(64, true, a_group_with_many_streams);
}

#[test]
fn a_directory_that_is_not_the_groups_is_refused() {
    world::run(64, true, directories_of_a_group);
}

#[test]
fn files_are_their_owners_alone() {
    let domain = processes_kit::domain("modes");
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&image("image")).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    let velocity = StreamSpec::velocity_command("cmd_vel");
    let mut commands = node.command_subscriber(&velocity).unwrap();
    let driver = node.publisher(&velocity).unwrap();
    let command = VelocityCommand { linear: [0.0; 3], angular: [0.0; 3] };
    assert!(!subscriber.wait(Duration::from_millis(20)).unwrap());
    let mut frame = publisher.loan(world::LEN).unwrap();
    frame.header_mut().set_packed(64, 48);
    frame.send().unwrap();
    driver.send_structs(0, &[command]).unwrap();
    assert!(subscriber.take().unwrap().is_some() && commands.take().unwrap().is_some());

    let files = files_of(domain.as_str());
    for path in &files {
        let metadata = fs::symlink_metadata(path).unwrap();
        let mode = metadata.permissions().mode() & 0o7777;
        assert_eq!(mode & 0o077, 0, "{} {mode:o}", path.display());
        assert_eq!(metadata.uid(), rustix::process::geteuid().as_raw());
    }
    // The test sees the right files: pools, dynamic parts of streams, connections, sockets, locks, tags.
    for kind in [
        "data",
        "dynamic",
        "connection",
        "event",
        "event_mgmt",
        "service",
        "node_monitor",
        "port_tag",
        "global_mgmt",
    ] {
        let has_it = |path: &&std::path::PathBuf| path.extension().is_some_and(|found| found == kind);
        assert!(files.iter().any(|path| has_it(&path)), "no .{kind} among {files:?}");
    }
    assert!(files.iter().any(|path| fs::symlink_metadata(path).unwrap().file_type().is_socket()));
    // Other users cannot list the root directory either.
    let root = fs::metadata(domain.directory()).unwrap().permissions().mode();
    assert_eq!(root & 0o027, 0, "{root:o}");
}

#[test]
fn an_unknown_group_is_refused() {
    let error = belvedere_bridge::Group::find("no-such-group").unwrap_err().to_string();
    assert!(error.contains("groupadd"), "{error}");
}

/// Returns what a process that tries everything prints about opening the domain.
fn attempt(domain: &str, user: User, env: &[(&str, &str)]) -> String {
    Actor::start("try", domain, user, env).says("open ")
}

fn assert_names(told: &str, parts: &[&str]) {
    assert!(told.starts_with("Permission {"), "{told}");
    for part in parts {
        assert!(told.contains(part), "\"{part}\" is not in: {told}");
    }
}

/// Other users' files in place of the user's own.
fn opened_directories() {
    const PLACE: &str = "/tmp/blvd~4001";
    let remove = format!("sudo rm -r {PLACE}");
    for (owner, name) in [(ROOT, "root (user id 0)"), (CARL, "user id 4003")] {
        fs::create_dir(PLACE).unwrap();
        chown(PLACE, Some(owner.uid), Some(owner.gid)).unwrap();
        for mode in [0o777, 0o750] {
            fs::set_permissions(PLACE, fs::Permissions::from_mode(mode)).unwrap();
            assert_names(&attempt("default", ANNA, &[]), &[PLACE, name, "user id 4001", &remove]);
        }
        // It does not affect other users.
        assert_eq!(attempt("default", BERT, &[]), "ok");
        fs::remove_dir(PLACE).unwrap();
    }
    fs::create_dir(PLACE).unwrap();
    chown(PLACE, Some(ANNA.uid), Some(ANNA.gid)).unwrap();
    fs::set_permissions(PLACE, fs::Permissions::from_mode(0o777)).unwrap();
    assert_names(&attempt("default", ANNA, &[]), &[PLACE, "others may write in it", "chmod 750"]);
    fs::remove_dir(PLACE).unwrap();
    // A link made by another user is refused, even if it leads to a directory of one's own.
    fs::create_dir("/tmp/of-anna").unwrap();
    chown("/tmp/of-anna", Some(ANNA.uid), Some(ANNA.gid)).unwrap();
    symlink("/tmp/of-anna", PLACE).unwrap();
    lchown(PLACE, Some(CARL.uid), Some(CARL.gid)).unwrap();
    assert_names(&attempt("default", ANNA, &[]), &[PLACE, "user id 4003"]);
    fs::remove_file(PLACE).unwrap();
    // A file with the name of one of Anna's files.
    let file = "/dev/shm/blvd.default~4001.1.data";
    fs::write(file, "forged").unwrap();
    chown(file, Some(CARL.uid), Some(CARL.gid)).unwrap();
    assert_names(&attempt("default", ANNA, &[]), &[file, "user id 4003", "choose another domain"]);
    assert_eq!(attempt("another", ANNA, &[]), "ok");
    fs::remove_file(file).unwrap();
    assert_eq!(attempt("default", ANNA, &[]), "ok");
}

fn a_group() {
    let mut anna = Actor::start("simulate", "default", ANNA, GROUP);
    anna.says("ready");
    let mut bert = Actor::start("drive", "default", BERT, GROUP);
    // Frames and commands arrive.
    bert.says("frame 5");
    anna.says("command 3");

    // Notifications arrive, too: a subscriber that only polled ten times a second would miss most frames.
    let missed: u32 = bert.says("frame 60 missed").parse().unwrap();
    assert!(missed < 30, "{missed} missed");

    // A user outside the group is refused with the group, alone without it, and cannot open the files.
    let told = attempt("default", CARL, GROUP);
    assert!(
        told.starts_with("InvalidGroup") && told.contains("user id 4003") && told.contains("usermod"),
        "{told}"
    );
    let mut carl = Actor::start("try", "default", CARL, &[]);
    assert_eq!(
        (carl.says("open "), carl.says("streams "), carl.says("wait ")),
        ("ok".into(), "0".into(), "false".into())
    );
    let files = files_of("default");
    for path in files.iter().filter(|path| path.to_string_lossy().contains('@')) {
        let found = fs::symlink_metadata(path).unwrap();
        assert_eq!((found.gid(), found.mode() & 0o007), (4100, 0), "{} {:o}", path.display(), found.mode());
        let reading = Command::new("cat").arg(path).uid(CARL.uid).gid(CARL.gid).output().unwrap();
        assert!(!reading.status.success(), "{} is not shut to others", path.display());
    }
    assert!(files.iter().any(|path| path.extension().is_some_and(|kind| kind == "connection")));

    // A member by a supplementary group, as usual.
    let by_supplement = Command::new("setpriv")
        .args([
            "--reuid=4005",
            "--regid=4005",
            "--groups=4100",
            world::PROGRAM,
            "--exact",
            &this_test(),
            "--nocapture",
        ])
        .envs([(world::ROLE, "try"), ("BELVEDERE_DOMAIN", "default"), GROUP[0]])
        .output()
        .expect("setpriv, which comes with unshare");
    let text = String::from_utf8_lossy(&by_supplement.stdout).into_owned();
    assert!(text.contains("open ok") && text.contains("wait true"), "{text}");
    assert!(text.contains("DomainInUse") && text.contains("\"simulator\""), "{text}");
    assert!(text.contains(&format!("process {}", anna.pid())), "{text}");

    for life in 0..6 {
        // The consumer is killed: the next one continues.
        bert.kill();
        bert = Actor::start("drive", "default", BERT, GROUP);
        bert.says("frame 5");
        anna.forget();
        anna.says("command ");
        // The simulator is killed: the consumer continues with the next one.
        anna.kill();
        anna = Actor::start("simulate", "default", ANNA, GROUP);
        anna.says("ready");
        let restarted = bert.says_containing("restarted");
        assert!(restarted.starts_with("frame"), "{life}: {restarted}");
        anna.says("command ");
    }
    // Both are killed and restarted, in both orders.
    bert.kill();
    anna.kill();
    bert = Actor::start("drive", "default", BERT, GROUP);
    bert.says("ready");
    anna = Actor::start("simulate", "default", ANNA, GROUP);
    bert.says("frame 5");
    anna.says("command ");
    // The consumer has created the stream of commands, and has gone when the simulator, the last process in it, is
    // killed.
    bert.kill();
    anna.kill();
    bert = Actor::start("drive", "default", BERT, &[GROUP[0], ("DRIVER_FIRST", "yes")]);
    bert.says("ready");
    anna = Actor::start("simulate", "default", ANNA, GROUP);
    anna.says("command ");
    assert!(bert.leave().success());
    anna.kill();
    anna = Actor::start("simulate", "default", ANNA, GROUP);
    bert = Actor::start("drive", "default", BERT, GROUP);
    bert.says("frame 5");
    anna.says("command ");
    // Each of them leaves first once.
    assert!(anna.leave().success());
    anna = Actor::start("simulate", "default", ANNA, GROUP);
    bert.says_containing("restarted");
    assert!(bert.leave().success());
    bert = Actor::start("drive", "default", BERT, GROUP);
    bert.says("frame 5");
    assert!(bert.leave().success());
    assert!(anna.leave().success());

    // The next start of each user removes what the other user could not.
    std::thread::sleep(Duration::from_millis(1100));
    for user in [ANNA, BERT, User { uid: 4005, gid: 4100 }] {
        assert!(Actor::start("simulate", "default", user, GROUP).leave().success());
    }
    assert_eq!(files_of("default"), [] as [&Path; 0]);
}

fn a_group_with_many_streams() {
    let dora = User { uid: 4004, gid: 4100 };
    let mut watchers = [BERT, dora].map(|user| Actor::start("watch_many", "default", user, GROUP));
    for watcher in &mut watchers {
        watcher.says("ready");
    }
    for life in 1..=3 {
        let mut anna = Actor::start("simulate_many", "default", ANNA, GROUP);
        anna.says("ready");
        for watcher in &mut watchers {
            watcher.says(&format!("all {life}"));
        }
        if life == 2 {
            anna.kill();
        } else {
            assert!(anna.leave().success());
        }
    }
    // All users join and leave at the same time.
    let users = [ANNA, BERT, dora, ANNA, BERT, dora];
    let mut restless = users.map(|user| Actor::start("join_often", "default", user, GROUP));
    for actor in &mut restless {
        actor.says("done");
    }
    // A process that exits normally leaves no connection, even if the last process that used it could not remove it.
    for watcher in watchers {
        assert!(watcher.leave().success());
    }
    let left = files_of("default");
    assert!(!left.iter().any(|path| path.extension().is_some_and(|kind| kind == "connection")), "{left:?}");
}

fn directories_of_a_group() {
    // Created by a user outside the group, who cannot give it to the group.
    let squat = |mode: u32, gid: u32| {
        let _ = fs::remove_dir_all("/tmp/blvd-4100");
        fs::create_dir("/tmp/blvd-4100").unwrap();
        chown("/tmp/blvd-4100", Some(CARL.uid), Some(gid)).unwrap();
        fs::set_permissions("/tmp/blvd-4100", fs::Permissions::from_mode(mode)).unwrap();
    };
    for (mode, gid) in [(0o777, CARL.gid), (0o2777, 4100), (0o700, 4100)] {
        squat(mode, gid);
        assert_names(&attempt("default", ANNA, GROUP), &["/tmp/blvd-4100", "user id 4003", "chgrp 4100"]);
    }
    // Links are not followed.
    fs::remove_dir_all("/tmp/blvd-4100").unwrap();
    symlink("/tmp", "/tmp/blvd-4100").unwrap();
    assert_names(&attempt("default", ANNA, GROUP), &["/tmp/blvd-4100"]);
    // A directory that an administrator created beforehand is used.
    fs::remove_file("/tmp/blvd-4100").unwrap();
    squat(0o2770, 4100);
    assert_eq!(attempt("default", ANNA, GROUP), "ok");

    // A link that a member creates in the group's directory does not open its target.
    let private = "/tmp/private";
    fs::write(private, "secret").unwrap();
    chown(private, Some(ANNA.uid), Some(ANNA.gid)).unwrap();
    fs::set_permissions(private, fs::Permissions::from_mode(0o600)).unwrap();
    let mut anna = Actor::start("simulate", "default", ANNA, GROUP);
    anna.says("ready");
    symlink(private, "/tmp/blvd-4100/blvd.default@4100.link").unwrap();
    symlink(private, "/dev/shm/blvd.default@4100.link").unwrap();
    fs::hard_link(private, "/tmp/blvd-4100/blvd.default@4100.hard").unwrap();
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(fs::metadata(private).unwrap().mode() & 0o777, 0o600);
    assert!(anna.leave().success());
}
