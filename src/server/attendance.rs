//! Consumers that the simulation waits for: at the start, and whenever one of them is gone.

use crate::rig::Rig;
use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;

/// A consumer that is waited for, by the name of its node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Awaited {
    /// What the consumer calls itself.
    pub name: String,
    /// Streams that it must follow for the simulation to go on.
    pub streams: usize,
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

impl fmt::Display for Awaited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\"", self.name)
    }
}

/// One that is not there, or not yet completely.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Who.
    pub awaited: Awaited,
    /// Streams that it follows now.
    pub following: usize,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.awaited)?;
        if self.awaited.streams > 1 {
            write!(f, " ({} of {} streams)", self.following, self.awaited.streams)?;
        }
        Ok(())
    }
}

/// Who is there of those who are waited for.
#[derive(Debug)]
pub struct Attendance {
    awaited: Vec<Awaited>,
    /// Subscribers of every stream when it was last looked at closely.
    seen: Vec<usize>,
    missing: Vec<Missing>,
}

impl Attendance {
    /// Of these; of nobody if there are none.
    pub fn new(awaited: &[Awaited]) -> Self {
        let missing = awaited.iter().map(|awaited| Missing { awaited: awaited.clone(), following: 0 });
        Self { awaited: awaited.to_vec(), seen: Vec::new(), missing: missing.collect() }
    }

    /// Who is missing. Costs a read of shared memory for each stream unless somebody has come or gone.
    pub fn missing(&mut self, rig: &Rig) -> &[Missing] {
        if self.awaited.is_empty() {
            return &[];
        }
        let outlets = rig.outlets();
        let seen: Vec<usize> = outlets.iter().map(|outlet| outlet.subscribers()).collect();
        if seen != self.seen {
            let mut following: HashMap<String, usize> = HashMap::new();
            for consumer in outlets.iter().flat_map(|outlet| outlet.consumers()) {
                *following.entry(consumer.name).or_default() += 1;
            }
            let missing = |awaited: &Awaited| {
                let following = following.get(&awaited.name).copied().unwrap_or(0);
                (following < awaited.streams).then(|| Missing { awaited: awaited.clone(), following })
            };
            self.missing = self.awaited.iter().filter_map(missing).collect();
            self.seen = seen;
        }
        &self.missing
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
}
