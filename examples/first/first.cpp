#include <belvedere.hpp>
#include <iostream>

int main() try {
    belvedere::Node node;
    belvedere::Subscriber camera = node.subscribe("image_raw");
    int count = 0;
    while (count < 10 && camera.wait(std::chrono::seconds(5))) {
        if (auto frame = camera.take()) {
            auto pixels = frame->row<std::uint8_t>(0);  // in place: the memory that the simulator wrote
            std::cout << frame->header().width << " x " << frame->header().height << ", first pixel "
                      << +pixels[0] << ' ' << +pixels[1] << ' ' << +pixels[2] << '\n';
            ++count;
        }
    }
    if (count == 10) return 0;
    std::cerr << "no image for 5 s; start a simulator (belvedere run)\n";
    return 1;
} catch (const belvedere::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
