//! [`Names`]: the topics that are taken, with their owners, and the rules for a second stream on the same topic.

use super::RigError;
use super::outlet::Outlet;
use super::owner::Owner;
use crate::description::diagnostics::{Problem, Severity, Source};
use belvedere_bridge::{Error, Kind, StreamSpec};
use std::cell::RefCell;
use std::collections::HashMap;

/// The topics of a rig while streams are opened, and notes on decisions about them.
pub(super) struct Names {
    taken: RefCell<HashMap<String, (Kind, Owner)>>,
    /// For each topic that several streams requested: the next number to try, so that assigned numbers are not tried
    /// again.
    next: RefCell<HashMap<String, u32>>,
    notes: RefCell<Vec<Problem>>,
}

impl Names {
    /// Returns the names of open streams.
    pub(super) fn of<'a>(outlets: impl IntoIterator<Item = &'a Outlet>) -> Self {
        let taken = outlets.into_iter().map(|outlet| {
            let owner = outlet.owner().clone();
            (outlet.topic().to_owned(), (outlet.kind(), owner))
        });
        Self { taken: RefCell::new(taken.collect()), next: RefCell::default(), notes: RefCell::default() }
    }

    /// Returns true if a stream has this topic, which begins with a slash.
    pub(super) fn is_taken(&self, topic: &str) -> bool {
        self.taken.borrow().contains_key(topic)
    }

    /// Adds a note on a decision.
    pub(super) fn note(&self, severity: Severity, source: &Source, what: String, remedy: &str) {
        let source = source.clone();
        self.notes.borrow_mut().push(Problem { severity, source, what, remedy: remedy.into() });
    }

    /// Returns the notes.
    pub(super) fn into_notes(self) -> Vec<Problem> {
        self.notes.into_inner()
    }

    /// Assigns a topic to a stream: the requested one, unless another stream has it.
    ///
    /// Gazebo publishes both streams on one topic, which is not possible in shared memory. The second stream is treated
    /// as follows:
    ///
    /// - A `CameraInfo` gets a topic next to its image, with a warning, because gz-sim derives the same topic for all
    ///   cameras of a folder.
    /// - A topic that was derived from names is numbered, with a warning: `a b` and `a:b` become the same word, because
    ///   a topic cannot contain all characters.
    /// - Any other stream is an error. With `gazebo_compat` its topic is numbered, with a warning.
    pub(super) fn settle(
        &self,
        spec: StreamSpec,
        picture: Option<&str>,
        owner: &Owner,
        gazebo_compat: bool,
    ) -> Result<StreamSpec, RigError> {
        let topic = with_slash(&spec)?;
        let mut taken = self.taken.borrow_mut();
        let Some((kind, first)) = taken.get(&topic).cloned() else {
            taken.insert(topic, (spec.kind, owner.clone()));
            return Ok(spec);
        };
        let is_info = kind == Kind::CameraInfo && spec.kind == Kind::CameraInfo;
        let beside = picture.filter(|_| is_info).map(|picture| format!("{picture}/camera_info"));
        // As `name_sensor_topics` makes them.
        let is_made = topic.contains("/world/") && topic.contains("/sensor/");
        let mut next = self.next.borrow_mut();
        let next = next.entry(topic.clone()).or_insert(2);
        let numbered = std::iter::from_fn(|| {
            let number = *next;
            *next += 1;
            Some(format!("{topic}_{number}"))
        });
        for free in beside.into_iter().chain(numbered.take_while(|_| gazebo_compat || is_made)) {
            let spec = StreamSpec { topic: free, ..spec.clone() };
            let free = with_slash(&spec)?;
            if taken.contains_key(&free) {
                continue;
            }
            let what = format!(
                "{} has the topic {topic}, which is that of {} ({}): it is published as {free}. Gazebo publishes both \
                 under one name",
                owner.name, first.name, first.source
            );
            let remedy = if is_info {
                "give each camera a topic in a folder of its own, as in left/image, or name the topics of their infos"
            } else {
                "give one of them another topic"
            };
            self.note(Severity::Warning, &owner.source, what, remedy);
            taken.insert(free, (spec.kind, owner.clone()));
            return Ok(spec);
        }
        Err(RigError::topic_taken(&topic, &first, owner))
    }
}

fn with_slash(spec: &StreamSpec) -> Result<String, Error> {
    Ok(format!("/{}", spec.name()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_that_names_make_are_numbered() {
        let names = Names::of([]);
        let settle = |topic: &str| {
            let asked = StreamSpec::structs(topic, Kind::Clock, 1);
            names.settle(asked, None, &Owner::simulation(), false).map(|spec| spec.topic)
        };
        let made = "/world/w/model/a_b/link/l/sensor/s/imu";
        assert_eq!([settle(made), settle(made)].map(Result::unwrap), [made.to_owned(), format!("{made}_2")]);
        assert_eq!(settle("/imu").unwrap(), "/imu");
        assert!(settle("/imu").is_err());
        assert_eq!(names.into_notes().len(), 1);
    }

    /// Returns the topics of `count` streams that ask for the same one, and the number of attempts.
    fn settled(count: usize) -> (Vec<String>, u32) {
        let names = Names::of([]);
        let asked = StreamSpec::structs("/scan", Kind::Clock, 1);
        let settle = |_| names.settle(asked.clone(), None, &Owner::simulation(), true).unwrap().topic;
        let topics = (0..count).map(settle).collect();
        let tried = names.next.borrow().values().map(|next| next - 2).sum();
        (topics, tried)
    }

    #[test]
    fn each_number_is_tried_once() {
        let (topics, tried) = settled(5000);
        assert_eq!(topics[..4], ["/scan", "/scan_2", "/scan_3", "/scan_4"]);
        assert_eq!(topics[4999], "/scan_5000");
        assert_eq!(tried, 4999);
    }
}
