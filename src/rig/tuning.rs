//! Changes a sensor's settings while it runs, and publishes them.

use super::{Rate, Rig, Scheduled, Settings};
use crate::description::suggestion::did_you_mean_or;

/// A sensor's settings, as described and as they are now.
pub(super) struct Tuning {
    pub(super) sensor: String,
    pub(super) described: Settings,
    pub(super) now: Settings,
}

impl Scheduled {
    /// Applies other settings from the next frame on.
    pub(super) fn configure(&mut self, settings: Settings, now_ns: u64) -> Result<(), String> {
        let Some(tuning) = &mut self.tuning else { return Ok(()) };
        let rate_hz = settings.update_rate_hz();
        let rate = Rate::from_hz(rate_hz).ok_or_else(|| format!("{rate_hz} Hz is not a valid rate"))?;
        self.channel.configure(&settings).map_err(|error| error.to_string())?;
        if rate_hz.to_bits() != tuning.now.update_rate_hz().to_bits() {
            self.schedule.change_rate(rate, now_ns);
        }
        tuning.now = settings;
        self.channel.outlets().into_iter().for_each(|outlet| outlet.set_rate_hz(rate_hz));
        Ok(())
    }

    fn topics(&self) -> Vec<String> {
        self.channel.outlets().into_iter().map(|outlet| outlet.topic().to_owned()).collect()
    }
}

impl Rig {
    /// Changes settings of a sensor, given by its name or one of its topics: all changes in the text, or none.
    ///
    /// # Errors
    /// A message, if there is no such sensor or several with this name, or the text is invalid.
    pub fn configure(&mut self, sensor: &str, text: &str, now_ns: u64) -> Result<(), String> {
        let scheduled = self.find(sensor)?;
        if let Some(Tuning { now, .. }) = &scheduled.tuning {
            let changed = now.changed(text)?;
            scheduled.configure(changed, now_ns)?;
        }
        self.send_settings(now_ns);
        Ok(())
    }

    /// Finds a sensor by its name, or else by one of its topics. With a leading slash it is a topic.
    pub(super) fn find(&mut self, sensor: &str) -> Result<&mut Scheduled, String> {
        let topic = format!("/{}", sensor.trim_start_matches('/'));
        let all_of = |is_meant: &dyn Fn(&Scheduled, &Tuning) -> bool| -> Vec<usize> {
            let channels = self.channels.iter().enumerate();
            let meant =
                channels.filter(|(_, it)| it.tuning.as_ref().is_some_and(|tuning| is_meant(it, tuning)));
            meant.map(|(index, _)| index).collect()
        };
        let mut meant = all_of(&|_, tuning| tuning.sensor == sensor);
        if meant.is_empty() {
            meant = all_of(&|scheduled, _| scheduled.topics().contains(&topic));
        }
        match meant[..] {
            [index] => Ok(&mut self.channels[index]),
            [] => {
                let sensors = || self.channels.iter().filter_map(|channel| channel.tuning.as_ref());
                let names: Vec<&str> = sensors().map(|tuning| tuning.sensor.as_str()).collect();
                let there = if names.is_empty() { "none".into() } else { names.join(", ") };
                let there = did_you_mean_or(sensor, names.iter().copied(), &format!("there are: {there}"));
                Err(format!("there is no sensor '{sensor}', and no sensor with such a topic; {there}"))
            }
            _ => {
                let topics: Vec<String> = meant
                    .iter()
                    .filter_map(|&index| self.channels[index].topics().into_iter().next())
                    .collect();
                Err(format!(
                    "there are {} sensors '{sensor}'; choose one of them by its topic: {}",
                    meant.len(),
                    topics.join(", ")
                ))
            }
        }
    }

    /// Publishes the settings of all sensors and their limits at `stamp_ns`.
    pub(super) fn send_settings(&mut self, stamp_ns: u64) {
        let message = |scheduled: &Scheduled| {
            let tuning = scheduled.tuning.as_ref()?;
            Some(tuning.now.message(&tuning.sensor, &scheduled.topics()))
        };
        let messages: Vec<_> = self.channels.iter().filter_map(message).collect();
        self.settings.send_structs(stamp_ns, &messages);
    }
}
