//! A simulator in another process, started and stopped by a test.
#![allow(dead_code, reason = "each test binary uses its own part of this")]

pub(crate) mod control;
pub(crate) mod terminal;

use belvedere_bridge::{Domain, Frame, Node, Subscriber};
use rustix::process::{Pid, Signal, kill_process};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// The longest wait for something that should be quick, on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// The simulator's command, with an environment that does not depend on the tester's.
pub(crate) fn belvedere() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_belvedere"));
    for variable in [
        "TURTLEBOT_BASE",
        "TURTLEBOT_STACKS",
        "TURTLEBOT_3D_SENSOR",
        "TURTLEBOT_GAZEBO_WORLD_FILE",
        "ROS_PACKAGE_PATH",
        "GAZEBO_MODEL_PATH",
        "BELVEDERE_DOMAIN",
        "BELVEDERE_MODELS",
        "RUST_LOG",
    ] {
        command.env_remove(variable);
    }
    command.stdin(Stdio::null());
    command
}

/// Runs the simulator to its end.
pub(crate) fn output(arguments: &[&str]) -> Output {
    belvedere().args(arguments).output().expect("the simulator's binary runs")
}

/// Runs the program with standard output that nobody reads. Returns its exit code and standard error.
pub(crate) fn with_closed_output(arguments: &[&str]) -> (Option<i32>, String) {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = belvedere().args(arguments).stdout(writer).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Returns a domain that no other test uses.
pub(crate) fn own_domain() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    format!("test-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// A running simulator, which is stopped when dropped.
pub(crate) struct Simulator {
    child: Child,
    domain: String,
}

impl Simulator {
    /// Starts `belvedere run` with these arguments in its own domain.
    pub(crate) fn start(arguments: &[&str]) -> Self {
        Self::start_in(own_domain(), arguments)
    }

    /// Starts it in the given domain.
    pub(crate) fn start_in(domain: String, arguments: &[&str]) -> Self {
        let child = belvedere()
            .args(["run", "--domain", &domain])
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the simulator's binary runs");
        Self { child, domain }
    }

    pub(crate) fn domain(&self) -> &str {
        &self.domain
    }

    /// A node of the test in the simulator's domain.
    pub(crate) fn node(&self) -> Node {
        Node::open(&Domain::new(&self.domain).unwrap(), "test").unwrap()
    }

    /// A subscriber in the simulator's domain.
    pub(crate) fn subscribe(&self, topic: &str) -> Subscriber {
        self.node().subscriber(topic).unwrap()
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.child), signal).expect("the simulator runs");
    }

    /// Kills it with SIGKILL, so that it cannot clean up, and returns its domain.
    pub(crate) fn kill(mut self) -> String {
        self.signal(Signal::KILL);
        self.child.wait().unwrap();
        self.domain.clone()
    }

    /// Sends Ctrl-C and waits for the end.
    pub(crate) fn interrupt(mut self) -> ExitStatus {
        self.signal(Signal::INT);
        let started = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(started.elapsed() < PATIENCE, "the simulator does not end");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        if let Ok(None) = self.child.try_wait() {
            let _ = kill_process(Pid::from_child(&self.child), Signal::INT);
            let _ = self.child.wait();
        }
    }
}

/// Creates subscribers of a consumer with this name, and waits until they have found their publishers.
pub(crate) fn follow(domain: &str, name: &str, topics: &[&str]) -> Vec<Subscriber> {
    let node = Node::open(&Domain::new(domain).unwrap(), name).unwrap();
    let mut subscribers: Vec<_> = topics.iter().map(|topic| node.subscriber(topic).unwrap()).collect();
    let started = Instant::now();
    for subscriber in &mut subscribers {
        while subscriber.publishers() == 0 {
            subscriber.wait(Duration::from_millis(10)).unwrap();
            assert!(started.elapsed() < PATIENCE, "{} is not published", subscriber.topic());
        }
    }
    subscribers
}

/// The next frame of a stream.
pub(crate) fn next_frame(subscriber: &mut Subscriber) -> Frame {
    let started = Instant::now();
    loop {
        if let Some(frame) = subscriber.take().unwrap() {
            return frame;
        }
        assert!(started.elapsed() < PATIENCE, "{} sends nothing", subscriber.topic());
        subscriber.wait(Duration::from_millis(100)).unwrap();
    }
}

/// The existing files of a domain.
pub(crate) fn files_of(domain: &str) -> Vec<String> {
    let domain = Domain::new(domain).unwrap();
    let marker = domain.prefix();
    let mut found = Vec::new();
    let mut folders = vec![Path::new("/dev/shm").to_path_buf(), domain.directory()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.to_string_lossy().contains(&marker) {
                found.push(path.display().to_string());
            }
            if path.is_dir() {
                folders.push(path);
            }
        }
    }
    found
}
