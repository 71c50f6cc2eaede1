//! Shortens messages that quote long texts of files.

use std::borrow::Cow;

/// The most characters of a quotation that are shown.
const QUOTED: usize = 240;
/// The most characters of a message.
const SHOWN: usize = 1200;
/// What stands for the characters that are left out.
const GAP: &str = " … ";

/// Returns a message in which each text between single quotes, and then the message itself, is cut in its middle if it is
/// long. A message without long texts is returned as it is.
pub(crate) fn shortened(message: &str) -> Cow<'_, str> {
    if message.len() <= QUOTED {
        return Cow::Borrowed(message);
    }
    let mut short = String::new();
    let mut rest = message;
    // Begins at a quote before which there is no letter, as in `don't`, and ends at one behind which there is none.
    while let Some((before, quoted)) = opening(rest).map(|at| rest.split_at(at + 1))
        && let Some((quoted, behind)) = closing(quoted).map(|at| quoted.split_at(at))
    {
        short.push_str(before);
        short.push_str(&cut(quoted, QUOTED));
        short.push('\'');
        rest = &behind[1..];
    }
    short.push_str(rest);
    match cut(&short, SHOWN) {
        Cow::Borrowed(all) if all == message => Cow::Borrowed(message),
        shown => Cow::Owned(shown.into_owned()),
    }
}

fn opening(text: &str) -> Option<usize> {
    let is_free = |at: &usize| !text[..*at].ends_with(char::is_alphanumeric);
    text.match_indices('\'').map(|(at, _)| at).find(is_free)
}

fn closing(text: &str) -> Option<usize> {
    let is_free = |at: &usize| !text[at + 1..].starts_with(char::is_alphanumeric);
    text.match_indices('\'').map(|(at, _)| at).find(is_free)
}

/// Returns a text with at most `most` characters: two thirds from its beginning, the rest from its end.
fn cut(text: &str, most: usize) -> Cow<'_, str> {
    let count = if text.len() <= most { 0 } else { text.chars().count() };
    if count <= most {
        return Cow::Borrowed(text);
    }
    let kept = most - GAP.chars().count();
    let place = |number: usize| text.char_indices().nth(number).map_or(text.len(), |(at, _)| at);
    let (begin, end) = (place(kept * 2 / 3), place(count - (kept - kept * 2 / 3)));
    Cow::Owned([&text[..begin], GAP, &text[end..]].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_quotations_lose_their_middle() {
        let long = "é".repeat(1000);
        let message = format!("the joint's name '{long}' isn't '{long}b', but 'c'");
        let short = shortened(&message);
        assert!(short.starts_with("the joint's name 'éé") && short.ends_with("ééb', but 'c'"), "{short}");
        assert!(short.contains("éé … éé") && short.contains("éé' isn't 'éé"), "{short}");
        assert!(short.chars().count() < 2 * QUOTED + 50, "{short}");
        assert_eq!(shortened(&short), short);
        for message in ["", "it's 'short'", &"'a' ".repeat(100), &format!("'{}'", &long[..2 * QUOTED])] {
            assert!(matches!(shortened(message), Cow::Borrowed(same) if same == message), "{message}");
        }
    }

    #[test]
    fn long_messages_lose_their_middle() {
        for text in ["<", "'", "' ", "a'b", "x'", "'x"] {
            let message = format!("a{}z", text.repeat(100_000));
            let short = shortened(&message);
            assert!(
                short.chars().count() == SHOWN && short.starts_with('a') && short.ends_with('z'),
                "{short}"
            );
            assert_eq!(shortened(&short), short);
        }
    }
}
