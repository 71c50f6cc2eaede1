//! Things alike, counted.

use crate::description::model::Model;

/// How many fiducials of each family a model has, if it has any.
pub(super) fn fiducials(model: &Model) -> Option<String> {
    let visuals = model.links.iter().flat_map(|link| &link.visuals);
    let families: Vec<_> =
        visuals.flat_map(|visual| &visual.fiducials).map(|tag| tag.family.clone()).collect();
    (!families.is_empty()).then(|| counted(&families))
}

/// Words in order, those alike counted where the first of them stands.
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
    fn words_alike_are_counted() {
        assert_eq!(counted(&["a", "b", "a"].map(str::to_owned)), "2 × a, b");
    }
}
