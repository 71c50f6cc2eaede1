// The latency of an image over each transport, measured over the same seconds.
//
//   latency publish                 publishes 640 x 480 RGB at 30 Hz on /plain
//   latency between SECONDS TOPIC   between processes: shared memory; the bridge over TCPROS; the plain publisher
//   latency inside SECONDS TOPIC    in the process of a bridge, one after the other: its frames; frames with busy polling;
//                                   frames and messages; all next to a plain publisher
//
// Prints the p50 and p99 of each in milliseconds. bench/latency.py starts everything, and compares.

#include <belvedere_ros/frame_subscriber.hpp>
#include <boost/make_shared.hpp>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "../src/bridge.hpp"

namespace {

using Milliseconds = std::vector<double>;

// The send times of the simulator's frames deviate by one to two milliseconds, like the times of rendering.
constexpr std::chrono::milliseconds kBusyPoll{8};

double ms(std::uint64_t from, std::uint64_t to) {
    return (static_cast<double>(to) - static_cast<double>(from)) * 1e-6;
}

void print(const char* what, Milliseconds& values) {
    if (values.empty()) return void(std::printf("%-26s nothing came\n", what));
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) { return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]; };
    std::printf("%-26s p50 %7.3f ms   p99 %7.3f ms   of %zu\n", what, at(0.5), at(0.99), values.size());
}

// Reads the data as a consumer would, after the time was taken, so that caches are realistic.
template <class Bytes>
void read_all(const Bytes& bytes) {
    static std::atomic<unsigned> sink;
    unsigned mixed = 0;
    for (const std::uint8_t byte : bytes) mixed ^= byte;
    sink = mixed;
}

/// Publishes one message per image, as the bridge does, until it is stopped; the send time is in the frame_id.
void publish(const std::atomic<bool>& stopping) {
    ros::NodeHandle nh;
    const auto publisher = nh.advertise<sensor_msgs::Image>("/plain", 2);
    std::uint64_t next = bv_mono_ns();
    for (std::uint32_t count = 0; ros::ok() && !stopping; ++count) {
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

/// Records the latencies of a plain publisher's images.
ros::Subscriber follow_plain(ros::NodeHandle& nh, Milliseconds& ages) {
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> receive = [&ages](const sensor_msgs::ImageConstPtr& image) {
        ages.push_back(ms(std::stoull(image->header.frame_id), bv_mono_ns()));
        read_all(image->data);
    };
    return nh.subscribe<sensor_msgs::Image>("/plain", 2, receive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

/// The send time of each image and the arrival of its message, by stamp.
class Messages {
public:
    ros::Subscriber follow(ros::NodeHandle& nh, const std::string& topic) {
        const boost::function<void(const sensor_msgs::ImageConstPtr&)> receive = [this](const sensor_msgs::ImageConstPtr& image) {
            const std::uint64_t now = bv_mono_ns();
            read_all(image->data);
            const std::lock_guard<std::mutex> lock(mutex_);
            arrived_[image->header.stamp.toNSec()] = now;
        };
        return nh.subscribe<sensor_msgs::Image>("/" + topic, 2, receive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
    }
    void sent(const belvedere::Header& header) {
        const std::lock_guard<std::mutex> lock(mutex_);
        sent_[header.stamp_ns] = header.publish_mono_ns;
    }
    Milliseconds ages() {
        const std::lock_guard<std::mutex> lock(mutex_);
        Milliseconds ages;
        for (const auto& [stamp, at] : arrived_)
            if (const auto sent = sent_.find(stamp); sent != sent_.end()) ages.push_back(ms(sent->second, at));
        return ages;
    }

private:
    std::mutex mutex_;
    std::map<std::uint64_t, std::uint64_t> sent_, arrived_;
};

void measure_between(int seconds, const std::string& topic) {
    ros::NodeHandle nh;
    Messages messages;
    Milliseconds memory, plain;
    const auto one = messages.follow(nh, topic);
    const auto two = follow_plain(nh, plain);
    ros::AsyncSpinner spinner(2);
    spinner.start();

    belvedere::Node node;
    belvedere::Subscriber subscriber = node.subscribe(topic);
    const std::uint64_t end = bv_mono_ns() + static_cast<std::uint64_t>(seconds) * 1'000'000'000;
    while (bv_mono_ns() < end) {
        subscriber.wait(std::chrono::milliseconds(100));
        while (const auto frame = subscriber.take()) {
            const std::uint64_t now = bv_mono_ns();
            if (frame->is_from_history()) continue;
            memory.push_back(ms(frame->header().publish_mono_ns, now));
            messages.sent(frame->header());
            read_all(frame->payload());
        }
    }
    spinner.stop();
    Milliseconds bridge = messages.ages();
    print("shared memory", memory);
    print("bridge over TCPROS", bridge);
    print("plain over TCPROS", plain);
}

/// Subscribes for this many seconds; `messages` receives the send times of frames.
void follow_frames(ros::NodeHandle& nh, const std::string& topic, int seconds, std::chrono::microseconds busy_poll,
                   Milliseconds& ages, Messages* messages) {
    const auto receive = [&](const belvedere_ros::FrameViewConstPtr& view) {
        ages.push_back(ms(view->frame().header().publish_mono_ns, bv_mono_ns()));
        if (messages != nullptr) messages->sent(view->frame().header());
        read_all(view->frame().payload());
    };
    const belvedere_ros::FrameSubscriber views(nh, topic, receive, busy_poll);
    std::this_thread::sleep_for(std::chrono::seconds(seconds));
}

void measure_inside(int seconds, const std::string& topic) {
    ros::NodeHandle nh;
    Messages messages;
    Milliseconds frames, polled, beside, plain;
    const auto plain_subscription = follow_plain(nh, plain);
    ros::AsyncSpinner spinner(2);
    spinner.start();
    std::atomic<bool> stopping{false};
    std::thread publisher([&] { publish(stopping); });
    {
        const belvedere_ros::Bridge bridge(nh, ros::NodeHandle("~"));
        follow_frames(nh, topic, seconds, {}, frames, nullptr);
        follow_frames(nh, topic, seconds, kBusyPoll, polled, nullptr);
        const auto subscription = messages.follow(nh, topic);
        follow_frames(nh, topic, seconds, {}, beside, &messages);
    }
    stopping = true;
    publisher.join();
    spinner.stop();
    Milliseconds bridge = messages.ages();
    print("frames inside", frames);
    print("frames inside, looked for", polled);
    print("frames beside messages", beside);
    print("messages inside", bridge);
    print("plain inside", plain);
}

}  // namespace

int main(int argc, char** argv) {
    ros::init(argc, argv, "latency", ros::init_options::AnonymousName);
    const std::string what = argc > 1 ? argv[1] : "";
    if (what == "publish") {
        publish(false);
    } else if (argc == 4 && what == "between") {
        measure_between(std::stoi(argv[2]), argv[3]);
    } else if (argc == 4 && what == "inside") {
        measure_inside(std::stoi(argv[2]), argv[3]);
    } else {
        std::fputs("usage: latency publish | between SECONDS TOPIC | inside SECONDS TOPIC\n", stderr);
        return 2;
    }
}
