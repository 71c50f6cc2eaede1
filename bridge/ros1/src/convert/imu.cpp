#include "imu.hpp"

#include <boost/make_shared.hpp>

#include <algorithm>

#include "geometry.hpp"

namespace belvedere_ros {

sensor_msgs::ImuPtr to_imu(const Sample& sample) {
    const auto from = read_struct<bv_imu>(sample);
    auto imu = boost::make_shared<sensor_msgs::Imu>();
    imu->header = to_header(sample);
    imu->orientation = to_quaternion(from.orientation);
    imu->angular_velocity = to_xyz<geometry_msgs::Vector3>(from.angular_velocity);
    imu->linear_acceleration = to_xyz<geometry_msgs::Vector3>(from.linear_acceleration);
    std::copy(std::begin(from.orientation_covariance), std::end(from.orientation_covariance), imu->orientation_covariance.begin());
    std::copy(std::begin(from.angular_velocity_covariance), std::end(from.angular_velocity_covariance),
              imu->angular_velocity_covariance.begin());
    std::copy(std::begin(from.linear_acceleration_covariance), std::end(from.linear_acceleration_covariance),
              imu->linear_acceleration_covariance.begin());
    return imu;
}

}  // namespace belvedere_ros
