// A C++ consumer that reads everything it is allowed to, and rows and structs that it is not: those must throw.
// Reads until the last frame, whose frame_id is "end". Prints how many frames were valid, and how many were not.
// The publisher is in main.rs; .ci/hostile runs the two together.
//
//   consumer DOMAIN TOPIC
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <belvedere.hpp>

namespace {

unsigned long long sum = 0;

void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "%s\n", what);
    std::abort();
}

/// Reads every value of a span, which must lie within the payload.
template <class T>
void read(const belvedere::Frame& frame, belvedere::Span<const T> span) {
    const auto payload = frame.payload();
    const auto* begin = reinterpret_cast<const std::uint8_t*>(span.data());
    require(span.empty() || (begin >= payload.begin() && begin + span.size() * sizeof(T) <= payload.end()),
            "a span outside the payload");
    for (const T& value : span) {
        std::uint8_t bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        for (const std::uint8_t byte : bytes) sum += byte;
    }
}

template <class Call>
void may_refuse(Call call) {
    try {
        call();
    } catch (const std::out_of_range&) {
        ++sum;
    }
}

template <class T>
void read_rows(const belvedere::Frame& frame) {
    const std::uint32_t height = frame.header().height;
    for (std::uint32_t y = 0; y < std::min<std::uint32_t>(height, 64); ++y) {
        may_refuse([&] { read(frame, frame.row<T>(y)); });
        may_refuse([&] { read(frame, frame.intensity_row<T>(y)); });
    }
    for (const std::uint32_t y : {height - 1, height, height + 1, 0x7fffffffu, 0xffffffffu}) {
        may_refuse([&] { read(frame, frame.row<T>(y)); });
        may_refuse([&] { read(frame, frame.intensity_row<T>(y)); });
    }
}

template <class T>
void read_structs(const belvedere::Frame& frame) {
    may_refuse([&] {
        const auto structs = frame.structs<T>();
        require(structs.size() * sizeof(T) <= frame.payload().size(), "structs beyond the payload");
        for (const T& value : structs) sum += reinterpret_cast<const std::uint8_t*>(&value)[sizeof(T) - 1];
    });
}

void read_all(const belvedere::Frame& frame) {
    require(frame.payload().size() == frame.header().payload_len, "the payload is as long as the header says");
    read(frame, frame.payload());
    read_rows<std::uint8_t>(frame);
    read_rows<std::uint16_t>(frame);
    read_rows<float>(frame);
    read_rows<double>(frame);
    read_structs<bv_camera_info>(frame);
    read_structs<bv_odometry>(frame);
    read_structs<bv_transform>(frame);
    read_structs<bv_joint_state>(frame);
    read_structs<bv_clock>(frame);
    read_structs<bv_velocity_command>(frame);
    require(frame.age().count() >= 0, "an age is not negative");
    sum += frame.missed() + frame.restarted() + frame.is_from_history();
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) throw std::invalid_argument("consumer DOMAIN TOPIC");
    belvedere::Node node(argv[1], "hostile-cpp");
    belvedere::Subscriber subscriber = node.subscribe(argv[2]);
    unsigned long long accepted = 0, rejected = 0;
    while (subscriber.wait(std::chrono::seconds(20))) {
        for (bool more = true; more;) {
            try {
                const auto frame = subscriber.take();
                more = frame.has_value();
                if (!more) break;
                if (std::strncmp(frame->header().frame_id, "end", sizeof frame->header().frame_id) == 0) {
                    std::printf("read %llu %llu %llu\n", accepted, rejected, sum);
                    return 0;
                }
                ++accepted;
                read_all(*frame);
            } catch (const belvedere::Error& error) {
                if (error.status() != BV_STATUS_BAD_FRAME || error.what()[0] == '\0') throw;
                ++rejected;
            }
        }
    }
    std::fprintf(stderr, "no last frame\n");
    return 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
