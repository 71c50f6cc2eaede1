// Tests of the TurtleBot's nodelets without ROS: the multiplexer's choice, and scans from depths.

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "../src/turtlebot/depth_scan.hpp"
#include "../src/turtlebot/mux.hpp"

namespace belvedere_ros::turtlebot {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Mux, PrefersHigherPriorityAndThenTheFirst) {
    Mux mux({{"safety", "s", 0.2, 10}, {"teleop", "t", 1.0, 7}, {"navi", "n", 1.0, 5}, {"other", "o", 1.0, 5}});
    EXPECT_FALSE(mux.active(0.0));
    EXPECT_TRUE(mux.hears(2, 0.0));
    EXPECT_FALSE(mux.hears(3, 0.5)) << "of equal priority, the active source stays active";
    EXPECT_TRUE(mux.hears(1, 0.6));
    EXPECT_FALSE(mux.hears(2, 1.6)) << "for a second";
    EXPECT_TRUE(mux.hears(0, 1.61));
    EXPECT_FALSE(mux.hears(1, 1.8));
    EXPECT_TRUE(mux.hears(1, 1.82)) << "each for its own timeout";
    EXPECT_EQ(mux.active(2.8), std::size_t{1});
    EXPECT_FALSE(mux.active(2.83));
    EXPECT_TRUE(mux.hears(1, 9.0));
    EXPECT_TRUE(mux.hears(2, 1.0)) << "a reset of time clears the state";
}

/// A wall at z = 2 m that fills the image, with fx = 100 and the principal point in the middle.
struct Wall {
    sensor_msgs::Image image;
    sensor_msgs::CameraInfo info;

    explicit Wall(std::uint32_t width = 161, std::uint32_t height = 21) {
        image.width = width;
        image.height = height;
        image.encoding = sensor_msgs::image_encodings::TYPE_32FC1;
        image.step = width * 4;
        image.data.resize(image.step * height);
        image.header.stamp = ros::Time(12, 5);
        info.K = {100, 0, (width - 1) / 2.0, 0, 100, (height - 1) / 2.0, 0, 0, 1};
        for (std::uint32_t row = 0; row < height; ++row)
            for (std::uint32_t column = 0; column < width; ++column) set(row, column, 2.0f);
    }
    void set(std::uint32_t row, std::uint32_t column, float depth) {
        std::memcpy(image.data.data() + row * image.step + column * 4, &depth, 4);
    }
};

TEST(DepthScan, SeesAWall) {
    DepthScan settings;
    settings.scan_height = 10;
    Wall wall;
    wall.set(0, 80, 0.6f);    // not one of the used rows
    wall.set(8, 80, 1.5f);    // in one row of ten
    wall.set(9, 80, 0.3f);    // too near
    for (std::uint32_t row = 0; row < 21; ++row) wall.set(row, 40, kInf);
    const auto scan = settings.scan(wall.image, wall.info);
    EXPECT_EQ(scan->header.frame_id, "camera_depth_frame");
    EXPECT_EQ(scan->header.stamp, ros::Time(12, 5));
    EXPECT_FLOAT_EQ(scan->angle_min, -std::atan(0.8f));
    EXPECT_FLOAT_EQ(scan->angle_max, std::atan(0.8f));
    ASSERT_EQ(scan->ranges.size(), 161u);
    EXPECT_FLOAT_EQ(scan->ranges[80], 1.5f);
    for (std::size_t i = 0; i < 161; ++i) {
        const double angle = scan->angle_min + static_cast<double>(i) * scan->angle_increment;
        const double column = 80 - 100 * std::tan(angle);
        if (std::abs(column - 80) < 1.5) continue;
        if (std::abs(column - 40) < 0.4) EXPECT_EQ(scan->ranges[i], kInf);
        // The plane at depth 2, to half a column: 0.5 cm times its slope there.
        if (std::abs(column - 40) > 1) EXPECT_NEAR(scan->ranges[i], 2 / std::cos(angle), 0.008);
    }
    // Angles are positive to the left, so the left of the image comes last.
    wall.set(10, 0, 1.0f);
    EXPECT_NEAR(settings.scan(wall.image, wall.info)->ranges[160], std::hypot(1.0, 0.8), 1e-6);
}

TEST(DepthScan, AcceptsMillimetresAndRefusesOtherEncodings) {
    const DepthScan settings;
    Wall wall;
    wall.image.encoding = sensor_msgs::image_encodings::TYPE_16UC1;
    for (std::size_t i = 0; i < wall.image.data.size(); i += 2) {
        const std::uint16_t depth = i % 4 == 0 ? 3000 : 0;
        std::memcpy(wall.image.data.data() + i, &depth, 2);
    }
    const auto scan = settings.scan(wall.image, wall.info);
    EXPECT_FLOAT_EQ(scan->ranges[80], 3.0f);
    EXPECT_TRUE(std::isnan(scan->ranges[81]));
    wall.image.encoding = "rgb8";
    EXPECT_THROW(settings.scan(wall.image, wall.info), BadDepth);
    DepthScan high;
    high.scan_height = 22;
    EXPECT_THROW(high.scan(Wall().image, Wall().info), BadDepth);
}

}  // namespace
}  // namespace belvedere_ros::turtlebot
