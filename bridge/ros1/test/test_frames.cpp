// Tests of frames without a copy, in the process of the bridge. Needs a master, and a simulator in the domain of
// BELVEDERE_DOMAIN: test_frames.py starts them.

#include <belvedere_ros/frame_subscriber.hpp>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "../src/bridge.hpp"

namespace belvedere_ros {
namespace {

using namespace std::chrono_literals;

constexpr const char* kTopic = "image_raw";

template <class Condition>
bool eventually(Condition condition, std::chrono::milliseconds patience = 20s) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
        if (condition()) return true;
        std::this_thread::sleep_for(5ms);
    }
    return condition();
}

/// The received values, by stamp.
template <class Value>
class Received {
public:
    void add(const ros::Time& stamp, const Value& value) {
        const std::lock_guard<std::mutex> lock(mutex_);
        values_[stamp.toNSec()] = value;
    }
    std::map<std::uint64_t, Value> take() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return std::move(values_);
    }
    std::size_t count() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return values_.size();
    }

private:
    std::mutex mutex_;
    std::map<std::uint64_t, Value> values_;
};

class Frames : public testing::Test {
protected:
    Frames() { spinner_.start(); }

    std::unique_ptr<Bridge> bridge() const { return std::make_unique<Bridge>(nh_, ros::NodeHandle("~")); }

    ros::NodeHandle nh_;
    ros::AsyncSpinner spinner_{2};
};

TEST_F(Frames, EqualTheMessages) {
    Received<sensor_msgs::ImageConstPtr> images;
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> keep = [&](const auto& image) { images.add(image->header.stamp, image); };
    std::map<std::uint64_t, std::vector<std::uint8_t>> bytes;
    std::mutex mutex;
    const FrameSubscriber frames(nh_, kTopic, [&](const FrameViewConstPtr& view) {
        const auto payload = view->frame().payload();
        EXPECT_EQ(view->header().frame_id, "base_camera_link_optical");
        const std::lock_guard<std::mutex> lock(mutex);
        bytes[view->header().stamp.toNSec()].assign(payload.begin(), payload.end());
    });
    const auto subscriber = nh_.subscribe<sensor_msgs::Image>(kTopic, 10, keep);
    EXPECT_FALSE(frames.is_served());
    const auto served = bridge();
    ASSERT_TRUE(eventually([&] { return images.count() >= 5; }));
    EXPECT_TRUE(frames.is_served());
    std::size_t compared = 0;
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [stamp, image] : images.take()) {
        const auto same = bytes.find(stamp);
        if (same == bytes.end()) continue;
        EXPECT_EQ(same->second, image->data);
        ++compared;
    }
    EXPECT_GE(compared, 3U);
}

TEST_F(Frames, AreTheSameWithBusyPolling) {
    const auto served = bridge();
    Received<std::uint64_t> slept, looked;
    std::atomic<std::int64_t> last{-1};
    const FrameSubscriber sleeper(nh_, kTopic, [&](const FrameViewConstPtr& view) {
        slept.add(view->header().stamp, view->frame().header().seq);
    });
    const FrameSubscriber looker(
        nh_, kTopic,
        [&](const FrameViewConstPtr& view) {
            const auto seq = static_cast<std::int64_t>(view->frame().header().seq);
            EXPECT_GT(seq, last.exchange(seq)) << "once, and in order";
            looked.add(view->header().stamp, view->frame().header().seq);
        },
        10ms);
    ASSERT_TRUE(eventually([&] { return slept.count() >= 40 && looked.count() >= 40; }));
    const auto sleepers = slept.take(), lookers = looked.take();
    std::size_t both = 0;
    for (const auto& [stamp, seq] : lookers) {
        const auto same = sleepers.find(stamp);
        if (same == sleepers.end()) continue;
        EXPECT_EQ(same->second, seq);
        ++both;
    }
    EXPECT_GE(both, 30U);
}

TEST_F(Frames, ThatAreKeptDoNotChange) {
    std::mutex mutex;
    std::vector<FrameViewConstPtr> kept;
    std::atomic<std::size_t> count{0};
    const FrameSubscriber frames(nh_, kTopic, [&](const FrameViewConstPtr& view) {
        const std::lock_guard<std::mutex> lock(mutex);
        ++count;
        if (kept.size() < 2) kept.push_back(view);
    });
    const auto served = bridge();
    const auto held = [&] {
        const std::lock_guard<std::mutex> lock(mutex);
        return kept.size();
    };
    ASSERT_TRUE(eventually([&] { return held() == 2; }));
    std::vector<std::uint8_t> before(kept[0]->frame().payload().begin(), kept[0]->frame().payload().end());

    const std::clock_t start = std::clock();
    std::this_thread::sleep_for(1s);  // thirty images
    const double share = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    EXPECT_LT(share, 0.3) << "waiting for room must not be work";
    EXPECT_EQ(count, 2U);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), kept[0]->frame().payload().begin()));
    EXPECT_NE(kept[0]->header().stamp, kept[1]->header().stamp);

    {
        const std::lock_guard<std::mutex> lock(mutex);
        kept[0].reset();
    }
    EXPECT_TRUE(eventually([&] { return count > 5; }));
}

TEST_F(Frames, ComeAndGoWithTheBridge) {
    std::atomic<std::size_t> count{0};
    const FrameSubscriber frames(nh_, kTopic, [&](const FrameViewConstPtr&) { ++count; });
    for (int life = 0; life < 3; ++life) {
        auto served = bridge();
        const std::size_t before = count;
        ASSERT_TRUE(eventually([&] { return count > before + 2; })) << "life " << life;
        served.reset();
        EXPECT_FALSE(frames.is_served());
        const std::size_t after = count;
        std::this_thread::sleep_for(100ms);
        EXPECT_EQ(count, after);
    }
}

// A simulator of a later version may have streams that this bridge does not know.
TEST_F(Frames, OfAnUnknownKindAreSkippedWithOneWarning) {
    std::atomic<std::size_t> warnings{0};
    const boost::function<void(const rosgraph_msgs::LogConstPtr&)> read = [&](const rosgraph_msgs::LogConstPtr& line) {
        if (line->msg.find("stream weather is skipped: ROS has no message type for a stream of kind 999") != std::string::npos) ++warnings;
    };
    const auto log = nh_.subscribe<rosgraph_msgs::Log>("/rosout", 100, read);
    const auto served = bridge();
    bv_stream_info stream{};
    std::strcpy(stream.topic, "weather");
    stream.kind = 999;
    stream.publishers = 1;
    for (int look = 0; look < 5; ++look) served->serve(stream);
    EXPECT_TRUE(eventually([&] { return warnings > 0; }));
    std::this_thread::sleep_for(300ms);
    EXPECT_EQ(warnings, 1U);
    std::atomic<std::size_t> images{0};
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> count = [&](const auto&) { ++images; };
    const auto subscriber = nh_.subscribe<sensor_msgs::Image>(kTopic, 10, count);
    EXPECT_TRUE(eventually([&] { return images > 2; })) << "the others are served";
}

}  // namespace
}  // namespace belvedere_ros

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    ros::init(argc, argv, "test_frames");
    const ros::NodeHandle nh;  // keeps roscpp running, for logging
    return RUN_ALL_TESTS();
}
