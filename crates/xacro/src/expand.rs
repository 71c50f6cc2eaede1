//! Walks the tree: directives, macro calls, includes.

mod call;
mod include;
mod lookup;
mod property;
mod role;
mod substitute;
mod wildcards;

use super::fault::Fault;
use super::limits::Work;
use super::macros::Macro;
use super::scope::Scope;
use super::value::Value;
use crate::budget::Budget;
use crate::diagnostics::{Diagnostics, Problem, Source};
use crate::package::{Found, PackagePath};
use crate::suggestion::{did_you_mean, did_you_mean_or};
use crate::xml::{Element, Node, Weight};
use role::Role;
use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Reads a file and expands it. `arguments` are the values of `$(arg name)`; they override the defaults of
/// `<xacro:arg>`.
///
/// The first error ends the expansion, as in ROS's xacro. Choices made for the user (such as a file of a package that
/// is taken from our copy) are reported in `diagnostics`.
///
/// # Errors
/// Returns a [`Problem`] at the line where the invalid text was written, with the macro calls that led to it.
pub fn expand(
    path: &Path,
    packages: &PackagePath,
    arguments: &[(String, String)],
    diagnostics: &mut Diagnostics,
) -> Result<Element, Problem> {
    diagnostics.opened(path);
    expand_root(Element::parse_file(path)?, path, packages, arguments, diagnostics)
}

/// Expands a file that has been parsed already, or a text; relative names are resolved against `path`.
///
/// # Errors
/// The errors of [`expand`].
pub fn expand_root(
    root: Element,
    path: &Path,
    packages: &PackagePath,
    arguments: &[(String, String)],
    diagnostics: &mut Diagnostics,
) -> Result<Element, Problem> {
    let mut expander = Expander {
        packages,
        diagnostics,
        arguments: arguments.iter().cloned().collect(),
        unused: RefCell::new(arguments.iter().map(|(name, _)| name.clone()).collect()),
        scopes: vec![Scope::default()],
        budget: Budget::default(),
        work: Rc::default(),
        calls: Vec::new(),
        files: vec![path.to_path_buf()],
        parsed: HashMap::new(),
        borrowed: HashSet::new(),
        // In a plain URDF, unknown elements are not misspelt macros.
        strict: path.extension().is_some_and(|extension| extension == "xacro"),
    };
    let expanded = expander.root(root)?;
    expander.warn_of_unused(path);
    Ok(expanded)
}

/// What is wrong with an argument that a robot does not have.
pub fn unused_argument(name: &str) -> String {
    format!("this robot has no argument '{name}', which was given: it changes nothing")
}

/// The state of an expansion.
pub(super) struct Expander<'a> {
    pub(super) packages: &'a PackagePath,
    pub(super) diagnostics: &'a mut Diagnostics,
    pub(super) arguments: HashMap<String, String>,
    /// Names of given arguments that have not been declared or read yet.
    pub(super) unused: RefCell<BTreeSet<String>>,
    /// The file's scope first, then one for each macro call that is being expanded.
    pub(super) scopes: Vec<Scope>,
    pub(super) budget: Budget,
    pub(super) work: Rc<Work>,
    /// Macros that are being expanded: name and place of the call.
    calls: Vec<(String, Source)>,
    /// The files that are being expanded; each is included by the previous one.
    pub(super) files: Vec<PathBuf>,
    parsed: HashMap<PathBuf, Rc<Element>>,
    /// Files taken from our packages that have been reported.
    borrowed: HashSet<PathBuf>,
    strict: bool,
}

/// The output of expanded nodes.
#[derive(Default)]
struct Output {
    /// Attributes from `xacro:attribute`.
    attributes: Vec<(String, String)>,
    children: Vec<Node>,
}

impl Expander<'_> {
    fn root(&mut self, root: Element) -> Result<Element, Problem> {
        let attributes = self.attributes(&root)?;
        let mut output = Output::default();
        self.nodes(&root.children, &root.source, root.name == "robot", &mut output)?;
        let mut result =
            Element { name: root.name, attributes, children: output.children, source: root.source };
        set_attributes(&mut result, output.attributes);
        Ok(result)
    }

    /// Warns of given arguments that the files neither declare nor read. xacro says nothing of them.
    fn warn_of_unused(&mut self, path: &Path) {
        let unused = self.unused.take();
        let known: BTreeSet<&String> = self.arguments.keys().filter(|name| !unused.contains(*name)).collect();
        for name in &unused {
            let names: Vec<&str> = known.iter().map(|name| name.as_str()).collect();
            let listed = if names.is_empty() {
                "leave it out: the robot has no arguments".to_owned()
            } else {
                did_you_mean_or(name, names.iter().copied(), &format!("there are: {}", names.join(", ")))
            };
            self.diagnostics.warning(&Source::new(path, 0), unused_argument(name), listed);
        }
    }

    /// Expands nodes. `source` is the place of the element around them, because text has no place of its own.
    fn nodes(
        &mut self,
        nodes: &[Node],
        source: &Source,
        at_top: bool,
        output: &mut Output,
    ) -> Result<(), Problem> {
        for node in nodes {
            match node {
                Node::Text(text) | Node::Cdata(text)
                    if !text.contains('$') || matches!(node, Node::Cdata(_)) =>
                {
                    let spent = self.budget.take(0, text.len());
                    spent.map_err(|spent| self.problem(spent.into(), source))?;
                    output.children.push(node.clone());
                }
                Node::Text(text) => {
                    let text = self.string(text, source).map_err(|fault| self.problem(fault, source))?;
                    output.children.push(Node::Text(text));
                }
                Node::Cdata(_) => {}
                Node::Element(element) => self.element(element, at_top, output)?,
            }
        }
        Ok(())
    }

    fn element(&mut self, element: &Element, at_top: bool, output: &mut Output) -> Result<(), Problem> {
        let attributes: usize = element.attributes.iter().map(|(name, value)| name.len() + value.len()).sum();
        let spent = self.budget.take(1, element.name.len() + attributes).and_then(|()| self.budget.enter(1));
        spent.map_err(|spent| self.problem(spent.into(), &element.source))?;
        let result = self.entered(element, at_top, output);
        self.budget.leave(1);
        result
    }

    fn entered(&mut self, element: &Element, at_top: bool, output: &mut Output) -> Result<(), Problem> {
        let role = self.role(element, at_top).map_err(|fault| self.problem(fault, &element.source))?;
        match role {
            Role::Directive(directive) => self.directive(directive, element, at_top, output),
            Role::Call(definition, home) => self.call(element, &definition, home, at_top, output),
            Role::Plain => {
                if at_top {
                    self.check_top(element);
                }
                let plain = self.plain(element)?;
                output.children.push(Node::Element(plain));
                Ok(())
            }
        }
    }

    /// Expands an element of the result by evaluating its attributes and its content.
    fn plain(&mut self, element: &Element) -> Result<Element, Problem> {
        let attributes = self.attributes(element)?;
        let mut inside = Output::default();
        self.nodes(&element.children, &element.source, false, &mut inside)?;
        let mut result = Element {
            name: element.name.clone(),
            attributes,
            children: inside.children,
            source: element.source.clone(),
        };
        set_attributes(&mut result, inside.attributes);
        Ok(result)
    }

    fn attributes(&mut self, element: &Element) -> Result<Vec<(String, String)>, Problem> {
        element
            .attributes
            .iter()
            .filter(|(name, _)| !name.starts_with("xacro:"))
            .map(|(name, value)| {
                let value = self.string(value, &element.source);
                value.map(|value| (name.clone(), value)).map_err(|fault| self.problem(fault, &element.source))
            })
            .collect()
    }

    fn directive(
        &mut self,
        directive: &str,
        element: &Element,
        at_top: bool,
        output: &mut Output,
    ) -> Result<(), Problem> {
        let source = &element.source;
        match directive {
            "include" => self.include(element, at_top, output),
            "property" => self.define_property(element).map_err(|fault| self.problem(fault, source)),
            "macro" => {
                self.copied(element).map_err(|fault| self.problem(fault, source))?;
                let definition = Macro::parse(element).map_err(|fault| self.problem(fault, source))?;
                self.top().macros.insert(definition.name.clone(), Rc::new(definition));
                Ok(())
            }
            "arg" => {
                let name = self.required(element, "name")?;
                self.unused.borrow_mut().remove(&name);
                if !self.arguments.contains_key(&name) {
                    let default = self.required(element, "default")?;
                    self.arguments.insert(name, default);
                }
                Ok(())
            }
            "insert_block" => self.insert_block(element, at_top, output),
            "if" | "unless" => {
                let condition =
                    self.condition(element, "value").map_err(|fault| self.problem(fault, source))?;
                if condition == (directive == "if") {
                    self.nodes(&element.children, source, at_top, output)?;
                }
                Ok(())
            }
            "element" => {
                let name = self.xml_name(element, "xacro:name")?;
                let renamed = Element { name, ..element.clone() };
                self.element(&renamed, at_top, output)
            }
            "attribute" => {
                let attribute = (self.xml_name(element, "name")?, self.required(element, "value")?);
                output.attributes.push(attribute);
                Ok(())
            }
            // `call`: the name of the macro is computed.
            _ => {
                let name = self.required(element, "macro")?;
                let mut renamed = Element { name: format!("xacro:{name}"), ..element.clone() };
                renamed.attributes.retain(|(name, _)| name != "macro");
                self.element(&renamed, at_top, output)
            }
        }
    }

    /// Returns the value of a required attribute; it must not be empty, except for `value` and `default`.
    fn required(&mut self, element: &Element, attribute: &str) -> Result<String, Problem> {
        let missing = || {
            Fault::new(
                format!("<{}> has no attribute '{attribute}'", element.name),
                format!("add {attribute}=\"…\""),
            )
        };
        let text = element.attribute(attribute).ok_or_else(missing);
        text.and_then(|text| self.string(text, &element.source))
            .and_then(|value| {
                let may_be_empty = matches!(attribute, "value" | "default");
                if value.is_empty() && !may_be_empty { Err(missing()) } else { Ok(value) }
            })
            .map_err(|fault| self.problem(fault, &element.source))
    }

    /// Returns the computed name of an element or attribute.
    fn xml_name(&mut self, element: &Element, attribute: &str) -> Result<String, Problem> {
        let name = self.required(element, attribute)?;
        let begins = |c: char| c.is_alphabetic() || c == '_';
        let goes_on = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        let is_name = name.split(':').count() <= 2
            && name.split(':').all(|part| part.starts_with(begins) && part.chars().all(goes_on));
        if is_name {
            return Ok(name);
        }
        let fault = Fault::new(
            format!("'{name}' cannot be the name of an element or attribute"),
            "use letters, digits, '_', '-' and '.', beginning with a letter",
        );
        Err(self.problem(fault, &element.source))
    }

    fn condition(&mut self, element: &Element, attribute: &str) -> Result<bool, Fault> {
        let text = element.attribute(attribute).unwrap_or_default();
        let value = self.value(text, &element.source)?;
        match &value {
            Value::Text(word) => match Value::literal(word.trim()) {
                Value::Text(word) => Err(Fault::new(
                    format!("the condition '{text}' is '{word}', which is neither true nor false"),
                    "write true, false, a number or a comparison",
                )),
                literal => Ok(literal.truth()),
            },
            value => Ok(value.truth()),
        }
    }

    fn insert_block(&mut self, element: &Element, at_top: bool, output: &mut Output) -> Result<(), Problem> {
        let name = self.required(element, "name")?;
        let found = self
            .scopes
            .iter()
            .rev()
            .find_map(|scope| {
                ["**", "*"].iter().find_map(|stars| scope.blocks.get(&format!("{stars}{name}")))
            })
            .cloned();
        let Some(block) = found else {
            let known: BTreeSet<_> = self.scopes.iter().flat_map(|scope| scope.blocks.keys()).collect();
            let meant = did_you_mean(&name, known.iter().map(|known| known.trim_start_matches('*')));
            let fault = Fault::new(
                format!("undefined block '{name}'"),
                meant.unwrap_or_else(|| {
                    format!("define it with <xacro:property name=\"{name}\">…, or as a parameter '*{name}'")
                }),
            );
            return Err(self.problem(fault, &element.source));
        };
        if block.expanded {
            let Weight { elements, bytes, depth } = block.weight;
            let spent = self.budget.take(elements, bytes).and_then(|()| self.budget.has_room_below(depth));
            spent.map_err(|spent| self.problem(spent.into(), &element.source))?;
            output.children.extend(block.nodes.iter().cloned());
            return Ok(());
        }
        self.calls.push((format!("block {name}"), element.source.clone()));
        let result = self.nodes(&block.nodes, &element.source, at_top, output);
        self.calls.pop();
        result
    }

    /// Counts a copy of an element's content.
    pub(super) fn copied(&mut self, element: &Element) -> Result<(), Fault> {
        let Weight { elements, bytes, .. } = element.weight();
        Ok(self.budget.take(elements, bytes)?)
    }

    fn top(&mut self) -> &mut Scope {
        let top = self.scopes.len() - 1;
        &mut self.scopes[top]
    }

    /// Reports once that a file was taken from our copy of a package.
    pub(super) fn note_borrowed(&mut self, package: &str, file: &str, found: &Found, source: &Source) {
        let Some(missing_in) = &found.missing_in else { return };
        if self.borrowed.insert(found.path.clone()) {
            self.diagnostics.note(
                source,
                format!(
                    "package '{package}' in {} lacks {file}: {} is used",
                    missing_in.display(),
                    found.path.display()
                ),
                "",
            );
        }
    }

    /// Returns the fault as an error at `source`, with the macro calls that led there.
    fn problem(&self, fault: Fault, source: &Source) -> Problem {
        let mut problem = fault.into_problem(source);
        if let Some((name, call)) = self.calls.last()
            && *call != problem.source
        {
            problem.what = format!("{} (in macro '{name}', called at {call})", problem.what);
        }
        problem
    }
}

/// Sets attributes of an element, in time that is proportional to their number.
fn set_attributes(element: &mut Element, attributes: Vec<(String, String)>) {
    if attributes.is_empty() {
        return;
    }
    let names = element.attributes.iter().map(|(name, _)| name.clone());
    let mut places: HashMap<String, usize> = names.zip(0..).collect();
    for (name, value) in attributes {
        let end = element.attributes.len();
        match *places.entry(name.clone()).or_insert(end) {
            place if place < end => element.attributes[place].1 = value,
            _ => element.attributes.push((name, value)),
        }
    }
}
