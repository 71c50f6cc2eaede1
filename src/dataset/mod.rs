//! Data sets for learning: worlds × seeds × poses, looked at by a robot's sensors, in shards that training code reads as
//! they are.
//!
//! A [`Plan`] says what is wanted and numbers its samples; every sample is a function of the plan and its number alone. So
//! it makes no difference which process makes which shard, when, or beside how many others: the bytes are the same. A shard
//! is a tar file in the layout of `WebDataset`; it is there as a whole or not at all, and what is there is not made again.
//!
//! | file | is |
//! |---|---|
//! | `plan` | what a plan's file says, each mistake with its line |
//! | `poses` | where the robot stands for each sample |
//! | `looks` | what lamps and materials look like in each sample |
//! | `make`, `making` | shards, several at a time, and progress |
//! | `studio` | a world with the robot in it, and its sensors' frames |
//! | `fields` | frames as files: PNG, npy |
//! | `labels` | what is known of a sample, as JSON |
//! | `shard` | samples in a tar file |
//! | `folder` | what is there already, of which plan; the manifest |
//! | `export` | the layouts of others |
//! | `sheet` | samples in one picture |

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
