#include "clock.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

rosgraph_msgs::ClockPtr to_clock(const Sample& sample) {
    auto clock = boost::make_shared<rosgraph_msgs::Clock>();
    clock->clock = to_time(read_struct<bv_clock>(sample).now_ns);
    return clock;
}

}  // namespace belvedere_ros
