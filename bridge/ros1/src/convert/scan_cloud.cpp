#include "scan_cloud.hpp"

#include <boost/make_shared.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace belvedere_ros {

namespace {

/// Appends packed fields, in the layout of drivers.
class Fields {
public:
    explicit Fields(std::vector<sensor_msgs::PointField>& fields) : fields_(fields) {}

    void add(const char* name, std::uint8_t datatype, std::uint32_t size) {
        sensor_msgs::PointField field;
        field.name = name;
        field.offset = step_;
        field.datatype = datatype;
        field.count = 1;
        fields_.push_back(field);
        step_ += size;
    }
    std::uint32_t step() const { return step_; }

private:
    std::vector<sensor_msgs::PointField>& fields_;
    std::uint32_t step_ = 0;
};

template <class T>
void append(std::uint8_t*& place, T value) {
    std::memcpy(place, &value, sizeof value);
    place += sizeof value;
}

struct Turn {
    double cos, sin;
    explicit Turn(double angle) : cos(std::cos(angle)), sin(std::sin(angle)) {}
};

float value_at(const Sample& sample, std::size_t offset) {
    float value;
    std::memcpy(&value, sample.payload.data() + offset, sizeof value);
    return value;
}

}  // namespace

sensor_msgs::PointCloud2Ptr to_scan_cloud(const Sample& sample) {
    const belvedere::Header& header = sample.header;
    if (header.encoding != BV_ENCODING_RANGES_F32 || header.elem_stride != sizeof(float))
        throw Unrepresentable("the scan is not of packed 32-bit floats");
    const bool has_intensities = (header.flags & BV_HAS_INTENSITIES) != 0;
    if (header.height > std::numeric_limits<std::uint16_t>::max())
        throw Unrepresentable("the lidar has more layers than rings can be numbered");
    // Check before allocating memory for points that do not exist.
    const std::size_t planes = has_intensities ? 2 : 1;
    const std::size_t row_stride = header.row_stride, row_bytes = header.width * sizeof(float);
    const bool is_empty = header.width == 0 || header.height == 0;
    if (!is_empty && (row_stride < row_bytes || (planes * header.height - 1) * row_stride + row_bytes > sample.payload.size()))
        throw Unrepresentable("the scan ends before its last ray");

    auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    cloud->header = to_header(sample);
    Fields fields(cloud->fields);
    for (const char* name : {"x", "y", "z"}) fields.add(name, sensor_msgs::PointField::FLOAT32, sizeof(float));
    if (has_intensities) fields.add("intensity", sensor_msgs::PointField::FLOAT32, sizeof(float));
    fields.add("ring", sensor_msgs::PointField::UINT16, sizeof(std::uint16_t));
    fields.add("time", sensor_msgs::PointField::FLOAT32, sizeof(float));
    if (!is_empty && header.width > std::numeric_limits<std::uint32_t>::max() / fields.step())
        throw Unrepresentable("a line has more rays than a sensor_msgs/PointCloud2 can hold");
    cloud->width = header.width;
    cloud->height = header.height;
    cloud->is_bigendian = false;
    cloud->point_step = fields.step();
    cloud->row_step = header.width * fields.step();
    cloud->is_dense = true;
    if (is_empty) return cloud;
    cloud->data.resize(static_cast<std::size_t>(header.height) * cloud->row_step);

    const bv_scan_geometry& geometry = header.block.scan;
    std::vector<Turn> azimuths;
    azimuths.reserve(header.width);
    for (std::uint32_t ray = 0; ray < header.width; ++ray) azimuths.emplace_back(geometry.angle_min + ray * geometry.angle_increment);
    std::uint8_t* place = cloud->data.data();
    for (std::uint32_t layer = 0; layer < header.height; ++layer) {
        const Turn elevation(geometry.vertical_angle_min + layer * geometry.vertical_angle_increment);
        for (std::uint32_t ray = 0; ray < header.width; ++ray) {
            const std::size_t offset = layer * row_stride + ray * sizeof(float);
            double range = value_at(sample, offset);
            if (!std::isfinite(range)) {
                range = std::numeric_limits<double>::quiet_NaN();
                cloud->is_dense = false;
            }
            append(place, static_cast<float>(range * elevation.cos * azimuths[ray].cos));
            append(place, static_cast<float>(range * elevation.cos * azimuths[ray].sin));
            append(place, static_cast<float>(range * elevation.sin));
            if (has_intensities) append(place, value_at(sample, header.height * row_stride + offset));
            append(place, static_cast<std::uint16_t>(layer));
            append(place, static_cast<float>(ray * geometry.time_increment));
        }
    }
    return cloud;
}

}  // namespace belvedere_ros
