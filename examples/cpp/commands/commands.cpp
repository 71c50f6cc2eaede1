#include <belvedere.hpp>
#include <iostream>

int main() try {
    belvedere::Node node;
    auto velocity = node.velocity();
    auto power = node.commands<bv_motor_power>();
    auto zero = node.commands<bv_reset_odometry>();
    belvedere::Subscriber odometry = node.subscribe("odom");
    const auto drive = [&] {  // for one second, which is 50 odometry messages
        double x = 0;
        for (int count = 0; count < 50 && odometry.wait(std::chrono::seconds(5)); velocity.send(0.3, 0.0))
            for (; auto frame = odometry.take(); ++count) x = frame->structs<bv_odometry>().at(0).position[0];
        return x;
    };
    std::cout << "odometry says " << drive() << " m\n";
    power.send({0});
    zero.send({});
    std::cout << "without power, from zero: " << drive() << " m\n";
    power.send({1});

    belvedere::Control simulation = node.control();
    const auto paused_ns = simulation.pause();
    std::cout << "10 steps of physics are " << (simulation.step(10) - paused_ns) / 1000000 << " ms\n";
    simulation.resume();
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
