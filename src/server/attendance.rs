//! Consumers that the simulation waits for: at the start, and whenever one of them is gone.

use crate::rig::Rig;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// How long consumers are waited for at the start, if nothing else is asked for: other programs may have to be started
/// first, by hand perhaps.
pub const START_PATIENCE: Duration = Duration::from_secs(60);

/// A consumer that is waited for, by the name of its node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Awaited {
    /// What the consumer calls itself.
    pub name: String,
    /// Streams that it must follow for the simulation to go on, or [`Awaited::ALL`].
    pub streams: usize,
}

impl Awaited {
    /// As many streams as there are.
    pub const ALL: usize = usize::MAX;
}

/// `NAME` or `NAME=STREAMS`.
impl FromStr for Awaited {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, streams) = match text.rsplit_once('=') {
            None => (text, 1),
            Some((name, count)) => match count.parse() {
                Ok(streams) if streams > 0 => (name, streams),
                _ => return Err(format!("after = a number of streams is wanted, not \"{count}\"")),
            },
        };
        if name.is_empty() {
            return Err("a name is wanted, such as recorder or recorder=3".into());
        }
        Ok(Self { name: name.into(), streams })
    }
}

/// One that is not there, or not yet completely.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Its name.
    pub name: String,
    /// Streams that it follows now.
    pub following: usize,
    /// Streams that it must follow.
    pub needed: usize,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\"", self.name)?;
        if self.needed > 1 {
            write!(f, " ({} of {} streams)", self.following, self.needed)?;
        }
        Ok(())
    }
}

/// Which of the consumers that are waited for are there.
#[derive(Debug)]
pub struct Attendance {
    awaited: Vec<Roll>,
    /// The rig's edition and the subscribers of every stream, when they were last looked at closely.
    seen: Option<(u64, Vec<usize>)>,
    missing: Vec<Missing>,
}

/// What is known of one that is waited for.
#[derive(Debug)]
struct Roll {
    awaited: Awaited,
    /// Topics that it follows, and those that it followed until the simulation closed them: of those it owes nothing.
    followed: HashSet<String>,
}

impl Attendance {
    /// Of these; of nobody if there are none.
    pub fn new(awaited: &[Awaited]) -> Self {
        let roll = |awaited: &Awaited| Roll { awaited: awaited.clone(), followed: HashSet::new() };
        Self { awaited: awaited.iter().map(roll).collect(), seen: None, missing: Vec::new() }
    }

    /// Who is missing. Costs a read of shared memory for each stream unless somebody has come or gone.
    pub fn missing(&mut self, rig: &Rig) -> &[Missing] {
        if self.awaited.is_empty() {
            return &[];
        }
        let outlets = rig.outlets();
        let seen = Some((rig.edition(), outlets.iter().map(|outlet| outlet.subscribers()).collect()));
        if seen != self.seen {
            let mut following: HashMap<String, HashSet<String>> = HashMap::new();
            for outlet in &outlets {
                for consumer in outlet.consumers() {
                    following.entry(consumer.name).or_default().insert(outlet.topic().to_owned());
                }
            }
            let open: HashSet<&str> = outlets.iter().map(|outlet| outlet.topic()).collect();
            let rolls = self.awaited.iter_mut();
            self.missing = rolls.filter_map(|roll| roll.call(&open, &following)).collect();
            self.seen = seen;
        }
        &self.missing
    }
}

impl Roll {
    /// What is missing of it, where these topics are open, and consumers follow these.
    fn call(
        &mut self,
        open: &HashSet<&str>,
        following: &HashMap<String, HashSet<String>>,
    ) -> Option<Missing> {
        let now = following.get(&self.awaited.name);
        self.followed.retain(|topic| !open.contains(topic.as_str()));
        let needed = self.awaited.streams.saturating_sub(self.followed.len()).min(open.len());
        self.followed.extend(now.into_iter().flatten().cloned());
        let following = now.map_or(0, HashSet::len);
        (following < needed).then(|| Missing { name: self.awaited.name.clone(), following, needed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_and_how_many_streams() {
        let awaited = |name: &str, streams| Ok(Awaited { name: name.into(), streams });
        assert_eq!("recorder".parse(), awaited("recorder", 1));
        assert_eq!("recorder=3".parse(), awaited("recorder", 3));
        assert_eq!("a=b=2".parse(), awaited("a=b", 2));
        for bad in ["", "=2", "recorder=", "recorder=0", "recorder=many"] {
            assert!(bad.parse::<Awaited>().is_err(), "{bad}");
        }
    }

    #[test]
    fn streams_that_are_closed_are_not_owed() {
        let topics = |topics: &[&str]| topics.iter().map(|topic| (*topic).to_owned()).collect();
        let missing = |roll: &mut Roll, open: &[&str], followed: &[&str]| {
            let following = HashMap::from([("recorder".to_owned(), topics(followed))]);
            roll.call(&open.iter().copied().collect(), &following).map(|missing| missing.to_string())
        };
        let roll = |streams| Roll {
            awaited: Awaited { name: "recorder".into(), streams },
            followed: HashSet::new(),
        };
        let mut two = roll(2);
        assert_eq!(missing(&mut two, &["/a", "/b", "/c"], &["/a"]).unwrap(), "\"recorder\" (1 of 2 streams)");
        assert_eq!(missing(&mut two, &["/a", "/b", "/c"], &["/a", "/b"]), None);
        // The simulation closes one, and opens it again.
        assert_eq!(missing(&mut two, &["/b", "/c"], &["/b"]), None);
        assert_eq!(missing(&mut two, &["/b", "/c"], &[]).unwrap(), "\"recorder\"");
        assert_eq!(missing(&mut two, &["/a", "/b", "/c"], &["/b"]).unwrap(), "\"recorder\" (1 of 2 streams)");
        let mut all = roll(Awaited::ALL);
        assert_eq!(missing(&mut all, &["/a", "/b"], &["/a"]).unwrap(), "\"recorder\" (1 of 2 streams)");
        assert_eq!(missing(&mut all, &["/a"], &["/a"]), None);
        assert_eq!(missing(&mut all, &["/a", "/b"], &["/a"]).unwrap(), "\"recorder\" (1 of 2 streams)");
    }
}
