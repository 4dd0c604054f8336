// Does everything that threads may do at once, for ThreadSanitizer. Usage: threads FOLDER [race] (see capture.h).
//
// Two threads try to set an allocator. Then two frames of one rig are made at once, each on threads of its own, while
// another thread reads both. With `race`, two threads instead make the library write to the same memory, which a
// sanitizer that covers the library must find.
#include "capture.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <pcmvs.hpp>
#include <thread>
#ifdef _WIN32
#include <malloc.h>
#endif

namespace {

std::atomic<long> blocks{0};

void *allocate(void *, std::size_t size, std::size_t alignment) {
    blocks++;
    alignment = std::max(alignment, sizeof(void *));
#ifdef _WIN32
    return _aligned_malloc(size, alignment);
#else
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
#endif
}

void deallocate(void *, void *memory, std::size_t, std::size_t) {
    blocks--;
#ifdef _WIN32
    _aligned_free(memory);
#else
    std::free(memory);
#endif
}

// One of two threads succeeds.
bool set_allocator() {
    auto allocator = pcmvs::make<pcmvs_allocator>();
    allocator.allocate = allocate;
    allocator.deallocate = deallocate;
    std::atomic<int> successes{0};
    const auto set = [&] { successes += pcmvs_set_allocator(&allocator) == PCMVS_STATUS_OK; };
    std::thread one(set), other(set);
    one.join();
    other.join();
    return successes == 1;
}

// Runs the jobs on two threads.
void on_two(void *, std::uint32_t count, pcmvs_job_fn run, void *job) {
    std::atomic<std::uint32_t> next{0};
    const auto work = [&] {
        for (std::uint32_t i = next++; i < count; i = next++) {
            run(job, i);
        }
    };
    std::thread other(work);
    work();
    other.join();
}

// Called only on the thread that made the call. It needs no lock.
int count_calls(void *calls, std::uint32_t, std::uint32_t, std::uint32_t) {
    ++*static_cast<unsigned *>(calls);
    return 0;
}

struct Run {
    explicit Run(const pcmvs::Rig &rig) : frame(rig) {}
    pcmvs::Frame frame;
    unsigned calls = 0;
    bool good = true;
};

void make(Run &run, pcmvs::Span<pcmvs_view> views) {
    auto options = pcmvs::make<pcmvs_options>();
    options.parallel = on_two;
    options.progress = count_calls;
    options.progress_user = &run.calls;
    for (options.frame = 0; options.frame < 2; options.frame++) {
        // The frame is busy while the reader reads it.
        pcmvs_status status = PCMVS_STATUS_BUSY;
        while (status == PCMVS_STATUS_BUSY) {
            status = run.frame.try_reconstruct(views, &options);
        }
        run.good = run.good && status == PCMVS_STATUS_OK;
    }
}

// Reads results. Returns true unless something fails for another reason than that there are none yet or that the frame
// is busy.
bool read(const Run &run, const pcmvs::Rig &rig) {
    pcmvs_counts counts;
    pcmvs_view_report view;
    std::uint32_t warnings = 0;
    std::size_t count = 0;
    const pcmvs_status results[] = {run.frame.try_get_counts(counts), run.frame.try_get_view_report(0, view),
                                    run.frame.try_warning_count(warnings),
                                    pcmvs_frame_copy_mesh(run.frame.get(), 0, 0, nullptr, 0, 0, &count)};
    bool good = rig.camera_count() > 0;
    for (const pcmvs_status status : results) {
        good = good && (status == PCMVS_STATUS_OK || status == PCMVS_STATUS_BUSY || status == PCMVS_STATUS_WRONG_ORDER);
    }
    const pcmvs_error error = run.frame.error();
    return good && std::memchr(error.message, 0, sizeof error.message) != nullptr;
}

int run(const capture &capture, bool race) {
    const pcmvs::Rig rig(pcmvs::Span<pcmvs_camera>(capture.cameras, capture.count));
    const pcmvs::Span<pcmvs_view> views(capture.views, capture.count);
    if (race) {
        std::uint32_t shared = 0;
        const auto write = [&] { pcmvs_rig_camera_count(rig.get(), &shared); };
        std::thread one(write), other(write);
        one.join();
        other.join();
        return 0;
    }
    Run runs[2] = {Run(rig), Run(rig)};
    std::atomic<bool> done{false};
    bool good = true;
    std::thread reader([&] {
        while (!done) {
            good = read(runs[0], rig) && read(runs[1], rig) && good;
            std::this_thread::yield();
        }
    });
    std::thread first([&] { make(runs[0], views); }), second([&] { make(runs[1], views); });
    first.join();
    second.join();
    done = true;
    reader.join();
    const pcmvs::Mesh a = runs[0].frame.get_mesh(), b = runs[1].frame.get_mesh();
    good = good && runs[0].good && runs[1].good && runs[0].calls > 0 && a.positions.size() == b.positions.size() &&
           std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(float)) == 0;
    std::cout << a.positions.size() / 3 << " vertices, " << runs[0].calls << " calls back\n";
    return good ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    capture capture;
    if (argc < 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    int status = set_allocator() ? run(capture, argc > 2) : 1;
    if (blocks != 0) {
        std::cout << blocks << " blocks are left\n";
        status = 1;
    }
    capture_free(&capture);
    return status;
}
