// Watches a stream from another process: prints rate, latency and gaps every second, and can save an image.
//
//   watch <topic> [--domain NAME] [--duration SECONDS | --count N] [--save FILE.ppm] [--json]
//
// The latency is the time from the publisher's send until this program has read every byte. The program may be started
// before the simulator, and continues after the simulator is killed and restarted.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <belvedere.hpp>

namespace {

using SteadyClock = std::chrono::steady_clock;

volatile std::sig_atomic_t stop = 0;

struct Options {
    std::string topic;
    std::string domain;  // if empty: that of BELVEDERE_DOMAIN, or "default"
    double duration_s = std::numeric_limits<double>::infinity();
    unsigned long long count = std::numeric_limits<unsigned long long>::max();
    std::string save;
    bool json = false;
};

Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string arg = argv[i];
        const auto value = [&]() -> std::string {
            if (++i >= argc) throw std::invalid_argument(arg + " needs a value");
            return argv[i];
        };
        if (arg == "--domain") options.domain = value();
        else if (arg == "--duration") options.duration_s = std::stod(value());
        else if (arg == "--count") options.count = std::stoull(value());
        else if (arg == "--save") options.save = value();
        else if (arg == "--json") options.json = true;
        else if (options.topic.empty() && arg.rfind("--", 0) != 0) options.topic = arg;
        else throw std::invalid_argument("unknown argument " + arg);
    }
    if (options.topic.empty()) throw std::invalid_argument("which topic?");
    return options;
}

class Statistics {
public:
    void add(SteadyClock::time_point now, std::chrono::nanoseconds latency, std::uint64_t missed) {
        if (seen_) intervals_s_.push_back(std::chrono::duration<double>(now - last_).count());
        seen_ = true;
        last_ = now;
        latencies_us_.push_back(std::chrono::duration<double, std::micro>(latency).count());
        gaps_ += missed;
    }

    // Keeps only the time of the last frame, at which the next interval starts.
    void start_anew() {
        intervals_s_.clear();
        latencies_us_.clear();
        gaps_ = 0;
    }

    void report(const Options& options) const {
        double span_s = 0;
        for (const double interval : intervals_s_) span_s += interval;
        const double n = static_cast<double>(intervals_s_.size());
        const double rate_hz = n / span_s, mean_s = span_s / n;
        double squares = 0;
        for (const double interval : intervals_s_) squares += (interval - mean_s) * (interval - mean_s);
        const double jitter_ms = std::sqrt(squares / n) * 1e3;
        std::vector<double> sorted = latencies_us_;
        std::sort(sorted.begin(), sorted.end());
        const double p50 = percentile(sorted, 0.50), p99 = percentile(sorted, 0.99);
        if (options.json) {
            std::printf("{\"topic\":\"%s\",\"rate_hz\":%s,\"jitter_ms\":%s,\"latency_us_p50\":%s,"
                        "\"latency_us_p99\":%s,\"frames\":%zu,\"gaps\":%llu}\n",
                        options.topic.c_str(), number(rate_hz, "null").c_str(), number(jitter_ms, "null").c_str(),
                        number(p50, "null").c_str(), number(p99, "null").c_str(), sorted.size(), gaps_);
        } else {
            std::printf("%s: rate %s Hz   jitter %s ms   latency p50 %s us  p99 %s us   frames %zu   gaps %llu\n",
                        options.topic.c_str(), number(rate_hz, "-").c_str(), number(jitter_ms, "-").c_str(),
                        number(p50, "-").c_str(), number(p99, "-").c_str(), sorted.size(), gaps_);
        }
        std::fflush(stdout);
    }

private:
    static double percentile(const std::vector<double>& sorted, double share) {
        if (sorted.empty()) return std::nan("");
        const double rank = std::ceil(share * static_cast<double>(sorted.size()));
        return sorted[static_cast<std::size_t>(std::max(rank - 1, 0.0))];
    }

    static std::string number(double value, const char* unknown) {
        if (!std::isfinite(value)) return unknown;
        std::array<char, 64> text{};
        std::snprintf(text.data(), text.size(), "%.3f", value);
        return text.data();
    }

    bool seen_ = false;
    SteadyClock::time_point last_;
    std::vector<double> intervals_s_, latencies_us_;
    unsigned long long gaps_ = 0;
};

// Reads every byte, eight at a time.
std::uint64_t sum_of_bytes(belvedere::Span<const std::uint8_t> bytes) {
    std::uint64_t sum = 0, word = 0;
    std::size_t i = 0;
    for (; i + sizeof word <= bytes.size(); i += sizeof word) {
        std::memcpy(&word, bytes.data() + i, sizeof word);
        sum += word;
    }
    for (; i < bytes.size(); ++i) sum += bytes[i];
    return sum;
}

// Draws a scan seen from above: x (forward) is up, y (left) is left.
void draw_scan(const belvedere::Frame& frame, std::ostream& out) {
    constexpr int size = 401;
    const belvedere::Header& header = frame.header();
    const bv_scan_geometry& scan = header.block.scan;
    std::vector<std::uint8_t> pixels(size * size, 255);
    double farthest = 1;
    const belvedere::Span<const float> ranges = frame.row<float>(0);
    for (const float range : ranges)
        if (std::isfinite(range)) farthest = std::max(farthest, static_cast<double>(range));
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        if (!std::isfinite(ranges[i])) continue;
        const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
        const double length = ranges[i] / farthest * (size / 2);
        const long x = size / 2 - std::lround(length * std::sin(angle));
        const long y = size / 2 - std::lround(length * std::cos(angle));
        if (x >= 0 && x < size && y >= 0 && y < size) pixels[static_cast<std::size_t>(y * size + x)] = 0;
    }
    out << "P5\n" << size << ' ' << size << "\n255\n";
    out.write(reinterpret_cast<const char*>(pixels.data()), static_cast<std::streamsize>(pixels.size()));
}

// Writes colour as PPM, grey as PGM, depth as 16-bit PGM in millimetres (0: no depth), a scan as a plan.
void save(const belvedere::Frame& frame, std::ostream& out) {
    const belvedere::Header& header = frame.header();
    const auto magic = [&](const char* type, int max) {
        out << type << '\n' << header.width << ' ' << header.height << '\n' << max << '\n';
    };
    const auto put16 = [&](unsigned value) {
        out.put(static_cast<char>(value >> 8)).put(static_cast<char>(value & 255));
    };
    switch (frame.encoding()) {
        case BV_ENCODING_RGB8:
        case BV_ENCODING_BGR8:
            magic("P6", 255);
            for (std::uint32_t y = 0; y < header.height; ++y) {
                const auto row = frame.row<std::uint8_t>(y);
                const std::size_t first = frame.encoding() == BV_ENCODING_RGB8 ? 0 : 2;
                for (std::size_t x = 0; x + 2 < row.size(); x += header.elem_stride)
                    out.put(static_cast<char>(row[x + first]))
                        .put(static_cast<char>(row[x + 1]))
                        .put(static_cast<char>(row[x + 2 - first]));
            }
            break;
        case BV_ENCODING_BAYER_RGGB8:
        case BV_ENCODING_BAYER_BGGR8:
        case BV_ENCODING_BAYER_GBRG8:
        case BV_ENCODING_BAYER_GRBG8:
        case BV_ENCODING_MONO8:
            magic("P5", 255);
            for (std::uint32_t y = 0; y < header.height; ++y)
                for (const std::uint8_t grey : frame.row<std::uint8_t>(y)) out.put(static_cast<char>(grey));
            break;
        case BV_ENCODING_F32C1:
            magic("P5", 65535);
            for (std::uint32_t y = 0; y < header.height; ++y)
                for (const float depth : frame.row<float>(y))
                    put16(std::isfinite(depth) ? static_cast<unsigned>(std::clamp(depth * 1e3F, 0.0F, 65535.0F)) : 0);
            break;
        case BV_ENCODING_BAYER_RGGB16:
        case BV_ENCODING_BAYER_BGGR16:
        case BV_ENCODING_BAYER_GBRG16:
        case BV_ENCODING_BAYER_GRBG16:
        case BV_ENCODING_MONO16:
        case BV_ENCODING_U16C1:
            magic("P5", 65535);
            for (std::uint32_t y = 0; y < header.height; ++y)
                for (const std::uint16_t depth : frame.row<std::uint16_t>(y)) put16(depth);
            break;
        case BV_ENCODING_RANGES_F32:
            draw_scan(frame, out);
            break;
        default:
            throw std::runtime_error("a frame of this kind cannot be saved as an image");
    }
}

// Writes to a temporary file, which is then renamed, so that the file is complete or does not exist.
void save_as(const belvedere::Frame& frame, const std::string& path) {
    const std::string temporary = path + ".part";
    std::ofstream out(temporary, std::ios::binary);
    if (!out) throw std::runtime_error("cannot write " + temporary);
    try {
        save(frame, out);
        out.close();
        if (!out || std::rename(temporary.c_str(), path.c_str()) != 0)
            throw std::runtime_error("cannot write " + path);
    } catch (...) {
        std::remove(temporary.c_str());
        throw;
    }
}

int watch(const Options& options) {
    belvedere::Node node(options.domain, "watch-cpp");
    belvedere::Subscriber subscriber = node.subscribe(options.topic);

    Statistics second, whole;
    std::optional<belvedere::Frame> last;
    unsigned long long count = 0;
    volatile std::uint64_t sink = 0;
    const auto started = SteadyClock::now();
    auto next_report = started + std::chrono::seconds(1);
    while (!stop && count < options.count &&
           std::chrono::duration<double>(SteadyClock::now() - started).count() < options.duration_s) {
        // Returns when a frame arrives, or after 50 ms to check whether the program should stop.
        if (subscriber.wait(std::chrono::milliseconds(50))) {
            last.reset();  // release the previous frame, because a subscriber may hold only two at a time
            if (std::optional<belvedere::Frame> frame = subscriber.take()) {
                sink = sum_of_bytes(frame->payload());
                const auto now = SteadyClock::now();
                const auto latency = frame->age();
                if (frame->restarted()) std::cerr << "the publisher was restarted\n";
                // A frame that was sent before this program connected has an image, but its age is not the latency.
                if (!frame->is_from_history()) {
                    second.add(now, latency, frame->missed());
                    whole.add(now, latency, frame->missed());
                }
                ++count;
                last = std::move(frame);
            }
        }
        if (SteadyClock::now() >= next_report) {
            next_report += std::chrono::seconds(1);
            second.report(options);
            second.start_anew();
        }
    }
    static_cast<void>(sink);
    whole.report(options);
    if (last && !options.save.empty()) save_as(*last, options.save);
    if (count == 0) throw std::runtime_error("no frame of " + options.topic + " arrived");
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGINT, [](int) { stop = 1; });
    std::signal(SIGTERM, [](int) { stop = 1; });
    Options options;
    try {
        options = parse(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what()
                  << "\nusage: watch <topic> [--domain NAME] [--duration SECONDS | --count N] [--save FILE.ppm] [--json]\n";
        return 2;
    }
    try {
        return watch(options);
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << '\n';
        return EXIT_FAILURE;
    }
}
