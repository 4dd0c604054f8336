// Reconstructs frame after frame as live capture software would: a pool of threads reads pictures and detects points,
// one view per job, and the host's own thread runs the stages in between. Usage: live FOLDER FRAMES THREADS OUT.glb
#include "capture.h"

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <pcmvs.hpp>
#include <thread>

namespace {

// Calls `work` for every index below `count` on several threads and rethrows the first exception.
template <typename F> void on_threads(unsigned threads, std::uint32_t count, F work) {
    std::atomic<std::uint32_t> next{0};
    std::atomic_flag failed = ATOMIC_FLAG_INIT;
    std::exception_ptr error;
    std::vector<std::thread> pool;
    for (unsigned t = 0; t < threads; t++) {
        pool.emplace_back([&] {
            try {
                for (std::uint32_t i = next++; i < count; i = next++) {
                    work(i);
                }
            } catch (...) {
                if (!failed.test_and_set()) {
                    error = std::current_exception();
                }
            }
        });
    }
    for (auto &thread : pool) {
        thread.join();
    }
    if (error) {
        std::rethrow_exception(error);
    }
}

void run(const capture &capture, unsigned frames, unsigned threads, const char *path) {
    const pcmvs::Rig rig(pcmvs::Span<pcmvs_camera>(capture.cameras, capture.count));
    pcmvs::Frame frame(rig);
    auto options = pcmvs::make<pcmvs_options>();
    for (options.frame = 0; options.frame < frames; options.frame++) {
        frame.begin(&options);
        on_threads(threads, capture.count, [&](std::uint32_t i) { frame.view(i, capture.views[i]); });
        frame.hull();
        frame.contours();
        frame.coarse();
        on_threads(threads, capture.count, [&](std::uint32_t i) { frame.detect(i); });
        frame.merge();
        frame.mesh();
        frame.colour();
        // A player would upload these spans to the graphics card.
        const pcmvs::Mesh mesh = frame.get_mesh();
        std::cout << "frame " << options.frame << ": " << mesh.positions.size() / 3 << " vertices\n";
    }
    std::ofstream file(path, std::ios::binary);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    frame.export_mesh([&](pcmvs::Span<std::byte> bytes) {
        file.write(reinterpret_cast<const char *>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    });
}

} // namespace

int main(int argc, char **argv) {
    capture capture;
    if (argc != 5 || !capture_read(argv[1], &capture)) {
        std::cerr << "usage: live FOLDER FRAMES THREADS OUT.glb\n";
        return 2;
    }
    int status = 0;
    try {
        run(capture, std::strtoul(argv[2], nullptr, 10), std::strtoul(argv[3], nullptr, 10), argv[4]);
    } catch (const std::exception &error) {
        std::cerr << error.what() << '\n';
        status = 1;
    }
    capture_free(&capture);
    return status;
}
