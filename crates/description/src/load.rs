//! Loading robots, worlds and models from files, from texts, or by name.
//!
//! [`world`], [`robot`] and [`model`] are for simple programs: packages are looked for in `ROS_PACKAGE_PATH` and
//! then among Belvedere's own, warnings are logged, and errors are returned. The other functions accept [`LoadOptions`], or
//! the parts of it that they need, and add problems to [`Diagnostics`](crate::Diagnostics).

mod any;
mod robot;
mod simple;
mod spawnable;
mod text;
mod world;

pub use any::{Described, is_world, load, load_text};
pub use robot::{LoadOptions, default_robot_name, expand_robot, load_robot, robot_names, xacro_argument};
pub use simple::{Errors, model, robot, world};
pub use spawnable::{NotSpawnable, Spawnable};
pub use text::{load_model_text, load_world_text};
pub use world::{default_world, load_world, world_names};
