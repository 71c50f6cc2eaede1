//! What a decoder has to know of a head, as the device tells it.

use super::inertial::{PACKETS_IN_FRAME, SAMPLES};
use super::{COLUMNS, IMU_PORT, INITIALIZATION, LIDAR_PORT, Ouster, SERIAL};
use crate::description::model::ImuProfile;

/// Metadata in JSON.
pub(super) fn of(device: &Ouster) -> String {
    let head = &device.head;
    let (rows, columns, rate_hz) = (head.lasers.len(), head.columns, device.rate_hz);
    let line = device.name[..3].to_uppercase().replace("OS", "OS-");
    let profile = device.profile.name();
    let list = |values: &mut dyn Iterator<Item = f64>| {
        values.map(|value| format!("{value:.6}")).collect::<Vec<_>>().join(", ")
    };
    let altitudes = list(&mut head.lasers.iter().map(|laser| laser.elevation_rad.to_degrees()));
    let azimuths = list(&mut head.azimuths_deg());
    let shifts = head.shifts().map(|shift| shift.to_string()).collect::<Vec<_>>().join(", ");
    let beam_mm = head.beam_origin_mm();
    let up_mm = head.lasers.first().map_or(0.0, |laser| laser.origin_m[2] * 1000.0);
    // The IMU is at the same place in all housings, but an OS2's is higher.
    let imu_mm = if line == "OS-2" { 11.645 } else { 7.645 };
    let last = columns - 1;
    let imu_profile = device.imu_profile.name();
    let imu_format = match device.imu_profile {
        ImuProfile::Legacy => String::new(),
        ImuProfile::Accel32Gyro32Nmea => format!(
            "\n  \"imu_data_format\": {{\"imu_measurements_per_packet\": {SAMPLES}, \"imu_packets_per_frame\": {PACKETS_IN_FRAME}}},"
        ),
    };
    format!(
        r#"{{
  "sensor_info": {{
    "prod_line": "{line}-{rows}", "prod_pn": "", "prod_sn": "{SERIAL}", "initialization_id": {INITIALIZATION},
    "build_date": "", "build_rev": "", "image_rev": "", "status": "RUNNING"
  }},
  "config_params": {{
    "lidar_mode": "{columns}x{rate_hz}", "udp_port_lidar": {LIDAR_PORT}, "udp_port_imu": {IMU_PORT},
    "udp_profile_lidar": "{profile}", "udp_profile_imu": "{imu_profile}"
  }},{imu_format}
  "lidar_data_format": {{
    "columns_per_frame": {columns}, "columns_per_packet": {COLUMNS}, "pixels_per_column": {rows}, "fps": {rate_hz},
    "column_window": [0, {last}], "udp_profile_lidar": "{profile}", "udp_profile_imu": "{imu_profile}",
    "pixel_shift_by_row": [{shifts}]
  }},
  "beam_intrinsics": {{
    "lidar_origin_to_beam_origin_mm": {beam_mm},
    "beam_to_lidar_transform": [1, 0, 0, {beam_mm}, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
    "beam_altitude_angles": [{altitudes}],
    "beam_azimuth_angles": [{azimuths}]
  }},
  "lidar_intrinsics": {{
    "lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, {up_mm}, 0, 0, 0, 1]
  }},
  "imu_intrinsics": {{
    "imu_to_sensor_transform": [1, 0, 0, 6.253, 0, 1, 0, -11.775, 0, 0, 1, {imu_mm}, 0, 0, 0, 1]
  }},
  "calibration_status": {{}}
}}
"#
    )
}
