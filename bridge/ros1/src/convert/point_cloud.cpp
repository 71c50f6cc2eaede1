#include "point_cloud.hpp"

#include <boost/make_shared.hpp>

#include "rows.hpp"

namespace belvedere_ros {

namespace {

sensor_msgs::PointField field_of(const char* name, std::uint32_t offset,
                                 std::uint8_t datatype = sensor_msgs::PointField::FLOAT32) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = offset;
    field.datatype = datatype;
    field.count = 1;
    return field;
}

/// Returns the fields of a point besides its position.
std::vector<sensor_msgs::PointField> own_fields(std::uint16_t encoding) {
    if (encoding == BV_ENCODING_XYZ_RGB_F32) return {field_of("rgb", 16)};
    if (encoding == BV_ENCODING_XYZ_IRT_F32)
        return {field_of("intensity", 12), field_of("ring", 16, sensor_msgs::PointField::UINT16), field_of("time", 18)};
    if (encoding == BV_ENCODING_OUSTER_POINT)
        return {field_of("intensity", 16),
                field_of("t", 20, sensor_msgs::PointField::UINT32),
                field_of("reflectivity", 24, sensor_msgs::PointField::UINT16),
                field_of("ring", 26, sensor_msgs::PointField::UINT16),
                field_of("ambient", 28, sensor_msgs::PointField::UINT16),
                field_of("range", 32, sensor_msgs::PointField::UINT32)};
    if (encoding == BV_ENCODING_LIVOX_POINT)
        return {field_of("intensity", 12), field_of("tag", 16, sensor_msgs::PointField::UINT8),
                field_of("line", 17, sensor_msgs::PointField::UINT8),
                field_of("timestamp", 18, sensor_msgs::PointField::FLOAT64)};
    throw Unrepresentable("points are of encoding " + std::to_string(encoding) + ", which is not known here");
}

}  // namespace

sensor_msgs::PointCloud2Ptr to_point_cloud(const Sample& sample) {
    const belvedere::Header& header = sample.header;
    const auto own = own_fields(header.encoding);
    auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    cloud->header = to_header(sample);
    cloud->width = header.width;
    cloud->height = header.height;
    cloud->fields = {field_of("x", 0), field_of("y", 4), field_of("z", 8)};
    cloud->fields.insert(cloud->fields.end(), own.begin(), own.end());
    cloud->is_bigendian = false;
    // A lidar's cloud in one row contains only valid points.
    cloud->is_dense = header.encoding != BV_ENCODING_XYZ_RGB_F32 && header.height <= 1;
    cloud->point_step = header.elem_stride;
    cloud->row_step = copy_rows(sample, cloud->data);
    return cloud;
}

}  // namespace belvedere_ros
