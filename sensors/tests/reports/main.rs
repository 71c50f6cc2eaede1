//! Measurements of each preset, compared with the published figures of its device: a page per preset in `docs/sensors`,
//! written by `BELVEDERE_BLESS=1 cargo test -p belvedere-sensors --test reports`. The test fails if a figure exceeds
//! its bound, if a page is not current, and for a preset without a page.

mod cameras;
#[path = "../common/mod.rs"]
mod common;
mod depth;
mod imu;
mod page;
mod plot;
mod scanners;
mod sheets;

use belvedere_sensors::device::{depth_model::presets as depth_presets, presets as camera_presets};
use belvedere_sensors::{imu::presets as imu_presets, scanner::presets as scanner_presets};
use page::{Page, check, index, summary};

/// The name of the device, which precedes the figures of a source.
fn device(source: &str) -> String {
    source.split(':').next().unwrap_or_default().to_owned()
}

fn hold(pages: &[Page]) {
    let missed: Vec<String> = pages.iter().flat_map(Page::missed).collect();
    assert!(missed.is_empty(), "out of bounds:\n{}", missed.join("\n"));
    for page in pages {
        check(&format!("{}.md", page.name), &page.markdown());
        for (number, plot) in page.plots.iter().enumerate() {
            check(&page.plot_name(number), &plot.svg());
        }
    }
}

#[test]
fn scanners_are_within_bounds() {
    hold(&scanner_presets::ALL.iter().map(scanners::page).collect::<Vec<_>>());
}

#[test]
fn depth_cameras_are_within_bounds() {
    hold(&depth_presets::ALL.iter().map(depth::page).collect::<Vec<_>>());
}

#[test]
fn inertial_units_are_within_bounds() {
    hold(&imu_presets::NAMES.map(imu::page));
}

#[test]
fn cameras_are_within_bounds() {
    hold(&camera_presets::NAMES.map(cameras::page));
}

#[test]
fn the_list_contains_all_pages() {
    let scanners = scanner_presets::ALL.iter().map(|preset| (preset.name, sheets::sheet(preset.name).device));
    let depth = depth_presets::ALL.iter().map(|preset| (preset.name, device(preset.source)));
    let cameras = camera_presets::NAMES.into_iter().map(|name| (name, cameras::sheet(name).device));
    let inertial = imu_presets::NAMES.into_iter().map(|name| (name, imu::sheet(name).device));
    let groups = [
        ("Lidars", scanners.collect()),
        ("Depth cameras", depth.collect()),
        ("Cameras", cameras.collect()),
        ("Inertial units", inertial.collect()),
    ];
    check("README.md", &index(&groups));
    check("../SUMMARY.md", &summary(&groups));
}
