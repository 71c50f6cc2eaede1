//! Data sets for machine learning: worlds × seeds × poses, seen by a robot's sensors, in shards that training code can
//! read directly.
//!
//! A [`Plan`] defines and numbers the samples. Each sample depends only on the plan and its number, so it makes no
//! difference which process makes which shard, when, or in parallel with how many others: the bytes are the same. A
//! shard is a tar file in the layout of `WebDataset`. It is written completely or not at all, and existing shards are
//! not made again.
//!
//! | file | is |
//! |---|---|
//! | `plan` | reads and checks a plan's file |
//! | `poses` | the robot's pose for each sample |
//! | `looks` | the lights and materials of each sample |
//! | `make`, `making` | makes shards, several at a time, and reports progress |
//! | `studio` | a world with the robot in it, which renders its sensors' frames |
//! | `fields` | converts frames to files: PNG, npy |
//! | `labels` | the labels of a sample, as JSON |
//! | `shard` | reads and writes samples in a tar file |
//! | `folder` | the folder with its plan's identity and the manifest |
//! | `export` | exports to other formats |
//! | `sheet` | a picture of some samples |

mod error;
mod export;
mod fields;
mod folder;
mod labels;
mod looks;
mod make;
mod making;
mod plan;
mod poses;
mod shard;
mod sheet;
mod studio;

pub use error::DatasetError;
pub use export::{check_coco, check_kitti, export_coco, export_kitti};
pub use folder::{Folder, Manifest, ShardEntry};
pub use make::make;
pub use making::Making;
pub use plan::{Plan, Sample, SensorPlan};
pub use sheet::contact_sheet;
