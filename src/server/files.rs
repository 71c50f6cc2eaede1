//! Models out of commands' texts.

use crate::description::load::load_model_text;
use crate::description::model::Model;
use crate::description::models::package_path;
use crate::description::package::PackagePath;
use crate::description::xml::{Element, Node};
use crate::description::{Diagnostics, Rules};
use std::path::Path;

/// Where the files are that spawned models name, and how these are read.
#[derive(Debug, Clone)]
pub struct ModelFiles {
    /// Where packages and `model://` files are found.
    pub packages: PackagePath,
    /// As for the world's own models.
    pub rules: Rules,
}

impl Default for ModelFiles {
    /// Our own models alone.
    fn default() -> Self {
        Self { packages: package_path([], None), rules: Rules::default() }
    }
}

impl ModelFiles {
    /// Reads a model to be spawned.
    ///
    /// # Errors
    /// In words: what is wrong with the text, with its lines.
    pub fn load(&self, text: &str, name: &str) -> Result<Model, String> {
        let name = if name.is_empty() { "text" } else { name };
        let mut diagnostics = Diagnostics::default();
        let model = load_model_text(text, name, &self.packages, self.rules, &mut diagnostics);
        if let Some(error) = diagnostics.errors().next() {
            return Err(error.to_string());
        }
        for problem in diagnostics.problems() {
            tracing::info!("{problem}");
        }
        let model = model.ok_or("there is no model in its text")?;
        Ok(model)
    }

    /// Returns the text of a URDF with the files of packages by their paths, as the description of the robot; none of a text
    /// that is no URDF.
    pub fn description(&self, text: &str) -> Option<String> {
        let mut robot = Element::parse(text, Path::new("text")).ok()?;
        (robot.name == "robot").then(|| {
            self.name_files(&mut robot);
            robot.to_string()
        })
    }

    fn name_files(&self, element: &mut Element) {
        if matches!(element.name.as_str(), "mesh" | "texture") {
            for (_, value) in element.attributes.iter_mut().filter(|(name, _)| name == "filename") {
                if let Some((package, file)) =
                    value.strip_prefix("package://").and_then(|rest| rest.split_once('/'))
                    && let Some(found) = self.packages.find_file(package, file)
                {
                    *value = format!("file://{}", found.path.to_string_lossy().replace('%', "%25"));
                }
            }
        }
        for child in &mut element.children {
            if let Node::Element(child) = child {
                self.name_files(child);
            }
        }
    }
}
