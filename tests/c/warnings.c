/* Checks warnings and views that contribute nothing. Usage: warnings FOLDER (see capture.h) */
#include "capture.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

/* A camera without picture and one with a black mask contribute nothing, and are named. `black` is a picture's black pixels. */
static void check_left_out(const struct capture *capture, pcmvs_frame *frame, pcmvs_view *views, unsigned char *black) {
    static const char *const codes[2] = {"no-picture", "empty-silhouette"};
    pcmvs_view_report report;
    pcmvs_warning warning;
    pcmvs_options options;
    pcmvs_image mask = *capture->views[4].mask;
    uint32_t i, count = 7;
    memcpy(views, capture->views, capture->count * sizeof *views);
    OK(pcmvs_view_init(&views[2], sizeof views[2]));
    mask.data = black;
    views[4].mask = &mask;
    OK(pcmvs_options_init(&options, sizeof options));
    options.preset = PCMVS_PRESET_HULL;
    OK(pcmvs_frame_reconstruct(frame, views, capture->count, &options));
    OK(pcmvs_frame_warning_count(frame, &count));
    CHECK(count == 2);
    for (i = 0; i < 2; i++) {
        OK(pcmvs_frame_get_warning(frame, i, &warning, sizeof warning));
        CHECK(warning.camera == (int32_t)(2 + 2 * i) && strcmp(warning.code, codes[i]) == 0);
        OK(pcmvs_frame_get_view_report(frame, 2 + 2 * i, &report, sizeof report));
        CHECK(report.used == 0 && report.carves == 0 && report.silhouette_overlap == -1 && report.contour_px == -1);
    }
    /* The same stage by stage. */
    OK(pcmvs_frame_begin(frame, &options));
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_view(frame, i, &views[i]));
    }
    OK(pcmvs_frame_colour(frame));
    OK(pcmvs_frame_warning_count(frame, &count));
    CHECK(count == 2);
}

/* A view without a silhouette is reported and causes a warning, and so is a view in which stereo finds nothing. */
static void check_warnings(const struct capture *capture, pcmvs_frame *frame) {
    pcmvs_options options;
    pcmvs_view *views = calloc(capture->count, sizeof *views);
    pcmvs_view_report report;
    pcmvs_warning warning;
    pcmvs_image *black = calloc(1, sizeof *black);
    const size_t bytes = 3 * (size_t)capture->pictures[4].width * capture->pictures[4].height;
    unsigned char *pixels = calloc(bytes, 1);
    uint32_t i, count = 7;
    if (views == NULL || black == NULL || pixels == NULL) {
        exit(3);
    }
    memcpy(views, capture->views, capture->count * sizeof *views);
    views[2].mask = NULL;
    *black = *views[4].image;
    black->data = pixels;
    views[4].image = black;
    OK(pcmvs_options_init(&options, sizeof options));
    OK(pcmvs_frame_reconstruct(frame, views, capture->count, &options));
    OK(pcmvs_frame_get_view_report(frame, 2, &report, sizeof report));
    CHECK(report.carves == 0 && report.inside == 0);
    OK(pcmvs_frame_get_view_report(frame, 4, &report, sizeof report));
    CHECK(report.carves == 1 && report.inside > 0 && report.detected == 0 && report.used == 1);
    CHECK(report.silhouette_overlap > 0.9 && report.silhouette_overlap <= 1 && report.contour_px >= 0);
    CHECK(report.contour_px < 1);
    /* The black picture has nothing to match. */
    CHECK(report.epipolar_px == -1);
    OK(pcmvs_frame_warning_count(frame, &count));
    OK(pcmvs_frame_get_warning(frame, 0, &warning, sizeof warning));
    CHECK(warning.camera == 2 && strcmp(warning.code, "no-silhouette") == 0);
    CHECK(strstr(warning.message, "camera 2") != NULL && strstr(warning.message, "mask") != NULL);
    /* In small pictures stereo may fail in the black picture's neighbours as well. */
    CHECK(count == 2 || count == 3);
    for (i = 1; i < count; i++) {
        OK(pcmvs_frame_get_warning(frame, i, &warning, sizeof warning));
        CHECK(warning.camera != 2 && strcmp(warning.code, "no-stereo-points") == 0);
    }
    CHECK(warning.camera == 4);
    EXPECT(pcmvs_frame_get_warning(frame, count, &warning, sizeof warning), PCMVS_STATUS_INVALID_ARGUMENT);
    /* The hull alone does not use stereo. */
    options.preset = PCMVS_PRESET_HULL;
    OK(pcmvs_frame_reconstruct(frame, views, capture->count, &options));
    OK(pcmvs_frame_warning_count(frame, &count));
    CHECK(count == 1);
    check_left_out(capture, frame, views, pixels);
    free(views);
    free(black);
    free(pixels);
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    if (argc != 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    check_warnings(&capture, frame);
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    capture_free(&capture);
    return verdict();
}
