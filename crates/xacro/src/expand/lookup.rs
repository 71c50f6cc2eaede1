//! The names that are available to expressions: properties and xacro's functions in `${…}`, arguments in `$(eval …)`.

use super::Expander;
use super::substitute::environment;
use crate::diagnostics::Source;
use crate::evaluate::{Names, evaluate};
use crate::expression::parse;
use crate::fault::Fault;
use crate::functions::{Arguments, printed};
use crate::suggestion::did_you_mean_or;
use crate::value::Value;
use crate::yaml;
use std::path::{Path, PathBuf};

/// Nested expressions need less stack than nested elements, so this many of their levels count as one.
const EXPRESSIONS_A_LEVEL: usize = 5;

impl Expander<'_> {
    /// Evaluates the inside of `${…}`.
    pub(super) fn evaluated(&mut self, text: &str, scope: usize, source: &Source) -> Result<Value, Fault> {
        let work = self.work.clone();
        evaluate(&parse(text)?, &mut Properties { expander: self, scope, text, source }, &work)
    }

    /// Evaluates the inside of `$(eval …)`.
    pub(super) fn evaluated_arguments(&mut self, text: &str) -> Result<Value, Fault> {
        let work = self.work.clone();
        evaluate(&parse(text)?, &mut InEval { expander: self }, &work)
    }

    /// Returns the path of a file whose name is relative to the folder of the file that is being expanded.
    pub(super) fn beside_file(&self, name: &str) -> PathBuf {
        let folder = self.files.last().and_then(|file| file.parent());
        folder.unwrap_or(Path::new("")).join(name)
    }
}

/// The names in `${…}`: properties.
struct Properties<'a, 'b> {
    expander: &'a mut Expander<'b>,
    scope: usize,
    text: &'a str,
    source: &'a Source,
}

impl Names for Properties<'_, '_> {
    fn get(&mut self, name: &str) -> Result<Option<Value>, Fault> {
        self.expander.property(name, self.scope)
    }

    fn call(&mut self, function: &str, arguments: &Arguments) -> Option<Result<Value, Fault>> {
        let (space, name) = function.rsplit_once('.').unwrap_or(("", function));
        let is_there = match name {
            "load_yaml" | "abs_filename" | "dotify" => space == "xacro" || space.is_empty(),
            "arg" | "tokenize" | "message" | "warning" | "error" | "fatal" | "print_location" => {
                space == "xacro"
            }
            _ => false,
        };
        is_there.then(|| self.of_xacro(name, arguments))
    }

    fn undefined(&self, name: &str) -> Fault {
        let known = self.expander.scopes[..=self.scope].iter().flat_map(|scope| scope.properties.keys());
        let mut known: Vec<_> = known.map(String::as_str).collect();
        known.sort_unstable();
        let define = format!("define it with <xacro:property name=\"{name}\" value=\"…\"/>");
        Fault::new(
            format!("undefined property '{name}' in '${{{}}}'", self.text.trim()),
            did_you_mean_or(name, known, &define),
        )
    }

    fn enter(&mut self, levels: usize) -> Result<(), Fault> {
        Ok(self.expander.budget.enter(levels.div_ceil(EXPRESSIONS_A_LEVEL))?)
    }

    fn leave(&mut self, levels: usize) {
        self.expander.budget.leave(levels.div_ceil(EXPRESSIONS_A_LEVEL));
    }
}

/// The names in `$(eval …)`: arguments.
struct InEval<'a, 'b> {
    expander: &'a mut Expander<'b>,
}

impl Names for InEval<'_, '_> {
    fn get(&mut self, name: &str) -> Result<Option<Value>, Fault> {
        self.expander.unused.borrow_mut().remove(name);
        Ok(self.expander.arguments.get(name).map(|value| Value::literal(value)))
    }

    fn call(&mut self, function: &str, arguments: &Arguments) -> Option<Result<Value, Fault>> {
        match (function, &arguments.positional[..]) {
            ("arg", [Value::Text(name)]) => Some(self.expander.argument(name).map(Value::into_literal)),
            ("find", [Value::Text(package)]) => Some(self.expander.package_folder(package).map(Value::Text)),
            ("env", [Value::Text(name)]) => Some(environment(name).map(Value::Text)),
            ("optenv", [Value::Text(name), default @ ..]) => {
                let default = default.first().map_or(Ok(String::new()), printed);
                Some(default.map(|default| Value::Text(std::env::var(name).unwrap_or(default))))
            }
            _ => None,
        }
    }

    fn undefined(&self, name: &str) -> Fault {
        Fault::new(
            format!("undefined argument '{name}' in $(eval …)"),
            format!("give it as {name}:=value, or add <xacro:arg name=\"{name}\" default=\"…\"/>"),
        )
    }

    fn enter(&mut self, levels: usize) -> Result<(), Fault> {
        Ok(self.expander.budget.enter(levels.div_ceil(EXPRESSIONS_A_LEVEL))?)
    }

    fn leave(&mut self, levels: usize) {
        self.expander.budget.leave(levels.div_ceil(EXPRESSIONS_A_LEVEL));
    }
}

impl Properties<'_, '_> {
    /// Calls a function of the namespace `xacro`.
    fn of_xacro(&mut self, name: &str, arguments: &Arguments) -> Result<Value, Fault> {
        let misuse = || crate::functions::misuse(&format!("xacro.{name}"), &arguments.positional);
        if let "message" | "warning" | "error" = name {
            return self.message(name, arguments);
        }
        match (name, &arguments.positional[..]) {
            ("tokenize", _) => return tokenize(arguments),
            ("print_location", []) => {
                let expander = &mut *self.expander;
                let calls = expander
                    .calls
                    .iter()
                    .rev()
                    .map(|(name, call)| format!("macro '{name}', called at {call}"));
                let place: Vec<String> = calls.collect();
                let what = if place.is_empty() { "here, in no macro".to_owned() } else { place.join("; ") };
                expander.diagnostics.note(self.source, what, "");
                return Ok(Value::text(""));
            }
            ("fatal", parts) => {
                let texts: Result<Vec<String>, Fault> = parts.iter().map(printed).collect();
                return Err(Fault::new(
                    texts?.join(" "),
                    "the file itself reports this: see the condition around it",
                ));
            }
            _ => {}
        }
        match (name, arguments.unnamed(name)?) {
            ("arg", [Value::Text(name)]) => self.expander.argument(name),
            ("load_yaml", [Value::Text(file)]) => {
                let path = self.expander.beside_file(file.trim());
                self.expander.diagnostics.opened(&path);
                let value = yaml::load(&path)?;
                self.expander.work.take(value.size() / 64)?;
                Ok(value)
            }
            ("abs_filename", [Value::Text(file)]) => {
                Ok(Value::Text(self.expander.beside_file(file).to_string_lossy().into_owned()))
            }
            ("dotify", [map @ Value::Map(_)]) => Ok(map.clone().dotted()),
            _ => Err(misuse()),
        }
    }

    /// Reports a message of the file's author. An error of `xacro.error` does not end the expansion, and is a warning
    /// here.
    fn message(&mut self, name: &str, arguments: &Arguments) -> Result<Value, Fault> {
        let texts: Result<Vec<String>, Fault> = arguments.positional.iter().map(printed).collect();
        let text = texts?.join(" ");
        self.expander.budget.take(0, text.len())?;
        match name {
            "message" => self.expander.diagnostics.note(self.source, text, ""),
            _ => self.expander.diagnostics.warning(self.source, text, ""),
        }
        Ok(Value::text(""))
    }
}

/// Splits a text at any of some characters.
fn tokenize(arguments: &Arguments) -> Result<Value, Fault> {
    let [text, separators, skip] = arguments.placed("tokenize", ["s", "sep", "skip_empty"])?;
    let (Some(text), separators) =
        (text.and_then(Value::as_text), separators.map_or(Some(",; "), Value::as_text))
    else {
        return Err(crate::functions::misuse("xacro.tokenize", &arguments.positional));
    };
    // xacro puts the separators into the brackets of a regular expression, in which these characters have a special
    // meaning.
    let Some(separators) =
        separators.filter(|set| !set.is_empty() && !set.contains(['\\', ']', '^', '-', '[']))
    else {
        return Err(Fault::new(
            "xacro.tokenize: the separators are empty or a pattern",
            "use characters without a meaning in patterns",
        ));
    };
    let skips = skip.is_none_or(Value::truth);
    let parts = text.split(|c| separators.contains(c)).filter(|part| !skips || !part.is_empty());
    let parts: Vec<&str> = parts.collect();
    crate::limits::sized(parts.len() * size_of::<Value>())?;
    Ok(Value::list(parts.into_iter().map(Value::text).collect()))
}
