/* Counts allocations. Usage: allocations FOLDER FRAMES (see capture.h). The library calls malloc, so that this program's own
 * malloc sees every allocation. All of them are on one thread. */
#include "capture.h"
#include "check.h"
#include "counted.h"

#include <string.h>

/* Number of frames after which memory use no longer changes. */
#define SETTLED 4

/* Prints what has been allocated since `start`, when `used` bytes were in use. */
static void show(const char *what, size_t used) {
    printf("%-16s %8zu allocations of %9.1f KiB, %8.1f KiB at most at a time, %8.1f KiB kept\n", what, counts.calls,
           (double)counts.bytes / 1024, (double)(counts.peak - used) / 1024,
           ((double)counts.used - (double)used) / 1024);
}

static int count_bytes(void *user, const void *data, size_t size) {
    (void)data;
    *(size_t *)user += size;
    return 0;
}

/* Reading results does not allocate. Only warnings are made when they are asked for, from a few figures of each view. */
static void check_reading(pcmvs_rig *rig, pcmvs_frame *frame, uint32_t views) {
    static float positions[3 << 20];
    static pcmvs_point points[1 << 20];
    pcmvs_mesh mesh;
    pcmvs_silhouette silhouette;
    pcmvs_counts counted;
    pcmvs_stage_report stage;
    pcmvs_view_report view;
    pcmvs_error error;
    uint32_t warnings, i;
    double origin[3];
    const size_t used = counts.used;
    start();
    OK(pcmvs_rig_origin(rig, origin));
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    OK(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FINAL, PCMVS_ATTRIBUTE_POSITION, positions, 1 << 20, 0, NULL));
    OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, points, 1 << 20, 0, NULL));
    OK(pcmvs_frame_get_silhouette(frame, 0, &silhouette, sizeof silhouette));
    OK(pcmvs_frame_get_counts(frame, &counted, sizeof counted));
    OK(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_MESH, &stage, sizeof stage));
    for (i = 0; i < views; i++) {
        OK(pcmvs_frame_get_view_report(frame, i, &view, sizeof view));
    }
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    show("reading results", used);
    CHECK(counts.calls == 0);
    start();
    OK(pcmvs_frame_warning_count(frame, &warnings));
    show("warnings", used);
    CHECK(counts.calls <= 6 && counts.bytes <= 64 * (size_t)views && counts.used == used);
}

/* After the first frame, reading views allocates one view's buffers, and detection allocates the points that it finds. */
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
    show("views", used);
    CHECK(counts.bytes < 40 * pixels + capture->count * each);
    OK(pcmvs_frame_hull(frame));
    OK(pcmvs_frame_contours(frame));
    OK(pcmvs_frame_coarse(frame));
    used = counts.used;
    start();
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_detect(frame, i));
    }
    show("detection", used);
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

/* A calibration keeps luma and silhouette of every view, and gives all memory back when it is freed. Reading its results does
 * not allocate. */
static void check_calibration(const struct capture *capture, const pcmvs_rig *rig) {
    const size_t pixels = (size_t)capture->count * capture->cameras[0].width * capture->cameras[0].height;
    const size_t before = counts.used;
    pcmvs_calibration *calibration = NULL;
    pcmvs_calibration_report report;
    pcmvs_camera_report of_camera;
    pcmvs_camera camera;
    uint32_t i;
    size_t used;
    OK(pcmvs_calibration_new(rig, &calibration));
    start();
    OK(pcmvs_calibration_add_frame(calibration, capture->views, capture->count, NULL));
    show("calibration", before);
    CHECK(counts.used - before < 3 * pixels + 2048 * (size_t)capture->count);
    used = counts.used;
    start();
    OK(pcmvs_calibration_run(calibration, NULL));
    show("its run", used);
    start();
    OK(pcmvs_calibration_get_report(calibration, &report, sizeof report));
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_calibration_get_camera_report(calibration, i, &of_camera, sizeof of_camera));
        OK(pcmvs_calibration_get_camera(calibration, i, &camera, sizeof camera));
    }
    CHECK(counts.calls == 0);
    OK(pcmvs_calibration_free(calibration));
    CHECK(counts.used == before);
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
    show("rig", before);
    used = counts.used;
    start();
    OK(pcmvs_frame_new(rig, &frame));
    show("new frame", used);
    used = counts.used;
    for (i = 0; i < frames; i++) {
        start();
        OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
        if (i == 0) {
            first = counts;
        } else if (i <= SETTLED) {
            /* The first frame's memory is reused. Blocks that are too small for their new use are allocated again. */
            later = counts;
            CHECK(later.bytes < first.bytes / 4 && later.calls < first.calls);
        } else {
            /* Every frame allocates the same. glibc rounds sizes up depending on its free blocks. */
            CHECK(counts.calls == later.calls && counts.bytes == later.bytes);
            CHECK(counts.used < later.used + later.used / 50 && counts.peak < later.peak + later.peak / 50);
        }
        CHECK(counts.peak < first.peak + first.peak / 5);
        if (i < 2 || i == frames - 1) {
            snprintf(name, sizeof name, "frame %u", i);
            show(name, used);
        }
    }
    check_reading(rig, frame, capture.count);
    check_stages(&capture, frame);
    used = counts.used;
    start();
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, count_bytes, &file));
    show("export as GLB", used);
    CHECK(counts.used == used);
    OK(pcmvs_frame_free(frame));
    check_calibration(&capture, rig);
    OK(pcmvs_rig_free(rig));
    /* Everything has been freed. */
    CHECK(counts.used == before);
    capture_free(&capture);
    return verdict();
}
