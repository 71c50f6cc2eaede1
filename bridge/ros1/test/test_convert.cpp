// Tests of every converter with frames of known bytes, without a master or shared memory.

#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "../src/convert/camera_info.hpp"
#include "../src/convert/image.hpp"
#include "../src/convert/laser_scan.hpp"
#include "../src/convert/point_cloud.hpp"
#include "../src/convert/transforms.hpp"
#include "known.hpp"

namespace belvedere_ros {
namespace {

TEST(Header, DropsTheSlashThatTf2Refuses) {
    const char slashed[64] = "/odom";
    EXPECT_EQ(to_text(slashed), "odom");
    char full[4] = {'a', 'b', 'c', 'd'};
    EXPECT_EQ(to_text(full), "abcd");
}

TEST(Header, TimeEndsAt32BitsOfSeconds) {
    EXPECT_EQ(to_time(4'294'967'295'999'999'999).sec, 4'294'967'295u);
    EXPECT_THROW(to_time(4'294'967'296'000'000'000), Unrepresentable);
}

TEST(Image, KeepsEveryByteAndTheRowStride) {
    struct Case {
        bv_kind kind;
        bv_encoding encoding;
        std::uint32_t size;
        const char* name;
    };
    for (const Case& one : {Case{BV_KIND_IMAGE, BV_ENCODING_RGB8, 3, "rgb8"}, Case{BV_KIND_IMAGE, BV_ENCODING_BGR8, 3, "bgr8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_MONO8, 1, "mono8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_RGBA8, 4, "rgba8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_MONO16, 2, "mono16"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_RGGB8, 1, "bayer_rggb8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_BGGR8, 1, "bayer_bggr8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_GBRG8, 1, "bayer_gbrg8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_GRBG8, 1, "bayer_grbg8"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_RGGB16, 2, "bayer_rggb16"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_BGGR16, 2, "bayer_bggr16"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_GBRG16, 2, "bayer_gbrg16"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_BAYER_GRBG16, 2, "bayer_grbg16"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_F32C2, 8, "32FC2"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_F32C3, 12, "32FC3"},
                            Case{BV_KIND_IMAGE, BV_ENCODING_I32C1, 4, "32SC1"},
                            Case{BV_KIND_DEPTH_IMAGE, BV_ENCODING_F32C1, 4, "32FC1"},
                            Case{BV_KIND_DEPTH_IMAGE, BV_ENCODING_U16C1, 2, "16UC1"}}) {
        Known known(one.kind, one.encoding, 5, 4, one.size, 12);
        const auto image = to_image(known.sample());
        expect_header(image->header);
        EXPECT_EQ(image->encoding, one.name);
        EXPECT_EQ(image->width, 5u);
        EXPECT_EQ(image->height, 4u);
        EXPECT_EQ(image->step, 5 * one.size + 12);
        EXPECT_EQ(image->is_bigendian, 0);
        EXPECT_EQ(image->data, known.bytes);
    }
}

TEST(Image, TheLastRowMayBeUnpadded) {
    Known known(BV_KIND_IMAGE, BV_ENCODING_MONO8, 5, 4, 1, 3);
    known.bytes.resize(known.bytes.size() - 3);
    EXPECT_EQ(to_image(known.sample())->data.size(), 32u);
}

TEST(Image, TakesAtMostTwiceThePayload) {
    Known known(BV_KIND_IMAGE, BV_ENCODING_RGB8, 2, 1, 3);
    known.header.row_stride = 4'000'000'000;
    EXPECT_EQ(to_image(known.sample())->step, 6u);
    EXPECT_EQ(to_image(known.sample())->data.size(), 6u);
    known.header.width = 0;
    known.header.height = 4'000'000'000;
    EXPECT_TRUE(to_image(known.sample())->data.empty());
    Known points(BV_KIND_POINT_CLOUD, BV_ENCODING_XYZ_RGB_F32, 2, 1, 32);
    points.header.row_stride = 4'000'000'000;
    EXPECT_EQ(to_point_cloud(points.sample())->row_step, 64u);
    EXPECT_EQ(to_point_cloud(points.sample())->data.size(), 64u);
    // For a single element nothing bounds the element stride.
    Known point(BV_KIND_POINT_CLOUD, BV_ENCODING_XYZ_RGB_F32, 1, 1, 32);
    EXPECT_EQ(to_point_cloud(point.sample())->data, point.bytes);
    point.header.elem_stride = std::numeric_limits<std::uint32_t>::max();
    EXPECT_THROW(to_point_cloud(point.sample()), Unrepresentable);
    // A row of 2³² bytes, whose length exceeds 2³² − 1.
    Known row(BV_KIND_POINT_CLOUD, BV_ENCODING_XYZ_RGB_F32, 2, 1, 32);
    row.header.elem_stride = 1u << 31;
    EXPECT_THROW(to_point_cloud(row.sample()), Unrepresentable);
}

TEST(Image, RefusesUnrepresentableFrames) {
    EXPECT_THROW(to_image(Known(BV_KIND_IMAGE, BV_ENCODING_XYZ_RGB_F32, 1, 1, 32).sample()), Unrepresentable);
    EXPECT_THROW(to_image(Known(BV_KIND_IMAGE, BV_ENCODING_RGB8, 2, 2, 4).sample()), Unrepresentable);
}

TEST(CameraInfo, HasMatricesAndTheModelsCoefficients) {
    bv_camera_info from{};
    from.width = 640;
    from.height = 480;
    std::strcpy(from.distortion_model, "rational_polynomial");
    from.d_len = 14;
    for (int i = 0; i < 14; ++i) from.d[i] = 0.1 * i;
    for (int i = 0; i < 9; ++i) from.k[i] = 100 + i, from.r[i] = 200 + i;
    for (int i = 0; i < 12; ++i) from.p[i] = 300 + i;
    auto known = Known::structs<bv_camera_info>(BV_KIND_CAMERA_INFO, {from});
    const auto info = to_camera_info(known.sample());
    expect_header(info->header);
    EXPECT_EQ(info->width, 640u);
    EXPECT_EQ(info->height, 480u);
    EXPECT_EQ(info->distortion_model, "rational_polynomial");
    EXPECT_EQ(info->D, std::vector<double>(from.d, from.d + 14));
    EXPECT_TRUE(std::equal(info->K.begin(), info->K.end(), from.k));
    EXPECT_TRUE(std::equal(info->R.begin(), info->R.end(), from.r));
    EXPECT_TRUE(std::equal(info->P.begin(), info->P.end(), from.p));
    // As many parameters as the model has, and never more than exist.
    for (const auto& [said, told] : {std::pair{5u, 5u}, {4u, 4u}, {0u, 0u}, {4'000'000'000u, 14u}}) {
        from.d_len = said;
        known = Known::structs<bv_camera_info>(BV_KIND_CAMERA_INFO, {from});
        EXPECT_EQ(to_camera_info(known.sample())->D, std::vector<double>(from.d, from.d + told));
    }
}

TEST(CameraInfo, RefusesSomethingSmaller) {
    EXPECT_THROW(to_camera_info(Known::structs<bv_clock>(BV_KIND_CAMERA_INFO, {{1}}).sample()), Unrepresentable);
    EXPECT_THROW(to_camera_info(Known(BV_KIND_CAMERA_INFO, BV_ENCODING_STRUCT, 0, 0, sizeof(bv_camera_info)).sample()), Unrepresentable);
}

Known scan_of(const std::vector<float>& planes, std::uint32_t rays, std::uint32_t flags) {
    Known known(BV_KIND_LASER_SCAN, BV_ENCODING_RANGES_F32, rays, 1, 4);
    known.header.flags = flags;
    known.header.block.scan = {-1.5, 0.25, 0.001, 0.025, 0.1f, 30.0f, 0.0, 0.0, {}};
    known.bytes.resize(planes.size() * sizeof(float));
    std::memcpy(known.bytes.data(), planes.data(), known.bytes.size());
    return known;
}

TEST(LaserScan, HasItsAnglesTimesAndRanges) {
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<float> ranges = {1.5f, inf, -inf, 2.5f};
    auto known = scan_of(ranges, 4, 0);
    const auto scan = to_laser_scan(known.sample());
    expect_header(scan->header);
    EXPECT_EQ(scan->ranges, ranges);
    EXPECT_TRUE(scan->intensities.empty());
    EXPECT_FLOAT_EQ(scan->angle_min, -1.5f);
    EXPECT_FLOAT_EQ(scan->angle_increment, 0.25f);
    EXPECT_FLOAT_EQ(scan->angle_max, -0.75f);
    EXPECT_FLOAT_EQ(scan->time_increment, 0.001f);
    EXPECT_FLOAT_EQ(scan->scan_time, 0.025f);
    EXPECT_FLOAT_EQ(scan->range_min, 0.1f);
    EXPECT_FLOAT_EQ(scan->range_max, 30.0f);
}

TEST(LaserScan, HasIntensitiesIfThereAreAny) {
    auto known = scan_of({1, 2, 3, 40, 50, 60}, 3, BV_HAS_INTENSITIES);
    const auto scan = to_laser_scan(known.sample());
    EXPECT_EQ(scan->ranges, (std::vector<float>{1, 2, 3}));
    EXPECT_EQ(scan->intensities, (std::vector<float>{40, 50, 60}));
    known.bytes.resize(20);
    EXPECT_THROW(to_laser_scan(known.sample()), Unrepresentable);
}

TEST(LaserScan, HasOneLayer) {
    EXPECT_THROW(to_laser_scan(Known(BV_KIND_LASER_SCAN, BV_ENCODING_RANGES_F32, 4, 16, 4).sample()), Unrepresentable);
}

TEST(PointCloud, IsOrganisedWithGazebosFields) {
    Known known(BV_KIND_POINT_CLOUD, BV_ENCODING_XYZ_RGB_F32, 3, 2, 32);
    const auto cloud = to_point_cloud(known.sample());
    expect_header(cloud->header);
    EXPECT_EQ(cloud->width, 3u);
    EXPECT_EQ(cloud->height, 2u);
    EXPECT_EQ(cloud->point_step, 32u);
    EXPECT_EQ(cloud->row_step, 96u);
    EXPECT_EQ(cloud->data, known.bytes);
    ASSERT_EQ(cloud->fields.size(), 4u);
    const char* names[] = {"x", "y", "z", "rgb"};
    const std::uint32_t offsets[] = {0, 4, 8, 16};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(cloud->fields[i].name, names[i]);
        EXPECT_EQ(cloud->fields[i].offset, offsets[i]);
        EXPECT_EQ(cloud->fields[i].datatype, sensor_msgs::PointField::FLOAT32);
        EXPECT_EQ(cloud->fields[i].count, 1u);
    }
}

TEST(PointCloud, OfALidarHasTheFieldsOfVelodynesDriver) {
    Known known(BV_KIND_POINT_CLOUD, BV_ENCODING_XYZ_IRT_F32, 3, 1, 22);
    const auto cloud = to_point_cloud(known.sample());
    EXPECT_EQ(cloud->point_step, 22u);
    EXPECT_EQ(cloud->row_step, 66u);
    EXPECT_EQ(cloud->data, known.bytes);
    EXPECT_TRUE(cloud->is_dense);
    const char* names[] = {"x", "y", "z", "intensity", "ring", "time"};
    const std::uint32_t offsets[] = {0, 4, 8, 12, 16, 18};
    ASSERT_EQ(cloud->fields.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(cloud->fields[i].name, names[i]);
        EXPECT_EQ(cloud->fields[i].offset, offsets[i]);
        const bool is_ring = i == 4;
        EXPECT_EQ(cloud->fields[i].datatype, is_ring ? sensor_msgs::PointField::UINT16 : sensor_msgs::PointField::FLOAT32);
    }
    EXPECT_FALSE(to_point_cloud(Known(BV_KIND_POINT_CLOUD, BV_ENCODING_XYZ_IRT_F32, 3, 2, 22).sample())->is_dense);
}

void expect_fields(bv_encoding encoding, std::uint32_t size, const std::vector<sensor_msgs::PointField>& expected) {
    const auto cloud = to_point_cloud(Known(BV_KIND_POINT_CLOUD, encoding, 3, 2, size).sample());
    EXPECT_EQ(cloud->point_step, size);
    EXPECT_FALSE(cloud->is_dense);
    ASSERT_EQ(cloud->fields.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(cloud->fields[i].name, expected[i].name);
        EXPECT_EQ(cloud->fields[i].offset, expected[i].offset);
        EXPECT_EQ(cloud->fields[i].datatype, expected[i].datatype);
    }
}

TEST(PointCloud, OfOthersLidarsHaveTheFieldsOfTheirDrivers) {
    using Field = sensor_msgs::PointField;
    const auto field = [](const char* name, std::uint32_t offset, std::uint8_t datatype) {
        Field field;
        field.name = name;
        field.offset = offset;
        field.datatype = datatype;
        return field;
    };
    expect_fields(BV_ENCODING_OUSTER_POINT, 48,
                  {field("x", 0, Field::FLOAT32), field("y", 4, Field::FLOAT32), field("z", 8, Field::FLOAT32),
                   field("intensity", 16, Field::FLOAT32), field("t", 20, Field::UINT32),
                   field("reflectivity", 24, Field::UINT16), field("ring", 26, Field::UINT16),
                   field("ambient", 28, Field::UINT16), field("range", 32, Field::UINT32)});
    expect_fields(BV_ENCODING_LIVOX_POINT, 26,
                  {field("x", 0, Field::FLOAT32), field("y", 4, Field::FLOAT32), field("z", 8, Field::FLOAT32),
                   field("intensity", 12, Field::FLOAT32), field("tag", 16, Field::UINT8),
                   field("line", 17, Field::UINT8), field("timestamp", 18, Field::FLOAT64)});
    expect_fields(BV_ENCODING_XYZ_IR_F32, 18,
                  {field("x", 0, Field::FLOAT32), field("y", 4, Field::FLOAT32), field("z", 8, Field::FLOAT32),
                   field("intensity", 12, Field::FLOAT32), field("ring", 16, Field::UINT16)});
}

TEST(PointCloud, OfOneRowIsDenseUnlessMissingPointsAreInIt) {
    const auto is_dense = [](bv_encoding encoding, std::uint32_t size) -> bool {
        return to_point_cloud(Known(BV_KIND_POINT_CLOUD, encoding, 3, 1, size).sample())->is_dense;
    };
    EXPECT_FALSE(is_dense(BV_ENCODING_XYZ_RGB_F32, 32));
    EXPECT_TRUE(is_dense(BV_ENCODING_XYZ_IRT_F32, 22));
    EXPECT_FALSE(is_dense(BV_ENCODING_OUSTER_POINT, 48));
    EXPECT_TRUE(is_dense(BV_ENCODING_LIVOX_POINT, 26));
    EXPECT_FALSE(is_dense(BV_ENCODING_XYZ_IR_F32, 18));
}

TEST(Odometry, HasPoseVelocityAndCovariances) {
    bv_odometry from{};
    std::strcpy(from.child_frame_id, "base_footprint");
    for (int i = 0; i < 3; ++i) from.position[i] = 1 + i, from.linear[i] = 4 + i, from.angular[i] = 7 + i;
    for (int i = 0; i < 4; ++i) from.orientation[i] = 10 + i;
    for (int i = 0; i < 36; ++i) from.pose_covariance[i] = 100 + i, from.twist_covariance[i] = 200 + i;
    auto known = Known::structs<bv_odometry>(BV_KIND_ODOMETRY, {from});
    const auto odometry = received<nav_msgs::Odometry>(known.sample());
    expect_header(odometry->header);
    EXPECT_EQ(odometry->child_frame_id, "base_footprint");
    EXPECT_EQ(odometry->pose.pose.position.z, 3);
    EXPECT_EQ(odometry->pose.pose.orientation.x, 10);
    EXPECT_EQ(odometry->pose.pose.orientation.w, 13);
    EXPECT_EQ(odometry->twist.twist.linear.x, 4);
    EXPECT_EQ(odometry->twist.twist.angular.z, 9);
    EXPECT_EQ(odometry->pose.covariance[35], 135);
    EXPECT_EQ(odometry->twist.covariance[0], 200);
}

TEST(Imu, HasTheMeasurement) {
    bv_imu from{};
    for (int i = 0; i < 4; ++i) from.orientation[i] = 1 + i;
    for (int i = 0; i < 3; ++i) from.angular_velocity[i] = 5 + i, from.linear_acceleration[i] = 8 + i;
    for (int i = 0; i < 9; ++i) {
        from.orientation_covariance[i] = 20 + i;
        from.angular_velocity_covariance[i] = 30 + i;
        from.linear_acceleration_covariance[i] = 40 + i;
    }
    auto known = Known::structs<bv_imu>(BV_KIND_IMU, {from});
    const auto imu = received<sensor_msgs::Imu>(known.sample());
    expect_header(imu->header);
    EXPECT_EQ(imu->orientation.x, 1);
    EXPECT_EQ(imu->orientation.w, 4);
    EXPECT_EQ(imu->angular_velocity.z, 7);
    EXPECT_EQ(imu->linear_acceleration.y, 9);
    EXPECT_EQ(imu->orientation_covariance[8], 28);
    EXPECT_EQ(imu->angular_velocity_covariance[0], 30);
    EXPECT_EQ(imu->linear_acceleration_covariance[4], 44);
}

TEST(JointStates, AreInOrder) {
    bv_joint_state left{}, right{};
    std::strcpy(left.name, "wheel_left_joint");
    left.position = 1, left.velocity = 2, left.effort = 3;
    std::strcpy(right.name, "wheel_right_joint");
    auto known = Known::structs<bv_joint_state>(BV_KIND_JOINT_STATES, {left, right});
    const auto joints = received<sensor_msgs::JointState>(known.sample());
    EXPECT_EQ(joints->name, (std::vector<std::string>{"wheel_left_joint", "wheel_right_joint"}));
    EXPECT_EQ(joints->position, (std::vector<double>{1, 0}));
    EXPECT_EQ(joints->velocity, (std::vector<double>{2, 0}));
    EXPECT_EQ(joints->effort, (std::vector<double>{3, 0}));
}

TEST(Transforms, CanBeRestrictedToOneParent) {
    bv_transform odom{}, wheel{};
    std::strcpy(odom.parent, "odom");
    std::strcpy(odom.child, "/base_footprint");
    odom.translation[1] = 2.5;
    odom.rotation[3] = 1;
    std::strcpy(wheel.parent, "base_link");
    std::strcpy(wheel.child, "wheel_left_link");
    auto known = Known::structs<bv_transform>(BV_KIND_TRANSFORMS, {odom, wheel});
    const auto all = to_transforms(known.sample());
    ASSERT_EQ(all->transforms.size(), 2u);
    EXPECT_EQ(all->transforms[0].header.stamp.sec, 12u);
    EXPECT_EQ(all->transforms[0].header.frame_id, "odom");
    EXPECT_EQ(all->transforms[0].child_frame_id, "base_footprint");
    EXPECT_EQ(all->transforms[0].transform.translation.y, 2.5);
    EXPECT_EQ(all->transforms[0].transform.rotation.w, 1);
    const auto of_odom = to_transforms(known.sample(), "odom");
    ASSERT_EQ(of_odom->transforms.size(), 1u);
    EXPECT_EQ(of_odom->transforms[0].child_frame_id, "base_footprint");
}

TEST(Clock, HasSimulatedTime) {
    auto known = Known::structs<bv_clock>(BV_KIND_CLOCK, {{3'010'000'000}});
    EXPECT_EQ(received<rosgraph_msgs::Clock>(known.sample())->clock, ros::Time(3, 10'000'000));
}

}  // namespace
}  // namespace belvedere_ros
