//! The metadata of a device, which a decoder needs in addition to its packets.

use super::device::Device;
use super::imu::{PACKETS_IN_FRAME, SAMPLES};
use super::lidar::COLUMNS;
use super::profile::ImuProfile;
use super::{IMU_PORT, LIDAR_PORT};

impl Device {
    /// Returns its metadata in the JSON format that the device provides over HTTP and ouster-sdk reads.
    #[must_use]
    pub fn metadata(&self) -> String {
        of(self)
    }
}

fn of(device: &Device) -> String {
    let head = &device.head;
    let (rows, columns, rate_hz) = (head.altitudes_deg.len(), head.columns_per_frame, device.rate_hz);
    let line = device.product_line.name();
    let profile = device.lidar_profile.name();
    let (serial, initialization) = (device.identity.serial, device.identity.initialization);
    let list =
        |values: &[f64]| values.iter().map(|value| format!("{value:.6}")).collect::<Vec<_>>().join(", ");
    let (altitudes, azimuths) = (list(&head.altitudes_deg), list(&head.azimuths_deg));
    let shifts = head.pixel_shifts().map(|shift| shift.to_string()).collect::<Vec<_>>().join(", ");
    let (beam_mm, up_mm) = (head.beam_origin_m * 1000.0, head.height_m * 1000.0);
    let imu_mm = device.product_line.imu_height_mm();
    let last = columns.saturating_sub(1);
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
    "prod_line": "{line}-{rows}", "prod_pn": "", "prod_sn": "{serial}", "initialization_id": {initialization},
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
