#include "odometry.hpp"

#include <boost/make_shared.hpp>

#include <algorithm>

#include "geometry.hpp"

namespace belvedere_ros {

nav_msgs::OdometryPtr to_odometry(const Sample& sample) {
    const auto from = read_struct<bv_odometry>(sample);
    auto odometry = boost::make_shared<nav_msgs::Odometry>();
    odometry->header = to_header(sample);
    odometry->child_frame_id = to_text(from.child_frame_id);
    odometry->pose.pose.position = to_xyz<geometry_msgs::Point>(from.position);
    odometry->pose.pose.orientation = to_quaternion(from.orientation);
    odometry->twist.twist.linear = to_xyz<geometry_msgs::Vector3>(from.linear);
    odometry->twist.twist.angular = to_xyz<geometry_msgs::Vector3>(from.angular);
    std::copy(std::begin(from.pose_covariance), std::end(from.pose_covariance), odometry->pose.covariance.begin());
    std::copy(std::begin(from.twist_covariance), std::end(from.twist_covariance), odometry->twist.covariance.begin());
    return odometry;
}

}  // namespace belvedere_ros
