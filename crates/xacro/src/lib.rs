#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! Every element keeps the [`Source`](diagnostics::Source) of the line it was written on, so that later errors point into
//! the user's own text. This is why the crate exists: xacro-rs (0.2) gives no file and line and lacks attributes,
//! conditional expressions, `in` and `%`; urdf-rs calls ROS's xacro as a program; and ROS's xacro is written in Python and
//! forgets the lines as well.
//!
//! An element without the prefix `xacro:` is a macro call if such a macro exists, the element gives what the macro needs and
//! no more, and the name is not one of the frequent elements of URDF and SDF: a macro `sonar` does not capture the
//! `<sonar>` inside a `<sensor>`.
//!
//! | module | contents |
//! |---|---|
//! | [`xml`] | elements that know their file and line; reading and writing XML |
//! | [`diagnostics`] | problems with file, line and remedy |
//! | [`package`] | finding ROS packages and their files |
//! | [`budget`] | limits on what a file may expand to |
//! | [`suggestion`] | "did you mean" |
//! | `expand` | walks the tree: directives, macro calls, includes; `${…}` and `$(…)` in texts and attributes |
//! | `scope`, `macros` | what is defined where |
//! | `yaml` | files that `load_yaml` reads |
//! | `text`, `expression`, `evaluate`, `functions`, `value` | the expression language, bottom up |
#![forbid(unsafe_code)]

pub mod budget;
pub mod diagnostics;
mod evaluate;
mod expand;
mod expression;
mod fault;
mod functions;
mod limits;
mod macros;
mod names;
pub mod package;
mod scope;
pub mod suggestion;
mod text;
mod value;
pub mod xml;
mod yaml;

pub use expand::{expand, expand_root};
pub use xml::Element;
