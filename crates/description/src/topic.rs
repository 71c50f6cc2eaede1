//! Names of topics in plugins and sensors.

use super::diagnostics::Diagnostics;
use super::xml::Element;

/// Elements that are parts of topics, in addition to those whose names end in `topic`.
const PARTS: [&str; 5] = ["robotnamespace", "node_namespace", "cameraname", "camera_name", "namespace"];

/// Adds an error for each topic, or part of one, in an element's children that is not valid as the name of a stream.
pub(super) fn check(parent: &Element, diagnostics: &mut Diagnostics) {
    for child in parent.elements() {
        let name = child.name.to_ascii_lowercase();
        let is_topic = ["topic", "topicname", "topic_name"].iter().any(|end| name.ends_with(end));
        let text = child.text();
        if (is_topic || PARTS.contains(&&*name)) && !text.chars().all(is_usable) {
            let wrong: String = text.chars().filter(|character| !is_usable(*character)).take(1).collect();
            diagnostics.error(
                &child.source,
                format!("<{}> is '{text}': '{wrong}' cannot be in a topic", child.name),
                "use a-z A-Z 0-9 _ - . ~ and /",
            );
        }
    }
}

fn is_usable(character: char) -> bool {
    character.is_ascii_alphanumeric() || "_/-.~".contains(character)
}
