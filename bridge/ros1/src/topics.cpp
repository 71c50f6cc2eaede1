#include "topics.hpp"

#include <boost/make_shared.hpp>

#include <algorithm>
#include <optional>

#include "convert/adjusted_scan.hpp"
#include "convert/camera_info.hpp"
#include "convert/image.hpp"
#include "convert/laser_scan.hpp"
#include "convert/point_cloud.hpp"
#include "convert/scan_cloud.hpp"
#include "convert/struct_message.hpp"
#include "convert/transforms.hpp"

namespace belvedere_ros {

namespace {

// Queue sizes: at most two large messages for a slow subscriber, as in Gazebo's camera plugin, and about one second of
// small ones.
constexpr std::uint32_t kLarge = 2;
constexpr std::uint32_t kSmall = 50;

/// Converts a scan adjusted by its parameters. An offset may move it before time 0, where there are no stamps.
template <class Message>
Convert<Message> adjusted(boost::shared_ptr<Message> (*convert)(const Sample&), const ScanParameters& parameters) {
    return [convert, parameters](const Sample& sample) -> boost::shared_ptr<Message> {
        const AdjustedScan scan(sample, parameters);
        return scan.sample().header.stamp_ns > 0 ? convert(scan.sample()) : nullptr;
    };
}

}  // namespace

std::unique_ptr<Relay> Topics::relay(Domain& domain, const bv_stream_info& stream) const {
    auto bell = std::make_shared<Bell>();
    auto out = output(stream, bell);
    if (!out) return nullptr;
    return std::make_unique<Relay>(domain, stream, std::move(out), std::move(bell), Relay::stamps_of(stream));
}

std::unique_ptr<Output> Topics::output(const bv_stream_info& stream, const std::shared_ptr<Bell>& bell) const {
    const std::string topic = stream.topic;
    const auto serve = [&](auto convert, const std::string& name, std::uint32_t queue, bool latch = false) -> std::unique_ptr<Output> {
        using Message = typename decltype(convert(std::declval<const Sample&>()))::element_type;
        return std::make_unique<TopicOutput<Message>>(nh_, name, queue, latch, bell, convert);
    };
    const auto serve_struct = [&](const std::string& name) -> std::unique_ptr<Output> {
        return std::make_unique<StructOutput>(nh_, name, kSmall, bell, StructMessage(stream.kind, topic));
    };
    switch (stream.kind) {
        case BV_KIND_IMAGE:
        case BV_KIND_DEPTH_IMAGE: return std::make_unique<ImageOutput>(nh_, topic, kLarge, bell, to_image);
        case BV_KIND_CAMERA_INFO: return serve(camera_info_converter(topic), topic, kLarge);
        case BV_KIND_LASER_SCAN: {
            const ScanParameters scan = scan_parameters(topic);
            if (stream.layers > 1) return serve(adjusted(to_scan_cloud, scan), topic, kLarge);
            return serve(adjusted(to_laser_scan, scan), topic, kSmall);
        }
        case BV_KIND_POINT_CLOUD: return serve(to_point_cloud, topic, kLarge);
        case BV_KIND_TRANSFORMS: {
            if (parameters_.transforms == Parameters::Transforms::none) return nullptr;
            const bool all = parameters_.transforms == Parameters::Transforms::all;
            const std::string parent = all ? std::string() : parameters_.odom_frame;
            return serve([parent](const Sample& sample) { return to_transforms(sample, parent); }, "/tf", kSmall);
        }
        case BV_KIND_STATIC_TRANSFORMS: {
            if (parameters_.transforms != Parameters::Transforms::all) return nullptr;
            const auto known = static_transforms_;
            return serve([known](const Sample& sample) { return known->with(to_transforms(sample)); }, "/tf_static", kSmall, true);
        }
        case BV_KIND_CLOCK:
            if (!parameters_.publish_clock) return nullptr;
            return serve_struct("/clock");
        // Named as in Gazebo. While paused they are repeated for new subscribers.
        case BV_KIND_MODEL_STATES: return serve_struct(parameters_.gazebo_namespace + '/' + topic.substr(topic.rfind('/') + 1));
        // Not published: Gazebo's services replace them.
        case BV_KIND_SIMULATION_COMMAND:
        case BV_KIND_SIMULATION_RESULT:
        // No standard ROS message fits: subscribe to the stream itself.
        case BV_KIND_BOUNDING_BOXES:
        case BV_KIND_TAG_DETECTIONS:
        // Served by dynamic_reconfigure: see settings.hpp.
        case BV_KIND_SENSOR_SETTINGS: return nullptr;
        default: return serve_struct(topic);
    }
}

/// Returns a converter with the service set_camera_info next to the topic: a calibration from the camera's images
/// replaces the simulator's values, as with a real camera.
Convert<sensor_msgs::CameraInfo> Topics::camera_info_converter(const std::string& topic) const {
    const std::size_t slash = topic.rfind('/');
    const std::string camera = slash == std::string::npos ? "" : topic.substr(0, slash);
    std::string name = "belvedere" + (camera.empty() ? "" : "_" + camera);
    std::replace(name.begin(), name.end(), '/', '_');
    const auto manager = std::make_shared<camera_info_manager::CameraInfoManager>(ros::NodeHandle(nh_, camera), name,
                                                                                  parameters_.camera_info_url);
    return [manager, topic, said = false](const Sample& sample) mutable {
        auto info = to_camera_info(sample);
        if (!manager->isCalibrated()) return info;
        auto calibrated = boost::make_shared<sensor_msgs::CameraInfo>(manager->getCameraInfo());
        if (calibrated->width != info->width || calibrated->height != info->height) return info;
        if (!std::exchange(said, true)) ROS_WARN_STREAM(topic << " is that of a calibration that was kept, not the simulator's");
        calibrated->header = info->header;
        return calibrated;
    };
}

}  // namespace belvedere_ros
