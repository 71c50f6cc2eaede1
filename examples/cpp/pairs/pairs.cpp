#include <belvedere/eigen.hpp>
#include <iostream>

int main() try {
    belvedere::Node node;
    auto pairs = node.synchronize(std::chrono::nanoseconds(0), "camera/rgb/image_raw", "camera/depth/points");
    int count = 0;
    while (count < 10 && pairs.wait(std::chrono::seconds(5))) {
        if (auto pair = pairs.take()) {
            const auto& [picture, cloud] = *pair;  // captured at the same time
            const auto points = belvedere::eigen_points(cloud);  // a map of the memory that the simulator wrote
            const auto middle = points.col(cloud.header().width * (cloud.header().height / 2) + cloud.header().width / 2);
            std::cout << picture.header().stamp_ns << " ns: " << points.cols() << " points, in the middle "
                      << (belvedere::eigen_world_from_optical(cloud) * middle.cast<double>()).transpose() << '\n';
            ++count;
        }
    }
    if (count == 10) return 0;
    std::cerr << "no pair for 5 s; start a simulator with a Kinect (belvedere run --robot kobuki_hexagons_kinect)\n";
    return 1;
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
