// How old a picture is where it arrives: in shared memory, and through the bridge over TCPROS; and, beside it, how long a
// plain roscpp publisher of the same picture takes to the same subscriber.
//
//   latency publish                      a process that publishes 640 x 480 RGB at 30 Hz on /plain
//   latency listen [SECONDS] [STREAM]    prints p50 and p99 of all three, in milliseconds

#include <belvedere.hpp>
#include <boost/make_shared.hpp>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace {

void publish() {
    ros::NodeHandle nh;
    auto publisher = nh.advertise<sensor_msgs::Image>("/plain", 2);
    std::uint64_t next = bv_mono_ns();
    for (std::uint32_t count = 0; ros::ok(); ++count) {
        // A message a picture, as the bridge has; sequence and time travel in the stamp and the frame_id.
        auto image = boost::make_shared<sensor_msgs::Image>();
        image->width = 640;
        image->height = 480;
        image->step = 1920;
        image->encoding = "rgb8";
        image->data.assign(640 * 480 * 3, static_cast<std::uint8_t>(count));
        image->header.frame_id = std::to_string(bv_mono_ns());
        publisher.publish(image);
        next += 33'333'333;
        const std::uint64_t now = bv_mono_ns();
        if (next > now) std::this_thread::sleep_for(std::chrono::nanoseconds(next - now));
    }
}

void print(const char* what, std::vector<double>& ms) {
    if (ms.empty()) return void(std::printf("%-32s nothing came\n", what));
    std::sort(ms.begin(), ms.end());
    const auto at = [&](double share) { return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))]; };
    std::printf("%-32s p50 %7.3f ms   p99 %7.3f ms   of %zu\n", what, at(0.5), at(0.99), ms.size());
}

double ms(std::uint64_t from, std::uint64_t to) {
    return (static_cast<double>(to) - static_cast<double>(from)) * 1e-6;
}

// Every byte is read, so that the picture has truly arrived.
template <class Bytes>
std::uint8_t read_all(const Bytes& bytes) {
    std::uint8_t mixed = 0;
    for (const std::uint8_t byte : bytes) mixed ^= byte;
    return mixed;
}

void listen(int seconds, const std::string& stream) {
    std::mutex mutex;
    std::map<std::uint64_t, std::uint64_t> sent_at, arrived_at;  // by the stamp of the simulation
    std::vector<double> memory, bridge, plain;
    volatile std::uint8_t sink = 0;

    ros::NodeHandle nh;
    const auto hints = ros::TransportHints().tcpNoDelay();
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> through_bridge = [&](const sensor_msgs::ImageConstPtr& image) {
        sink = read_all(image->data);
        const std::lock_guard<std::mutex> lock(mutex);
        arrived_at[image->header.stamp.toNSec()] = bv_mono_ns();
    };
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> from_plain = [&](const sensor_msgs::ImageConstPtr& image) {
        sink = read_all(image->data);
        plain.push_back(ms(std::stoull(image->header.frame_id), bv_mono_ns()));
    };
    const auto one = nh.subscribe<sensor_msgs::Image>("/" + stream, 2, through_bridge, ros::VoidConstPtr(), hints);
    const auto two = nh.subscribe<sensor_msgs::Image>("/plain", 2, from_plain, ros::VoidConstPtr(), hints);
    ros::AsyncSpinner spinner(2);
    spinner.start();

    belvedere::Node node;
    belvedere::Subscriber subscriber = node.subscribe(stream);
    const std::uint64_t end = bv_mono_ns() + static_cast<std::uint64_t>(seconds) * 1'000'000'000;
    while (bv_mono_ns() < end) {
        subscriber.wait(std::chrono::milliseconds(100));
        while (const auto frame = subscriber.take()) {
            sink = read_all(frame->payload());
            if (frame->is_from_history()) continue;
            memory.push_back(ms(frame->header().publish_mono_ns, bv_mono_ns()));
            const std::lock_guard<std::mutex> lock(mutex);
            sent_at[frame->header().stamp_ns] = frame->header().publish_mono_ns;
        }
    }
    spinner.stop();
    for (const auto& [stamp, at] : arrived_at)
        if (const auto sent = sent_at.find(stamp); sent != sent_at.end()) bridge.push_back(ms(sent->second, at));
    print("shared memory", memory);
    print("through the bridge (TCPROS)", bridge);
    print("a plain publisher (TCPROS)", plain);
}

}  // namespace

int main(int argc, char** argv) {
    ros::init(argc, argv, "latency", ros::init_options::AnonymousName);
    if (argc > 1 && std::string(argv[1]) == "publish")
        publish();
    else
        listen(argc > 2 ? std::stoi(argv[2]) : 20, argc > 3 ? argv[3] : "image_raw");
}
