// Belvedere's frames as cv::Mat, without a copy. Needs OpenCV's core headers. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_OPENCV_HPP
#define BELVEDERE_OPENCV_HPP

#include <opencv2/core.hpp>

#include <vector>

#include "../belvedere.hpp"

namespace belvedere {

/// Returns pixels, depth, ranges (one row per layer) or points (eight channels: x y z, and five for colour and padding)
/// as a matrix over the simulator's own memory. It is valid as long as the frame lives. The memory is read-only, which
/// cv::Mat cannot express: writing to it is a segmentation fault, so clone() a matrix before you change or keep it.
///
/// rgb8 has red first, but OpenCV's own images have blue first: cv::cvtColor(mat, bgr, cv::COLOR_RGB2BGR).
/// Throws std::invalid_argument if the frame's encoding or strides do not fit a matrix.
inline cv::Mat cv_mat(const Frame& frame) {
    const Header& h = frame.header();
    int type = 0;
    switch (frame.encoding()) {
        case BV_ENCODING_RGB8:
        case BV_ENCODING_BGR8: type = CV_8UC3; break;
        case BV_ENCODING_RGBA8: type = CV_8UC4; break;
        case BV_ENCODING_BAYER_RGGB8:
        case BV_ENCODING_BAYER_BGGR8:
        case BV_ENCODING_BAYER_GBRG8:
        case BV_ENCODING_BAYER_GRBG8:
        case BV_ENCODING_MONO8: type = CV_8UC1; break;
        case BV_ENCODING_BAYER_RGGB16:
        case BV_ENCODING_BAYER_BGGR16:
        case BV_ENCODING_BAYER_GBRG16:
        case BV_ENCODING_BAYER_GRBG16:
        case BV_ENCODING_MONO16:
        case BV_ENCODING_U16C1: type = CV_16UC1; break;
        case BV_ENCODING_F32C1:
        case BV_ENCODING_RANGES_F32: type = CV_32FC1; break;
        case BV_ENCODING_F32C2: type = CV_32FC2; break;
        case BV_ENCODING_F32C3: type = CV_32FC3; break;
        case BV_ENCODING_I32C1: type = CV_32SC1; break;
        case BV_ENCODING_XYZ_RGB_F32: type = CV_32FC(8); break;
        default: throw std::invalid_argument("a frame of this encoding cannot be a cv::Mat");
    }
    if (h.width == 0 || h.height == 0) return cv::Mat(0, 0, type);
    const std::size_t size = CV_ELEM_SIZE(type);
    const std::size_t step = h.height == 1 ? h.width * size : h.row_stride;
    if (h.elem_stride != size || step % CV_ELEM_SIZE1(type) != 0)
        throw std::invalid_argument("a frame with gaps between its elements cannot be a cv::Mat");
    // OpenCV has no matrices of const elements.
    void* data = const_cast<std::uint8_t*>(frame.payload().data());
    return cv::Mat(static_cast<int>(h.height), static_cast<int>(h.width), type, data, step);
}
/// Deleted: the frame would be released before the matrix is used.
cv::Mat cv_mat(Frame&&) = delete;

/// Returns the camera matrix: fx skew cx, 0 fy cy, 0 0 1. Throws std::invalid_argument for a kind without intrinsics.
inline cv::Matx33d cv_camera_matrix(const Frame& frame) {
    const bv_intrinsics& lens = frame.intrinsics();
    return {lens.fx, lens.skew, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
}

/// Returns the parameters of the frame's distortion_model(), in its order. OpenCV supports plumb_bob (5) and
/// rational_polynomial (8, 12 or 14) in cv::undistort and related functions, and equidistant (4) in cv::fisheye; it
/// does not have the other models.
inline std::vector<double> cv_distortion(const Frame& frame) {
    const Span<const double> d = frame.distortion();
    return {d.begin(), d.end()};
}

}  // namespace belvedere

#endif  // BELVEDERE_OPENCV_HPP
