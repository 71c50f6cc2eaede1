//! Recordings from outside: everything that is published is in the file, and survives any kind of end.

use crate::live;
use crate::live::{PATIENCE, Simulator, belvedere, output, own_domain, with_closed_output};
use crate::recordings::{Process, frames, info, read, record_a_run};
use belvedere::recording::{Compression, Item, Profile, RecordedStream, RecordingError, RecordingWriter};
use belvedere_bridge::{Encoding, FrameHeader, Kind};
use rustix::process::{Pid, Signal, kill_process};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::process::Command;
use std::time::{Duration, Instant};

/// The robot as expanded by xacro and the world file can be extracted from a recording unchanged, and run.
#[test]
fn a_recording_keeps_robot_and_world() {
    let folder = tempfile::tempdir().unwrap();
    let (file, kept) = (folder.path().join("a.mcap"), folder.path().join("kept"));
    let published = record_a_run(&file, "0.5");
    let told = info(&file)["files"].clone();
    let names: Vec<&str> =
        told.as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
    let [world, robot] = names[..] else { panic!("{names:?}") };
    let extract = ["info", file.to_str().unwrap(), "--extract", kept.to_str().unwrap()];
    // Even if nobody reads what it prints.
    let (code, said) = with_closed_output(&extract);
    assert_eq!((code, &*said), (Some(0), ""));
    let again = output(&extract);
    let said = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(!again.status.success() && said.contains("cannot write") && said.contains("exists"), "{said}");
    let [world, robot] = [world, robot].map(|name| kept.join(name).to_str().unwrap().to_owned());
    let domain = own_domain();
    let run = [
        "run",
        "--robot",
        &robot,
        "--world",
        &world,
        "--domain",
        &domain,
        "--rate",
        "max",
        "--duration",
        "0.5",
    ];
    let run = output(&[&run[..], &["--hash", "--drive", "loop"]].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = String::from_utf8(run.stdout).unwrap();
    for (topic, (hash, _)) in published {
        // A plain URDF has optical frames as links, in another order.
        assert!(
            topic == "/tf_static" || text.contains(&hash),
            "{topic} of the robot and the world that were kept differs:\n{text}"
        );
    }
}

#[test]
fn a_truncated_file_gives_all_complete_records() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    record_a_run(&file, "0.5");
    let bytes = std::fs::read(&file).unwrap();
    let (whole, end) = read(&bytes);
    assert!(end.is_none());
    let mut most = 0;
    for part in 0..40 {
        let len = bytes.len() * part / 40 + part % 7;
        let (items, end) = read(&bytes[..len]);
        match end {
            Some(RecordingError::Cut) => {}
            Some(RecordingError::NotMcap) => assert!(len < 8),
            other => panic!("cut after {len} bytes: {other:?}"),
        }
        assert!(items[..] == whole[..items.len()], "cut after {len} bytes");
        assert!(items.len() >= most);
        most = items.len();
    }
    assert!(most > whole.len() / 2, "{most} of {}", whole.len());
    // A wrong bit is detected by the checksums, and no frame is returned that was not recorded.
    let known = frames(&whole);
    for part in 1..100 {
        let mut wrong = bytes.clone();
        let place = bytes.len() * part / 100;
        wrong[place] ^= 1 << (part % 8);
        let (items, end) = read(&wrong);
        let found = frames(&items);
        let is_told = items.iter().any(|item| matches!(item, Item::LeftOut(_)));
        assert!(end.is_some() || is_told || found == known, "byte {place}");
        for frame in found.values().flatten() {
            assert!(known[&frame.topic[..]].contains(frame), "byte {place}");
        }
    }
    // A wrong length is detected before this much memory is requested: 4 GiB, for a text of the first record.
    let mut wrong = bytes.clone();
    wrong[17..21].fill(0xff);
    let (items, end) = read(&wrong);
    let Some(Item::LeftOut(why)) = items.first() else { panic!("{end:?}") };
    assert!(why.contains("longer than the record"), "{why}");
    let long = folder.path().join("long.mcap");
    std::fs::write(&long, &wrong).unwrap();
    let program = env!("CARGO_BIN_EXE_belvedere");
    let limited = format!("ulimit -v 3000000; exec '{program}' info '{}'", long.display());
    let shown = Command::new("sh").args(["-c", &limited]).output().unwrap();
    let errors = String::from_utf8_lossy(&shown.stderr).into_owned();
    assert!(shown.status.code() == Some(1) && errors.contains("longer than the record"), "{errors}");
    let cut = folder.path().join("cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let shown = output(&["info", cut.to_str().unwrap()]);
    assert_eq!(shown.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&shown.stdout).contains("/image_raw"));
    let errors = String::from_utf8_lossy(&shown.stderr).into_owned();
    assert!(errors.contains("ends in the middle") && errors.lines().count() == 1, "{errors}");
}

#[test]
fn a_killed_recorder_leaves_a_readable_file() {
    let simulator = Simulator::start(&[]);
    live::follow(simulator.domain(), "test", &["clock"]);
    let folder = tempfile::tempdir().unwrap();
    let kills = if std::env::var_os("BELVEDERE_FULL").is_some_and(|full| full == "1") { 200 } else { 8 };
    let mut with_frames = 0_u64;
    for kill in 0..kills {
        let file = folder.path().join(format!("{kill}.mcap"));
        let mut record = belvedere();
        record.arg("record").arg("-o").arg(&file).args(["--domain", simulator.domain()]);
        let record = Process::start(&mut record);
        let active = folder.path().join(format!("{kill}.mcap.active"));
        // Every other one has written frames.
        let is_begun =
            || std::fs::read(&active).is_ok_and(|bytes| kill % 2 == 0 || !frames(&read(&bytes).0).is_empty());
        let started = Instant::now();
        while !is_begun() {
            assert!(started.elapsed() < PATIENCE);
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(173 * kill % 500));
        kill_process(Pid::from_child(&record.0), Signal::KILL).unwrap();
        drop(record);
        assert!(!file.exists(), "an incomplete file has no final name");
        let (items, end) = read(&std::fs::read(&active).unwrap());
        assert!(matches!(end, Some(RecordingError::Cut)), "{end:?}");
        with_frames += u64::from(!frames(&items).is_empty());
        std::fs::remove_file(active).unwrap();
    }
    assert!(with_frames >= kills / 2, "{with_frames} of {kills} have frames");
}

/// Accepts this many bytes, and then none.
struct Disk<'a> {
    bytes: &'a mut Vec<u8>,
    room: usize,
}

impl Write for Disk<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.bytes.len() + bytes.len() > self.room {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn data_written_before_the_disk_was_full_can_be_read() {
    let mut bytes = Vec::new();
    let disk = Disk { bytes: &mut bytes, room: 3_000_000 };
    let mut writer = RecordingWriter::new(disk, Profile::Ros1, Compression::None, &BTreeMap::new()).unwrap();
    let stream = RecordedStream {
        topic: "picture".into(),
        kind: Kind::Image,
        encoding: Encoding::Mono8,
        frame_id: "camera".into(),
        rate_hz: None,
        layers: None,
        max_payload_len: 640 * 480,
    };
    let id = writer.add(&stream).unwrap();
    let mut header = FrameHeader::new(Kind::Image, Encoding::Mono8);
    header.payload_len = header.set_packed(640, 480) as u64;
    let mut written = 0;
    let error = loop {
        header.stamp_ns += 1000;
        let payload = vec![written as u8; 640 * 480];
        match writer.write(id, &header, &payload).and_then(|()| writer.flush()) {
            Ok(()) => written += 1,
            Err(error) => break error,
        }
    };
    assert!(matches!(&error, RecordingError::Io(error) if error.kind() == io::ErrorKind::StorageFull));
    drop(writer);
    let (items, end) = read(&bytes);
    assert!(matches!(end, Some(RecordingError::Cut)), "{end:?}");
    assert_eq!(
        items.iter().filter(|item| matches!(item, Item::Stream(found) if *found == stream)).count(),
        1
    );
    let read = frames(&items)["picture"].len();
    assert!(written == 9 && read == 9, "{read} of {written}");
}

#[test]
fn files_of_other_recorders_are_not_overwritten() {
    let simulator = Simulator::start(&[]);
    live::follow(simulator.domain(), "test", &["clock"]);
    let folder = tempfile::tempdir().unwrap();
    let (file, active) = (folder.path().join("a.mcap"), folder.path().join("a.mcap.active"));
    let record = |more: &[&str]| {
        let mut record = belvedere();
        record.args(["record", "/clock", "-o"]).arg(&file).args(["--domain", simulator.domain()]).args(more);
        record
    };
    let first = Process::start(&mut record(&[]));
    let started = Instant::now();
    while !std::fs::metadata(&active).is_ok_and(|active| active.len() > 10_000) {
        assert!(started.elapsed() < PATIENCE, "nothing is written");
        std::thread::sleep(Duration::from_millis(20));
    }
    for more in [&[][..], &["--force"]] {
        let (code, errors) = Process::start(&mut record(more)).end();
        assert_eq!(code, Some(1), "{errors}");
        assert!(errors.contains("another process is writing it"), "{more:?}: {errors}");
    }
    kill_process(Pid::from_child(&first.0), Signal::KILL).unwrap();
    drop(first);
    let left = std::fs::read(&active).unwrap();
    assert!(!frames(&read(&left).0)["clock"].is_empty());
    let (code, errors) = Process::start(&mut record(&[])).end();
    assert!(code == Some(1) && errors.contains("a.mcap.active exists"), "{errors}");
    assert!(errors.contains("rename it") && errors.contains("--force"), "{errors}");
    assert!(std::fs::read(&active).unwrap() == left, "it was touched");
    let (code, errors) = Process::start(&mut record(&["--force", "--duration", "0.3"])).end();
    assert_eq!(code, Some(0), "{errors}");
    assert!(file.exists() && !active.exists());
}
