// Conversion of vectors and rotations.
#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Vector3.h>

namespace belvedere_ros {

/// Converts to a geometry_msgs/Point or Vector3.
template <class Xyz>
Xyz to_xyz(const double (&from)[3]) {
    Xyz to;
    to.x = from[0];
    to.y = from[1];
    to.z = from[2];
    return to;
}

/// Converts from x y z w.
inline geometry_msgs::Quaternion to_quaternion(const double (&from)[4]) {
    geometry_msgs::Quaternion to;
    to.x = from[0];
    to.y = from[1];
    to.z = from[2];
    to.w = from[3];
    return to;
}

}  // namespace belvedere_ros
