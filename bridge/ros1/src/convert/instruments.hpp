// Measurements of satellite receivers, magnetometers, barometers and altimeters.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts a GPS fix without its velocity, for which the message has no field. Its covariance is of
/// type COVARIANCE_TYPE_DIAGONAL_KNOWN, or unknown if all values are 0.
sensor_msgs::NavSatFixPtr to_nav_sat_fix(const Sample& sample);

sensor_msgs::MagneticFieldPtr to_magnetic_field(const Sample& sample);

sensor_msgs::FluidPressurePtr to_fluid_pressure(const Sample& sample);

/// Converts the height to a point above the origin of its frame, since Debian has no message for altimeters.
geometry_msgs::PointStampedPtr to_height(const Sample& sample);

geometry_msgs::Vector3StampedPtr to_vector(const Sample& sample);

}  // namespace belvedere_ros
