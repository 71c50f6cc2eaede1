// Checks the lenses of tests/lenses.urdf, as reported by the simulator's cameras in images and camera_info.

#include <belvedere.hpp>
#if BELVEDERE_TEST_OPENCV
#include <belvedere/opencv.hpp>
#endif

#include <iostream>
#include <string>
#include <vector>

namespace {

void require(bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error(what);
}

belvedere::Frame first(belvedere::Node& node, const std::string& topic) {
    belvedere::Subscriber subscriber = node.subscribe(topic);
    for (int tries = 0; tries < 300; ++tries) {
        subscriber.wait(std::chrono::milliseconds(100));
        if (std::optional<belvedere::Frame> frame = subscriber.take()) return std::move(*frame);
    }
    throw std::runtime_error("nothing on " + topic);
}

void check(belvedere::Node& node, const std::string& camera, bv_distortion_model model, const std::string& name,
           const std::vector<double>& parameters) {
    const belvedere::Frame picture = first(node, camera + "/image_raw");
    const bv_camera_info info = first(node, camera + "/camera_info").structs<bv_camera_info>().at(0);
    require(picture.distortion_model() == model, camera + ": model of the picture");
    require(info.distortion_model == name, camera + ": model of the info");
    const belvedere::Span<const double> d = picture.distortion();
    require(std::vector<double>(d.begin(), d.end()) == parameters, camera + ": parameters of the picture");
    require(std::vector<double>(info.d, info.d + info.d_len) == parameters, camera + ": parameters of the info");
    const bv_intrinsics& lens = picture.intrinsics();
    require(lens.fx == info.k[0] && lens.skew == info.k[1] && lens.cx == info.k[2], camera + ": K, across");
    require(lens.fy == info.k[4] && lens.cy == info.k[5], camera + ": K, down");
#if BELVEDERE_TEST_OPENCV
    require(belvedere::cv_distortion(picture) == parameters, camera + ": parameters for OpenCV");
#endif
    std::cout << camera << ": " << name << " of " << parameters.size() << " parameters\n";
}

}  // namespace

int main(int argc, char** argv) try {
    belvedere::Node node(argc > 1 ? argv[1] : "", "lenses");
    check(node, "tilted", BV_DISTORTION_MODEL_RATIONAL_POLYNOMIAL, "rational_polynomial",
          {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.009, 0.01, 0.011, 0.012, 0.013, 0.014});
    check(node, "fisheye", BV_DISTORTION_MODEL_EQUIDISTANT, "equidistant", {0.05, -0.01, 0.002, 0.0001});
    check(node, "spheres", BV_DISTORTION_MODEL_DOUBLE_SPHERE, "double_sphere", {-0.2, 0.6});
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
