#include "point_cloud.hpp"

#include <boost/make_shared.hpp>

#include "rows.hpp"

namespace belvedere_ros {

namespace {

sensor_msgs::PointField float_field(const char* name, std::uint32_t offset) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = offset;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    return field;
}

}  // namespace

sensor_msgs::PointCloud2Ptr to_point_cloud(const Sample& sample) {
    const belvedere::Header& header = sample.header;
    if (header.encoding != BV_ENCODING_XYZ_RGB_F32)
        throw Unrepresentable("points are not of x, y, z and colour, but of encoding " + std::to_string(header.encoding));
    auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    cloud->header = to_header(sample);
    cloud->width = header.width;
    cloud->height = header.height;
    cloud->fields = {float_field("x", 0), float_field("y", 4), float_field("z", 8), float_field("rgb", 16)};
    cloud->is_bigendian = false;
    cloud->is_dense = false;
    cloud->point_step = header.elem_stride;
    cloud->row_step = copy_rows(sample, cloud->data);
    return cloud;
}

}  // namespace belvedere_ros
