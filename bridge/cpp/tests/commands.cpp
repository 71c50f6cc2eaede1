// Commands to a robot and to a simulation, and their effects. No other process drives the robot.
//
//   commands [domain]
#include <cmath>
#include <iostream>

#include <belvedere.hpp>

namespace {

using std::chrono::seconds;

void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(what);
}

template <class F>
std::string refusal(F&& call) {
    try {
        call();
    } catch (const belvedere::Refused& refused) {
        return refused.what();
    }
    throw std::runtime_error("the command was not refused");
}

constexpr const char* kCrate = "<sdf version='1.6'><model name='crate'><link name='l'><collision name='c'><geometry>"
                               "<box><size>0.2 0.2 0.2</size></box></geometry></collision></link></model></sdf>";

class Robot {
public:
    explicit Robot(belvedere::Node& node) : velocity_(node.velocity()), odometry_(node.subscribe("odom")) {}

    /// Drives forward for `count` odometry messages, 50 per second, and returns the last one.
    bv_odometry drive(int count, double forward) {
        bv_odometry last{};
        while (count > 0) {
            require(odometry_.wait(seconds(20)), "no odometry");
            while (const auto frame = odometry_.take()) {
                last = frame->structs<bv_odometry>().at(0);
                velocity_.send(forward, 0.0);
                --count;
            }
        }
        return last;
    }

private:
    belvedere::VelocityPublisher velocity_;
    belvedere::Subscriber odometry_;
};

void check_robot(belvedere::Node& node) {
    Robot robot(node);
    auto power = node.commands<bv_motor_power>();
    auto zero = node.commands<bv_reset_odometry>("/mobile_base/commands/reset_odometry");
    const double far = robot.drive(100, 0.3).position[0];
    require(far > 0.2, "it does not drive");
    power.send({0});
    const double stood = robot.drive(50, 0.3).position[0];
    const bv_odometry off = robot.drive(25, 0.3);
    require(off.linear[0] == 0.0 && std::abs(off.position[0] - stood) < 1e-3, "it drives without power");
    zero.send({});
    require(std::abs(robot.drive(5, 0.3).position[0]) < 1e-3, "odometry is not zero");
    power.send({1});
    require(robot.drive(50, 0.3).position[0] > 0.1, "it does not drive again");
    robot.drive(50, 0.0);
    std::cout << "the robot has driven " << far << " m, stood, begun anew and driven again\n";
}

void check_simulation(belvedere::Node& node) {
    belvedere::Control simulation = node.control();
    const auto paused_ns = simulation.pause();
    require(simulation.pause() == paused_ns, "time goes on");
    const auto step_ns = simulation.step() - paused_ns;
    require(step_ns > 0 && simulation.step(9) == paused_ns + 10 * step_ns, "ten steps");
    require(refusal([&] { simulation.step(0); }).find("0 steps cannot be run") == 0, "no steps");
    simulation.spawn(kCrate, "second", {{2, 0, 0.5}});
    const auto crate = simulation.query("second");
    require(crate.time_ns == paused_ns + 10 * step_ns, "time of a query");
    require(crate.is("paused") && crate.is("spawned") && !crate.is("playing") && !crate.is("pause"), "a query");
    require(!simulation.query().is("spawned"), "a query of the simulation alone");
    require(refusal([&] { simulation.query("third"); }).find("'third'") != std::string::npos, "a query of nothing");
    require(refusal([&] { simulation.spawn(kCrate, "second"); }).find("'second'") != std::string::npos, "twice");
    simulation.move("second", {{1, 0, 1}, {0, 0, 0, 1}, "second"});
    auto states = node.subscribe("simulation/model_states");
    require(states.wait(seconds(20)), "no states");
    bool found = false;
    const auto newest = states.take_newest();
    require(newest.has_value(), "states of models");
    for (const bv_model_state& state : newest->structs<bv_model_state>())
        if (std::string(state.name) == "second") found = state.position[0] == 3 && state.position[2] == 1.5;
    require(found, "the crate is not where it was moved to");
    simulation.remove("second");
    require(refusal([&] { simulation.remove("second"); }).find("'second'") != std::string::npos, "it is gone");
    require(refusal([&] { simulation.remove(std::string(64, 'x')); }).find("63 bytes") != std::string::npos, "a name");
    require(simulation.reset_world() == paused_ns + 10 * step_ns, "time of a reset of the world");
    require(simulation.reset() == 0, "time after a reset");
    simulation.resume();
    require(simulation.query().is("playing"), "a query of a simulation that plays");
    std::cout << "the simulation has paused, stepped, described itself, spawned, moved, removed and begun again\n";

    belvedere::Node nowhere("nobody-is-in-this-one", "commands");
    try {
        nowhere.control(std::chrono::milliseconds(50)).pause();
        throw std::runtime_error("a simulator answers");
    } catch (const belvedere::Error& error) {
        require(error.status() == BV_STATUS_NOTHING, error.what());
    }
}

}  // namespace

int main(int argc, char** argv) try {
    belvedere::Node node(argc > 1 ? argv[1] : "", "commands");
    check_robot(node);
    check_simulation(node);
    return 0;
} catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 1;
}
