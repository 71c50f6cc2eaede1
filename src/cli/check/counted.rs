//! Lists of words with counts.

use crate::description::model::Model;

/// Counts a model's fiducials by family. Returns `None` if it has none.
pub(super) fn fiducials(model: &Model) -> Option<String> {
    let visuals = model.links.iter().flat_map(|link| &link.visuals);
    let families: Vec<_> =
        visuals.flat_map(|visual| &visual.fiducials).map(|tag| tag.family.clone()).collect();
    (!families.is_empty()).then(|| counted(&families))
}

/// Joins words in the order of their first occurrence, with a count for each word that is repeated.
pub(super) fn counted(words: &[String]) -> String {
    let mut groups: Vec<(&str, usize)> = Vec::new();
    for word in words {
        match groups.iter_mut().find(|(other, _)| other == word) {
            Some((_, count)) => *count += 1,
            None => groups.push((word, 1)),
        }
    }
    let texts = groups.iter().map(|(word, count)| match count {
        1 => (*word).to_owned(),
        many => format!("{many} × {word}"),
    });
    texts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_words_are_counted() {
        assert_eq!(counted(&["a", "b", "a"].map(str::to_owned)), "2 × a, b");
    }
}
