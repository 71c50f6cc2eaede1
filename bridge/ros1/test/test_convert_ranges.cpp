// Tests of rangefinders, lidars with several layers, and scans adjusted by their parameters.

#include <gtest/gtest.h>
#include <sensor_msgs/Range.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "../src/convert/adjusted_scan.hpp"
#include "../src/convert/laser_scan.hpp"
#include "../src/convert/scan_cloud.hpp"
#include "known.hpp"

namespace belvedere_ros {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Range, HasItsConeLimitsAndRange) {
    auto known = Known::structs<bv_range>(BV_KIND_RANGE, {{1, 0.2f, 0.02f, 4.0f, 1.5f}});
    const auto range = received<sensor_msgs::Range>(known.sample());
    expect_header(range->header);
    EXPECT_EQ(range->radiation_type, sensor_msgs::Range::INFRARED);
    EXPECT_FLOAT_EQ(range->field_of_view, 0.2f);
    EXPECT_FLOAT_EQ(range->min_range, 0.02f);
    EXPECT_FLOAT_EQ(range->max_range, 4.0f);
    EXPECT_FLOAT_EQ(range->range, 1.5f);
    auto sound = Known::structs<bv_range>(BV_KIND_RANGE, {{0, 0.2f, 0.02f, 4.0f, -kInf}});
    EXPECT_EQ(received<sensor_msgs::Range>(sound.sample())->radiation_type, sensor_msgs::Range::ULTRASOUND);
    EXPECT_EQ(received<sensor_msgs::Range>(sound.sample())->range, -kInf);
}

/// Returns a scan of this many rays and layers, 0.5 rad and 0.25 rad apart from −0.5 on.
Known layers_of(std::uint32_t rays, std::uint32_t layers, const std::vector<float>& planes, std::uint32_t flags) {
    Known known(BV_KIND_LASER_SCAN, BV_ENCODING_RANGES_F32, rays, layers, 4);
    known.header.flags = flags;
    known.header.block.scan = {-0.5, 0.5, 0.001, 0.1, 0.1f, 100.0f, -0.5, 0.25, {}};
    known.bytes.resize(planes.size() * sizeof(float));
    std::memcpy(known.bytes.data(), planes.data(), known.bytes.size());
    return known;
}

template <class T>
T at(const sensor_msgs::PointCloud2& cloud, std::size_t point, const std::string& name) {
    for (const auto& field : cloud.fields) {
        if (field.name != name) continue;
        T value;
        std::memcpy(&value, cloud.data.data() + point * cloud.point_step + field.offset, sizeof value);
        return value;
    }
    ADD_FAILURE() << "no field " << name;
    return {};
}

TEST(ScanCloud, IsOrganisedWithTheFieldsOfAVelodyne) {
    auto known = layers_of(3, 2, {1, 2, 3, 4, kInf, -kInf, 10, 20, 30, 40, 0, 0}, BV_HAS_INTENSITIES);
    const auto cloud = to_scan_cloud(known.sample());
    expect_header(cloud->header);
    EXPECT_EQ(cloud->width, 3u);
    EXPECT_EQ(cloud->height, 2u);
    EXPECT_EQ(cloud->point_step, 22u);
    EXPECT_EQ(cloud->row_step, 66u);
    EXPECT_EQ(cloud->data.size(), 132u);
    EXPECT_FALSE(cloud->is_dense);
    const std::vector<std::string> names = {"x", "y", "z", "intensity", "ring", "time"};
    ASSERT_EQ(cloud->fields.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(cloud->fields[i].name, names[i]);
    EXPECT_EQ(cloud->fields[4].datatype, sensor_msgs::PointField::UINT16);
    for (std::uint32_t point = 0; point < 6; ++point) {
        const std::uint32_t ray = point % 3, layer = point / 3;
        EXPECT_EQ(at<std::uint16_t>(*cloud, point, "ring"), layer);
        EXPECT_FLOAT_EQ(at<float>(*cloud, point, "time"), 0.001f * static_cast<float>(ray));
        if (point >= 4) {
            for (const char* axis : {"x", "y", "z"}) EXPECT_TRUE(std::isnan(at<float>(*cloud, point, axis)));
            continue;
        }
        const double range = point + 1.0, azimuth = -0.5 + 0.5 * ray, elevation = -0.5 + 0.25 * layer;
        EXPECT_NEAR(at<float>(*cloud, point, "x"), range * std::cos(elevation) * std::cos(azimuth), 1e-6);
        EXPECT_NEAR(at<float>(*cloud, point, "y"), range * std::cos(elevation) * std::sin(azimuth), 1e-6);
        EXPECT_NEAR(at<float>(*cloud, point, "z"), range * std::sin(elevation), 1e-6);
        EXPECT_FLOAT_EQ(at<float>(*cloud, point, "intensity"), 10.0f * static_cast<float>(range));
    }
}

TEST(ScanCloud, IsDenseIfEveryRayHasARange) {
    const auto cloud = to_scan_cloud(layers_of(2, 2, {1, 2, 3, 4}, 0).sample());
    EXPECT_TRUE(cloud->is_dense);
    EXPECT_EQ(cloud->fields.size(), 5u);
    EXPECT_EQ(cloud->point_step, 18u);
}

TEST(ScanCloud, AllocatesNothingForMissingRays) {
    for (const auto& [width, height, row_stride] : std::vector<std::array<std::uint32_t, 3>>{
             {4'000'000'000, 1, 16}, {2, 60'000, 8}, {2, 60'000, 0}, {2, 4'000'000'000, 8}, {2, 2, 4}, {2, 3, 4'000'000'000}}) {
        auto known = layers_of(2, 2, {1, 2, 3, 4}, 0);
        known.header.width = width;
        known.header.height = height;
        known.header.row_stride = row_stride;
        EXPECT_THROW(to_scan_cloud(known.sample()), Unrepresentable) << width << " x " << height << ", " << row_stride;
    }
    auto empty = layers_of(2, 2, {}, 0);
    empty.header.width = 4'000'000'000;
    empty.header.height = 0;
    EXPECT_TRUE(to_scan_cloud(empty.sample())->data.empty());
}

TEST(ScanCloud, RefusesTooManyLayers) {
    auto known = layers_of(1, 1, {1}, 0);
    known.header.width = 250'000'000;  // of 18 bytes each: more than 2^32
    known.header.row_stride = known.header.width * 4;
    // Refused before reading the payload, of which only the first ray exists.
    const Sample sample(known.header, {known.bytes.data(), known.header.row_stride});
    EXPECT_THROW(to_scan_cloud(sample), Unrepresentable);
}

TEST(AdjustedScan, IsCroppedToWholeRaysWithBothPlanes) {
    auto known = layers_of(5, 1, {1, 2, 3, 4, 5, 10, 20, 30, 40, 50}, BV_HAS_INTENSITIES);  // −0.5, 0, 0.5, 1, 1.5
    ScanParameters parameters;
    parameters.angle_min = -0.1;
    parameters.angle_max = 0.9999;  // as 1.0 may have been rounded
    const AdjustedScan adjusted(known.sample(), parameters);
    const auto scan = to_laser_scan(adjusted.sample());
    EXPECT_EQ(scan->ranges, (std::vector<float>{2, 3, 4}));
    EXPECT_EQ(scan->intensities, (std::vector<float>{20, 30, 40}));
    EXPECT_FLOAT_EQ(scan->angle_min, 0.0f);
    EXPECT_FLOAT_EQ(scan->angle_max, 1.0f);
    // The new first ray is measured a millisecond later.
    EXPECT_EQ(scan->header.stamp.toNSec(), known.header.stamp_ns + 1'000'000);
    parameters.angle_max = 0.4;
    EXPECT_EQ(to_laser_scan(AdjustedScan(known.sample(), parameters).sample())->ranges, (std::vector<float>{2}));
    parameters.angle_min = 0.1;
    EXPECT_THROW(AdjustedScan(known.sample(), parameters), Unrepresentable);
}

TEST(AdjustedScan, OfSeveralLayersIsCroppedInEach) {
    auto known = layers_of(3, 2, {1, 2, 3, 4, 5, 6}, 0);
    ScanParameters parameters;
    parameters.angle_min = 0.0;
    const AdjustedScan adjusted(known.sample(), parameters);
    const auto cloud = to_scan_cloud(adjusted.sample());
    EXPECT_EQ(cloud->width, 2u);
    const auto range = [&](std::size_t point) {
        return std::hypot(at<float>(*cloud, point, "x"), at<float>(*cloud, point, "y"), at<float>(*cloud, point, "z"));
    };
    EXPECT_NEAR(range(0), 2.0, 1e-6);
    EXPECT_NEAR(range(3), 6.0, 1e-6);
}

TEST(AdjustedScan, HasAnotherFrameAndStampAndNoIntensities) {
    auto known = layers_of(2, 1, {1, 2, 10, 20}, BV_HAS_INTENSITIES);
    ScanParameters parameters;
    parameters.frame_id = "laser";
    parameters.time_offset = -0.25;
    parameters.publish_intensity = false;
    const AdjustedScan adjusted(known.sample(), parameters);
    const auto scan = to_laser_scan(adjusted.sample());
    EXPECT_EQ(scan->header.frame_id, "laser");
    EXPECT_EQ(scan->header.stamp.toNSec(), known.header.stamp_ns - 250'000'000);
    EXPECT_TRUE(scan->intensities.empty());
    parameters.time_offset = -1e6;
    EXPECT_EQ(AdjustedScan(known.sample(), parameters).sample().header.stamp_ns, 0u);
    for (const double no_time : {1e300, std::nan("")}) {
        auto odd = known;
        odd.header.block.scan.time_increment = no_time;
        parameters.angle_min = -0.1;  // the second ray becomes the first one
        EXPECT_THROW(AdjustedScan(odd.sample(), parameters), Unrepresentable);
    }
    parameters.time_offset = 2e9;
    EXPECT_THROW(parameters.check("/belvedere"), BadParameter);
    // Without parameters the scan is unchanged.
    EXPECT_EQ(to_laser_scan(AdjustedScan(known.sample(), {}).sample())->ranges, (std::vector<float>{1, 2}));
}

}  // namespace
}  // namespace belvedere_ros
