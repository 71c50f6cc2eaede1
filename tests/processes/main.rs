//! The command, tested from other processes.

#[path = "../eyes/mod.rs"]
mod eyes;
#[path = "../live/mod.rs"]
mod live;
#[path = "../page/mod.rs"]
mod page;
#[path = "../robot_models/mod.rs"]
mod robot_models;
#[path = "../sdf/mod.rs"]
mod sdf;

mod bad_input;
mod cameras;
mod carried_models;
mod check;
mod check_folder;
mod check_folder_models;
mod commands;
mod contacts;
mod control_command_line;
mod control_faults;
mod control_models;
mod control_time;
mod damaged_recordings;
mod dataset;
mod dataset_looks;
mod environment;
mod force_torque;
mod foxglove;
mod given_paths;
mod housings;
mod interest;
mod kobuki;
mod lidar_packets;
mod lossless;
mod messages;
mod named_files;
mod poses;
mod ranges;
mod recording;
mod recordings;
mod repeatable;
mod replaying;
mod sensor_frames;
mod settings;
mod several_robots;
mod small_machine;
mod streams;
mod tag_ceiling;
mod tags;
mod terminal;
mod urdf;
mod view;
mod view_limits;
mod view_recording;
