//! No file breaks a parser, whatever it contains. For each format, mutations of small files are read, and all inputs
//! of `corpus/`, which once failed. None may cause a panic, an abort, a request for more than a gigabyte, or much
//! processor time; and the time grows in proportion to the size of the file.
//!
//! Each format is read by a process of its own, so that a test outlives what it reads. `BELVEDERE_FUZZ_SECONDS` is the
//! time that is spent on mutations of each format (20 with `BELVEDERE_FULL=1`), and `BELVEDERE_SEED` selects other ones.
//! An input that fails is written into `target/fuzz`; once the fault is mended, it belongs into `corpus/`.

mod binary;
mod documents;
mod formats;
mod growth;
mod mutate;
mod random;

use formats::Format;
use random::Random;
use rustix::process::{Resource, Rlimit, setrlimit};
use std::collections::{HashSet, hash_map::DefaultHasher};
use std::hash::Hasher as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Names the format that a child process reads.
const ROLE: &str = "BELVEDERE_FUZZ_FORMAT";
/// The folder that the child works in.
const FOLDER: &str = "BELVEDERE_FUZZ_FOLDER";
/// Mutations of each format, if no time is set.
const FEW: u64 = 200;
/// Address space of a child, bytes.
const MEMORY: u64 = 1 << 30;
/// Processor time that one input may take in a dev build, seconds. Most take less than a millisecond.
const SECONDS: u64 = 10;
/// The beginning of a line in which a child reports a fault.
const FAULT: &str = "FAULT ";

/// The last panic of this process: its place and message.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

macro_rules! formats {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            test(stringify!($name));
        }
    )*
    #[test]
    fn each_format_has_a_test() {
        let names: Vec<_> = formats::ALL.iter().map(|format| format.name).collect();
        assert_eq!(names, [$(stringify!($name)),*]);
    }};
}
formats! { xacro yaml urdf sdf collada obj mtl stl ply gltf glb png jpeg tga bmp dds material mcap plan }

fn test(name: &str) {
    let format = formats::ALL.iter().find(|format| format.name == name).unwrap();
    if std::env::var(ROLE).is_ok_and(|role| role == name) {
        read_in_child(format);
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--nocapture", "--test-threads=1"])
        .env(ROLE, name)
        .env(FOLDER, folder.path())
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let mut faults: Vec<String> =
        said.lines().filter_map(|line| line.strip_prefix(FAULT)).map(str::to_owned).collect();
    for line in said.lines().filter(|line| line.starts_with("READ ")) {
        println!("{line}");
    }
    let seed = String::from_utf8_lossy(&output.stderr);
    if let Some(seed) = seed.lines().find(|line| line.starts_with("BELVEDERE_SEED=")) {
        println!("{seed}");
    }
    // The child ends with 1 if it has reported its faults. Anything else ended it early, perhaps after faults.
    if !output.status.success() && (faults.is_empty() || output.status.code() != Some(1)) {
        let kept = keep(format, &folder.path().join(format.file));
        let last = String::from_utf8_lossy(&output.stderr);
        let last: Vec<_> = said.lines().chain(last.lines()).rev().take(3).collect();
        faults.push(format!("{}: {last:?}: {}", output.status, kept.display()));
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Copies an input that failed into `target/fuzz`.
fn keep(format: &Format, input: &Path) -> PathBuf {
    let bytes = std::fs::read(input).unwrap_or_default();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("fuzz").join(format.name);
    std::fs::create_dir_all(&folder).unwrap();
    let kept = folder.join(format!("{:016x}", hash(&bytes)));
    std::fs::write(&kept, bytes).unwrap();
    kept
}

fn hash(value: &(impl std::hash::Hash + ?Sized)) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// Reads inputs of one format until the time or the number of mutations is reached, and prints the faults.
fn read_in_child(format: &Format) {
    // The harness has begun a line.
    println!();
    std::panic::set_hook(Box::new(|panic| {
        *PANIC.lock().unwrap() = Some(panic.to_string().replace('\n', " "));
    }));
    let limit = Rlimit { current: Some(MEMORY), maximum: Some(MEMORY) };
    setrlimit(Resource::As, limit).unwrap();
    let mut reader = Reader::new(format, Path::new(&std::env::var_os(FOLDER).unwrap()));
    let mut pool = (format.seeds)();
    for seed in &pool {
        reader.read(seed);
    }
    // What once failed is no good beginning: it is large, or takes long.
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(format.name);
    let mut kept: Vec<PathBuf> =
        std::fs::read_dir(corpus).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
    kept.sort();
    for path in kept {
        reader.read(&std::fs::read(path).unwrap());
    }
    let is_full = std::env::var_os("BELVEDERE_FULL").is_some_and(|full| full == "1");
    let seconds = match std::env::var("BELVEDERE_FUZZ_SECONDS") {
        Ok(seconds) => Some(seconds.parse().expect("a number of seconds")),
        Err(_) => is_full.then_some(20),
    };
    let mut random = Random::new();
    let (start, mut count) = (Instant::now(), 0);
    while seconds.map_or(count < FEW, |seconds| start.elapsed() < Duration::from_secs(seconds)) {
        let input = mutate::mutate(&mut random, &pool, format);
        count += 1;
        // What causes a message that no other input caused is mutated further.
        if reader.read(&input) && pool.len() < 5000 {
            pool.push(input);
        }
    }
    growth::check(&mut reader, is_full || seconds.is_some());
    println!("READ {}: {count} inputs, {} kept, slowest {:?}", format.name, pool.len(), reader.slowest);
    std::process::exit(i32::from(!reader.faults.is_empty()));
}

/// Reads inputs and collects faults.
struct Reader<'f> {
    format: &'f Format,
    path: PathBuf,
    messages: HashSet<u64>,
    faults: HashSet<String>,
    slowest: Duration,
}

impl<'f> Reader<'f> {
    fn new(format: &'f Format, folder: &Path) -> Self {
        (format.beside)(folder);
        let path = folder.join(format.file);
        Self { format, path, messages: HashSet::new(), faults: HashSet::new(), slowest: Duration::ZERO }
    }

    /// Reads an input; true if its messages are new.
    fn read(&mut self, input: &[u8]) -> bool {
        std::fs::write(&self.path, input).unwrap();
        let start = processor_time();
        // The signal ends this process if an input takes for ever.
        let end = Rlimit { current: Some(start.as_secs() + SECONDS + 1), maximum: None };
        setrlimit(Resource::Cpu, end).unwrap();
        let messages = catch_unwind(AssertUnwindSafe(|| (self.format.read)(&self.path)));
        let taken = processor_time().saturating_sub(start);
        if input.len() <= mutate::LARGEST {
            self.slowest = self.slowest.max(taken);
        }
        let Ok(messages) = messages else {
            let panic = PANIC.lock().unwrap().take().unwrap_or_default();
            // One input for each place is enough.
            let place: String = panic.split(": ").next().unwrap_or_default().into();
            self.fault(&place, &panic);
            return false;
        };
        if taken > Duration::from_secs(SECONDS) {
            self.fault("time", &format!("{taken:?} of processor time"));
        }
        let mut is_new = false;
        for message in messages {
            let shape: String = message.chars().filter(char::is_ascii_alphabetic).collect();
            is_new |= self.messages.len() < 20_000 && self.messages.insert(hash(&shape));
        }
        is_new
    }

    fn fault(&mut self, kind: &str, what: &str) {
        if self.faults.len() < 50 && self.faults.insert(kind.to_owned()) {
            println!("{FAULT}{}: {}", what.escape_debug(), keep(self.format, &self.path).display());
        }
    }
}

/// Processor time of this process so far.
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
