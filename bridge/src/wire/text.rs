//! [`Text`]: strings of fixed size for shared memory.

use std::fmt;

use bytemuck::{Pod, Zeroable};
#[cfg(feature = "shared-memory")]
use iceoryx2::prelude::ZeroCopySend;

/// UTF-8 text in `N` bytes, padded with NUL; C sees a `char[N]`. The last byte is always NUL.
#[derive(Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Text<const N: usize>([u8; N]);

// The derive macro requires `repr(C)`, bytemuck's requires `repr(transparent)` for a generic type.
// SAFETY: it has the layout of `[u8; N]`, which may be sent: no pointer, no padding, no `Drop`, `'static`.
#[allow(unsafe_code)]
#[cfg(feature = "shared-memory")]
unsafe impl<const N: usize> ZeroCopySend for Text<N> {}

/// The error for a text that does not fit: it is longer than `N - 1` bytes or contains a NUL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a name of {len} bytes does not fit: at most {max} bytes, none of them NUL")]
pub struct TextError {
    /// Length of the refused text in bytes.
    pub len: usize,
    /// The largest length that fits.
    pub max: usize,
}

impl<const N: usize> Text<N> {
    /// The empty text.
    pub const EMPTY: Self = Self([0; N]);

    /// Creates a text.
    ///
    /// # Errors
    /// If the text is longer than `N - 1` bytes or contains a NUL.
    pub fn new(text: &str) -> Result<Self, TextError> {
        if text.len() >= N || text.as_bytes().contains(&0) {
            return Err(TextError { len: text.len(), max: N - 1 });
        }
        let mut bytes = [0; N];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Ok(Self(bytes))
    }

    /// Creates a text of as much of `text` as fits, for messages to people.
    #[must_use]
    pub fn cut(text: &str) -> Self {
        let text = text.split('\0').next().unwrap_or_default();
        let mut end = text.len().min(N.saturating_sub(1));
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        Self::new(&text[..end]).unwrap_or_default()
    }

    /// Returns the text up to the first NUL, or up to the first bytes that are not UTF-8, which a foreign writer may
    /// have written.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let len = self.0.iter().position(|&byte| byte == 0).unwrap_or(N);
        match std::str::from_utf8(&self.0[..len]) {
            Ok(text) => text,
            Err(error) => std::str::from_utf8(&self.0[..error.valid_up_to()]).unwrap_or_default(),
        }
    }

    /// Returns the same text with a NUL in the last byte, as readers in C expect: a foreign writer may have left none.
    #[must_use]
    pub fn terminated(mut self) -> Self {
        if let Some(last) = self.0.last_mut() {
            *last = 0;
        }
        self
    }

    /// Returns true if the text is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0[0] == 0
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl<const N: usize> TryFrom<&str> for Text<N> {
    type Error = TextError;

    fn try_from(text: &str) -> Result<Self, TextError> {
        Self::new(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_comes_back() {
        assert_eq!(Text::<8>::new("bücher").unwrap().as_str(), "bücher");
        assert_eq!(Text::<8>::new("").unwrap(), Text::EMPTY);
        assert_eq!(Text::<8>::new("12345678"), Err(TextError { len: 8, max: 7 }));
        assert!(Text::<8>::new("a\0b").is_err());
        assert_eq!(Text::<4>::cut("abü").as_str(), "ab");
        assert_eq!(Text::<8>::cut("a\0b").as_str(), "a");
    }

    #[test]
    fn foreign_bytes_are_cut_where_they_stop_being_text() {
        assert_eq!(Text::<4>([b'a', 0xff, b'b', 0]).as_str(), "a");
        assert_eq!(Text::<4>([b'a'; 4]).as_str(), "aaaa");
        assert_eq!(Text::<4>([b'a'; 4]).terminated(), Text::new("aaa").unwrap());
        assert_eq!(Text::<4>::new("ab").unwrap().terminated().as_str(), "ab");
    }
}
