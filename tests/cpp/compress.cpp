// A compressed file, by meshoptimizer that the program links. Usage: compress FOLDER OUT.glb (see capture.h)
#include <meshoptimizer.h>

#include <pcmvs.hpp>

#include "capture.h"

#include <fstream>

int main(int argc, char **argv) {
    struct capture capture;
    if (argc != 3 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    pcmvs::Rig rig;
    rig.set_cameras({capture.cameras, capture.count});
    pcmvs::Frame frame(rig);
    frame.reconstruct({capture.views, capture.count});
    auto options = pcmvs::make<pcmvs_export_options>();
    options.has_up = 1;
    options.up[2] = 1;
    pcmvs::compress(options);
    std::ofstream file(argv[2], std::ios::binary);
    frame.export_mesh(
        [&](pcmvs::Span<std::byte> bytes) {
            file.write(reinterpret_cast<const char *>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        },
        &options);
    capture_free(&capture);
    return file.flush() ? 0 : 1;
}
