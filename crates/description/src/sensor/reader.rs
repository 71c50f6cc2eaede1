//! Reading and checking of the values in a sensor's elements.

use crate::diagnostics::{Diagnostics, Source};
use crate::rules::Rules;
use crate::values::number;
use crate::xml::Element;

/// The lowest rate that timestamps support: once in twelve days.
const MIN_RATE_HZ: f64 = 1e-6;
/// The highest rate: physics never steps faster.
const MAX_RATE_HZ: f64 = 1e6;

/// Reads the values of one sensor; its errors name the sensor.
///
/// A value that is absent, or whose parent is, gives its default; a wrong value gives none and an error.
pub(super) struct Reader<'a> {
    /// Name of the sensor.
    pub(super) sensor: String,
    /// Rate of its plugin, once that has been read.
    pub(super) plugin_rate_hz: Option<f64>,
    pub(super) rules: Rules,
    pub(super) diagnostics: &'a mut Diagnostics,
}

impl Reader<'_> {
    /// Reads a finite number in the child element `name` that fulfils a condition; `remedy` states the condition.
    pub(super) fn checked(
        &mut self,
        parent: Option<&Element>,
        name: &str,
        default: f64,
        is_valid: impl Fn(f64) -> bool,
        remedy: &str,
    ) -> Option<f64> {
        let Some(child) = parent.and_then(|parent| parent.child(name)) else { return Some(default) };
        let what = self.what(name);
        let value = number(&child.text(), &what, &child.source, self.diagnostics)?;
        if is_valid(value) {
            return Some(value);
        }
        self.diagnostics.error(&child.source, format!("{what} is {value}"), remedy);
        None
    }

    /// Reads a finite number.
    pub(super) fn number(&mut self, parent: Option<&Element>, name: &str, default: f64) -> Option<f64> {
        self.checked(parent, name, default, |_| true, "")
    }

    /// Reads a number of 0 or more; 0 if absent.
    pub(super) fn not_negative(&mut self, parent: Option<&Element>, name: &str) -> Option<f64> {
        self.checked(parent, name, 0.0, |value| value >= 0.0, "write 0 or more")
    }

    /// Reads a whole number from 1 to `max`. `640.0` is accepted because xacro's arithmetic writes numbers so.
    pub(super) fn count(
        &mut self,
        parent: Option<&Element>,
        name: &str,
        default: u32,
        max: u32,
    ) -> Option<u32> {
        let is_valid = |value: f64| value.fract() == 0.0 && (1.0..=f64::from(max)).contains(&value);
        let remedy = format!("write a whole number from 1 to {max}");
        self.checked(parent, name, f64::from(default), is_valid, &remedy).map(|value| value as u32)
    }

    /// Like [`Reader::count`], but drops a fraction, as Gazebo does.
    pub(super) fn truncated(
        &mut self,
        parent: Option<&Element>,
        name: &str,
        default: u32,
        max: u32,
    ) -> Option<u32> {
        let is_valid = |value: f64| (1.0..=f64::from(max)).contains(&value);
        let remedy = format!("write a whole number from 1 to {max}");
        let value = self.checked(parent, name, f64::from(default), is_valid, &remedy)?;
        if value.fract() != 0.0
            && let Some(child) = parent.and_then(|parent| parent.child(name))
        {
            let what = format!("{} is {value}: its fraction is dropped, as in Gazebo", self.what(name));
            self.diagnostics.warning(&child.source, what, &remedy);
        }
        Some(value as u32)
    }

    /// Reads a rate in hertz; the inner none means every step, written as 0.
    #[expect(clippy::option_option, reason = "outer: readable; inner: limited")]
    pub(super) fn rate(&mut self, parent: &Element, name: &str) -> Option<Option<f64>> {
        let remedy = "write a rate in hertz, or 0 for every step";
        let rate = self.checked(Some(parent), name, 0.0, |rate| rate >= 0.0, remedy)?;
        if rate == 0.0 {
            return Some(None);
        }
        let kept = rate.clamp(MIN_RATE_HZ, MAX_RATE_HZ);
        if kept != rate {
            let what = if rate > kept {
                format!("{} is {rate} Hz: it measures at every step", self.what(name))
            } else {
                format!("{} is {rate} Hz: it measures every {} s", self.what(name), 1.0 / kept)
            };
            let remedy = format!("write a rate from {MIN_RATE_HZ} to {MAX_RATE_HZ} Hz, or 0 for every step");
            self.diagnostics.warning(Self::place(Some(parent), name, parent), what, remedy);
        }
        Some((rate <= MAX_RATE_HZ).then_some(kept))
    }

    /// Adds a warning for each child of an element that is not read.
    pub(super) fn left_out(&mut self, parent: &Element, is_read: impl Fn(&str) -> bool, remedy: &str) {
        for child in parent.elements().filter(|child| !is_read(&child.name)) {
            let what = format!("{} is not simulated and is left out", self.what(&child.name));
            self.diagnostics.warning(&child.source, what, remedy);
        }
    }

    /// Returns the name of the value in the child element `name` for errors.
    pub(super) fn what(&self, name: &str) -> String {
        format!("<{name}> of sensor '{}'", self.sensor)
    }

    /// Returns the place of the child element `name`, of its parent, or of the element that contains the parent.
    pub(super) fn place<'e>(parent: Option<&'e Element>, name: &str, outer: &'e Element) -> &'e Source {
        let parent = parent.unwrap_or(outer);
        parent.child(name).map_or(&parent.source, |child| &child.source)
    }
}
