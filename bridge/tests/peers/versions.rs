//! Peers of other versions: errors name both versions.

use std::{
    fs::File,
    io::{BufRead as _, BufReader},
    os::unix::fs::FileExt as _,
    path::PathBuf,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Encoding, Error, Kind, Node, StreamSpec};
use iceoryx2::prelude::*;

use crate::processes_kit::{PATIENCE, domain, plain, skip};

/// A header of the next schema.
#[derive(Debug, Clone, Copy, ZeroCopySend)]
#[repr(C)]
#[repr(align(64))]
#[type_name("belvedere.FrameHeader.v3")]
struct NextHeader([u64; 32]);

/// A header with the same name and another size.
#[derive(Debug, Clone, Copy, ZeroCopySend)]
#[repr(C)]
#[repr(align(64))]
#[type_name("belvedere.FrameHeader.v2")]
struct ShortHeader([u64; 16]);

fn spec() -> StreamSpec {
    StreamSpec::new("image_raw", Kind::Image, Encoding::Mono8, 64)
}

/// Returns the errors of reading and publishing a stream that another program has created.
fn told(domain: &Domain) -> String {
    let start = Instant::now();
    let node = Node::open(domain, "test").unwrap();
    let reading = node.subscriber("image_raw").unwrap().wait(Duration::from_millis(100)).unwrap_err();
    let publishing = node.publisher(&spec()).unwrap_err();
    for error in [&reading, &publishing] {
        assert!(matches!(error, Error::Incompatible { .. }), "{error:?}");
    }
    assert_eq!(reading.to_string(), publishing.to_string());
    assert!(start.elapsed() < PATIENCE, "neither waits for another version to come");
    reading.to_string()
}

fn foreign_stream<H: ZeroCopySend + std::fmt::Debug>(domain: &Domain) -> impl Sized {
    let builder = plain::node(domain).service_builder(&plain::service("image_raw"));
    builder.publish_subscribe::<[u8]>().user_header::<H>().create().unwrap()
}

#[test]
fn an_incompatible_header_is_named() {
    let next = domain("next");
    let stream = foreign_stream::<NextHeader>(&next);
    let text = told(&next);
    assert!(text.contains("belvedere.FrameHeader.v3 of 256 bytes"), "{text}");
    assert!(text.contains("belvedere.FrameHeader.v2 of 384 bytes"), "{text}");
    drop(stream);
    // A plain iceoryx2 node leaves its counter; the last node of the bridge removes it.
    drop(Node::open(&next, "last").unwrap());

    let short = domain("short");
    let stream = foreign_stream::<ShortHeader>(&short);
    let text = told(&short);
    assert!(text.contains("belvedere.FrameHeader.v2 of 128 bytes"), "{text}");
    assert!(text.contains("belvedere.FrameHeader.v2 of 384 bytes"), "{text}");
    drop(stream);
    // A plain iceoryx2 node leaves its counter; the last node of the bridge removes it.
    drop(Node::open(&short, "last").unwrap());
}

/// The dynamic part of a stream as iceoryx2 0.9.3 would have begun it.
#[test]
fn another_version_of_iceoryx2_is_named() {
    let domain = domain("book");
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    let books: Vec<PathBuf> = std::fs::read_dir("/dev/shm")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.file_name().unwrap().to_str().unwrap().starts_with(&domain.prefix()))
        .filter(|path| path.extension().is_some_and(|kind| kind == "dynamic"))
        .collect();
    let version = |minor: u8, patch: u8| [patch, 0, minor, 0, 0, 0, 0, 0];
    let write = |bytes: [u8; 8]| {
        for book in &books {
            File::options().write(true).open(book).unwrap().write_all_at(&bytes, 0).unwrap();
        }
    };
    write(version(9, 3));
    let text = told(&domain);
    assert!(text.contains("made by iceoryx2 0.9.3") && text.contains("0.10.0"), "{text}");
    write(version(10, 0));
    drop((publisher, node));
}

/// A program that creates the stream with the iceoryx2 of its Python.
const PROGRAM: &str = r#"
import ctypes, sys
import iceoryx2 as iox2
class FrameHeader(ctypes.Structure):
    _fields_ = (("words", ctypes.c_uint64 * 48),)
    @staticmethod
    def type_name():
        return "belvedere.FrameHeader.v2"
config = iox2.config.default()
config.global_cfg.prefix = iox2.FileName.new(sys.argv[1])
config.global_cfg.root_path = iox2.Path.new(sys.argv[3])
node = iox2.NodeBuilder.new().config(config).create(iox2.ServiceType.Ipc)
name = iox2.ServiceName.new("belvedere/image_raw")
builder = node.service_builder(name).publish_subscribe(iox2.Slice[ctypes.c_uint8]).user_header(FrameHeader)
if sys.argv[2] == "make":
    service = builder.open_or_create()
    publisher = service.publisher_builder().initial_max_slice_len(64).create()
    print("ready", flush=True)
    sys.stdin.read()
else:
    try:
        builder.open()
        print("opened", flush=True)
    except Exception as error:
        print("refused:", error, flush=True)
"#;

/// Uses a Python that has `iceoryx2==0.9.*`, named by `BELVEDERE_TEST_PYTHON_ICEORYX2_0_9`.
#[test]
fn a_real_peer_of_version_0_9() {
    let Some(python) = std::env::var_os("BELVEDERE_TEST_PYTHON_ICEORYX2_0_9") else {
        return skip("BELVEDERE_TEST_PYTHON_ICEORYX2_0_9 names no Python with iceoryx2 0.9");
    };
    let peer = |domain: &Domain, what: &str| {
        let mut child = Command::new(&python)
            .args(["-c", PROGRAM, &domain.prefix(), what])
            .arg(domain.directory())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let line = BufReader::new(child.stdout.take().unwrap()).lines().next().unwrap().unwrap();
        (child, line)
    };
    // The peer has created the stream.
    let made = domain("made-0-9");
    let (mut child, line) = peer(&made, "make");
    assert_eq!(line, "ready");
    let text = told(&made);
    assert!(text.contains("made by iceoryx2 0.9.") && text.contains("0.10.0"), "{text}");
    // After a kill its files do not prevent the next start.
    child.kill().unwrap();
    child.wait().unwrap();
    std::thread::sleep(Duration::from_millis(1100));
    let node = Node::open(&made, "test").unwrap();
    drop(node.publisher(&spec()).unwrap());
    drop(node);

    // The peer subscribes to a stream of this version: it is refused, and the stream continues.
    let ours = domain("ours-0-10");
    let node = Node::open(&ours, "test").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    let (mut child, line) = peer(&ours, "open");
    assert!(line.starts_with("refused:"), "{line}");
    child.wait().unwrap();
    let mut subscriber = node.subscriber("image_raw").unwrap();
    assert!(!subscriber.wait(Duration::from_millis(20)).unwrap());
    publisher.loan(64).unwrap().send().unwrap();
    assert!(subscriber.take().unwrap().is_some());
}
