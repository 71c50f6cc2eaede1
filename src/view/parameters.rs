//! Parameters of ROS, as clients of Foxglove's protocol are told of them: the descriptions of robots come and go with these.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The parameters of a server.
#[derive(Debug)]
pub(super) struct Parameters(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    /// By their names: the edition in which each was changed, and its value; none of one that is gone.
    known: BTreeMap<String, (u64, Option<Value>)>,
    edition: u64,
}

/// Parameters whose changes a client is told of.
#[derive(Debug, Default)]
pub(super) struct Followed {
    names: BTreeSet<String>,
    is_all: bool,
    edition: u64,
}

impl Parameters {
    /// Returns those that never change.
    pub(super) fn new() -> Self {
        let parameters = Self(Mutex::default());
        parameters.set("/use_sim_time".to_owned(), Some(Value::Bool(true)));
        parameters
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives a parameter this value, or takes it away.
    pub(super) fn set(&self, name: String, value: Option<Value>) {
        let mut state = self.state();
        state.edition += 1;
        let edition = state.edition;
        state.known.insert(name, (edition, value));
    }

    /// Whether there is a parameter of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.state().known.get(name).is_some_and(|(_, value)| value.is_some())
    }

    /// Returns the parameters of these names that there are, or all if no name is given.
    pub(super) fn values(&self, names: &[String]) -> Vec<Value> {
        let state = self.state();
        let wanted = state.known.iter().filter(|(name, _)| names.is_empty() || names.contains(name));
        wanted
            .filter_map(|(name, (_, value))| Some(json!({ "name": name, "value": value.as_ref()? })))
            .collect()
    }

    /// Returns what has changed of the followed ones since this was called last. Those that are gone have no value.
    pub(super) fn changes(&self, followed: &mut Followed) -> Vec<Value> {
        let state = self.state();
        let before = std::mem::replace(&mut followed.edition, state.edition);
        if before == state.edition {
            return Vec::new();
        }
        let changed =
            state.known.iter().filter(|(name, (edition, _))| *edition > before && followed.has(name));
        changed
            .map(|(name, (_, value))| match value {
                Some(value) => json!({ "name": name, "value": value }),
                None => json!({ "name": name }),
            })
            .collect()
    }
}

impl Followed {
    fn has(&self, name: &str) -> bool {
        self.is_all || self.names.contains(name)
    }

    /// Follows the parameters of these names, or all if no name is given.
    pub(super) fn follow(&mut self, names: Vec<String>) {
        self.is_all |= names.is_empty();
        self.names.extend(names);
    }

    /// Follows the parameters of these names no longer, or none if no name is given.
    pub(super) fn leave(&mut self, names: &[String]) {
        if names.is_empty() {
            (self.is_all, self.names) = (false, BTreeSet::new());
        }
        self.names.retain(|name| !names.contains(name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_told_once_to_those_who_follow() {
        let parameters = Parameters::new();
        let (mut one, mut all, mut nothing) = (Followed::default(), Followed::default(), Followed::default());
        one.follow(vec!["/a".into()]);
        all.follow(Vec::new());
        parameters.set("/a".into(), Some(json!(1)));
        parameters.set("/b".into(), Some(json!(2)));
        let (a, b) = (json!({ "name": "/a", "value": 1 }), json!({ "name": "/b", "value": 2 }));
        let told = parameters.changes(&mut one);
        assert!(told.len() == 1 && told[0] == a, "{told:?}");
        assert_eq!(parameters.changes(&mut all)[..2], [a.clone(), b]);
        assert_eq!(parameters.changes(&mut nothing), [] as [Value; 0]);
        assert_eq!(parameters.values(&["/a".into()]), [a]);
        parameters.set("/a".into(), None);
        for followed in [&mut one, &mut all] {
            assert_eq!(parameters.changes(followed), [json!({ "name": "/a" })]);
            assert_eq!(parameters.changes(followed), [] as [Value; 0]);
        }
        assert!(!parameters.has("/a") && parameters.has("/b"));
        assert_eq!(parameters.values(&["/a".into()]), [] as [Value; 0]);
        one.leave(&["/a".into()]);
        all.leave(&[]);
        parameters.set("/a".into(), Some(json!(3)));
        for followed in [&mut one, &mut all] {
            assert_eq!(parameters.changes(followed), [] as [Value; 0]);
        }
    }
}
