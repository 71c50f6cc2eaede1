//! Processes of several users in mount namespaces with their own `/tmp` and `/dev/shm`.
//!
//! A test starts its program again as the same test: [`run`] in a new mount namespace, and [`Actor`]s in a role as any
//! user. Users need no entry in `/etc/passwd`; their ids suffice.

#![allow(dead_code, unreachable_pub, reason = "each test program uses a part of it")]

use std::{
    fs,
    io::{BufRead as _, BufReader},
    os::unix::process::CommandExt as _,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    sync::mpsc::{Receiver, channel},
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec, payload::VelocityCommand};

use crate::processes_kit::{PATIENCE, skip, this_test};

const WORLD: &str = "BRIDGE_WORLD";
pub const ROLE: &str = "BRIDGE_ROLE";
/// The path of the copy of this program in the namespace: the original may be in a directory that is hidden there, or
/// closed to other users.
pub const PROGRAM: &str = "/mnt/program";

/// A user and its only group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct User {
    pub uid: u32,
    pub gid: u32,
}

/// The user who runs the test; root in scenarios with other users.
pub const ROOT: User = User { uid: 0, gid: 0 };

/// Runs the rest of a test in a mount namespace with a `/dev/shm` of this many MiB, and forwards its output. Without
/// root it uses a user namespace, or skips the test if the scenario has other users.
pub fn run(shm_mib: u32, other_users: bool, scenario: impl FnOnce()) {
    play();
    if is_here() {
        return scenario();
    }
    let is_root = rustix::process::geteuid().is_root();
    if other_users && !is_root {
        return skip("processes of several users need root");
    }
    let set_up = format!(
        "mount -t tmpfs tmpfs /mnt && cp \"$0\" {PROGRAM} && chmod 755 /mnt {PROGRAM} && \
         mount -t tmpfs -o mode=1777 tmpfs /tmp && mount -t tmpfs -o mode=1777,size={shm_mib}m tmpfs /dev/shm && \
         exec {PROGRAM} --exact {} --nocapture",
        this_test()
    );
    let output = Command::new("unshare")
        .args(if is_root { ["--mount", "--propagation=private"] } else { ["--mount", "--map-root-user"] })
        .args(["sh", "-c", &set_up])
        .arg(std::env::current_exe().unwrap())
        .env(WORLD, "1")
        .output();
    let output = match output {
        Ok(output) => output,
        Err(error) => return skip(format_args!("unshare cannot be run: {error}")),
    };
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    if !is_root && !text.contains("running 1 test") {
        return skip(format_args!("this user may not make a user namespace: {text}"));
    }
    println!("{text}");
    assert!(output.status.success(), "{text}");
}

/// Returns true if this process is in such a namespace.
fn is_here() -> bool {
    std::env::var_os(WORLD).is_some()
}

/// A process in a role, with the lines of its output.
pub struct Actor {
    child: Child,
    lines: Receiver<String>,
    seen: Vec<String>,
}

impl Actor {
    /// Starts `role` (see [`play`]) in `domain` as `user`, or as the current user if that is [`ROOT`], with additional
    /// environment variables.
    pub fn start(role: &str, domain: &str, user: User, env: &[(&str, &str)]) -> Self {
        assert!(
            std::env::var_os(ROLE).is_none(),
            "the test does not begin with `play`: it would start itself for ever"
        );
        let program = if is_here() { PathBuf::from(PROGRAM) } else { std::env::current_exe().unwrap() };
        let mut command = Command::new(program);
        command
            .args(["--exact", &this_test(), "--nocapture"])
            .env(ROLE, role)
            .env("BELVEDERE_DOMAIN", domain)
            .env_remove("BELVEDERE_GROUP")
            .envs(env.iter().copied())
            .current_dir("/")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit());
        if user != ROOT {
            // This also drops supplementary groups.
            command.uid(user.uid).gid(user.gid);
        }
        let mut child = command.spawn().unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self { child, lines, seen: Vec::new() }
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the next line with this beginning and returns the rest of the line.
    pub fn says(&mut self, beginning: &str) -> String {
        let deadline = Instant::now() + PATIENCE;
        while let Ok(line) = self.lines.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            if let Some(rest) = line.strip_prefix(beginning) {
                return rest.trim().to_owned();
            }
            self.seen.push(line);
        }
        panic!("\"{beginning}\" was never said, but: {:#?}", self.seen);
    }

    /// Waits for the next line that contains a word.
    pub fn says_containing(&mut self, word: &str) -> String {
        loop {
            let line = self.says("");
            if line.contains(word) {
                return line;
            }
        }
    }

    /// Returns true if a line with this word has arrived.
    pub fn has_said(&mut self, word: &str) -> bool {
        self.seen.extend(self.lines.try_iter());
        self.seen.iter().any(|line| line.contains(word))
    }

    /// Discards the output until now.
    pub fn forget(&mut self) {
        while self.lines.try_recv().is_ok() {}
    }

    /// Kills the process with SIGKILL and reaps it.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Closes its input, which asks it to exit, and waits.
    pub fn leave(mut self) -> ExitStatus {
        drop(self.child.stdin.take());
        self.child.wait().unwrap()
    }
}

impl Drop for Actor {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub const LEN: usize = 64 * 48;

pub fn image(topic: &str) -> StreamSpec {
    StreamSpec::new(topic, Kind::Image, Encoding::Mono8, LEN).rate_hz(100.0)
}

/// Plays its role until its input ends, and exits, in a process that [`Actor::start`] has started. Does nothing in the
/// test itself.
pub fn play() {
    let Ok(role) = std::env::var(ROLE) else { return };
    match role.as_str() {
        "simulate" => simulate(),
        "simulate_large" => simulate_large(),
        "drive" => drive(),
        "join_often" => join_often(),
        "simulate_many" => simulate_many(),
        "watch_many" => watch_many(),
        "try" => try_everything(),
        _ => panic!("no such role: {role}"),
    }
    std::process::exit(0);
}

fn asked_to_leave() -> Receiver<()> {
    let (sender, left) = channel::<()>();
    std::thread::spawn(move || {
        let _ = std::io::stdin().lines().count();
        drop(sender);
    });
    left
}

fn goes_on(left: &Receiver<()>) -> bool {
    left.try_recv() == Err(std::sync::mpsc::TryRecvError::Empty)
}

/// Publishes images, and prints each new command.
fn simulate() {
    let left = asked_to_leave();
    let node = Node::open(&Domain::from_env().unwrap(), "simulator").unwrap();
    let publisher = node.publisher(&image("image_raw")).unwrap();
    let mut commands = node.command_subscriber(&StreamSpec::velocity_command("cmd_vel")).unwrap();
    println!("\nready");
    let mut last = 0.0;
    while goes_on(&left) {
        let mut frame = publisher.loan(LEN).unwrap();
        frame.header_mut().set_packed(64, 48);
        frame.payload_mut().fill(7);
        frame.send().unwrap();
        if let Some(frame) = commands.take_newest().unwrap() {
            let command: VelocityCommand = frame.message().unwrap();
            if command.linear[0] != last {
                last = command.linear[0];
                println!("command {last}");
            }
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Joins and leaves repeatedly.
fn join_often() {
    for count in 0..40 {
        let node = Node::open(&Domain::from_env().unwrap(), "restless").unwrap();
        if count % 4 == 0 {
            assert!(!node.subscriber("image_raw").unwrap().wait(Duration::ZERO).unwrap());
        }
    }
    println!("\ndone");
}

const MANY: usize = 12;

/// Publishes on many streams.
fn simulate_many() {
    let left = asked_to_leave();
    let node = Node::open(&Domain::from_env().unwrap(), "simulator").unwrap();
    let publishers: Vec<_> =
        (0..MANY).map(|index| node.publisher(&image(&format!("image_{index}"))).unwrap()).collect();
    println!("\nready");
    while goes_on(&left) {
        for publisher in &publishers {
            let mut frame = publisher.loan(LEN).unwrap();
            frame.header_mut().set_packed(64, 48);
            frame.send().unwrap();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Prints when frames of all streams have arrived, after each start of the simulator.
fn watch_many() {
    let left = asked_to_leave();
    let node = Node::open(&Domain::from_env().unwrap(), "watcher").unwrap();
    let mut cameras: Vec<_> =
        (0..MANY).map(|index| node.subscriber(&format!("image_{index}")).unwrap()).collect();
    println!("\nready");
    let mut sessions = [0; MANY];
    let mut last_said = 0;
    while goes_on(&left) {
        for (camera, session) in cameras.iter_mut().zip(&mut sessions) {
            while let Some(frame) = camera.take().unwrap() {
                // The publishers of one simulator start together and are counted per start.
                if frame.header().session != *session {
                    *session = frame.header().session;
                    last_said += 1;
                    if last_said % MANY == 0 {
                        println!("all {}", last_said / MANY);
                    }
                }
            }
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Prints whether a stream of large images can be opened.
fn simulate_large() {
    let node = Node::open(&Domain::from_env().unwrap(), "simulator").unwrap();
    match node.publisher(&StreamSpec::new("image_raw", Kind::Image, Encoding::Rgb8, 640 * 480 * 3)) {
        Ok(_) => println!("\nready"),
        Err(error) => println!("\nerror {error}"),
    }
}

/// Prints how many images have arrived and were missed, and sends the former number as a command. With `DRIVER_FIRST`
/// it creates the stream of commands, unless the simulator has.
fn drive() {
    let left = asked_to_leave();
    let node = Node::open(&Domain::from_env().unwrap(), "driver").unwrap();
    let mut camera = node.subscriber("image_raw").unwrap();
    let commands = || node.publisher(&StreamSpec::velocity_command("cmd_vel")).unwrap();
    let mut driver = std::env::var_os("DRIVER_FIRST").map(|_| commands());
    let mut count = 0;
    println!("\nready");
    while goes_on(&left) {
        if !camera.wait(Duration::from_millis(50)).unwrap() {
            continue;
        }
        if let Some(frame) = camera.take().unwrap() {
            assert_eq!(frame.payload(), [7; LEN]);
            count += 1;
            let restarted = if frame.restarted() { "restarted" } else { "" };
            println!("frame {count} missed {} {restarted}", camera.missed_total());
            let driver = driver.get_or_insert_with(commands);
            let command = VelocityCommand { linear: [f64::from(count), 0.0, 0.0], angular: [0.0; 3] };
            driver.send_structs(0, &[command]).unwrap();
        }
    }
}

/// Tries each operation in a domain and prints the results.
fn try_everything() {
    let domain = Domain::from_env().unwrap();
    let node = match Node::open(&domain, "curious") {
        Ok(node) => node,
        Err(error) => {
            println!("\nopen {error:?} | {error}");
            return;
        }
    };
    println!("\nopen ok");
    let said = |result: Result<String, belvedere_bridge::Error>| match result {
        Ok(text) => text,
        Err(error) => format!("{error:?} | {error}"),
    };
    println!("streams {}", said(node.streams().map(|streams| format!("{}", streams.len()))));
    let mut subscriber = node.subscriber("image_raw").unwrap();
    println!("wait {}", said(subscriber.wait(Duration::from_secs(2)).map(|frame| frame.to_string())));
    println!("publish {}", said(node.publisher(&image("image_raw")).map(|_| "ok".to_owned())));
    println!("done");
}

/// Returns every file whose name contains that of a domain, including those in the directories of nodes.
pub fn files_of(domain: &str) -> Vec<PathBuf> {
    fn walk(directory: &Path, beginnings: &[String; 2], found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
            let (name, path) = (entry.file_name(), entry.path());
            if beginnings.iter().any(|beginning| name.to_string_lossy().starts_with(beginning)) {
                found.push(path);
            } else if path.is_dir() && !path.is_symlink() {
                walk(&path, beginnings, found);
            }
        }
    }
    let mut found = Vec::new();
    let beginnings = [format!("blvd.{domain}~"), format!("blvd.{domain}@")];
    let tmp = fs::read_dir("/tmp").unwrap().flatten().map(|entry| entry.path()).filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("blvd~") || name.starts_with("blvd-")
    });
    for directory in tmp.chain([PathBuf::from("/dev/shm")]) {
        walk(&directory, &beginnings, &mut found);
    }
    found
}
