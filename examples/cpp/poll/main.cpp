// Waits for two streams and a timer with one poll(), as a program with its own event loop does.
//
//   poll [--domain NAME] [--seconds N]
//
// A subscriber's descriptor remains the same even if the simulator is started later, or is killed and restarted. The event
// loops of GUIs and robot frameworks accept such a descriptor in the same way.
#include <poll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include <belvedere.hpp>

namespace {

// A timer that expires every second.
class Timer {
public:
    Timer() : fd_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
        itimerspec every{};
        every.it_interval.tv_sec = every.it_value.tv_sec = 1;
        if (fd_ < 0 || timerfd_settime(fd_, 0, &every, nullptr) != 0) throw std::runtime_error(std::strerror(errno));
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() { close(fd_); }
    int fd() const { return fd_; }
    std::uint64_t rings() const {
        std::uint64_t rings = 0;
        return read(fd_, &rings, sizeof rings) == sizeof rings ? rings : 0;
    }

private:
    int fd_;
};

struct Stream {
    belvedere::Subscriber subscriber;
    const char* topic;
    unsigned long long frames = 0;

    // Takes all queued frames, after which the descriptor is not readable until the next one arrives.
    void drain() {
        while (const std::optional<belvedere::Frame> frame = subscriber.take()) {
            if (frame->restarted()) std::cerr << topic << ": the simulator was started again\n";
            ++frames;
        }
    }
};

}  // namespace

int main(int argc, char** argv) try {
    std::string domain;
    unsigned long long seconds = 10;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::string(argv[i]) == "--domain") domain = argv[i + 1];
        else if (std::string(argv[i]) == "--seconds") seconds = std::stoull(argv[i + 1]);
        else throw std::invalid_argument(std::string("unknown argument ") + argv[i]);
    }
    belvedere::Node node(domain, "poll-cpp");
    std::array<Stream, 2> streams{Stream{node.subscribe("image_raw"), "image_raw"},
                                  Stream{node.subscribe("scan"), "scan"}};
    const Timer timer;
    std::array<pollfd, 3> fds{pollfd{streams[0].subscriber.fd(), POLLIN, 0},
                              pollfd{streams[1].subscriber.fd(), POLLIN, 0}, pollfd{timer.fd(), POLLIN, 0}};
    unsigned long long wakes = 0;
    while (seconds > 0) {
        if (poll(fds.data(), fds.size(), -1) < 0 && errno != EINTR) throw std::runtime_error(std::strerror(errno));
        ++wakes;
        for (std::size_t i = 0; i < streams.size(); ++i)
            if (fds[i].revents & POLLIN) streams[i].drain();
        if (!(fds[2].revents & POLLIN)) continue;
        seconds -= std::min<unsigned long long>(seconds, timer.rings());
        for (Stream& stream : streams) {
            std::cout << stream.topic << ": " << stream.frames << " frames   ";
            stream.frames = 0;
        }
        std::cout << wakes << " wakes" << std::endl;
        wakes = 0;
    }
    return EXIT_SUCCESS;
} catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return EXIT_FAILURE;
}
