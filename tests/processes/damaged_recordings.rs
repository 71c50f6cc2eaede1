//! Of a damaged recording everything that is intact is read, and what is left out is told.

use crate::live::{output, own_domain};
use crate::recordings::{frames, info, read, read_all, record_a_run};
use belvedere::recording::{Item, RecordingError, RecordingReader};
use std::io::Cursor;
use std::ops::Range;
use std::path::Path;
use std::time::Duration;

const CHUNK: u8 = 6;
const ATTACHMENT: u8 = 9;
const STATISTICS: u8 = 11;
const METADATA: u8 = 12;

/// Returns the kind of each record of an MCAP file, and the bytes of its content.
fn records(bytes: &[u8]) -> Vec<(u8, Range<usize>)> {
    let mut records = Vec::new();
    let mut at = 8;
    while at + 9 <= bytes.len() - 8 {
        let len = u64::from_le_bytes(*bytes[at + 1..].first_chunk().unwrap()) as usize;
        records.push((bytes[at], at + 9..at + 9 + len));
        at += 9 + len;
    }
    records
}

fn of_kind(bytes: &[u8], kind: u8) -> Vec<Range<usize>> {
    records(bytes).into_iter().filter(|(found, _)| *found == kind).map(|(_, range)| range).collect()
}

/// Reads with the index, as the commands do.
fn read_file(bytes: &[u8]) -> (Vec<Item>, Option<RecordingError>) {
    read_all(RecordingReader::starting_at(Cursor::new(bytes), Duration::ZERO).unwrap())
}

fn left_out(items: &[Item]) -> Vec<&str> {
    items
        .iter()
        .filter_map(|item| if let Item::LeftOut(what) = item { Some(&**what) } else { None })
        .collect()
}

/// Returns the items without those that say what is left out.
fn intact(items: &[Item]) -> Vec<&Item> {
    items.iter().filter(|item| !matches!(item, Item::LeftOut(_))).collect()
}

/// Plays a file as fast as possible, and returns the number of frames and the warnings.
fn replayed(path: &Path) -> (u64, String) {
    let domain = own_domain();
    let done = output(&["replay", path.to_str().unwrap(), "--rate", "max", "--domain", &domain]);
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{said}");
    let text = String::from_utf8(done.stdout).unwrap();
    let words: Vec<&str> = text.split_whitespace().collect();
    (words[words.len() - 3].parse().unwrap_or_else(|_| panic!("{text}")), said)
}

#[test]
fn a_damaged_attachment_is_left_out_and_everything_else_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    record_a_run(&file, "0.5");
    let bytes = std::fs::read(&file).unwrap();
    let (whole, end) = read_file(&bytes);
    assert!(end.is_none() && left_out(&whole).is_empty());
    let damaged = folder.path().join("damaged.mcap");
    let attachments = of_kind(&bytes, ATTACHMENT);
    assert_eq!(attachments.len(), 2);
    for (number, range) in attachments.iter().enumerate() {
        // A byte of the content, and a length that reaches beyond the record.
        for (place, value) in [(range.end - 20, bytes[range.end - 20] ^ 1), (range.start + 19, 0xff)] {
            let mut wrong = bytes.clone();
            wrong[place] = value;
            let (items, end) = read_file(&wrong);
            assert!(end.is_none(), "{end:?}");
            let told = left_out(&items);
            assert!(told.len() == 1 && told[0].contains("attachment"), "{told:?}");
            let mut expected: Vec<&Item> = whole.iter().collect();
            let is_attachment = |item: &&Item| matches!(item, Item::Attachment(_));
            let places: Vec<usize> = (0..expected.len()).filter(|&at| is_attachment(&expected[at])).collect();
            expected.remove(places[number]);
            assert!(intact(&items) == expected);
            std::fs::write(&damaged, &wrong).unwrap();
            let shown = output(&["info", damaged.to_str().unwrap()]);
            let errors = String::from_utf8(shown.stderr).unwrap();
            assert_eq!(shown.status.code(), Some(1));
            assert!(errors.contains(&format!("damaged.mcap: {}", told[0])), "{errors}");
            assert!(errors.contains("1 part is left out; the rest was read"), "{errors}");
            let text = String::from_utf8(shown.stdout).unwrap();
            assert!(text.contains("/image_raw") && text.matches("  file: ").count() == 1, "{text}");
        }
    }
    let Item::Attachment(first) = whole.iter().find(|item| matches!(item, Item::Attachment(_))).unwrap()
    else {
        unreachable!()
    };
    let mut wrong = bytes.clone();
    wrong[attachments[0].end - 20] ^= 1;
    std::fs::write(&damaged, &wrong).unwrap();
    let words =
        format!("damaged.mcap: the attachment '{}' is left out: its checksum does not match", first.name);
    let (played, warned) = replayed(&damaged);
    assert_eq!(warned.matches(&words).count(), 1, "{warned}");
    assert_eq!(played, replayed(&file).0);
    assert_eq!(info(&damaged)["left_out"].as_array().unwrap().len(), 1);
    assert_eq!(info(&damaged)["complete"], false);
    // The other file is extracted.
    let extracted = folder.path().join("extracted");
    let _ = output(&["info", damaged.to_str().unwrap(), "--extract", extracted.to_str().unwrap()]);
    assert_eq!(std::fs::read_dir(&extracted).unwrap().count(), 1);
}

#[test]
fn a_damaged_chunk_costs_only_its_own_messages() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    record_a_run(&file, "0.5");
    let bytes = std::fs::read(&file).unwrap();
    let (whole, _) = read_file(&bytes);
    let known = frames(&whole);
    let number = |items: &[Item]| items.iter().filter(|item| matches!(item, Item::Frame(_))).count();
    let chunks = of_kind(&bytes, CHUNK);
    assert!(chunks.len() > 3, "{}", chunks.len());
    for (place, is_in_head) in [
        (chunks[0].start + chunks[0].len() / 2, false),
        (chunks[1].start + chunks[1].len() / 2, false),
        (chunks[1].start + 20, true),
        (chunks[1].start + 30, true),
        (chunks[2].start + 27, true),
    ] {
        let mut wrong = bytes.clone();
        wrong[place] ^= 0x55;
        let (items, end) = read_file(&wrong);
        assert!(end.is_none(), "byte {place}: {end:?}");
        let told = left_out(&items);
        assert!(!told.is_empty() && told[0].starts_with("a chunk, with all messages from "), "{told:?}");
        assert!(
            is_in_head || told[0].ends_with("its checksum does not match") || told[0].contains(": "),
            "{told:?}"
        );
        // A chunk has at most its share of the frames, and a frame whose payload was in it is lost with it.
        assert!(number(&items) > number(&whole) / 2, "{} of {}", number(&items), number(&whole));
        for (topic, found) in frames(&items) {
            assert!(found.iter().all(|frame| known[topic].contains(frame)), "{topic}");
        }
        let damaged = folder.path().join("damaged.mcap");
        std::fs::write(&damaged, &wrong).unwrap();
        let (played, warned) = replayed(&damaged);
        assert_eq!(played as usize, number(&items));
        assert!(warned.contains(&format!("damaged.mcap: {}", told[0])), "{warned}");
    }
}

#[test]
fn other_damaged_records_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    record_a_run(&file, "0.2");
    let bytes = std::fs::read(&file).unwrap();
    let (whole, _) = read_file(&bytes);
    // The record that describes the image stream: without it, its frames cannot be replayed.
    let metadata = of_kind(&bytes, METADATA);
    let is_of_images = |range: &&Range<usize>| {
        let text = String::from_utf8_lossy(&bytes[(*range).clone()]).into_owned();
        text.contains("belvedere.stream") && text.contains("image_raw")
    };
    let images = metadata.iter().find(is_of_images).unwrap();
    let mut wrong = bytes.clone();
    wrong[images.start..images.start + 4].fill(0xff);
    let (items, end) = read_file(&wrong);
    assert!(end.is_none());
    let told = left_out(&items);
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].starts_with("the metadata record whose name cannot be read is left out: "), "{told:?}");
    assert_eq!(told[1], "all of /image_raw is left out: a damaged part described it");
    let (mut expected, found) = (frames(&whole), frames(&items));
    assert!(expected.remove("image_raw").is_some() && expected == found);
    let damaged = folder.path().join("damaged.mcap");
    std::fs::write(&damaged, &wrong).unwrap();
    let (_, warned) = replayed(&damaged);
    assert!(warned.contains("damaged.mcap: all of /image_raw is left out"), "{warned}");
    // The statistics and the index repeat what is in the data.
    let statistics = of_kind(&bytes, STATISTICS);
    let mut wrong = bytes.clone();
    wrong[statistics[0].start] ^= 1;
    let (items, end) = read_file(&wrong);
    assert!(end.is_none() && intact(&items) == whole.iter().collect::<Vec<_>>());
    assert_eq!(
        left_out(&items),
        ["the index at the end of the file is not read: its checksum does not match"]
    );
    // Bytes that have no checksum of their own.
    let about = metadata.first().unwrap();
    let mut wrong = bytes.clone();
    let last = about.end - 1;
    wrong[last] = if wrong[last] == b'0' { b'1' } else { b'0' };
    let (items, end) = read(&wrong);
    assert!(end.is_none());
    let told = left_out(&items);
    assert!(told.len() == 1 && told[0].contains("no damaged part of them is known"), "{told:?}");
}
