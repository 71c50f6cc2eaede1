// Tests of the converters of a Kobuki's messages and commands with known bytes, and of the messages' MD5 sums.

#include <gtest/gtest.h>
#include <kobuki_msgs/AutoDockingAction.h>
#include <kobuki_msgs/AutoDockingActionFeedback.h>
#include <kobuki_msgs/AutoDockingActionGoal.h>
#include <kobuki_msgs/AutoDockingActionResult.h>
#include <kobuki_msgs/AutoDockingFeedback.h>
#include <kobuki_msgs/AutoDockingGoal.h>
#include <kobuki_msgs/AutoDockingResult.h>
#include <kobuki_msgs/BumperEvent.h>
#include <kobuki_msgs/ButtonEvent.h>
#include <kobuki_msgs/CliffEvent.h>
#include <kobuki_msgs/ControllerInfo.h>
#include <kobuki_msgs/DigitalInputEvent.h>
#include <kobuki_msgs/DigitalOutput.h>
#include <kobuki_msgs/DockInfraRed.h>
#include <kobuki_msgs/ExternalPower.h>
#include <kobuki_msgs/KeyboardInput.h>
#include <kobuki_msgs/Led.h>
#include <kobuki_msgs/MotorPower.h>
#include <kobuki_msgs/PowerSystemEvent.h>
#include <kobuki_msgs/RobotStateEvent.h>
#include <kobuki_msgs/ScanAngle.h>
#include <kobuki_msgs/SensorState.h>
#include <kobuki_msgs/Sound.h>
#include <kobuki_msgs/VersionInfo.h>
#include <kobuki_msgs/WheelDropEvent.h>

#include <cmath>
#include <string>

#include "../src/convert/command.hpp"
#include "known.hpp"

namespace belvedere_ros {
namespace {

template <class Message>
const char* sum() {
    return ros::message_traits::md5sum<Message>();
}

// The MD5 sums that roscpp and rospy compare: those of the released kobuki_msgs.
TEST(KobukiMessages, HaveTheSumsOfItsDriver) {
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingAction>(), "44be114f3afc06365a090db0a5e982b5");
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingActionFeedback>(), "6f7132467beab5153587d9ebb8d8262d");
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingActionGoal>(), "4b30be6cd12b9e72826df56b481f40e0");
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingActionResult>(), "3fb2b9cd9cec6b4cb23b224521dd7679");
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingFeedback>(), "03343b6aa0067ce6251bcc08bf318388");
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingGoal>(), "d41d8cd98f00b204e9800998ecf8427e");
    EXPECT_STREQ(sum<kobuki_msgs::AutoDockingResult>(), "74697ed3d931f6eede8bf3a8dfeca160");
    EXPECT_STREQ(sum<kobuki_msgs::BumperEvent>(), "ffe360cd50f14f9251d9844083e72ac5");
    EXPECT_STREQ(sum<kobuki_msgs::ButtonEvent>(), "49eca512765dbdec759a79083ffcec8d");
    EXPECT_STREQ(sum<kobuki_msgs::CliffEvent>(), "c5b106efbb1427a94f517c5e05f06295");
    EXPECT_STREQ(sum<kobuki_msgs::ControllerInfo>(), "46af38e72f0640f41ed22174d43a2550");
    EXPECT_STREQ(sum<kobuki_msgs::DigitalInputEvent>(), "93da823c8b121f8a3940ef3830c58e44");
    EXPECT_STREQ(sum<kobuki_msgs::DigitalOutput>(), "1e97cd7f196a0270516b506e8bf29ca2");
    EXPECT_STREQ(sum<kobuki_msgs::DockInfraRed>(), "a3d77f7d15e50579473dcc24e9b97b34");
    EXPECT_STREQ(sum<kobuki_msgs::ExternalPower>(), "95149d524971a4c6d19e64c827307194");
    EXPECT_STREQ(sum<kobuki_msgs::KeyboardInput>(), "9288b95cb32b48719d84d696be253401");
    EXPECT_STREQ(sum<kobuki_msgs::Led>(), "4391183b0cf05f8f25d04220401b9f43");
    EXPECT_STREQ(sum<kobuki_msgs::MotorPower>(), "8f77c0161e0f2021493136bb5f3f0e51");
    EXPECT_STREQ(sum<kobuki_msgs::PowerSystemEvent>(), "f6464657d6c911b00c7bc7b43a154bf8");
    EXPECT_STREQ(sum<kobuki_msgs::RobotStateEvent>(), "c6eccd4cb1f95df95635b56d6226ea32");
    EXPECT_STREQ(sum<kobuki_msgs::ScanAngle>(), "06e2c839dc5c7f5c13ac09a8b4ff0a6a");
    EXPECT_STREQ(sum<kobuki_msgs::SensorState>(), "430a4bfd78449c8740bfef32b26613a6");
    EXPECT_STREQ(sum<kobuki_msgs::Sound>(), "dfeab0daae67749c426c1db741a4f420");
    EXPECT_STREQ(sum<kobuki_msgs::VersionInfo>(), "3dc0ce6edd49be1fc86730f4a4a21861");
    EXPECT_STREQ(sum<kobuki_msgs::WheelDropEvent>(), "e102837d89384d67669a0df86b63f33b");
}

Known event(std::uint32_t source, std::uint32_t index, std::uint32_t state, std::uint32_t value = 0) {
    return Known::structs<bv_robot_event>(BV_KIND_ROBOT_EVENT, {{source, index, state, value}});
}

TEST(RobotEvent, HasItsPlaceAndState) {
    using kobuki_msgs::BumperEvent;
    using kobuki_msgs::CliffEvent;
    const std::uint8_t bumpers[] = {BumperEvent::LEFT, BumperEvent::CENTER, BumperEvent::RIGHT};
    const std::uint8_t cliffs[] = {CliffEvent::LEFT, CliffEvent::CENTER, CliffEvent::RIGHT};
    for (std::uint32_t index = 0; index < 3; ++index) {
        for (std::uint32_t state : {0u, 1u}) {
            const auto bumper = received<kobuki_msgs::BumperEvent>(event(0, index, state).sample(), "bumper");
            EXPECT_EQ(bumper->bumper, bumpers[index]);
            EXPECT_EQ(bumper->state, state == 1 ? BumperEvent::PRESSED : BumperEvent::RELEASED);
            const auto cliff = received<kobuki_msgs::CliffEvent>(event(1, index, state, 3021).sample(), "cliff");
            EXPECT_EQ(cliff->sensor, cliffs[index]);
            EXPECT_EQ(cliff->state, state == 1 ? CliffEvent::CLIFF : CliffEvent::FLOOR);
            EXPECT_EQ(cliff->bottom, 3021);
        }
    }
}

TEST(RobotEvent, TheRightWheelIsNumberOne) {
    using kobuki_msgs::WheelDropEvent;
    EXPECT_EQ(received<kobuki_msgs::WheelDropEvent>(event(2, 0, 1).sample(), "wheel_drop")->wheel, WheelDropEvent::LEFT);
    const auto right = received<kobuki_msgs::WheelDropEvent>(event(2, 2, 1).sample(), "wheel_drop");
    EXPECT_EQ(right->wheel, WheelDropEvent::RIGHT);
    EXPECT_EQ(right->wheel, 1);
    EXPECT_EQ(right->state, WheelDropEvent::DROPPED);
    EXPECT_EQ(received<kobuki_msgs::WheelDropEvent>(event(2, 2, 0).sample(), "wheel_drop")->state, WheelDropEvent::RAISED);
    EXPECT_THROW(received<kobuki_msgs::WheelDropEvent>(event(2, 1, 1).sample(), "wheel_drop"), Unrepresentable);  // there is no centre wheel
}

TEST(RobotEvent, RefusesUnrepresentableFrames) {
    EXPECT_THROW(received<kobuki_msgs::BumperEvent>(event(1, 0, 1).sample(), "bumper"), Unrepresentable);
    EXPECT_THROW(received<kobuki_msgs::CliffEvent>(event(0, 0, 1).sample(), "cliff"), Unrepresentable);
    EXPECT_THROW(received<kobuki_msgs::BumperEvent>(event(0, 3, 1).sample(), "bumper"), Unrepresentable);
    EXPECT_THROW(received<kobuki_msgs::BumperEvent>(event(0, 0xffffffff, 1).sample(), "bumper"), Unrepresentable);
    EXPECT_THROW(received<kobuki_msgs::BumperEvent>(event(0, 0, 2).sample(), "bumper"), Unrepresentable);
    EXPECT_THROW(received<kobuki_msgs::BumperEvent>(Known::structs<bv_motor_power>(BV_KIND_ROBOT_EVENT, {{0}}).sample(), "bumper"), Unrepresentable);
}

TEST(CoreSensors, HasEveryField) {
    bv_core_sensors from{};
    from.time_stamp = 65'000;
    from.bumper = kobuki_msgs::SensorState::BUMPER_LEFT;
    from.wheel_drop = kobuki_msgs::SensorState::WHEEL_DROP_RIGHT;
    from.cliff = kobuki_msgs::SensorState::CLIFF_CENTRE;
    from.buttons = kobuki_msgs::SensorState::BUTTON2;
    from.left_encoder = 60'000;
    from.right_encoder = 7;
    from.left_pwm = -128;
    from.right_pwm = 127;
    from.charger = kobuki_msgs::SensorState::ADAPTER_CHARGING;
    from.battery = 165;
    for (std::uint16_t i = 0; i < 3; ++i) from.bottom[i] = static_cast<std::uint16_t>(3000 + i);
    auto known = Known::structs<bv_core_sensors>(BV_KIND_CORE_SENSORS, {from});
    const auto state = received<kobuki_msgs::SensorState>(known.sample());
    expect_header(state->header);
    EXPECT_EQ(state->time_stamp, 65'000);
    EXPECT_EQ(state->bumper, 4);
    EXPECT_EQ(state->wheel_drop, 1);
    EXPECT_EQ(state->cliff, 2);
    EXPECT_EQ(state->buttons, 4);
    EXPECT_EQ(state->left_encoder, 60'000);
    EXPECT_EQ(state->right_encoder, 7);
    EXPECT_EQ(state->left_pwm, -128);
    EXPECT_EQ(state->right_pwm, 127);
    EXPECT_EQ(state->charger, 22);
    EXPECT_EQ(state->battery, 165);
    EXPECT_EQ(state->bottom, (std::vector<std::uint16_t>{3000, 3001, 3002}));
    EXPECT_EQ(state->current, (std::vector<std::uint8_t>{0, 0}));
    EXPECT_EQ(state->analog_input, (std::vector<std::uint16_t>{0, 0, 0, 0}));
    auto too_small = Known::structs<bv_robot_event>(BV_KIND_CORE_SENSORS, {{0, 0, 0, 0}});
    EXPECT_THROW(received<kobuki_msgs::SensorState>(too_small.sample()), Unrepresentable);
}

TEST(Commands, AreConverted) {
    geometry_msgs::Twist twist;
    twist.linear.x = 1, twist.linear.y = 2, twist.linear.z = 3;
    twist.angular.x = 4, twist.angular.y = 5, twist.angular.z = 6;
    const bv_velocity_command velocity = from_twist(twist);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(velocity.linear[i], 1 + i);
        EXPECT_EQ(velocity.angular[i], 4 + i);
    }
    twist.angular.y = std::nan("");
    EXPECT_THROW(from_twist(twist), Unrepresentable);

    kobuki_msgs::MotorPower power;
    power.state = kobuki_msgs::MotorPower::ON;
    EXPECT_EQ(from_motor_power(power).state, 1u);
    power.state = kobuki_msgs::MotorPower::OFF;
    EXPECT_EQ(from_motor_power(power).state, 0u);
    power.state = 2;
    EXPECT_THROW(from_motor_power(power), Unrepresentable);
    EXPECT_EQ(from_empty({}).reserved, 0u);
}

}  // namespace
}  // namespace belvedere_ros
