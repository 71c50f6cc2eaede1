//! Replays from outside: recorded streams are played back unchanged, from the requested time.

use crate::live;
use crate::live::control::{done, refusal, step};
use crate::live::{PATIENCE, Simulator, belvedere, output, own_domain};
use crate::recordings::{Process, frames, info, messages, read, record_a_run, record_a_run_as};
use belvedere::recording::{
    Compression, Item, Profile, RecordedFrame, RecordedStream, RecordingReader, RecordingWriter,
};
use belvedere_bridge::payload::{Clock, SimulationCommand};
use belvedere_bridge::{Domain, Encoding, FrameHeader, Kind, Node, Operation, SimulationControl};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::time::{Duration, Instant};

#[test]
fn a_run_is_recorded_played_and_recorded_again_with_every_byte() {
    record_play_and_record_again("ros1", ("/image_raw", "sensor_msgs/Image"));
}

#[test]
fn a_run_with_messages_of_ros2_is_recorded_played_and_recorded_again_with_every_byte() {
    record_play_and_record_again("ros2", ("/image_raw", "sensor_msgs/msg/Image"));
}

/// `image` is the topic and the type of a message in both files.
fn record_play_and_record_again(profile: &str, image: (&str, &str)) {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    let published = record_a_run_as(&first, "2", profile);
    let told = info(&first);
    assert_eq!(told["complete"], true);
    assert_eq!(told["about"]["seed"], "1");
    let streams = told["streams"].as_array().unwrap();
    let recorded: BTreeMap<String, (String, u64)> = streams
        .iter()
        .filter(|stream| published.contains_key(stream["topic"].as_str().unwrap()))
        .map(|stream| {
            let text = |name: &str| stream[name].as_str().unwrap().to_owned();
            (text("topic"), (text("hash"), stream["frames"].as_u64().unwrap()))
        })
        .collect();
    assert!(published.values().filter(|(_, count)| *count > 10).count() > 5, "{published:?}");
    assert_eq!(recorded, published);

    // Played as fast as possible into a recorder for which it waits.
    let domain = own_domain();
    let wait_for = format!("recorder={}", streams.len());
    let mut replay = belvedere();
    replay.arg("replay").arg(&first).args(["--domain", &domain, "--rate", "max", "--wait-for", &wait_for]);
    let replay = Process::start(&mut replay);
    let started = Instant::now();
    while output(&["list", "--domain", &domain]).stdout.is_empty() {
        assert!(started.elapsed() < PATIENCE, "nothing is played");
    }
    let mut record = belvedere();
    record.arg("record").arg("-o").arg(&second).args(["--domain", &domain, "--until-gone"]);
    record.args(["--profile", profile]);
    let (code, errors) = Process::start(&mut record).end();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(replay.end().0, Some(0));

    let (first, second) = (std::fs::read(first).unwrap(), std::fs::read(second).unwrap());
    let ((first, first_end), (second, second_end)) = (read(&first), read(&second));
    assert!(first_end.is_none() && second_end.is_none());
    assert_eq!(messages(&first), messages(&second), "what ROS reads");
    assert!(messages(&first).contains_key(&image), "{:?}", messages(&first).keys());
    let (first, second) = (frames(&first), frames(&second));
    assert_eq!(first.keys().collect::<Vec<_>>(), second.keys().collect::<Vec<_>>());
    for (topic, frames) in first {
        assert_eq!(frames.len(), second[topic].len(), "{topic}");
        for (frame, again) in frames.iter().zip(&second[topic]) {
            assert!(frame.payload == again.payload, "{topic}");
            let common = |header: &FrameHeader| {
                let header =
                    FrameHeader { session: 0, publish_mono_ns: 0, flags: header.flags & 1, ..*header };
                bytemuck::bytes_of(&header).to_vec()
            };
            assert_eq!(common(&frame.header), common(&again.header), "{topic}");
            let flag = |frame: &RecordedFrame| frame.header.flags & FrameHeader::REPLAYED;
            assert_eq!((flag(frame), flag(again)), (0, FrameHeader::REPLAYED));
        }
    }
}

/// A file that counts the bytes that are read.
struct Counted<'a> {
    file: Cursor<&'a [u8]>,
    read: &'a Cell<usize>,
}

impl Read for Counted<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.read.set(self.read.get() + read);
        Ok(read)
    }
}

impl Seek for Counted<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// With the index, nothing before the start is read except latched messages; the rest is the same.
#[test]
fn a_later_start_is_found_by_the_index() {
    find_a_later_start(Profile::Ros1);
    find_a_later_start(Profile::Ros2);
}

fn find_a_later_start(profile: Profile) {
    let stream = |topic: &str, kind, encoding, max_payload_len| RecordedStream {
        topic: topic.into(),
        kind,
        encoding,
        frame_id: "camera".into(),
        rate_hz: None,
        layers: None,
        max_payload_len,
    };
    let mut bytes = Vec::new();
    let mut writer = RecordingWriter::new(&mut bytes, profile, Compression::None, &BTreeMap::new()).unwrap();
    let picture = writer.add(&stream("picture", Kind::Image, Encoding::Mono8, 640 * 480)).unwrap();
    let clock = writer.add(&stream("clock", Kind::Clock, Encoding::Struct, size_of::<Clock>())).unwrap();
    let settings = stream("simulation/sensor_settings", Kind::SensorSettings, Encoding::Struct, 0);
    let settings = writer.add(&settings).unwrap();
    let mut header = FrameHeader::new(Kind::Image, Encoding::Mono8);
    header.payload_len = header.set_packed(640, 480) as u64;
    let mut ticks = FrameHeader::new(Kind::Clock, Encoding::Struct);
    ticks.payload_len = size_of::<Clock>() as u64;
    for number in 0..400_u64 {
        // Times do not begin at zero.
        (header.stamp_ns, header.seq) = (5_000_000_000 + number * 10_000_000, number);
        (ticks.stamp_ns, ticks.seq) = (header.stamp_ns, number);
        writer.write(clock, &ticks, bytemuck::bytes_of(&Clock { now_ns: ticks.stamp_ns })).unwrap();
        if number == 100 {
            let told = FrameHeader {
                stamp_ns: header.stamp_ns,
                ..FrameHeader::new(Kind::SensorSettings, Encoding::Struct)
            };
            writer.write(settings, &told, &[]).unwrap();
        }
        writer.write(picture, &header, &vec![number as u8; 640 * 480]).unwrap();
    }
    writer.finish().unwrap();
    let (whole, end) = read(&bytes);
    assert!(end.is_none());
    for start_ms in [10, 995, 1000, 3333, 3990, 9000] {
        let read = Cell::new(0);
        let counted = Counted { file: Cursor::new(&bytes), read: &read };
        let mut reader = RecordingReader::starting_at(counted, Duration::from_millis(start_ms)).unwrap();
        let mut found = Vec::new();
        while let Some(item) = reader.next_item().unwrap() {
            found.push(item);
        }
        let from_ns = 5_000_000_000 + start_ms * 1_000_000;
        let later = |items: &[Item]| {
            let frames = items.iter().filter_map(|item| match item {
                Item::Frame(frame) if frame.log_time_ns >= from_ns => Some(frame.clone()),
                _ => None,
            });
            frames.collect::<Vec<_>>()
        };
        assert!(later(&found) == later(&whole), "from {start_ms} ms on");
        assert!(frames(&found).contains_key("simulation/sensor_settings"), "{start_ms}");
        let share = read.get() as f64 / bytes.len() as f64;
        let expected = (1.0 - start_ms as f64 / 4000.0).max(0.0);
        // A chunk before, one with the settings, and the index.
        assert!(share < expected + 0.15, "{share} of the file is read from {start_ms} ms on");
    }
    // A file without an index is read from its beginning.
    let cut = &bytes[..bytes.len() - 100];
    let mut reader = RecordingReader::starting_at(Cursor::new(cut), Duration::from_secs(3)).unwrap();
    let mut count = 0;
    while let Ok(Some(_)) = reader.next_item() {
        count += 1;
    }
    assert!(count > 1200, "{count}");
}

#[test]
fn a_replay_starts_pauses_and_steps() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    record_a_run(&file, "1");
    let domain = own_domain();
    let mut replay = belvedere();
    replay.arg("replay").arg(&file).args(["--domain", &domain, "--start", "0.5", "--paused"]);
    let replay = Process::start(&mut replay);
    let node = Node::open(&Domain::new(&domain).unwrap(), "control").unwrap();
    let mut control = SimulationControl::open(&node).unwrap();
    let first = step(&mut control, 1);
    assert!((500_000_000..=510_000_000).contains(&first), "{first}");
    let mut clock = live::follow(&domain, "test", &["clock"]).remove(0);
    let later = step(&mut control, 5);
    let mut times = Vec::new();
    while times.last() != Some(&later) {
        assert!(clock.wait(PATIENCE).unwrap(), "{times:?} and not {later}");
        while let Some(frame) = clock.take().unwrap() {
            times.push(frame.header().stamp_ns);
        }
    }
    // The last earlier frame of a stream is sent to late subscribers.
    times.retain(|&time| time > first);
    assert!(times.len() == 5 && times.is_sorted(), "{times:?} after {first}");
    // Nothing is sent while it is paused.
    assert!(!clock.wait(Duration::from_millis(200)).unwrap());
    let refused = refusal(&mut control, &SimulationCommand::new(Operation::ResetWorld), "");
    assert!(refused.contains("this is a replay"), "{refused}");
    done(&mut control, Operation::Resume);
    assert_eq!(replay.end().0, Some(0));
}

#[test]
fn frames_that_outgrow_their_stream_are_played() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    // As if a simulator was started again with a larger camera.
    let stream = RecordedStream {
        topic: "picture".into(),
        kind: Kind::Image,
        encoding: Encoding::Mono8,
        frame_id: "camera".into(),
        rate_hz: Some(30.0),
        layers: None,
        max_payload_len: 32 * 24,
    };
    let file = std::fs::File::create(&first).unwrap();
    let mut writer = RecordingWriter::new(file, Profile::Ros1, Compression::Lz4, &BTreeMap::new()).unwrap();
    let id = writer.add(&stream).unwrap();
    // A stream that stays, so that the recorder does not assume that the replay has ended.
    let clock = RecordedStream {
        topic: "clock".into(),
        kind: Kind::Clock,
        encoding: Encoding::Struct,
        max_payload_len: size_of::<Clock>(),
        ..stream.clone()
    };
    writer.add(&clock).unwrap();
    for (number, (width, height)) in [(32, 24), (640, 480), (33, 25), (800, 600)].into_iter().enumerate() {
        let mut header = FrameHeader::new(Kind::Image, Encoding::Mono8);
        (header.stamp_ns, header.seq) = (number as u64 * 33_333_333, number as u64);
        header.payload_len = header.set_packed(width, height) as u64;
        let payload = vec![number as u8 + 1; header.payload_len as usize];
        writer.write(id, &header, &payload).unwrap();
    }
    writer.finish().unwrap();
    let domain = own_domain();
    let mut replay = belvedere();
    replay.arg("replay").arg(&first).args(["--domain", &domain, "--rate", "max", "--wait-for", "recorder=2"]);
    let replay = Process::start(&mut replay);
    let mut record = belvedere();
    record.arg("record").arg("-o").arg(&second).args(["--domain", &domain, "--wait", "--until-gone"]);
    let (code, errors) = Process::start(&mut record).end();
    assert_eq!(code, Some(0), "{errors}");
    let (code, errors) = replay.end();
    assert_eq!(code, Some(0), "{errors}");
    let (first, second) = (read(&std::fs::read(first).unwrap()).0, read(&std::fs::read(second).unwrap()).0);
    let payloads = |items| frames(items)["picture"].iter().map(|frame| frame.payload.clone()).collect();
    let (first, second): (Vec<Vec<u8>>, Vec<Vec<u8>>) = (payloads(&first), payloads(&second));
    assert!(first == second && first.len() == 4, "{} frames of {}", second.len(), first.len());
}

#[test]
fn errors_of_recording_and_replay_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (none, empty, foreign) = (path("none.mcap"), path("empty.mcap"), path("foreign.mcap"));
    std::fs::write(&empty, "PNG, say").unwrap();
    let mut others = mcap::Writer::new(std::fs::File::create(&foreign).unwrap()).unwrap();
    others.finish().unwrap();
    let domain = own_domain();
    let taken = Simulator::start(&[]);
    live::follow(taken.domain(), "test", &["clock"]);
    let there = path("there.mcap");
    std::fs::write(&there, "mine").unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["replay", &none, "--domain", &domain], "No such file"),
        (
            &["replay", &empty, "--domain", &domain],
            "it is not an MCAP file; choose a file written by `belvedere record` or `run --record`",
        ),
        (&["replay", &foreign, "--domain", &domain], "it has no frames of Belvedere"),
        (&["info", &empty], "it is not an MCAP file"),
        (&["record", "-o", &none, "--domain", &domain], "nothing is published"),
        (&["record", "/scam", "-o", &none, "--domain", taken.domain()], "no topic /scam"),
        (&["record", "-o", &there, "--domain", taken.domain()], "replace it with --force"),
        (&["run", "--record", &there, "--domain", &domain, "--duration", "1"], "replace it with --force"),
    ];
    for (arguments, expected) in cases {
        let refused = output(arguments);
        let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(1), "{arguments:?}: {errors}");
        let last = errors.lines().last().unwrap_or_default();
        assert!(last.contains(expected), "{arguments:?}: {errors}");
    }
    assert_eq!(std::fs::read(&there).unwrap(), b"mine");
    assert!(!folder.path().join("none.mcap").exists());
    // A domain that has a simulator.
    let played = path("played.mcap");
    record_a_run(Path::new(&played), "0.5");
    let refused = output(&["replay", &played, "--domain", taken.domain()]);
    let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(1) && errors.contains("in use"), "{errors}");
    // After its end there is nothing to play, however often.
    for again in [&[][..], &["--loop"]] {
        let refused = output(&[&["replay", &played, "--domain", &domain, "--start", "1000"], again].concat());
        let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(
            refused.status.code() == Some(1)
                && errors.contains("it lasts only 0.490 s, and was to be played from 1000.000 s"),
            "{errors}"
        );
    }
}
