// Tests of several bridges in one process that serve the same topic.

#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "../src/served.hpp"

namespace belvedere_ros {
namespace {

constexpr const char* kTopic = "/image_raw";

/// A seeker that records its notifications.
class Seeks : public Served::Seeker {
public:
    Seeks() { Served::here().seek(kTopic, *this); }
    ~Seeks() override { Served::here().forget(kTopic, *this); }
    void serve(const Source* source) override {
        domain = source == nullptr ? nullptr : &source->domain;
        ++told;
    }

    const Domain* domain = nullptr;
    int told = 0;
};

TEST(Served, ATopicBelongsToTheFirstBridgeAndThenTheNext) {
    const std::string name = "served-" + std::to_string(getpid());
    Domain one(name), other(name);
    const bv_stream_info stream{};
    const Seeks early;
    auto first = std::make_unique<Served::Place>(kTopic, one, stream);
    EXPECT_EQ(early.domain, &one);
    // A second bridge comes and goes: seekers of the first are not affected.
    std::make_unique<Served::Place>(kTopic, other, stream).reset();
    EXPECT_EQ(early.domain, &one);
    EXPECT_EQ(early.told, 1);
    EXPECT_EQ(Seeks().domain, &one);

    const Served::Place next(kTopic, other, stream);
    EXPECT_EQ(early.domain, &one);
    first.reset();
    EXPECT_EQ(early.domain, &other);
    EXPECT_EQ(early.told, 2);
}

TEST(Served, ATopicEndsWithItsLastPlace) {
    Domain domain("served-" + std::to_string(getpid()));
    const Seeks early;
    std::make_unique<Served::Place>(kTopic, domain, bv_stream_info{}).reset();
    EXPECT_EQ(early.domain, nullptr);
    EXPECT_EQ(early.told, 2);
    EXPECT_EQ(Seeks().told, 0);
}

}  // namespace
}  // namespace belvedere_ros
