//! [`Parameters`]: ROS parameters for Foxglove clients, among them the descriptions of robots.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The parameters of a server.
#[derive(Debug)]
pub(super) struct Parameters(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    /// By name: the edition of the last change, and the value, which is `None` if the parameter was removed.
    known: BTreeMap<String, (u64, Option<Value>)>,
    edition: u64,
}

/// The parameters whose changes a client subscribes to.
#[derive(Debug, Default)]
pub(super) struct Followed {
    names: BTreeSet<String>,
    is_all: bool,
    edition: u64,
}

impl Parameters {
    /// Creates the parameters that never change.
    pub(super) fn new() -> Self {
        let parameters = Self(Mutex::default());
        parameters.set("/use_sim_time".to_owned(), Some(Value::Bool(true)));
        parameters
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets a parameter to this value, or removes it.
    pub(super) fn set(&self, name: String, value: Option<Value>) {
        let mut state = self.state();
        state.edition += 1;
        let edition = state.edition;
        state.known.insert(name, (edition, value));
    }

    /// Returns true if there is a parameter with this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.state().known.get(name).is_some_and(|(_, value)| value.is_some())
    }

    /// Returns the parameters with these names, or all if no name is given.
    pub(super) fn values(&self, names: &[String]) -> Vec<Value> {
        let state = self.state();
        let wanted = state.known.iter().filter(|(name, _)| names.is_empty() || names.contains(name));
        wanted
            .filter_map(|(name, (_, value))| Some(json!({ "name": name, "value": value.as_ref()? })))
            .collect()
    }

    /// Returns the subscribed parameters that have changed since the last call. Removed ones have no value.
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

    /// Subscribes to the parameters with these names, or to all if no name is given.
    pub(super) fn follow(&mut self, names: Vec<String>) {
        self.is_all |= names.is_empty();
        self.names.extend(names);
    }

    /// Unsubscribes from the parameters with these names, or from all if no name is given.
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
    fn changes_are_reported_once_to_subscribed_clients() {
        let parameters = Parameters::new();
        let (mut one, mut all, mut nothing) = (Followed::default(), Followed::default(), Followed::default());
        one.follow(vec!["/a".into()]);
        all.follow(Vec::new());
        parameters.set("/a".into(), Some(json!(1)));
        parameters.set("/b".into(), Some(json!(2)));
        let (a, b) = (json!({ "name": "/a", "value": 1 }), json!({ "name": "/b", "value": 2 }));
        let changes = parameters.changes(&mut one);
        assert!(changes.len() == 1 && changes[0] == a, "{changes:?}");
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
