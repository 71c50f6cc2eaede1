// Belvedere's frames as maps of Eigen, without a copy. Needs Eigen 3. SPDX-License-Identifier: MIT OR Apache-2.0
//
// A map is valid as long as its frame lives. Temporary frames do not compile.
#ifndef BELVEDERE_EIGEN_HPP
#define BELVEDERE_EIGEN_HPP

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "../belvedere.hpp"

namespace belvedere {

/// One layer of ranges, beginning at angle_min.
using EigenRanges = Eigen::Map<const Eigen::ArrayXf>;
/// A height x width array of T: depth, grey pixels, layers of ranges.
template <class T>
using EigenGrid = Eigen::Map<const Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, Eigen::Unaligned,
                             Eigen::OuterStride<>>;
/// A matrix of points with one column for each: x, y, z.
using EigenPoints = Eigen::Map<const Eigen::Matrix3Xf, Eigen::Unaligned, Eigen::OuterStride<>>;

/// Returns the ranges of a layer in metres; -inf too near, +inf nothing in range. Throws std::out_of_range if there is
/// no such layer.
inline EigenRanges eigen_ranges(const Frame& frame, std::uint32_t layer = 0) {
    if (frame.encoding() != BV_ENCODING_RANGES_F32) throw std::out_of_range("the frame has no ranges");
    const Span<const float> row = frame.row<float>(layer);
    return EigenRanges(row.data(), static_cast<Eigen::Index>(row.size()));
}
EigenRanges eigen_ranges(Frame&&, std::uint32_t = 0) = delete;

/// Returns the values of a frame as an array: T is float for depth and ranges, std::uint16_t for depth, std::uint8_t
/// for grey pixels, and either of the integers for Bayer images.
/// Throws std::out_of_range for a frame of another type.
template <class T>
EigenGrid<T> eigen_grid(const Frame& frame) {
    const Header& h = frame.header();
    const bv_encoding e = frame.encoding();
    const bool words = e == BV_ENCODING_U16C1 || e == BV_ENCODING_MONO16 ||
                       (e >= BV_ENCODING_BAYER_RGGB16 && e <= BV_ENCODING_BAYER_GRBG16);
    const bool bytes = e == BV_ENCODING_MONO8 || (e >= BV_ENCODING_BAYER_RGGB8 && e <= BV_ENCODING_BAYER_GRBG8);
    const bool same = std::is_same<T, float>::value           ? e == BV_ENCODING_F32C1 || e == BV_ENCODING_RANGES_F32
                      : std::is_same<T, std::uint16_t>::value ? words
                                                              : std::is_same<T, std::uint8_t>::value && bytes;
    if (!same || h.elem_stride != sizeof(T) || (h.height > 1 && h.row_stride % sizeof(T) != 0))
        throw std::out_of_range("the frame does not hold a grid of values of this type");
    return EigenGrid<T>(reinterpret_cast<const T*>(frame.payload().data()), h.height, h.width,
                        Eigen::OuterStride<>(h.row_stride / sizeof(T)));
}
template <class T>
EigenGrid<T> eigen_grid(Frame&&) = delete;

/// Returns the points of a cloud, row after row, in metres in frame_id; NaN for no point.
/// Throws std::out_of_range if the frame is not a cloud without gaps between its rows.
inline EigenPoints eigen_points(const Frame& frame) {
    const Header& h = frame.header();
    if (frame.encoding() != BV_ENCODING_XYZ_RGB_F32 || h.elem_stride % sizeof(float) != 0 ||
        (h.height > 1 && h.row_stride != std::uint64_t{h.width} * h.elem_stride))
        throw std::out_of_range("the frame is not a point cloud without gaps");
    return EigenPoints(reinterpret_cast<const float*>(frame.payload().data()), 3,
                       static_cast<Eigen::Index>(h.width) * h.height,
                       Eigen::OuterStride<>(h.elem_stride / sizeof(float)));
}
EigenPoints eigen_points(Frame&&) = delete;

/// Returns the camera matrix: fx skew cx, 0 fy cy, 0 0 1. Throws std::invalid_argument for a kind without intrinsics.
inline Eigen::Matrix3d eigen_camera_matrix(const Frame& frame) {
    const bv_intrinsics& lens = frame.intrinsics();
    Eigen::Matrix3d matrix;
    matrix << lens.fx, lens.skew, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1;
    return matrix;
}

namespace detail {

/// Converts a translation and a quaternion x y z w.
template <class T>
Eigen::Isometry3d isometry(const double (&translation)[3], const T (&rotation)[4]) {
    const Eigen::Quaterniond q(static_cast<double>(rotation[3]), static_cast<double>(rotation[0]),
                               static_cast<double>(rotation[1]), static_cast<double>(rotation[2]));
    Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
    transform.linear() = q.normalized().toRotationMatrix();
    transform.translation() << translation[0], translation[1], translation[2];
    return transform;
}

}  // namespace detail

/// Returns the pose of the sensor at the stamp: point_in_world = world_from_sensor * point_in_sensor. The sensor's axes
/// are x forward, y left, z up, also for a camera.
inline Eigen::Isometry3d eigen_world_from_sensor(const Frame& frame) {
    return detail::isometry(frame.header().position, frame.header().orientation);
}

/// Returns the pose of a camera's optical frame, whose axes are x right, y down, z forward:
/// eigen_world_from_optical(cloud) * eigen_points(cloud).col(i).cast<double>() is a point in the world.
inline Eigen::Isometry3d eigen_world_from_optical(const Frame& frame) {
    Eigen::Matrix3d sensor_from_optical;
    sensor_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return eigen_world_from_sensor(frame) * Eigen::Isometry3d(sensor_from_optical);
}

/// Returns the transform: point_in_parent = parent_from_child * point_in_child.
inline Eigen::Isometry3d eigen_parent_from_child(const bv_transform& transform) {
    return detail::isometry(transform.translation, transform.rotation);
}

/// Returns the pose of the robot in the odometry's fixed frame.
inline Eigen::Isometry3d eigen_odom_from_base(const bv_odometry& odometry) {
    return detail::isometry(odometry.position, odometry.orientation);
}

}  // namespace belvedere

#endif  // BELVEDERE_EIGEN_HPP
