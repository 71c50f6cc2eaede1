// Belvedere's point clouds for the Point Cloud Library. Needs PCL's headers. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_PCL_HPP
#define BELVEDERE_PCL_HPP

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "../belvedere.hpp"

namespace belvedere {

static_assert(sizeof(pcl::PointXYZRGB) == 32 && offsetof(pcl::PointXYZRGB, x) == 0 && offsetof(pcl::PointXYZRGB, z) == 8 &&
                  offsetof(pcl::PointXYZRGB, rgb) == 16,
              "the wire's points have PCL's layout");

/// Returns one row of points in the simulator's own memory, valid as long as the frame lives. PCL's fourth coordinate
/// and alpha are 0 here: use x, y, z, r, g, b, not getVector4fMap().
/// Throws std::out_of_range if the row does not exist or the frame is not a cloud.
inline Span<const pcl::PointXYZRGB> pcl_row(const Frame& frame, std::uint32_t y) {
    const Header& h = frame.header();
    if (frame.encoding() != BV_ENCODING_XYZ_RGB_F32 || h.elem_stride != sizeof(pcl::PointXYZRGB))
        throw std::out_of_range("the frame is not a point cloud");
    const Span<const std::uint8_t> row = frame.row<std::uint8_t>(y);
    if (reinterpret_cast<std::uintptr_t>(row.data()) % alignof(pcl::PointXYZRGB) != 0)
        throw std::out_of_range("rows of the cloud are not aligned for PCL");
    return {reinterpret_cast<const pcl::PointXYZRGB*>(row.data()), row.size() / sizeof(pcl::PointXYZRGB)};
}
Span<const pcl::PointXYZRGB> pcl_row(Frame&&, std::uint32_t) = delete;

/// Returns a copy, since pcl::PointCloud owns its points. It is organised like the frame, with its coordinate frame,
/// sequence number and stamp (simulated time, in PCL's microseconds). Missing points are NaN, so the cloud is not
/// dense.
inline pcl::PointCloud<pcl::PointXYZRGB> pcl_cloud(const Frame& frame) {
    const Header& h = frame.header();
    pcl::PointCloud<pcl::PointXYZRGB> cloud(h.width, h.height);
    cloud.header.seq = static_cast<std::uint32_t>(h.seq);
    cloud.header.stamp = h.stamp_ns / 1000;
    cloud.header.frame_id = frame.frame_id();
    cloud.is_dense = false;
    auto out = cloud.points.begin();
    for (std::uint32_t y = 0; y < h.height; ++y)
        for (const pcl::PointXYZRGB& in : pcl_row(frame, y)) {
            // Assigned by component, so that a new point keeps PCL's values of the fourth coordinate and alpha.
            out->x = in.x;
            out->y = in.y;
            out->z = in.z;
            out->r = in.r;
            out->g = in.g;
            out->b = in.b;
            ++out;
        }
    return cloud;
}

}  // namespace belvedere

#endif  // BELVEDERE_PCL_HPP
