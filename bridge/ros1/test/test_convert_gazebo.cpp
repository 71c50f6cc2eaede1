// Tests of states of models and links with known bytes, of relative states, and of names in commands.

#include <gtest/gtest.h>
#include <gazebo_msgs/LinkStates.h>
#include <gazebo_msgs/ModelStates.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "../src/gazebo/simulator.hpp"
#include "../src/gazebo/states.hpp"
#include "known.hpp"

namespace belvedere_ros {
namespace {

bv_model_state state(const char* name, double x, double y, double yaw, double forward = 0, double turn = 0) {
    bv_model_state state{};
    std::strcpy(state.name, name);
    state.position[0] = x;
    state.position[1] = y;
    state.orientation[2] = std::sin(yaw / 2);
    state.orientation[3] = std::cos(yaw / 2);
    state.linear[0] = forward * std::cos(yaw);
    state.linear[1] = forward * std::sin(yaw);
    state.angular[2] = turn;
    return state;
}

TEST(ModelStates, HaveTheStatesOfTheFrame) {
    auto known = Known::structs<bv_model_state>(BV_KIND_MODEL_STATES, {state("room", 0, 0, 0), state("robot", 1, 2, M_PI / 2, 0.5, 0.25)});
    const auto models = received<gazebo_msgs::ModelStates>(known.sample(), "gazebo/model_states");
    EXPECT_EQ(models->name, (std::vector<std::string>{"room", "robot"}));
    ASSERT_EQ(models->pose.size(), 2u);
    EXPECT_EQ(models->pose[1].position.y, 2);
    EXPECT_DOUBLE_EQ(models->pose[1].orientation.z, std::sqrt(0.5));
    EXPECT_EQ(models->pose[0].orientation.w, 1);
    ASSERT_EQ(models->twist.size(), 2u);
    EXPECT_DOUBLE_EQ(models->twist[1].linear.y, 0.5);
    EXPECT_EQ(models->twist[1].angular.z, 0.25);
    const auto links = received<gazebo_msgs::LinkStates>(known.sample(), "gazebo/link_states");
    EXPECT_EQ(links->name, models->name);
    EXPECT_EQ(links->twist, models->twist);

    auto nobody = Known::structs<bv_model_state>(BV_KIND_MODEL_STATES, {});
    EXPECT_TRUE(received<gazebo_msgs::ModelStates>(nobody.sample(), "gazebo/model_states")->name.empty());
    known.bytes.resize(known.bytes.size() - 1);
    EXPECT_THROW(received<gazebo_msgs::ModelStates>(known.sample(), "gazebo/model_states"), Unrepresentable);
}

TEST(States, AreFoundByModelAndLink) {
    gazebo::States links;
    links.of = {state("robot::base", 0, 0, 0), state("robot::arm", 1, 0, 0), state("other::arm", 2, 0, 0)};
    ASSERT_NE(links.find_link("other::arm"), nullptr);
    EXPECT_EQ(links.find_link("other::arm")->position[0], 2);
    ASSERT_NE(links.find_link("arm"), nullptr);
    EXPECT_EQ(links.find_link("arm")->position[0], 1);
    for (const char* name : {"", "rm", "robot", "robot::", "::arm", "robot::base::arm"}) EXPECT_EQ(links.find_link(name), nullptr) << name;
    for (const char* name : {"", "world", "map", "/map"}) EXPECT_TRUE(gazebo::is_world(name)) << name;
    EXPECT_FALSE(gazebo::is_world("robot"));
}

TEST(Motion, IsSeenFromAnother) {
    const auto robot = gazebo::Motion::of(state("robot", 1, 2, M_PI / 2, 0.5, 0.25));
    const auto box = gazebo::Motion::of(state("box", 1, 5, M_PI, 1));
    const auto seen = box.relative_to(robot);
    EXPECT_NEAR(seen.to_pose().position.x, 3, 1e-12);
    EXPECT_NEAR(seen.to_pose().position.y, 0, 1e-12);
    EXPECT_NEAR(seen.to_pose().orientation.z, std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(seen.to_twist().linear.x, -0.5, 1e-12);
    EXPECT_NEAR(seen.to_twist().linear.y, 1, 1e-12);
    EXPECT_NEAR(seen.to_twist().angular.z, -0.25, 1e-12);
    const auto itself = robot.relative_to(robot);
    EXPECT_NEAR(itself.pose.getOrigin().length() + itself.linear.length() + itself.angular.length(), 0, 1e-12);
    EXPECT_NEAR(itself.to_pose().orientation.w, 1, 1e-12);
}

TEST(Command, RefusesLongNames) {
    bv_simulation_command command = gazebo::command_of(BV_OPERATION_SET_MODEL_STATE);
    gazebo::set_name(command.name, std::string(63, 'n'));
    EXPECT_EQ(to_text(command.name), std::string(63, 'n'));
    gazebo::set_name(command.name, "short");
    EXPECT_EQ(to_text(command.name), "short");
    EXPECT_THROW(gazebo::set_name(command.name, std::string(64, 'n')), gazebo::Refused);
    EXPECT_THROW(gazebo::set_name(command.name, std::string("a\0b", 3)), gazebo::Refused);
}

}  // namespace
}  // namespace belvedere_ros
