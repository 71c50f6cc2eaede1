//! Checks the lengths in MCAP records against the size of the record. A damaged length could otherwise reserve up to 4
//! GiB before it is found to be wrong.

use super::RecordingError;
use mcap::records::op;

/// Checks the lengths of the texts in a record.
///
/// # Errors
/// [`RecordingError::Broken`] for a length that reaches beyond the record.
pub(super) fn check(opcode: u8, body: &[u8]) -> Result<(), RecordingError> {
    // Bytes before the texts, number of texts, and whether a map of texts follows.
    let (before, texts, has_map) = match opcode {
        op::HEADER => (0, 2, false),
        op::SCHEMA => (2, 2, false),
        op::CHANNEL => (4, 2, true),
        op::ATTACHMENT => (16, 2, false),
        op::METADATA => (0, 1, true),
        op::CHUNK_INDEX => return check_chunk_index(body),
        op::ATTACHMENT_INDEX => (40, 2, false),
        op::METADATA_INDEX => (16, 1, false),
        _ => return Ok(()),
    };
    let mut rest = body.get(before..);
    for _ in 0..texts {
        rest = rest.and_then(after_text);
    }
    if has_map {
        rest = rest.and_then(after_map);
    }
    rest.map(|_| ()).ok_or_else(broken)
}

/// Returns the text that begins with its length at a place of a record, or `None` if it is damaged.
pub(super) fn text(body: &[u8], at: usize) -> Option<&str> {
    let rest = body.get(at..)?;
    let len = rest.len() - after_text(rest)?.len();
    std::str::from_utf8(&rest[4..len]).ok()
}

/// Checks a chunk index, whose text follows a map of numbers with a length of its own.
fn check_chunk_index(body: &[u8]) -> Result<(), RecordingError> {
    let offsets = body.get(32..).and_then(after_text);
    let text = offsets.and_then(|rest| rest.get(8..)).and_then(after_text);
    text.map(|_| ()).ok_or_else(broken)
}

/// Returns the bytes after a text, or after any other field that starts with its length in bytes.
fn after_text(bytes: &[u8]) -> Option<&[u8]> {
    let (len, rest) = bytes.split_first_chunk::<4>()?;
    rest.get(u32::from_le_bytes(*len) as usize..)
}

/// Returns the bytes after a map of texts, if all keys and values are within its length.
fn after_map(bytes: &[u8]) -> Option<&[u8]> {
    let after = after_text(bytes)?;
    let mut inside = &bytes[4..bytes.len() - after.len()];
    while !inside.is_empty() {
        inside = after_text(inside).and_then(after_text)?;
    }
    Some(after)
}

fn broken() -> RecordingError {
    RecordingError::Broken("a text is longer than the record that it is in".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
    }

    #[test]
    fn lengths_beyond_the_record_are_found_before_memory_is_reserved() {
        let map = [text("key"), text("value")].concat();
        let map = [&(map.len() as u32).to_le_bytes()[..], &map].concat();
        let offsets = [&10_u32.to_le_bytes()[..], &[0; 10]].concat();
        let records = [
            (op::HEADER, [text("profile"), text("library")].concat()),
            (op::SCHEMA, [vec![0; 2], text("a/B"), text("ros1msg"), vec![0; 4]].concat()),
            (op::CHANNEL, [vec![0; 4], text("/topic"), text("ros1"), map.clone()].concat()),
            (op::ATTACHMENT, [vec![0; 16], text("name"), text("type"), vec![0; 12]].concat()),
            (op::METADATA, [text("name"), map].concat()),
            (op::CHUNK_INDEX, [vec![0; 32], offsets, vec![0; 8], text("lz4"), vec![0; 16]].concat()),
            (op::ATTACHMENT_INDEX, [vec![0; 40], text("name"), text("type")].concat()),
            (op::METADATA_INDEX, [vec![0; 16], text("name")].concat()),
        ];
        for (opcode, whole) in records {
            check(opcode, &whole).unwrap();
            // Any four bytes are set to the maximum: an error is found if they are a text's length.
            let is_found = |at: usize| {
                let mut damaged = whole.clone();
                damaged[at..at + 4].fill(0xff);
                check(opcode, &damaged).is_err()
            };
            assert!((0..whole.len() - 3).any(is_found), "{opcode}");
            assert!(check(opcode, &whole[..4]).is_err(), "{opcode}");
        }
        check(op::MESSAGE, &[]).unwrap();
    }
}
