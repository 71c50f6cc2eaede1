//! Converts the preset of an Ouster to a head of lidar-packets.

use belvedere_sensors::scanner::presets::Preset;
use belvedere_sensors::scanner::{Columns, Pattern};
use lidar_packets::ouster::Head;

/// Returns the head of a preset. It has no beams if the preset is not an Ouster.
pub(super) fn head_of(preset: &Preset) -> Head {
    let Pattern::Spinning(head) = preset.pattern else {
        return Head {
            altitudes_deg: Vec::new(),
            azimuths_deg: Vec::new(),
            columns_per_frame: 0,
            beam_origin_m: 0.0,
            height_m: 0.0,
        };
    };
    let [beam_origin_m, _, height_m] = head.lasers.first().map_or([0.0; 3], |laser| laser.origin_m);
    Head {
        altitudes_deg: head.lasers.iter().map(|laser| laser.elevation_rad.to_degrees()).collect(),
        // Azimuths of presets are counter-clockwise, those of Ouster clockwise.
        azimuths_deg: head.lasers.iter().map(|laser| -laser.azimuth_rad.to_degrees()).collect(),
        columns_per_frame: if let Columns::Turn { per_turn, .. } = head.columns { per_turn } else { 0 },
        beam_origin_m,
        height_m,
    }
}
