#include "camera_info.hpp"

#include <boost/make_shared.hpp>

#include <algorithm>

namespace belvedere_ros {

sensor_msgs::CameraInfoPtr to_camera_info(const Sample& sample) {
    const auto from = read_struct<bv_camera_info>(sample);
    auto info = boost::make_shared<sensor_msgs::CameraInfo>();
    info->header = to_header(sample);
    info->width = from.width;
    info->height = from.height;
    info->distortion_model = to_text(from.distortion_model);
    info->D.assign(from.d, from.d + std::min<std::size_t>(from.d_len, std::size(from.d)));
    std::copy(std::begin(from.k), std::end(from.k), info->K.begin());
    std::copy(std::begin(from.r), std::end(from.r), info->R.begin());
    std::copy(std::begin(from.p), std::end(from.p), info->P.begin());
    return info;
}

}  // namespace belvedere_ros
