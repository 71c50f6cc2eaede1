#include "adjusted_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace belvedere_ros {

namespace {

// The tolerance of an edge, as a share of the angle between two rays: edges are written with few digits.
constexpr double kEdge = 0.01;

/// Returns a stamp moved by seconds; 0, which means no stamp, if the result would be before time 0.
std::uint64_t moved(std::uint64_t stamp_ns, double seconds) {
    if (!(std::abs(seconds) <= ScanParameters::most_offset))
        throw Unrepresentable("its stamp cannot be moved by " + std::to_string(seconds) + " s");
    const auto offset_ns = static_cast<std::int64_t>(std::llround(seconds * 1e9));
    if (offset_ns >= 0) return stamp_ns + static_cast<std::uint64_t>(offset_ns);
    return stamp_ns - std::min(stamp_ns, static_cast<std::uint64_t>(-offset_ns));
}

}  // namespace

AdjustedScan::AdjustedScan(const Sample& scan, const ScanParameters& parameters) : header_(scan.header), payload_(scan.payload) {
    if (!parameters.publish_intensity) header_.flags &= ~static_cast<std::uint32_t>(BV_HAS_INTENSITIES);
    if (!parameters.frame_id.empty()) {
        std::memset(header_.frame_id, 0, sizeof header_.frame_id);
        std::copy(parameters.frame_id.begin(), parameters.frame_id.end(), header_.frame_id);
    }
    crop(parameters);
    header_.stamp_ns = moved(header_.stamp_ns, parameters.time_offset);
}

void AdjustedScan::crop(const ScanParameters& parameters) {
    bv_scan_geometry& geometry = header_.block.scan;
    if (header_.width == 0 || !(geometry.angle_increment > 0)) return;
    // Keep the rays from the first to the last one between the edges.
    const double last_ray = header_.width - 1.0;
    const auto place = [&](double angle) { return (angle - geometry.angle_min) / geometry.angle_increment; };
    const double first = std::max(0.0, std::ceil(place(parameters.angle_min) - kEdge));
    const double last = std::min(last_ray, std::floor(place(parameters.angle_max) + kEdge));
    if (first > last)
        throw Unrepresentable("none of its rays lies between angle_min " + std::to_string(parameters.angle_min) + " and angle_max " +
                              std::to_string(parameters.angle_max));
    const auto skipped = static_cast<std::size_t>(first) * header_.elem_stride;
    if (skipped > payload_.size()) throw Unrepresentable("the scan ends before its last ray");
    payload_ = {payload_.data() + skipped, payload_.size() - skipped};
    header_.width = static_cast<std::uint32_t>(last - first) + 1;
    geometry.angle_min += first * geometry.angle_increment;
    // The stamp is that of the first ray.
    header_.stamp_ns = moved(header_.stamp_ns, first * geometry.time_increment);
}

}  // namespace belvedere_ros
