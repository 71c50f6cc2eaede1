//! [`Text`]: the text of a plan, which converts positions to line numbers.

use crate::description::diagnostics::Source;
use std::ops::Range;
use std::path::Path;

/// The text of a plan, which converts positions to line numbers.
pub(super) struct Text<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl Text<'_> {
    pub(super) fn source(&self, span: &Range<usize>) -> Source {
        let before = self.text.get(..span.start).unwrap_or_default();
        Source::new(self.path, 1 + before.matches('\n').count() as u32)
    }
}
