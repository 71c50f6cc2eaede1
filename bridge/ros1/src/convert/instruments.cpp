#include "instruments.hpp"

#include <boost/make_shared.hpp>

#include <algorithm>

#include "geometry.hpp"

namespace belvedere_ros {

sensor_msgs::NavSatFixPtr to_nav_sat_fix(const Sample& sample) {
    using sensor_msgs::NavSatFix;
    using sensor_msgs::NavSatStatus;
    const auto from = read_struct<bv_nav_sat_fix>(sample);
    auto fix = boost::make_shared<NavSatFix>();
    fix->header = to_header(sample);
    fix->status.status = NavSatStatus::STATUS_FIX;
    fix->status.service = NavSatStatus::SERVICE_GPS;
    fix->latitude = from.latitude;
    fix->longitude = from.longitude;
    fix->altitude = from.altitude;
    const auto& covariance = from.position_covariance;
    std::copy(std::begin(covariance), std::end(covariance), fix->position_covariance.begin());
    const bool known = std::any_of(std::begin(covariance), std::end(covariance), [](double part) { return part != 0; });
    fix->position_covariance_type = known ? NavSatFix::COVARIANCE_TYPE_DIAGONAL_KNOWN : NavSatFix::COVARIANCE_TYPE_UNKNOWN;
    return fix;
}

sensor_msgs::MagneticFieldPtr to_magnetic_field(const Sample& sample) {
    const auto from = read_struct<bv_magnetic_field>(sample);
    auto field = boost::make_shared<sensor_msgs::MagneticField>();
    field->header = to_header(sample);
    field->magnetic_field = to_xyz<geometry_msgs::Vector3>(from.magnetic_field);
    std::copy(std::begin(from.covariance), std::end(from.covariance), field->magnetic_field_covariance.begin());
    return field;
}

sensor_msgs::FluidPressurePtr to_fluid_pressure(const Sample& sample) {
    const auto from = read_struct<bv_fluid_pressure>(sample);
    auto pressure = boost::make_shared<sensor_msgs::FluidPressure>();
    pressure->header = to_header(sample);
    pressure->fluid_pressure = from.fluid_pressure;
    pressure->variance = from.variance;
    return pressure;
}

geometry_msgs::PointStampedPtr to_height(const Sample& sample) {
    const auto from = read_struct<bv_altimeter>(sample);
    auto height = boost::make_shared<geometry_msgs::PointStamped>();
    height->header = to_header(sample);
    height->point.z = from.vertical_position;
    return height;
}

geometry_msgs::Vector3StampedPtr to_vector(const Sample& sample) {
    const auto from = read_struct<bv_vector3>(sample);
    auto vector = boost::make_shared<geometry_msgs::Vector3Stamped>();
    vector->header = to_header(sample);
    vector->vector = to_xyz<geometry_msgs::Vector3>(from.vector);
    return vector;
}

}  // namespace belvedere_ros
