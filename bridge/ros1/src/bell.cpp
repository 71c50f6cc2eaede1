#include "bell.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace belvedere_ros {

Bell::Bell() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (event_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Bell::~Bell() {
    close(event_);
}

void Bell::ring() {
    eventfd_write(event_, 1);
}

void Bell::sleep(std::chrono::milliseconds patience, int descriptor) {
    pollfd both[] = {{event_, POLLIN, 0}, {descriptor, POLLIN, 0}};  // poll ignores a negative descriptor
    poll(both, 2, static_cast<int>(patience.count()));
    eventfd_t rings;
    eventfd_read(event_, &rings);
}

}  // namespace belvedere_ros
