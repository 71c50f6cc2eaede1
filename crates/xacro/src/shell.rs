//! Quoting of words for a shell, for the commands that messages suggest.

use std::ffi::OsStr;
use std::fmt::Write as _;

/// Characters beside letters and digits that have no meaning to a shell.
const PLAIN: &str = "_@%+=:,./-";

/// Returns a word such that a shell reads it as one word, with the same bytes: unchanged if it has no special character,
/// in quotes otherwise.
///
/// ```
/// use belvedere_xacro::shell::quoted;
/// assert_eq!(quoted("worlds/my.world"), "worlds/my.world");
/// assert_eq!(quoted("it's my world"), r"'it'\''s my world'");
/// ```
pub fn quoted(word: impl AsRef<OsStr>) -> String {
    let word = word.as_ref();
    match word.to_str() {
        Some(text) if !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || PLAIN.contains(c)) => {
            text.to_owned()
        }
        Some(text) if !text.contains(char::is_control) => format!("'{}'", text.replace('\'', r"'\''")),
        _ => escaped(word.as_encoded_bytes()),
    }
}

/// Returns `$'…'`, in which bytes that cannot be printed are written as numbers, as bash, zsh and POSIX 2024 read them.
fn escaped(bytes: &[u8]) -> String {
    let mut text = String::from("$'");
    for &byte in bytes {
        match byte {
            b'\'' | b'\\' => text.extend(['\\', char::from(byte)]),
            b' '..=b'~' => text.push(char::from(byte)),
            // Three octal digits end by themselves, whatever follows. Writing to a text does not fail.
            _ => _ = write!(text, "\\{byte:03o}"),
        }
    }
    text + "'"
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::ffi::OsStrExt as _;
    use std::process::Command;

    #[test]
    fn a_shell_reads_back_what_was_quoted() {
        for word in
            ["plain/a-b_c.urdf", "mit_ä", "dir mit ä", "", "it's", "$HOME `ls` \"x\" \\ * ? ~ # ! & ; |", "~"]
        {
            let said =
                Command::new("sh").args(["-c", &format!("printf %s {}", quoted(word))]).output().unwrap();
            assert_eq!(String::from_utf8(said.stdout).unwrap(), word);
        }
        assert_eq!(quoted("plain/a-b_c.urdf"), "plain/a-b_c.urdf");
        assert_eq!(quoted("mit_ä"), "mit_ä");
        // What is no text, or more than one line, needs a shell that knows $'…'.
        for word in [&b"a\xff1"[..], b"two\nlines", b"it's\t\\ \xe4"] {
            let quoted = quoted(OsStr::from_bytes(word));
            assert!(quoted.is_ascii() && !quoted.contains('\n'), "{quoted}");
            let Ok(said) = Command::new("bash").args(["-c", &format!("printf %s {quoted}")]).output() else {
                return;
            };
            assert_eq!(said.stdout, word, "{quoted}");
        }
    }
}
