//! `belvedere dataset`: generates training data, in shards.

use super::error::CliError;
use super::follow::{listen_for_stop, print_line, stop_wanted};
use super::log::status_lines;
use crate::dataset::{
    DatasetError, Folder, Making, Plan, check_coco, check_kitti, contact_sheet, export_coco, export_kitti,
    make,
};
use crate::description::models::package_path;
use crate::description::text::count;
use indicatif::{HumanBytes, HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal as _;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Make a data set for machine learning: worlds × seeds × poses, as defined by a plan, in shards of `WebDataset`.
///
/// The bytes of a shard depend only on the plan: not on the number of workers, the machine, or the other shards that
/// are made. A shard is written completely or not at all, and existing shards are not made again: after a kill or a
/// full disk, run the same command again and it continues. Once all shards exist, manifest.json lists their SHA-256.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere dataset plan.toml -o out
  belvedere dataset plan.toml -o out --shards 3..7        (shards 3, 4, 5, 6)
  belvedere dataset plan.toml -o out --shard 2/16         (the share of task 2 of 16, numbered from 0)
  belvedere dataset plan.toml -o out                      (afterwards: the missing shards, and the manifest)")]
pub struct DatasetArgs {
    /// The plan; docs/datasets.md describes its format
    plan: PathBuf,
    /// The folder of the shards
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Make only these shards, the last excluded, and no manifest
    #[arg(long, value_name = "FIRST..END", conflicts_with = "shard")]
    shards: Option<ShardRange>,
    /// Make only the share of one of several tasks, numbered from 0, and no manifest
    #[arg(long, value_name = "TASK/TASKS")]
    shard: Option<Share>,
    /// Number of shards to make in parallel [default: number of cores]
    #[arg(long, value_name = "COUNT")]
    workers: Option<NonZeroUsize>,
    /// Also export the images and objects of a sensor in COCO format to FOLDER/coco/SENSOR; may be repeated
    #[arg(long, value_name = "SENSOR", conflicts_with_all = ["shards", "shard"])]
    coco: Vec<String>,
    /// Also export the images and objects of a pinhole camera in KITTI format to FOLDER/kitti/CAMERA, and the clouds of
    /// a Velodyne lidar; may be repeated
    #[arg(long, value_name = "CAMERA[,LIDAR]", conflicts_with_all = ["shards", "shard"])]
    kitti: Vec<String>,
    /// Print the plan's number of samples and shards, and make nothing
    #[arg(long)]
    count: bool,
    /// A folder of ROS packages, searched before `ROS_PACKAGE_PATH` and the shipped packages; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
}

/// A range of shards, the end excluded: `3..7` is 3, 4, 5, 6.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ShardRange {
    first: u64,
    end: u64,
}

impl FromStr for ShardRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range =
            text.split_once("..").and_then(|(first, end)| Some((first.parse().ok()?, end.parse().ok()?)));
        range.filter(|(first, end)| first < end).map(|(first, end)| Self { first, end }).ok_or_else(|| {
            format!("'{text}' is not a range; write FIRST..END, such as 3..7 for 3, 4, 5 and 6")
        })
    }
}

/// The shards of one task: `2/16` is 2, 18, 34, …
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Share {
    task: u64,
    tasks: u64,
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let share =
            text.split_once('/').and_then(|(task, tasks)| Some((task.parse().ok()?, tasks.parse().ok()?)));
        share
            .filter(|(task, tasks)| task < tasks)
            .map(|(task, tasks)| Self { task, tasks })
            .ok_or_else(|| format!("'{text}' is not a share; write TASK/TASKS, from 0/16 to 15/16"))
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Dataset`].
pub fn run(args: &DatasetArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let packages = package_path(args.package_path.iter().cloned(), ros_package_path.as_deref());
    let plan = Plan::read(&args.plan, &packages)?;
    // Report wrong names before hours of work instead of after them.
    for sensor in &args.coco {
        check_coco(&plan, sensor)?;
    }
    for sensors in &args.kitti {
        check_kitti(&plan, camera_and_lidar(sensors))?;
    }
    let all = plan.shards();
    if args.count {
        return print_line(&format!("{}, {}", count(plan.samples(), "sample"), count(all, "shard")));
    }
    let shards: Vec<u64> = match (args.shards, args.shard) {
        (Some(ShardRange { first, end }), _) if end > all => {
            return Err(DatasetError::NoSuchShards { first, end, shards: all }.into());
        }
        (Some(range), _) => (range.first..range.end).collect(),
        (_, Some(share)) => (share.task..all).step_by(share.tasks as usize).collect(),
        _ => (0..all).collect(),
    };
    let folder = Folder::open(&args.output, &plan)?;
    let there = shards.iter().filter(|shard| folder.has(**shard)).count();
    let missing = shards.iter().filter(|shard| !folder.has(**shard));
    let progress = Progress::new(
        missing.map(|shard| plan.samples_of(*shard)).map(|range| range.end - range.start).sum(),
    );
    let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    make(&plan, &folder, &shards, args.workers.unwrap_or(cores), &progress)?;
    progress.bar.finish_and_clear();
    if args.shards.is_some() || args.shard.is_some() {
        let made = shards.len() - there;
        let still = (0..all).filter(|shard| !folder.has(*shard)).count();
        let then = if still == 0 {
            "all shards exist: run the command without --shards and --shard to write the manifest".to_owned()
        } else {
            format!("{still} of {all} are still missing")
        };
        return print_line(&format!(
            "{}: {} made, {there} existed already; {then}",
            args.output.display(),
            count(made as u64, "shard")
        ));
    }
    let (manifest, path) = folder.finish(&plan, &progress)?;
    let bytes: u64 = manifest.shards.iter().map(|shard| shard.bytes).sum();
    print_line(&format!(
        "{}: {} in {}, {there} of which existed already, {}; {}",
        args.output.display(),
        count(manifest.samples, "sample"),
        count(manifest.shards.len() as u64, "shard"),
        HumanBytes(bytes),
        path.display()
    ))?;
    for sensor in &args.coco {
        let to = args.output.join("coco").join(sensor);
        let written = export_coco(&plan, &folder, sensor, &to, &progress)?;
        print_line(&format!("{}: export in COCO format", written.display()))?;
    }
    for sensors in &args.kitti {
        let (camera, lidar) = camera_and_lidar(sensors);
        let to = args.output.join("kitti").join(camera);
        let written = export_kitti(&plan, &folder, (camera, lidar), &to, &progress)?;
        print_line(&format!("{}: export in KITTI format", written.display()))?;
    }
    match contact_sheet(&plan, &folder)? {
        Some(sheet) => print_line(&format!("{}: contact sheet, one row per sample", sheet.display())),
        None => Ok(()),
    }
}

/// Splits `CAMERA[,LIDAR]`.
fn camera_and_lidar(sensors: &str) -> (&str, Option<&str>) {
    match sensors.split_once(',') {
        Some((camera, lidar)) => (camera, Some(lidar)),
        None => (sensors, None),
    }
}

/// Shortest time between two lines of progress if there is no terminal.
const LINE_PERIOD: Duration = Duration::from_secs(10);

/// Shows progress: a bar on a terminal, else a line from time to time.
struct Progress {
    bar: ProgressBar,
    /// Time of the last line, if lines are written instead of a bar.
    line: Option<Mutex<Instant>>,
}

impl Progress {
    fn new(samples: u64) -> Self {
        let is_terminal = std::io::stderr().is_terminal();
        let bar = if is_terminal {
            status_lines().add(ProgressBar::new(samples))
        } else {
            ProgressBar::with_draw_target(Some(samples), ProgressDrawTarget::hidden())
        };
        let style = "{bar:30} {pos}/{len} samples, {per_sec}, {elapsed} elapsed, {eta} left";
        bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self { bar, line: (!is_terminal).then(|| Mutex::new(Instant::now())) }
    }
}

impl Making for Progress {
    fn sample_done(&self) {
        self.bar.inc(1);
        let Some(Ok(mut last)) = self.line.as_ref().map(Mutex::lock) else { return };
        if last.elapsed() >= LINE_PERIOD {
            *last = Instant::now();
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or_default());
            let left = HumanDuration(self.bar.eta());
            eprintln!("{done} of {all} samples, {left} left");
        }
    }

    fn is_stopped(&self) -> bool {
        stop_wanted()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_shares() {
        assert_eq!("3..7".parse(), Ok(ShardRange { first: 3, end: 7 }));
        assert_eq!("2/16".parse(), Ok(Share { task: 2, tasks: 16 }));
        for text in ["7..3", "3", "", "-1..2", "3..3", "a..b"] {
            assert!(text.parse::<ShardRange>().unwrap_err().contains("3..7"), "{text}");
        }
        for text in ["16/16", "0/0", "1", "/", "-1/2"] {
            assert!(text.parse::<Share>().unwrap_err().contains("0/16"), "{text}");
        }
    }
}
