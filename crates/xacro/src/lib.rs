#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! Every element keeps the [`Source`](diagnostics::Source) of the line it was written on, so that later errors refer to
//! the user's own text. This is why the crate exists: xacro-rs (0.2) gives no file and line and lacks attributes,
//! conditional expressions, `in` and `%`; urdf-rs calls ROS's xacro as a program; and ROS's xacro is written in Python
//! and also loses the lines.
//!
//! An element without the prefix `xacro:` is a macro call if a macro with its name exists, if it has all required
//! parameters and nothing else, and if the name is not one of the frequent elements of URDF and SDF: a macro `sonar`
//! does not capture the `<sonar>` inside a `<sensor>`.
//!
//! | module | contents |
//! |---|---|
//! | [`xml`] | elements that know their file and line; reading and writing XML |
//! | [`diagnostics`] | problems with file, line and remedy |
//! | [`package`] | finding ROS packages and their files |
//! | [`budget`] | limits on what a file may expand to |
//! | [`mod@file`] | reading of files, up to a size |
//! | [`encoding`] | the encodings of text files |
//! | [`suggestion`] | "did you mean" |
//!  `expand` | the traversal of the tree: directives, macro calls, includes; `${…}` and `$(…)` in texts and attributes |
//!  `scope`, `macros` | the scopes of names, and the definitions of macros |
//!  `yaml` | files that `load_yaml` reads |
//!  `text`, `expression`, `evaluate`, `functions`, `value` | the expression language, bottom up |
#![forbid(unsafe_code)]

pub mod budget;
pub mod diagnostics;
pub mod encoding;
mod evaluate;
mod expand;
mod expression;
mod fault;
pub mod file;
mod functions;
mod limits;
mod macros;
pub mod model_index;
mod names;
pub mod package;
mod scope;
pub mod shell;
mod shorten;
pub mod suggestion;
mod text;
mod value;
pub mod xml;
mod yaml;

pub use expand::{expand, expand_root, unused_argument};
pub use xml::Element;
