// Checks the calibration of the capture in a folder (see capture.h), prints what is wrong with it, and reconstructs the
// capture with the refined cameras. Usage: refine FOLDER OUT.glb
#include "capture.h"

#include <fstream>
#include <iostream>
#include <pcmvs.hpp>

namespace {

// Returns the cameras to go on with: the refined ones, or the given ones if those are as good.
std::vector<pcmvs_camera> refined(const capture &capture) {
    const pcmvs::Rig rig(pcmvs::Span<pcmvs_camera>(capture.cameras, capture.count));
    pcmvs::Calibration calibration(rig);
    // A few frames of the take, in which the person stands differently, say more than one.
    calibration.add_frame({capture.views, capture.count});
    calibration.run();
    for (const pcmvs_warning &warning : calibration.get_warnings()) {
        std::cout << warning.code << ": " << warning.message << '\n';
    }
    std::vector<pcmvs_camera> cameras;
    for (std::uint32_t i = 0; i < capture.count; i++) {
        const pcmvs_camera_report report = calibration.get_camera_report(i);
        std::cout << "camera " << i << ": its contour misses by " << report.contour_px << " px, refined by "
                  << report.refined_contour_px << " px\n";
        cameras.push_back(calibration.get_camera(i));
    }
    return cameras;
}

void run(const capture &capture, const char *path) {
    const pcmvs::Rig rig(refined(capture));
    pcmvs::Frame frame(rig);
    frame.reconstruct({capture.views, capture.count});
    std::ofstream file(path, std::ios::binary);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    frame.export_mesh([&](auto bytes) {
        file.write(reinterpret_cast<const char *>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    });
}

} // namespace

int main(int argc, char **argv) {
    capture capture;
    if (argc != 3 || !capture_read(argv[1], &capture)) {
        std::cerr << "usage: refine FOLDER OUT.glb\n";
        return 2;
    }
    int status = 0;
    try {
        run(capture, argv[2]);
    } catch (const std::exception &error) {
        std::cerr << error.what() << '\n';
        status = 1;
    }
    capture_free(&capture);
    return status;
}
