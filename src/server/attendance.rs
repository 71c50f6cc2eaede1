//! [`Attendance`]: the consumers that the simulation waits for, at the start and whenever one of them disconnects.

use crate::rig::Rig;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// Default time to wait for consumers at the start, when other programs may have to be started first, perhaps by hand.
pub const START_PATIENCE: Duration = Duration::from_secs(60);

/// A consumer that the simulation waits for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Awaited {
    /// Name of the consumer's node.
    pub name: String,
    /// Number of streams that it must subscribe to before the simulation continues, or [`Awaited::ALL`].
    pub streams: usize,
}

impl Awaited {
    /// All streams.
    pub const ALL: usize = usize::MAX;
}

/// Parses `NAME` or `NAME=STREAMS`.
impl FromStr for Awaited {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, streams) = match text.rsplit_once('=') {
            None => (text, 1),
            Some((name, count)) => match count.parse() {
                Ok(streams) if streams > 0 => (name, streams),
                _ => return Err(format!("expected a number of streams after =, not \"{count}\"")),
            },
        };
        if name.is_empty() {
            return Err("expected a name, such as recorder or recorder=3".into());
        }
        Ok(Self { name: name.into(), streams })
    }
}

/// A consumer that is missing, or lacks subscriptions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Name of the consumer's node.
    pub name: String,
    /// Number of streams that it subscribes to now.
    pub following: usize,
    /// Number of streams that it must subscribe to.
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

/// Keeps track of which awaited consumers are connected.
#[derive(Debug)]
pub struct Attendance {
    awaited: Vec<Roll>,
    /// The rig's edition and the number of subscribers of every stream at the last full check.
    seen: Option<(u64, Vec<usize>)>,
    missing: Vec<Missing>,
}

/// State of one awaited consumer.
#[derive(Debug)]
struct Roll {
    awaited: Awaited,
    /// Topics that it subscribes to, and those that it subscribed to until the simulation closed them, which still
    /// count.
    followed: HashSet<String>,
}

impl Attendance {
    /// Creates it for these consumers, of which there may be none.
    pub fn new(awaited: &[Awaited]) -> Self {
        let roll = |awaited: &Awaited| Roll { awaited: awaited.clone(), followed: HashSet::new() };
        Self { awaited: awaited.iter().map(roll).collect(), seen: None, missing: Vec::new() }
    }

    /// Returns the missing consumers. While no subscriber comes or goes, this only reads shared memory once for each
    /// stream.
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
    /// Returns what the consumer lacks, given the open topics and the topics that each consumer subscribes to.
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
    fn streams_that_were_closed_still_count() {
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
        // The simulation closes a stream and opens it again.
        assert_eq!(missing(&mut two, &["/b", "/c"], &["/b"]), None);
        assert_eq!(missing(&mut two, &["/b", "/c"], &[]).unwrap(), "\"recorder\"");
        assert_eq!(missing(&mut two, &["/a", "/b", "/c"], &["/b"]).unwrap(), "\"recorder\" (1 of 2 streams)");
        let mut all = roll(Awaited::ALL);
        assert_eq!(missing(&mut all, &["/a", "/b"], &["/a"]).unwrap(), "\"recorder\" (1 of 2 streams)");
        assert_eq!(missing(&mut all, &["/a"], &["/a"]), None);
        assert_eq!(missing(&mut all, &["/a", "/b"], &["/a"]).unwrap(), "\"recorder\" (1 of 2 streams)");
    }
}
