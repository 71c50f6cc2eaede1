#include "point_cloud.hpp"

#include <boost/make_shared.hpp>

#include <utility>

#include "rows.hpp"

namespace belvedere_ros {

namespace {

/// What the wire format says of the points of an encoding.
struct Points {
    std::vector<sensor_msgs::PointField> fields;
    /// Whether a cloud of one row contains only valid points.
    bool row_is_dense = false;
};

Points points_of(std::uint16_t encoding) {
    Points points;
#define BELVEDERE_FIELD(of, its_name, its_offset, type)               \
    if (encoding == of) {                                             \
        sensor_msgs::PointField field;                                \
        field.name = its_name;                                        \
        field.offset = its_offset;                                    \
        field.datatype = sensor_msgs::PointField::type;               \
        field.count = 1;                                              \
        points.fields.push_back(field);                               \
    }
    BV_POINT_FIELDS(BELVEDERE_FIELD)
#undef BELVEDERE_FIELD
#define BELVEDERE_POINT(of, size, is_dense) \
    if (encoding == of) points.row_is_dense = is_dense;
    BV_POINTS(BELVEDERE_POINT)
#undef BELVEDERE_POINT
    if (points.fields.empty())
        throw Unrepresentable("points are of encoding " + std::to_string(encoding) + ", which is not known here");
    return points;
}

}  // namespace

sensor_msgs::PointCloud2Ptr to_point_cloud(const Sample& sample) {
    const belvedere::Header& header = sample.header;
    Points points = points_of(header.encoding);
    auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    cloud->header = to_header(sample);
    cloud->width = header.width;
    cloud->height = header.height;
    cloud->fields = std::move(points.fields);
    cloud->is_bigendian = false;
    cloud->is_dense = points.row_is_dense && header.height <= 1;
    cloud->point_step = header.elem_stride;
    cloud->row_step = copy_rows(sample, cloud->data);
    return cloud;
}

}  // namespace belvedere_ros
