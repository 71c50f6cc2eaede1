//! [`ModelFiles`]: loads models from the texts of commands.

use crate::description::load::load_model_text;
use crate::description::model::Model;
use crate::description::models::package_path;
use crate::description::package::PackagePath;
use crate::description::xml::{Element, Node};
use crate::description::{Diagnostics, Rules};
use std::path::Path;

/// The places of the files that spawned models refer to, and the rules for reading models.
#[derive(Debug, Clone)]
pub struct ModelFiles {
    /// The folders that are searched for packages and `model://` files.
    pub packages: PackagePath,
    /// The rules for reading models, as for the world's own models.
    pub rules: Rules,
}

impl Default for ModelFiles {
    /// Only the shipped models are found.
    fn default() -> Self {
        Self { packages: package_path([], None), rules: Rules::default() }
    }
}

impl ModelFiles {
    /// Reads a model that is to be spawned.
    ///
    /// # Errors
    /// A message with the line and the problem in the text.
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

    /// Returns a URDF's text as the description of the robot, with the paths of files in place of their packages.
    /// Returns `None` if the text is not a URDF.
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
