//! Messages of ROS 2 in CDR: [`Cdr`] reads them, and [`message`] writes them with the encoder of the bridge.
//!
//! A message begins with four bytes that name its encoding. After these, each number is aligned to its size.

use belvedere_bridge::{Ros, RosBytes};

/// Why a message cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(super) enum Unreadable {
    /// The encoding is not plain CDR.
    #[error("its encoding is not CDR")]
    Encoding,
    /// Nothing is left of a message that was too large.
    #[error("it is larger than this service accepts")]
    Large,
    /// The message ends before its last field.
    #[error("it ends before its last field")]
    Short,
    /// A text has bytes that are not UTF-8.
    #[error("a text is not UTF-8")]
    Text,
    /// A list has more elements than are accepted.
    #[error("a list has {count} elements, and at most {most} are accepted")]
    Long {
        /// The number of its elements.
        count: usize,
        /// The largest number that is accepted.
        most: usize,
    },
}

/// Reads the fields of a message one after the other, in either byte order.
#[derive(Debug, Clone)]
pub(super) struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    is_little: bool,
}

macro_rules! numbers {
    ($($type:ident),+) => {
        $(
            /// Reads a number of this type.
            pub(super) fn $type(&mut self) -> Result<$type, Unreadable> {
                let bytes = self.aligned()?;
                Ok(if self.is_little { $type::from_le_bytes(bytes) } else { $type::from_be_bytes(bytes) })
            }
        )+
    };
}

impl<'a> Cdr<'a> {
    /// Begins to read a message, which starts with the four bytes that name its encoding.
    pub(super) fn new(message: &'a [u8]) -> Result<Self, Unreadable> {
        if message.is_empty() {
            return Err(Unreadable::Large);
        }
        let (encoding, body) = message.split_first_chunk::<4>().ok_or(Unreadable::Short)?;
        let is_little = match encoding[..2] {
            [0, 0] => false,
            [0, 1] => true,
            _ => return Err(Unreadable::Encoding),
        };
        Ok(Self { body, at: 0, is_little })
    }

    numbers! { u8, i32, u32, i64, u64, f64 }

    /// Reads a bool. Every number but 0 is true.
    pub(super) fn bool(&mut self) -> Result<bool, Unreadable> {
        Ok(self.u8()? != 0)
    }

    /// Reads a text, whose length counts the 0 at its end.
    pub(super) fn text(&mut self) -> Result<&'a str, Unreadable> {
        let length = self.u32()? as usize;
        let bytes = self.take(length)?;
        std::str::from_utf8(bytes.strip_suffix(&[0]).unwrap_or(bytes)).map_err(|_| Unreadable::Text)
    }

    /// Reads the number of elements of a list, of which at most `most` are accepted.
    pub(super) fn count(&mut self, most: usize) -> Result<usize, Unreadable> {
        let count = self.u32()? as usize;
        // An element takes at least one byte, so a message cannot announce more than it has.
        if count > self.body.len() - self.at {
            return Err(Unreadable::Short);
        }
        if count > most { Err(Unreadable::Long { count, most }) } else { Ok(count) }
    }

    /// Reads a list of at most `most` elements.
    pub(super) fn list<T>(
        &mut self,
        most: usize,
        mut element: impl FnMut(&mut Self) -> Result<T, Unreadable>,
    ) -> Result<Vec<T>, Unreadable> {
        let count = self.count(most)?;
        (0..count).map(|_| element(self)).collect()
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Unreadable> {
        let end = self.at.checked_add(count).ok_or(Unreadable::Short)?;
        let taken = self.body.get(self.at..end).ok_or(Unreadable::Short)?;
        self.at = end;
        Ok(taken)
    }

    fn aligned<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let gap = self.at.next_multiple_of(N) - self.at;
        self.take(gap)?;
        self.take(N)?.try_into().map_err(|_| Unreadable::Short)
    }
}

/// Returns a message of ROS 2 whose fields `write` appends.
pub(super) fn message(write: impl FnOnce(&mut RosBytes<'_>)) -> Vec<u8> {
    let mut message = Vec::new();
    let mut bytes = RosBytes::begin(Ros::Two, &mut message);
    write(&mut bytes);
    // A time or a count beyond 32 bits was written as the largest one.
    let _ = bytes.end();
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let message = message(|bytes| {
            bytes.u8(1);
            bytes.u64(u64::MAX);
            bytes.text("wall");
            bytes.i64(-5);
            bytes.count(2);
            bytes.f64(0.5);
            bytes.f64(f64::NEG_INFINITY);
            bytes.text("");
            bytes.u8(7);
            bytes.u32(9);
        });
        let mut read = Cdr::new(&message).unwrap();
        assert_eq!((read.bool(), read.u64()), (Ok(true), Ok(u64::MAX)));
        assert_eq!((read.text(), read.i64()), (Ok("wall"), Ok(-5)));
        assert_eq!(read.list(2, Cdr::f64), Ok(vec![0.5, f64::NEG_INFINITY]));
        assert_eq!((read.text(), read.u8()), (Ok(""), Ok(7)));
        assert_eq!((read.u32(), read.u8()), (Ok(9), Err(Unreadable::Short)));
    }

    #[test]
    fn both_byte_orders_are_read() {
        let little = [0, 1, 0, 0, 1, 0, 0, 0, 0xfe, 0xff, 0xff, 0xff, 2, 0, 0, 0, b'a', 0];
        let big = [0, 0, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xfe, 0, 0, 0, 2, b'a', 0];
        for message in [little, big] {
            let mut read = Cdr::new(&message).unwrap();
            assert_eq!((read.u8(), read.i32(), read.text()), (Ok(1), Ok(-2), Ok("a")));
        }
    }

    #[test]
    fn a_message_of_another_form_is_an_error() {
        let of = |body: &[u8]| [&[0, 1, 0, 0], body].concat();
        assert_eq!(Cdr::new(&[0, 1, 0]).err(), Some(Unreadable::Short));
        assert_eq!(Cdr::new(&[0, 3, 0, 0]).err(), Some(Unreadable::Encoding));
        assert_eq!(Cdr::new(&of(&[9, 0, 0, 0, b'a'])).unwrap().text(), Err(Unreadable::Short));
        assert_eq!(Cdr::new(&of(&[2, 0, 0, 0, 0xff, 0])).unwrap().text(), Err(Unreadable::Text));
        // A count that the message cannot hold reserves no memory.
        let endless = of(&[0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0]);
        assert_eq!(Cdr::new(&endless).unwrap().list(usize::MAX, Cdr::u8), Err(Unreadable::Short));
        let three = of(&[3, 0, 0, 0, 1, 2, 3]);
        let long = Unreadable::Long { count: 3, most: 2 };
        assert_eq!(Cdr::new(&three).unwrap().list(2, Cdr::u8), Err(long));
    }
}
