//! `${…}` and `$(…)` in texts and attributes.

use super::Expander;
use crate::diagnostics::Source;
use crate::fault::Fault;
use crate::functions::printed;
use crate::scope::Property;
use crate::text::{Piece, pieces};
use crate::value::Value;
use std::path::Path;

/// Makes the result of `$(find package)` absolute, as in ROS: a package path may be relative to the working directory,
/// while a relative name in a file is relative to that file.
fn absolute(path: &Path) -> String {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).to_string_lossy().into_owned()
}

/// The result of substitution in a text.
#[derive(Debug)]
pub(super) struct Substituted {
    pub(super) value: Value,
    /// The package and the file inside it, if the text is `$(find package)/file`.
    pub(super) package_file: Option<(String, String)>,
}

impl Expander<'_> {
    /// Evaluates a text in the innermost scope. If the text is a single expression, the type of its value is kept.
    pub(super) fn value(&mut self, text: &str, source: &Source) -> Result<Value, Fault> {
        self.value_in(text, self.scopes.len() - 1, source)
    }

    /// Evaluates a text and converts the result to text.
    pub(super) fn string(&mut self, text: &str, source: &Source) -> Result<String, Fault> {
        if !text.contains('$') {
            return Ok(text.to_owned());
        }
        self.value(text, source).and_then(|value| printed(&value))
    }

    fn value_in(&mut self, text: &str, scope: usize, source: &Source) -> Result<Value, Fault> {
        if !text.contains('$') {
            return Ok(Value::Text(text.to_owned()));
        }
        self.substitute(text, scope, source).map(|substituted| substituted.value)
    }

    pub(super) fn substitute(
        &mut self,
        text: &str,
        scope: usize,
        source: &Source,
    ) -> Result<Substituted, Fault> {
        self.budget.enter(1).map_err(|spent| Fault::from(spent).at(source))?;
        let result = self.substitute_pieces(text, scope, source).and_then(|substituted| {
            self.budget.take(0, substituted.value.size())?;
            Ok(substituted)
        });
        self.budget.leave(1);
        result.map_err(|fault| fault.at(source))
    }

    fn substitute_pieces(&mut self, text: &str, scope: usize, source: &Source) -> Result<Substituted, Fault> {
        let pieces = pieces(text)?;
        let mut values = Vec::with_capacity(pieces.len());
        // The index and the package of the last `$(find package)`.
        let mut found = None;
        for piece in &pieces {
            values.push(match piece {
                Piece::Text(text) => Value::Text((*text).to_owned()),
                Piece::Expression(inside) => {
                    let inside = printed(&self.value_in(inside, scope, source)?)?;
                    self.evaluated(&inside, scope, source)?
                }
                Piece::Extension(inside) => {
                    let inside = printed(&self.value_in(inside, scope, source)?)?;
                    if let Some(package) = inside.strip_prefix("find ") {
                        found = Some((values.len(), package.trim().to_owned()));
                    }
                    self.extension(&inside, source)?
                }
            });
        }
        // For `$(find package)/file`, the user's copy of a package may lack a file that our copy has.
        let mut package_file = None;
        if let Some((index, package)) = found {
            let behind: String = values[index + 1..].iter().map(ToString::to_string).collect();
            if let Some(file) = behind.trim_end().strip_prefix('/') {
                if let Some(found) = self.packages.find_file(&package, file) {
                    self.note_borrowed(&package, file, &found, source);
                    values.truncate(index);
                    values.push(Value::Text(absolute(&found.path)));
                }
                package_file = Some((package, file.to_owned()));
            }
        }
        let value = if values.len() == 1 {
            values.swap_remove(0)
        } else {
            let texts: Result<String, Fault> = values.iter().map(printed).collect();
            Value::Text(texts?)
        };
        Ok(Substituted { value, package_file })
    }

    /// `$(find p)`, `$(arg a)`, `$(env V)`, `$(optenv V default)`, `$(eval …)`, `$(dirname)`, `$(cwd)`.
    fn extension(&mut self, inside: &str, source: &Source) -> Result<Value, Fault> {
        let (command, rest) = inside.trim().split_once(char::is_whitespace).unwrap_or((inside.trim(), ""));
        let rest = rest.trim();
        let mut words = rest.split_whitespace();
        Ok(match (command, words.next()) {
            ("find", Some(package)) => Value::Text(self.package_folder(package)?),
            ("arg", Some(name)) => self.argument(name)?,
            ("env", Some(name)) => Value::Text(environment(name)?),
            ("optenv", Some(name)) => {
                let default = words.collect::<Vec<_>>().join(" ");
                Value::Text(std::env::var(name).unwrap_or(default))
            }
            ("eval", Some(_)) => {
                if rest.contains("__") {
                    let what = format!("'$({inside})' contains two consecutive underscores");
                    return Err(Fault::new(what, "rename the argument"));
                }
                // roslaunch converts the result to text, and so does xacro.
                Value::Text(printed(&self.evaluated_arguments(rest)?)?)
            }
            ("dirname", None) => {
                let folder = source.file.parent().unwrap_or(&source.file);
                Value::Text(folder.to_string_lossy().into_owned())
            }
            ("cwd", None) => {
                let folder = std::env::current_dir()
                    .map_err(|error| Fault::new(format!("$(cwd): {error}"), "name the folder itself"))?;
                Value::Text(folder.to_string_lossy().into_owned())
            }
            ("anon", Some(_)) => {
                return Err(Fault::new(
                    format!("'$({inside})' would differ in each run, and xacro has no $(anon …)"),
                    "write a name of your own",
                ));
            }
            _ => {
                return Err(Fault::new(
                    format!("'$({inside})' is not understood"),
                    "write $(find package), $(arg name), $(env NAME), $(optenv NAME default) or $(eval expression)",
                ));
            }
        })
    }

    pub(super) fn argument(&self, name: &str) -> Result<Value, Fault> {
        self.unused.borrow_mut().remove(name);
        self.arguments.get(name).map(|value| Value::Text(value.clone())).ok_or_else(|| {
            Fault::new(
                format!("undefined argument '{name}'"),
                format!("give it as {name}:=value, or add <xacro:arg name=\"{name}\" default=\"…\"/>"),
            )
        })
    }

    pub(super) fn package_folder(&self, package: &str) -> Result<String, Fault> {
        self.packages
            .find_package(package)
            .map(|folder| absolute(&folder))
            .ok_or_else(|| self.unknown_package(package))
    }

    pub(super) fn unknown_package(&self, package: &str) -> Fault {
        Fault::new(
            format!("package '{package}' is in none of the folders {}", self.folders()),
            "add its parent folder with --package-path or ROS_PACKAGE_PATH",
        )
    }

    /// Returns the folders of the package path, for error messages.
    pub(super) fn folders(&self) -> String {
        self.packages.folders().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
    }

    /// Returns the property with this name, as seen from `scope`, and evaluates it if that has not been done.
    pub(super) fn property(&mut self, name: &str, scope: usize) -> Result<Option<Value>, Fault> {
        let Some(at) = (0..=scope).rev().find(|at| self.scopes[*at].properties.contains_key(name)) else {
            return self.namespaced_property(name, scope);
        };
        let slot = self.scopes[at].properties.get_mut(name);
        let Some(slot) = slot else { return Ok(None) };
        match slot {
            Property::Known(value) => Ok(Some(value.clone())),
            Property::Broken(fault) => Err(fault.clone()),
            Property::Evaluating => Err(Fault::new(
                format!("property '{name}' refers to itself"),
                "give it a value that does not depend on it",
            )),
            Property::Lazy { text, source } => {
                let (text, source) = (text.clone(), source.clone());
                *slot = Property::Evaluating;
                let result = self.value_in(&text, at, &source).map(Value::into_literal);
                let property = match &result {
                    Ok(value) => Property::Known(value.clone()),
                    Err(_) => Property::Lazy { text, source },
                };
                self.scopes[at].properties.insert(name.to_owned(), property);
                result.map(Some)
            }
        }
    }

    /// Returns `space.property`, which is defined in a file that was included with `ns="space"`.
    fn namespaced_property(&self, name: &str, scope: usize) -> Result<Option<Value>, Fault> {
        let Some((space, rest)) = name.split_once('.') else { return Ok(None) };
        let mut space = self.scopes[..=scope].iter().rev().find_map(|scope| scope.namespaces.get(space));
        let mut rest = rest;
        while let Some(here) = space {
            match here.properties.get(rest) {
                Some(Property::Known(value)) => return Ok(Some(value.clone())),
                Some(Property::Broken(fault)) => return Err(fault.clone()),
                Some(Property::Lazy { .. } | Property::Evaluating) => return Ok(None),
                None => {}
            }
            let Some((next, deeper)) = rest.split_once('.') else { break };
            space = here.namespaces.get(next);
            rest = deeper;
        }
        Ok(None)
    }
}

pub(super) fn environment(name: &str) -> Result<String, Fault> {
    std::env::var(name).map_err(|_| {
        Fault::new(
            format!("environment variable '{name}' is not set"),
            format!("set it, or write $(optenv {name} default)"),
        )
    })
}
