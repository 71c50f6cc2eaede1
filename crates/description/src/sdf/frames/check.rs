//! Checks of all frames of a model or world, also of those that nothing refers to.

use super::{Attachment, Frames};
use crate::diagnostics::Diagnostics;
use std::collections::HashSet;

impl Frames {
    /// Adds an error for each frame whose pose cannot be found, and for each that is attached to nothing.
    pub(in crate::sdf) fn check(&self, diagnostics: &mut Diagnostics) {
        for (name, frame) in &self.own {
            self.follow(name, Some(frame), &frame.source, diagnostics);
        }
        for (name, frame) in &self.joints {
            // A child that does not exist is reported with the joint.
            if matches!(&frame.attachment, Attachment::To(child) if *child == frame.parent && !self.knows(child))
            {
                continue;
            }
            self.follow(name, Some(frame), &frame.source, diagnostics);
        }
        let mut seen: HashSet<&str> = HashSet::new();
        for name in self.own.keys() {
            self.check_attachment(name, &mut seen, diagnostics);
        }
    }

    /// Follows the chain of what a frame is attached to, up to the first frame of an earlier chain.
    fn check_attachment<'f>(
        &'f self,
        mut name: &'f str,
        seen: &mut HashSet<&'f str>,
        diagnostics: &mut Diagnostics,
    ) {
        let mut chain: HashSet<&str> = HashSet::new();
        while let Some(frame) = self.get(name)
            && let Attachment::To(to) = &frame.attachment
        {
            if !seen.insert(name) {
                if chain.contains(name) {
                    let what = format!("the frame '{name}' is attached to itself");
                    diagnostics.error(&frame.source, what, "break the circle of attached_to");
                }
                return;
            }
            chain.insert(name);
            // The ends of joints are checked with the joints.
            if !self.knows(to) && self.has(name) {
                self.tell_unknown(to, &frame.source, false, diagnostics);
            }
            name = to;
        }
    }
}
