// Tests of satellite receivers, magnetometers, barometers, altimeters, sensors of forces and contacts, and true poses.

#include <cstring>
#include <string>
#include <vector>

#include <gazebo_msgs/ContactsState.h>
#include <gtest/gtest.h>
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>

#include "known.hpp"

namespace belvedere_ros {
namespace {

TEST(NavSatFix, IsAFixByGps) {
    bv_nav_sat_fix from{};
    from.latitude = 49.9;
    from.longitude = 8.9;
    from.altitude = 120.5;
    auto exact = Known::structs<bv_nav_sat_fix>(BV_KIND_NAV_SAT_FIX, {from});
    const auto fix = received<sensor_msgs::NavSatFix>(exact.sample());
    expect_header(fix->header);
    EXPECT_EQ(fix->status.status, sensor_msgs::NavSatStatus::STATUS_FIX);
    EXPECT_EQ(fix->status.service, sensor_msgs::NavSatStatus::SERVICE_GPS);
    EXPECT_EQ(fix->latitude, 49.9);
    EXPECT_EQ(fix->longitude, 8.9);
    EXPECT_EQ(fix->altitude, 120.5);
    EXPECT_EQ(fix->position_covariance_type, sensor_msgs::NavSatFix::COVARIANCE_TYPE_UNKNOWN);
    from.position_covariance[0] = 4;
    from.position_covariance[8] = 9;
    auto noisy = Known::structs<bv_nav_sat_fix>(BV_KIND_NAV_SAT_FIX, {from});
    const auto with_noise = received<sensor_msgs::NavSatFix>(noisy.sample());
    EXPECT_EQ(with_noise->position_covariance_type, sensor_msgs::NavSatFix::COVARIANCE_TYPE_DIAGONAL_KNOWN);
    EXPECT_EQ(with_noise->position_covariance[0], 4);
    EXPECT_EQ(with_noise->position_covariance[8], 9);
}

TEST(MagneticField, IsInTeslas) {
    auto known = Known::structs<bv_magnetic_field>(BV_KIND_MAGNETIC_FIELD, {{{1e-6, 2e-6, -4e-5}, {1e-14}}});
    const auto field = received<sensor_msgs::MagneticField>(known.sample());
    expect_header(field->header);
    EXPECT_EQ(field->magnetic_field.x, 1e-6);
    EXPECT_EQ(field->magnetic_field.z, -4e-5);
    EXPECT_EQ(field->magnetic_field_covariance[0], 1e-14);
}

TEST(FluidPressure, IsInPascals) {
    auto known = Known::structs<bv_fluid_pressure>(BV_KIND_FLUID_PRESSURE, {{101325.5, 4}});
    const auto pressure = received<sensor_msgs::FluidPressure>(known.sample());
    expect_header(pressure->header);
    EXPECT_EQ(pressure->fluid_pressure, 101325.5);
    EXPECT_EQ(pressure->variance, 4);
}

TEST(Altimeter, IsAPoint) {
    auto known = Known::structs<bv_altimeter>(BV_KIND_ALTIMETER, {{2.5, 0.1, 30, 0.01}});
    const auto height = received<geometry_msgs::PointStamped>(known.sample());
    expect_header(height->header);
    EXPECT_EQ(height->point.x, 0);
    EXPECT_EQ(height->point.z, 2.5);
}

TEST(Vector3, IsStamped) {
    auto known = Known::structs<bv_vector3>(BV_KIND_VECTOR3, {{{1, 2, 3}}});
    const auto vector = received<geometry_msgs::Vector3Stamped>(known.sample());
    expect_header(vector->header);
    EXPECT_EQ(vector->vector.y, 2);
    EXPECT_EQ(vector->vector.z, 3);
}

TEST(Wrench, IsStamped) {
    auto known = Known::structs<bv_wrench>(BV_KIND_WRENCH, {{{1, 2, 3}, {4, 5, 6}}});
    const auto wrench = received<geometry_msgs::WrenchStamped>(known.sample());
    expect_header(wrench->header);
    EXPECT_EQ(wrench->wrench.force.z, 3);
    EXPECT_EQ(wrench->wrench.torque.y, 5);
}

TEST(Pose, IsStamped) {
    auto known = Known::structs<bv_pose>(BV_KIND_POSE, {{{1, 2, 3}, {0, 0, 0.6, 0.8}}});
    const auto pose = received<geometry_msgs::PoseStamped>(known.sample());
    expect_header(pose->header);
    EXPECT_EQ(pose->pose.position.z, 3);
    EXPECT_EQ(pose->pose.orientation.w, 0.8);
}

TEST(Contacts, OfAPairAreOneState) {
    bv_contact first{}, second{}, other{};
    std::strcpy(first.collision1, "robot::base::bumper");
    std::strcpy(first.collision2, "wall::link::collision");
    first.normal[0] = -1;
    first.depth = 0.25;
    first.force[0] = -2;
    second = other = first;
    second.position[1] = 3;
    std::strcpy(other.collision2, "box::link::collision");
    auto known = Known::structs<bv_contact>(BV_KIND_CONTACTS, {first, second, other});
    const auto contacts = received<gazebo_msgs::ContactsState>(known.sample());
    expect_header(contacts->header);
    ASSERT_EQ(contacts->states.size(), 2U);
    const auto& pair = contacts->states[0];
    EXPECT_EQ(pair.collision1_name, "robot::base::bumper");
    EXPECT_EQ(contacts->states[1].collision2_name, "box::link::collision");
    ASSERT_EQ(pair.wrenches.size(), 2U);
    EXPECT_EQ(pair.total_wrench.force.x, -4);
    EXPECT_EQ(pair.contact_positions[1].y, 3);
    EXPECT_EQ(pair.contact_normals[0].x, -1);
    EXPECT_EQ(pair.depths, (std::vector<double>{0.25, 0.25}));
    auto nobody = Known::structs<bv_contact>(BV_KIND_CONTACTS, {});
    EXPECT_TRUE(received<gazebo_msgs::ContactsState>(nobody.sample())->states.empty());
}

}  // namespace
}  // namespace belvedere_ros
