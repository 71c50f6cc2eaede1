//! The rules for topic names.

use crate::Error;

/// Checks a topic and returns it without its leading slash.
pub(crate) fn canonical_topic(topic: &str) -> Result<&str, Error> {
    let bare = topic.strip_prefix('/').unwrap_or(topic);
    let invalid = |reason| Err(Error::InvalidTopic { topic: topic.to_owned(), reason });
    if bare.is_empty() {
        return invalid("it is empty");
    }
    if bare.len() > 200 {
        return invalid("it is longer than 200 characters");
    }
    if !bare.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_/-.~".contains(&byte)) {
        return invalid("only a-z A-Z 0-9 _ - . ~ and / are allowed");
    }
    if bare.starts_with('/') || bare.ends_with('/') || bare.contains("//") {
        return invalid("a part between slashes is empty");
    }
    Ok(bare)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_lose_their_leading_slash_only() {
        assert_eq!(canonical_topic("/camera/rgb/image_raw").unwrap(), "camera/rgb/image_raw");
        assert_eq!(canonical_topic("scan").unwrap(), "scan");
        for bad in ["", "/", "a//b", "a/", "a b", "//a"] {
            assert!(canonical_topic(bad).is_err(), "{bad}");
        }
    }
}
