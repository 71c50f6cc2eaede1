//! Expands xacro: macros, properties and includes in, one XML tree out.
//!
//! Every element of the result keeps the [`Source`](super::Source) of the line it was written on, in whatever
//! file that was, so that later errors point into the user's own text. This is why it is written here: the
//! crate xacro-rs (0.2) gives no file and line and has no `element`, `attribute`, conditional expressions, `in`
//! and `%`; urdf-rs calls ROS's xacro as a program; and ROS's xacro is a Python program, no library for Rust,
//! and forgets the places as well.
//!
//! What is understood is what xacro 2.1 understands, and the older style of the TurtleBot's files besides:
//! `include`, `property`, `macro`, `if`, `unless`, `insert_block` and `arg` without the prefix `xacro:`, and
//! macros called without it. An element without prefix is a macro call if such a macro exists and the name is
//! not one of URDF's or SDF's own (a macro `camera` does not capture `<camera>` inside a `<sensor>`).
//!
//! Not understood, each with a clear error: `$(anon …)`, comprehensions and dictionaries written in expressions
//! (those of YAML files are), wildcards in file names.
//!
//! | file | |
//! |---|---|
//! | `expand` | walks the tree: directives, macro calls, includes |
//! | `substitute` | `${…}` and `$(…)` in texts and attributes |
//! | `scope`, `macros` | what is defined where |
//! | `yaml` | files that `load_yaml` reads |
//! | `text`, `expression`, `evaluate`, `functions`, `value` | the expression language, bottom up |

mod evaluate;
mod expand;
mod expression;
mod fault;
mod functions;
mod macros;
mod names;
mod scope;
mod substitute;
mod text;
mod value;
mod yaml;

pub use expand::{expand, expand_root};
