#include "image.hpp"

#include <boost/make_shared.hpp>
#include <sensor_msgs/image_encodings.h>

#include "rows.hpp"

namespace belvedere_ros {

namespace encodings = sensor_msgs::image_encodings;

namespace {

struct Pixel {
    const std::string& encoding;
    std::uint32_t size;
};

Pixel pixel_of(std::uint16_t encoding) {
    switch (encoding) {
        case BV_ENCODING_RGB8: return {encodings::RGB8, 3};
        case BV_ENCODING_BGR8: return {encodings::BGR8, 3};
        case BV_ENCODING_MONO8: return {encodings::MONO8, 1};
        case BV_ENCODING_RGBA8: return {encodings::RGBA8, 4};
        case BV_ENCODING_MONO16: return {encodings::MONO16, 2};
        case BV_ENCODING_BAYER_RGGB8: return {encodings::BAYER_RGGB8, 1};
        case BV_ENCODING_BAYER_BGGR8: return {encodings::BAYER_BGGR8, 1};
        case BV_ENCODING_BAYER_GBRG8: return {encodings::BAYER_GBRG8, 1};
        case BV_ENCODING_BAYER_GRBG8: return {encodings::BAYER_GRBG8, 1};
        case BV_ENCODING_BAYER_RGGB16: return {encodings::BAYER_RGGB16, 2};
        case BV_ENCODING_BAYER_BGGR16: return {encodings::BAYER_BGGR16, 2};
        case BV_ENCODING_BAYER_GBRG16: return {encodings::BAYER_GBRG16, 2};
        case BV_ENCODING_BAYER_GRBG16: return {encodings::BAYER_GRBG16, 2};
        case BV_ENCODING_F32C1: return {encodings::TYPE_32FC1, 4};
        case BV_ENCODING_U16C1: return {encodings::TYPE_16UC1, 2};
        case BV_ENCODING_F32C2: return {encodings::TYPE_32FC2, 8};
        case BV_ENCODING_F32C3: return {encodings::TYPE_32FC3, 12};
        case BV_ENCODING_I32C1: return {encodings::TYPE_32SC1, 4};
        default: throw Unrepresentable("no encoding of sensor_msgs/Image for number " + std::to_string(encoding));
    }
}

}  // namespace

sensor_msgs::ImagePtr to_image(const Sample& sample) {
    const belvedere::Header& header = sample.header;
    const Pixel pixel = pixel_of(header.encoding);
    if (header.elem_stride != pixel.size)
        throw Unrepresentable("pixels are " + std::to_string(header.elem_stride) + " bytes apart; a sensor_msgs/Image of " +
                              pixel.encoding + " has them " + std::to_string(pixel.size) + " apart");
    auto image = boost::make_shared<sensor_msgs::Image>();
    image->header = to_header(sample);
    image->width = header.width;
    image->height = header.height;
    image->encoding = pixel.encoding;
    image->is_bigendian = false;
    image->step = copy_rows(sample, image->data);
    return image;
}

}  // namespace belvedere_ros
