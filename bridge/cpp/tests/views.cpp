// Views of frames of a live robot with a depth camera as the types of OpenCV, Eigen and PCL, as far as installed.
//
//   views [domain]
//
// Image, depth and points of the same stamp must agree in each library's view.
#include <cmath>
#include <cstdio>
#include <iostream>

#include <belvedere.hpp>

#include <belvedere/eigen.hpp>
#if BELVEDERE_TEST_OPENCV
#include <belvedere/opencv.hpp>
#endif
#if BELVEDERE_TEST_PCL
#include <belvedere/pcl.hpp>
#endif

namespace {

using belvedere::Frame;

void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(what);
}

template <class F>
void require_throws(F&& call, const char* what) {
    try {
        call();
    } catch (const std::logic_error&) {
        return;
    }
    throw std::runtime_error(what);
}

// A map of a temporary frame must not compile.
template <class F, class = void>
struct maps : std::false_type {};
template <class F>
struct maps<F, decltype(void(belvedere::eigen_points(std::declval<F>())))> : std::true_type {};
static_assert(maps<const Frame&>::value && !maps<Frame>::value, "a temporary frame is refused");

// Nor must a view of its rows.
template <class F, class = void>
struct has_rows : std::false_type {};
template <class F>
struct has_rows<F, decltype(void(std::declval<F>().template row<std::uint8_t>(0)))> : std::true_type {};
template <class F, class = void>
struct has_header : std::false_type {};
template <class F>
struct has_header<F, decltype(void(std::declval<F>().header()))> : std::true_type {};
template <class F, class = void>
struct has_payload : std::false_type {};
template <class F>
struct has_payload<F, decltype(void(std::declval<F>().payload()))> : std::true_type {};
static_assert(has_rows<const Frame&>::value && !has_rows<Frame>::value, "rows of a temporary frame are refused");
static_assert(has_header<const Frame&>::value && !has_header<Frame>::value, "its header, too");
static_assert(has_payload<const Frame&>::value && !has_payload<Frame>::value, "and its payload");

// Nor must `camera.take()->…`, which would access a temporary frame or an empty optional.
template <class T, class = void>
struct has_arrow : std::false_type {};
template <class T>
struct has_arrow<T, decltype(void(std::declval<T>().operator->()))> : std::true_type {};
using Taken = decltype(std::declval<belvedere::Subscriber&>().take());
static_assert(has_arrow<Taken&>::value && has_arrow<const Taken&>::value && !has_arrow<Taken>::value,
              "what is taken needs a name");
static_assert(std::is_convertible<Taken, std::optional<Frame>>::value, "and is an optional");

void check_eigen(const Frame& picture, const Frame& depth, const Frame& cloud) {
    const auto points = belvedere::eigen_points(cloud);
    const auto grid = belvedere::eigen_grid<float>(depth);
    require(points.data() == reinterpret_cast<const float*>(cloud.payload().data()), "points are a copy");
    require(grid.data() == reinterpret_cast<const float*>(depth.payload().data()), "depth is a copy");
    require(grid.rows() == 480 && grid.cols() == 640 && points.cols() == 480 * 640, "sizes");
    require_throws([&] { belvedere::eigen_grid<std::uint16_t>(depth); }, "float depth as integers");
    require_throws([&] { belvedere::eigen_points(depth); }, "depth as points");

    // Each point equals its pixel's depth times the ray through the inverse camera matrix.
    const Eigen::Matrix3d rays_from_pixels = belvedere::eigen_camera_matrix(cloud).inverse();
    int compared = 0;
    for (int v = 0; v < 480; v += 7)
        for (int u = 0; u < 640; u += 7) {
            const Eigen::Vector3d point = points.col(v * 640 + u).cast<double>();
            if (!point.allFinite() || !std::isfinite(grid(v, u))) continue;
            const Eigen::Vector3d expected = rays_from_pixels * Eigen::Vector3d(u, v, 1) * static_cast<double>(grid(v, u));
            require((point - expected).norm() < 1e-4 * point.norm(), "a point is not where its depth is");
            ++compared;
        }
    require(compared > 1000, "hardly any points");

    require(belvedere::eigen_world_from_sensor(picture).translation().z() > 0.1, "the camera is above the floor");
    const Eigen::Isometry3d world_from_optical = belvedere::eigen_world_from_optical(cloud);
    int on_the_floor = 0;
    for (Eigen::Index i = 0; i < points.cols(); i += 7) {
        const Eigen::Vector3d point = world_from_optical * points.col(i).cast<double>();
        if (!point.allFinite()) continue;
        require(point.z() > -0.1, "a point below the floor");
        on_the_floor += std::abs(point.z()) < 0.05;
    }
    require(on_the_floor > 1000, "hardly any floor");
    std::cout << "Eigen: " << compared << " points are where their depth is\n";
}

void check_transforms(belvedere::Node& node) {
    belvedere::Subscriber transforms = node.subscribe("tf_static");
    for (int tries = 0; tries < 100; ++tries) {
        transforms.wait(std::chrono::milliseconds(100));
        const std::optional<Frame> frame = transforms.take();
        if (!frame) continue;
        const auto all = frame->structs<bv_transform>();
        require(!all.empty(), "transforms");
        require_throws([&] { frame->structs<bv_joint_state>(); }, "transforms as states of joints");
        for (const bv_transform& one : all)
            require(std::abs(belvedere::eigen_parent_from_child(one).linear().determinant() - 1) < 1e-9, "a rotation");
        return;
    }
    throw std::runtime_error("no static transforms");
}

#if BELVEDERE_TEST_OPENCV
void check_opencv(const Frame& picture, const Frame& depth, const Frame& cloud) {
    const cv::Mat pixels = belvedere::cv_mat(picture), metres = belvedere::cv_mat(depth), points = belvedere::cv_mat(cloud);
    require(pixels.data == picture.payload().data() && pixels.type() == CV_8UC3, "the picture is a copy");
    require(pixels.rows == 480 && pixels.cols == 640 && pixels.isContinuous(), "size of the picture");
    require(metres.data == depth.payload().data() && metres.type() == CV_32FC1, "the depth is a copy");
    require(points.type() == CV_32FC(8) && points.step == 640 * 32, "type of the points");
    require(picture.distortion_model() == BV_DISTORTION_MODEL_PLUMB_BOB, "model of the lens");
    require(belvedere::cv_distortion(picture) == std::vector<double>(5, 0.0), "distortion");
    const cv::Matx33d k = belvedere::cv_camera_matrix(depth);
    const float z = metres.at<float>(300, 200), x = points.ptr<float>(300, 200)[0];
    require(!std::isfinite(z) || std::abs(x - (200 - k(0, 2)) / k(0, 0) * z) < 1e-4, "point and depth");
    require(cv::mean(pixels)[0] > 1, "a black picture");
    std::cout << "OpenCV: views of picture, depth and points\n";
}
#endif

#if BELVEDERE_TEST_PCL
void check_pcl(const Frame& picture, const Frame& cloud) {
    const auto copy = belvedere::pcl_cloud(cloud);
    require(copy.width == 640 && copy.height == 480 && copy.isOrganized() && !copy.is_dense, "size of the cloud");
    require(copy.header.stamp == cloud.header().stamp_ns / 1000 && copy.header.frame_id == cloud.frame_id(), "header");
    int compared = 0;
    for (std::uint32_t y = 0; y < 480; y += 7) {
        const auto row = belvedere::pcl_row(cloud, y);
        const auto colours = picture.row<std::uint8_t>(y);
        require(static_cast<const void*>(row.data()) == cloud.row<std::uint8_t>(y).data(), "the row is a copy");
        for (std::uint32_t x = 0; x < 640; x += 7) {
            const pcl::PointXYZRGB& point = copy.at(static_cast<int>(x), static_cast<int>(y));
            if (!std::isfinite(point.z)) continue;
            require(point.x == row[x].x && point.z == row[x].z && point.g == row[x].g, "view and copy");
            require(point.data[3] == 1 && point.a == 255, "what PCL's own points have");
            require(point.r == colours[3 * x] && point.g == colours[3 * x + 1] && point.b == colours[3 * x + 2],
                    "colour of a point");
            ++compared;
        }
    }
    require(compared > 1000, "hardly any points");
    std::cout << "PCL: " << compared << " points have their colours\n";
}
#endif

}  // namespace

int main(int argc, char** argv) try {
    belvedere::Node node(argc > 1 ? argv[1] : "", "views");
    auto sets = node.synchronize(std::chrono::nanoseconds(0), "camera/rgb/image_raw", "camera/depth/image_raw",
                                 "camera/depth/points");
    int count = 0;
    std::uint64_t last_ns = 0;
    while (count < 5) {
        require(sets.wait(std::chrono::seconds(20)), "no set came");
        const auto set = sets.take();
        if (!set) continue;
        const auto& [picture, depth, cloud] = *set;
        require(picture.header().stamp_ns == depth.header().stamp_ns && depth.header().stamp_ns == cloud.header().stamp_ns,
                "stamps of a set");
        require(count == 0 || picture.header().stamp_ns > last_ns, "sets in order");
        last_ns = picture.header().stamp_ns;
        require(cloud.frame_id() == "camera_depth_optical_frame", "frame");
        if (count == 0) {
            check_eigen(picture, depth, cloud);
#if BELVEDERE_TEST_OPENCV
            check_opencv(picture, depth, cloud);
#endif
#if BELVEDERE_TEST_PCL
            check_pcl(picture, cloud);
#endif
        }
        ++count;
    }
    check_transforms(node);
    return 0;
} catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 1;
}
