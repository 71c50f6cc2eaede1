//! Nested models: their names, and how their parts are merged into the outer model.

use super::Loader;
use super::frames::Frames;
use super::model::{ParsedModel, Parts};
use super::names::{Again, Names};
use crate::model::{Model, ModelPlugin, SensorKind};
use std::borrow::Cow;

impl ParsedModel {
    /// Returns a function that names a link or joint of this model in the outer one.
    pub(super) fn naming(&self) -> impl Fn(&str) -> String + use<> {
        let before = if self.is_merged { String::new() } else { format!("{}::", self.model.name) };
        move |name| format!("{before}{name}")
    }

    /// Returns the name of this model's frame in the outer model.
    pub(super) fn frame_name(&self) -> Cow<'_, str> {
        let name = &self.model.name;
        if self.is_merged { format!("_merged__{name}__model__").into() } else { name.into() }
    }
}

impl Loader<'_> {
    /// Adds the frames of a model, its own and those inside it, to the outer model or world.
    pub(super) fn add_frames(&mut self, inner: &mut ParsedModel, frames: &mut Frames) {
        let inside = std::mem::replace(&mut inner.frames, Frames::new("__model__"));
        if !inner.is_merged {
            frames.add_model(&inner.model.name, &inner.pose, inside);
            return;
        }
        for name in frames.merge(&inner.frame_name(), &inner.pose, inside) {
            self.diagnostics.error(
                &inner.pose.source,
                format!(
                    "the merged model '{}' has a part called '{name}', as the model around it has",
                    inner.model.name
                ),
                "rename one, or include it without merge",
            );
        }
    }

    /// Gives a model a number if an earlier one has the same name, because they could not be distinguished.
    pub(super) fn make_names_unique(&mut self, models: &mut [ParsedModel]) {
        let mut names = Names::of(models.iter().map(|parsed| parsed.model.name.clone()));
        for (index, Model { name, source, .. }) in
            models.iter_mut().map(|parsed| &mut parsed.model).enumerate()
        {
            if let Err(Again { unique, .. }) = names.take(name, index) {
                self.diagnostics.warning(
                    source,
                    format!("two models are called '{name}': this one becomes '{unique}'"),
                    "give each model or <include> its own <name>",
                );
                *name = unique;
            }
        }
    }

    /// Moves the links, joints and sensors of a nested model to the outer one.
    pub(super) fn dissolve(&mut self, inner: ParsedModel, frames: &Frames, parts: &mut Parts) {
        let outer_from_inner = frames
            .resolve(&inner.frame_name(), &inner.pose.source, self.diagnostics)
            .unwrap_or(inner.pose.pose);
        let outer_name = inner.naming();
        let ParsedModel { model, lights, .. } = inner;
        let (first, first_joint) = (parts.links.len(), parts.joints.len());
        parts.links.extend(model.links.into_iter().map(|mut link| {
            link.name = outer_name(&link.name);
            let scoped = link.collisions.iter_mut().filter_map(|collision| collision.scoped_name.as_mut());
            scoped.for_each(|name| *name = outer_name(name));
            link.model_from_link = outer_from_inner * link.model_from_link;
            // As in Gazebo, a nested model keeps its own <static>.
            link.is_static |= model.is_static;
            link
        }));
        parts.joints.extend(model.joints.into_iter().map(|mut joint| {
            joint.name = outer_name(&joint.name);
            joint.parent += first;
            joint.child += first;
            if let Some(mimic) = &mut joint.dynamics.mimic {
                mimic.leader += first_joint;
            }
            joint
        }));
        parts.sensors.extend(model.sensors.into_iter().map(|mut sensor| {
            sensor.link += first;
            match &mut sensor.kind {
                SensorKind::ForceTorque(it) => it.joint += first_joint,
                SensorKind::Contact(it) => it.collisions.iter_mut().for_each(|(link, _)| *link += first),
                _ => {}
            }
            sensor
        }));
        let renamed = |plugin: ModelPlugin| plugin.nested(first, first_joint, &outer_name);
        parts.plugins.extend(model.plugins.into_iter().map(renamed));
        parts.lights.extend(lights.into_iter().map(|mut light| {
            light.world_from_light = outer_from_inner * light.world_from_light;
            light
        }));
    }
}
