//! "Did you mean": the known name that was probably meant by an unknown one.

/// The number of first characters in which names must agree to be considered similar.
const BEGINNING: usize = 3;

/// Longer names, in bytes, are not compared letter by letter: time and memory would grow with the product of both lengths.
const LONGEST: usize = 100;

/// The greatest number of candidates that a name is compared with, because a file can have many unknown names.
const MOST: usize = 1000;

/// The similarity of a candidate, the most similar first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Likeness {
    /// It differs by one typing error.
    Slip,
    /// It begins or ends with the whole name.
    Part,
    /// It differs by two typing errors.
    TwoSlips,
    /// It begins with the same characters, except for this number of the name's last ones.
    Beginning(usize),
    /// Two thirds of it agree.
    Most,
    Unlike,
}

fn likeness(name: &str, candidate: &str, distance: usize) -> Likeness {
    let (length, other) = (name.chars().count(), candidate.chars().count());
    // All topics begin with a slash, which makes none of them alike.
    let [bare, other_bare] = [name, candidate].map(|name| name.trim_start_matches('/'));
    let beginning = bare.chars().zip(other_bare.chars()).take_while(|(one, other)| one == other).count();
    if distance <= 1 {
        Likeness::Slip
    } else if !name.is_empty() && (candidate.starts_with(name) || candidate.ends_with(name)) {
        Likeness::Part
    } else if distance == 2 && length > 5 {
        Likeness::TwoSlips
    } else if beginning >= BEGINNING {
        Likeness::Beginning(bare.chars().count() - beginning)
    } else if 3 * distance <= length.max(other) {
        Likeness::Most
    } else {
        Likeness::Unlike
    }
}

/// Returns the candidate most similar to the name, however different it is, with its similarity.
fn most_like<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<(Likeness, usize, &'a str)> {
    let judged = candidates.into_iter().take(MOST).map(|candidate| {
        let distance = if name.len().max(candidate.len()) <= LONGEST {
            strsim::damerau_levenshtein(name, candidate)
        } else {
            name.len().max(candidate.len())
        };
        (likeness(name, candidate, distance), distance, candidate)
    });
    judged.min_by_key(|(likeness, distance, _)| (*likeness, *distance))
}

/// Returns the candidate most similar to the name, if one of them must have been meant.
pub fn closest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    most_like(name, candidates).map(|(_, _, candidate)| candidate)
}

/// Returns the candidate that was probably meant: one that differs by a typing error; else one that begins or ends like
/// the name; else one of which two thirds agree. `None` if there is no such candidate.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let likely = most_like(name, candidates).filter(|(likeness, ..)| *likeness != Likeness::Unlike);
    likely.map(|(_, _, candidate)| candidate)
}

/// Returns the question "did you mean …?", if there is a probable candidate.
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(name, candidates).map(|near| format!("did you mean '{near}'?"))
}

/// Returns the question, if there is a probable candidate, followed by another remedy; otherwise only the remedy.
pub fn did_you_mean_or<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
    otherwise: &str,
) -> String {
    did_you_mean(name, candidates)
        .map_or_else(|| otherwise.to_owned(), |meant| format!("{meant} {otherwise}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_beginnings_count_more_than_edit_distance() {
        let links = ["laser", "base_footprint", "base_link", "depth_joint", "left_wheel_joint"];
        for (name, expected) in [
            ("left_joint", Some("left_wheel_joint")),
            ("base", Some("base_link")),
            ("base_lnik", Some("base_link")),
            ("lazer", Some("laser")),
            ("wheel_joint", Some("left_wheel_joint")),
            ("dept_joint", Some("depth_joint")),
            ("gripper", None),
            ("", None),
        ] {
            assert_eq!(nearest(name, links), expected, "{name}");
        }
        let topics = ["/camera/rgb/image_raw", "/camera/depth/image_raw", "/scan", "/odom"];
        assert_eq!(nearest("/scam", topics), Some("/scan"));
        assert_eq!(nearest("/depth/image_raw", topics), Some("/camera/depth/image_raw"));
        assert_eq!(nearest("/xyz", topics), None);
        assert_eq!(nearest("/scan", ["/cam", "/tf", "/clock"]), None);
        assert_eq!(nearest("/imu", ["/odom", "/image"]), None);
        assert_eq!(nearest("/imige_rwa", ["/odom", "/image_raw"]), Some("/image_raw"));
        assert_eq!(nearest("weel_r", ["wheel_l", "wheel_r", "weight"]), Some("wheel_r"));
        assert_eq!(nearest("x", ["y"]), Some("y"));
        assert_eq!(nearest("hokuyo", ["camera"]), None);
        assert_eq!(closest("hokuyo", ["camera"]), Some("camera"));
    }

    #[test]
    fn the_question_precedes_the_remedy() {
        assert_eq!(
            did_you_mean_or("lazer", ["laser"], "else leave it out"),
            "did you mean 'laser'? else leave it out"
        );
        assert_eq!(did_you_mean_or("lazer", ["hokuyo"], "leave it out"), "leave it out");
    }
}
