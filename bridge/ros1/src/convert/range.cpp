#include "range.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

sensor_msgs::RangePtr to_range(const Sample& sample) {
    const auto from = read_struct<bv_range>(sample);
    auto range = boost::make_shared<sensor_msgs::Range>();
    range->header = to_header(sample);
    range->radiation_type = from.radiation_type == 0 ? sensor_msgs::Range::ULTRASOUND : sensor_msgs::Range::INFRARED;
    range->field_of_view = from.field_of_view;
    range->min_range = from.min_range;
    range->max_range = from.max_range;
    range->range = from.range;
    return range;
}

}  // namespace belvedere_ros
