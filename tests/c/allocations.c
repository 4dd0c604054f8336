/* What is allocated when: allocations FOLDER FRAMES (see capture.h). Rust asks the C library for memory, so
 * that this program's own malloc sees everything; both are on one thread. */
#include "capture.h"
#include "check.h"
#include "counted.h"

#include <string.h>

/* After so many frames nothing changes any more. */
#define SETTLED 4

/* Says what has happened since `start`; `used` was in use then. */
static void tell(const char *what, size_t used) {
    printf("%-16s %8zu allocations of %9.1f KiB, %8.1f KiB at most at a time, %8.1f KiB kept\n", what, counts.calls,
           (double)counts.bytes / 1024, (double)(counts.peak - used) / 1024,
           ((double)counts.used - (double)used) / 1024);
}

static int count_bytes(void *user, const void *data, size_t size) {
    (void)data;
    *(size_t *)user += size;
    return 0;
}

/* Everything that reads results to memory that is there. */
static void check_reading(pcmvs_rig *rig, pcmvs_frame *frame) {
    static float positions[3 << 20];
    static pcmvs_point points[1 << 20];
    pcmvs_mesh mesh;
    pcmvs_silhouette silhouette;
    pcmvs_report report;
    pcmvs_error error;
    double origin[3];
    const size_t used = counts.used;
    start();
    OK(pcmvs_rig_origin(rig, origin));
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    OK(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FINAL, PCMVS_ATTRIBUTE_POSITION, positions, 1 << 20, 0, NULL));
    OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, points, 1 << 20, 0, NULL));
    OK(pcmvs_frame_get_silhouette(frame, 0, &silhouette, sizeof silhouette));
    OK(pcmvs_frame_get_report(frame, &report, sizeof report));
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(counts.calls == 0);
    tell("reading results", used);
}

/* After the first frame, reading views asks for one view's buffers, and detection for the points that it finds. */
static void check_stages(const struct capture *capture, pcmvs_frame *frame) {
    const size_t pixels = (size_t)capture->cameras[0].width * capture->cameras[0].height, each = 16384;
    size_t points = 0, count, used;
    uint32_t i;
    OK(pcmvs_frame_begin(frame, NULL));
    used = counts.used;
    start();
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_view(frame, i, &capture->views[i]));
    }
    tell("views", used);
    CHECK(counts.bytes < 40 * pixels + capture->count * each);
    OK(pcmvs_frame_hull(frame));
    OK(pcmvs_frame_contours(frame));
    OK(pcmvs_frame_coarse(frame));
    used = counts.used;
    start();
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_detect(frame, i));
    }
    tell("detection", used);
    count = counts.bytes;
    OK(pcmvs_frame_merge(frame));
    for (i = 0; i < capture->count; i++) {
        size_t found = 0;
        OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_DETECTED, i, NULL, 0, 0, &found));
        points += found;
    }
    CHECK(points > 0 && count < 60 * points + capture->count * each);
    OK(pcmvs_frame_mesh(frame));
    OK(pcmvs_frame_colour(frame));
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    struct counts first = {0, 0, 0, 0}, later = {0, 0, 0, 0};
    size_t before, used, file = 0;
    unsigned i, frames;
    char name[32];
    if (argc != 3 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    printf("%u views of %u x %u\n", capture.count, capture.cameras[0].width, capture.cameras[0].height);
    frames = (unsigned)strtoul(argv[2], NULL, 10);
    before = counts.used;
    start();
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    tell("rig", before);
    used = counts.used;
    start();
    OK(pcmvs_frame_new(rig, &frame));
    tell("new frame", used);
    used = counts.used;
    for (i = 0; i < frames; i++) {
        start();
        OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
        if (i == 0) {
            first = counts;
        } else if (i <= SETTLED) {
            /* The first frame's memory is used again; what was too small for its new place, or is on no list yet, is
             * asked for once more. */
            later = counts;
            CHECK(later.bytes < first.bytes / 4 && later.calls < first.calls);
        } else {
            /* Frame after frame the same. How much glibc rounds up depends on what it has at hand. */
            CHECK(counts.calls == later.calls && counts.bytes == later.bytes);
            CHECK(counts.used < later.used + later.used / 50 && counts.peak < later.peak + later.peak / 50);
        }
        CHECK(counts.peak < first.peak + first.peak / 5);
        if (i < 2 || i == frames - 1) {
            snprintf(name, sizeof name, "frame %u", i);
            tell(name, used);
        }
    }
    check_reading(rig, frame);
    check_stages(&capture, frame);
    used = counts.used;
    start();
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, count_bytes, &file));
    tell("export as GLB", used);
    CHECK(counts.used == used);
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    /* All of it has been given back. */
    CHECK(counts.used == before);
    capture_free(&capture);
    return verdict();
}
