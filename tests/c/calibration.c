/* Checks and refines the calibration of a capture of which camera 4 was turned. Usage: calibration FOLDER (see capture.h) */
#include "capture.h"
#include "check.h"

#include <string.h>

#define TURNED 4

/* What a progress callback saw, and what it shall do. */
struct seen {
    pcmvs_calibration *calibration;
    uint32_t calls, stage, done, cancel_at;
};

/* Checks that progress advances, and that the handle is busy. Cancels at one of the calls. */
static int watch(void *user, uint32_t stage, uint32_t done, uint32_t total) {
    struct seen *seen = user;
    pcmvs_calibration_report report;
    pcmvs_error error;
    seen->calls++;
    CHECK(total == 1000 && done <= total && (seen->calls == 1 || (stage == seen->stage && done >= seen->done)));
    seen->stage = stage;
    seen->done = done;
    if (seen->calls == 1) {
        EXPECT(pcmvs_calibration_run(seen->calibration, NULL), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_calibration_get_report(seen->calibration, &report, sizeof report), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_calibration_free(seen->calibration), PCMVS_STATUS_BUSY);
        OK(pcmvs_calibration_error(seen->calibration, &error, sizeof error));
        CHECK(error.status == PCMVS_STATUS_BUSY && strstr(error.message, "the calibration is in use") != NULL);
    }
    return seen->calls == seen->cancel_at;
}

/* Runs jobs on this thread, backwards, and leaves out the last one. */
static void backwards(void *user, uint32_t count, pcmvs_job_fn run, void *job) {
    uint32_t i;
    (void)user;
    for (i = count - 1; i > 0; i--) {
        run(job, i - 1);
    }
}

static pcmvs_calibration *made(const pcmvs_camera *cameras, uint32_t count) {
    pcmvs_calibration *calibration = NULL;
    pcmvs_rig *rig = NULL;
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, cameras, count));
    OK(pcmvs_calibration_new(rig, &calibration));
    /* A calibration outlives its rig. */
    OK(pcmvs_rig_free(rig));
    return calibration;
}

/* Copies the cameras to go on with to memory that the caller frees. */
static pcmvs_camera *cameras_of(const pcmvs_calibration *calibration, uint32_t count) {
    pcmvs_camera *cameras = calloc(count, sizeof *cameras);
    uint32_t i;
    if (cameras == NULL) {
        exit(3);
    }
    for (i = 0; i < count; i++) {
        OK(pcmvs_calibration_get_camera(calibration, i, &cameras[i], sizeof cameras[i]));
        CHECK(cameras[i].struct_size == sizeof cameras[i]);
    }
    return cameras;
}

/* Returns the smallest overlap of a silhouette with the hull. */
static float least_overlap(const struct capture *capture, const pcmvs_camera *cameras) {
    pcmvs_view_report report;
    pcmvs_options options;
    pcmvs_frame *frame = NULL;
    pcmvs_rig *rig = NULL;
    float least = 1;
    uint32_t i;
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, cameras, capture->count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_options_init(&options, sizeof options));
    options.preset = PCMVS_PRESET_HULL;
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, &options));
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_get_view_report(frame, i, &report, sizeof report));
        least = report.silhouette_overlap < least ? report.silhouette_overlap : least;
    }
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    return least;
}

/* The turned camera is named, and the refined cameras fit. */
static void check_results(const struct capture *capture, const pcmvs_calibration *calibration) {
    pcmvs_calibration_report report;
    pcmvs_camera_report camera;
    pcmvs_warning warning;
    pcmvs_camera *cameras;
    uint32_t i, count = 7;
    float before, after;
    OK(pcmvs_calibration_get_report(calibration, &report, sizeof report));
    CHECK(report.verdict == PCMVS_VERDICT_IMPROVED && report.frames == 1 && report.points > 0);
    CHECK(report.refined_held_out_loss < report.held_out_loss && report.exchanged[0] == -1 && report.exchanged[1] == -1);
    CHECK(report.refined_epipolar_bias_px >= 0 && report.refined_epipolar_bias_px < report.epipolar_bias_px);
    OK(pcmvs_calibration_warning_count(calibration, &count));
    CHECK(count == 1);
    OK(pcmvs_calibration_get_warning(calibration, 0, &warning, sizeof warning));
    CHECK(warning.camera == TURNED && strcmp(warning.code, "camera-bumped") == 0 && warning.reserved == 0);
    CHECK(strncmp(warning.message, "camera 4: ", 10) == 0);
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_calibration_get_camera_report(calibration, i, &camera, sizeof camera));
        CHECK(camera.silhouette_overlap > 0.5f && camera.silhouette_overlap < 1);
        CHECK(camera.gain > 0.8f && camera.gain < 1.25f && camera.matches > 0 && camera.match_noise_px > 0);
        CHECK(camera.refined_contour_px >= 0 && camera.refined_contour_px < 0.5f);
        CHECK(camera.sigma_px > 0 && camera.sigma_px < 1);
        CHECK(camera.direction_sigma_px > 0 && camera.roll_sigma_px > 0 && camera.centre_sigma_px > 0);
        CHECK(i == TURNED ? camera.moved_px > 3 : camera.moved_px < 1);
        if (i == TURNED) {
            CHECK(camera.refined_contour_px < camera.contour_px / 4);
            CHECK(camera.refined_epipolar_px < camera.epipolar_px / 2);
        }
    }
    cameras = cameras_of(calibration, capture->count);
    CHECK(memcmp(cameras[TURNED].r, capture->cameras[TURNED].r, sizeof cameras->r) != 0);
    CHECK(memcmp(cameras[TURNED].k, capture->cameras[TURNED].k, sizeof cameras->k) == 0);
    before = least_overlap(capture, capture->cameras);
    after = least_overlap(capture, cameras);
    printf("least overlap %.4f, refined %.4f\n", before, after);
    CHECK(after > before + 0.02f && after > 0.95f);
    free(cameras);
}

/* Other threads, other options, and frames that are added later. */
static void check_options(const struct capture *capture, pcmvs_calibration *calibration) {
    pcmvs_calibration_options options;
    pcmvs_calibration_report report;
    pcmvs_calibration *threaded = made(capture->cameras, capture->count);
    pcmvs_camera *cameras = cameras_of(calibration, capture->count), *again;
    pcmvs_view *views = calloc(capture->count, sizeof *views);
    pcmvs_camera_report camera;
    float loss;
    OK(pcmvs_calibration_options_init(&options, sizeof options));
    options.parallel = backwards;
    OK(pcmvs_calibration_add_frame(threaded, capture->views, capture->count, &options));
    OK(pcmvs_calibration_run(threaded, &options));
    again = cameras_of(threaded, capture->count);
    CHECK(memcmp(cameras, again, capture->count * sizeof *cameras) == 0);
    free(again);
    /* More free parameters give another result. */
    OK(pcmvs_calibration_get_report(threaded, &report, sizeof report));
    loss = report.refined_held_out_loss;
    options.intrinsics = 1;
    OK(pcmvs_calibration_run(threaded, &options));
    OK(pcmvs_calibration_get_report(threaded, &report, sizeof report));
    CHECK(report.refined_held_out_loss != loss);
    /* A second frame discards the results; one of its cameras has no picture. */
    if (views == NULL) {
        exit(3);
    }
    memcpy(views, capture->views, capture->count * sizeof *views);
    OK(pcmvs_view_init(&views[2], sizeof views[2]));
    OK(pcmvs_calibration_add_frame(threaded, views, capture->count, NULL));
    EXPECT(pcmvs_calibration_get_report(threaded, &report, sizeof report), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_calibration_run(threaded, NULL));
    OK(pcmvs_calibration_get_report(threaded, &report, sizeof report));
    CHECK(report.frames == 2 && report.verdict == PCMVS_VERDICT_IMPROVED);
    OK(pcmvs_calibration_free(threaded));
    /* Without any picture of camera 2, nothing of it can be measured. */
    threaded = made(capture->cameras, capture->count);
    OK(pcmvs_calibration_add_frame(threaded, views, capture->count, NULL));
    OK(pcmvs_calibration_run(threaded, NULL));
    OK(pcmvs_calibration_get_camera_report(threaded, 2, &camera, sizeof camera));
    CHECK(camera.silhouette_overlap == -1 && camera.gain == -1 && camera.contour_px == -1 && camera.epipolar_px == -1);
    CHECK(camera.match_noise_px == -1 && camera.matches == 0 && camera.moved_px == 0);
    OK(pcmvs_calibration_free(threaded));
    free(views);
    free(cameras);
}

/* Exchanged pictures are named. Once they are exchanged back, nothing is wrong. `calibration` has corrected the cameras. */
static void check_exchanged(const struct capture *capture, const pcmvs_calibration *calibration) {
    pcmvs_camera *cameras = cameras_of(calibration, capture->count);
    pcmvs_calibration *again = made(cameras, capture->count);
    pcmvs_calibration_report report;
    pcmvs_warning warning;
    pcmvs_view *views = calloc(capture->count, sizeof *views);
    uint32_t count = 7;
    if (views == NULL) {
        exit(3);
    }
    memcpy(views, capture->views, capture->count * sizeof *views);
    views[1] = capture->views[5];
    views[5] = capture->views[1];
    OK(pcmvs_calibration_add_frame(again, views, capture->count, NULL));
    OK(pcmvs_calibration_run(again, NULL));
    OK(pcmvs_calibration_get_report(again, &report, sizeof report));
    CHECK(report.exchanged[0] == 1 && report.exchanged[1] == 5);
    OK(pcmvs_calibration_get_warning(again, 0, &warning, sizeof warning));
    CHECK(strcmp(warning.code, "cameras-swapped") == 0 && warning.camera == 5);
    CHECK(strncmp(warning.message, "cameras 1 and 5: ", 17) == 0);
    OK(pcmvs_calibration_free(again));
    again = made(cameras, capture->count);
    OK(pcmvs_calibration_add_frame(again, capture->views, capture->count, NULL));
    OK(pcmvs_calibration_run(again, NULL));
    OK(pcmvs_calibration_get_report(again, &report, sizeof report));
    OK(pcmvs_calibration_warning_count(again, &count));
    CHECK(report.verdict == PCMVS_VERDICT_KEPT && report.exchanged[0] == -1 && report.exchanged[1] == -1 && count == 0);
    OK(pcmvs_calibration_free(again));
    free(cameras);
    free(views);
}

/* Cancels at one call after another while views are read and while the cameras are refined. The handle stays usable. */
static void check_cancelling(const struct capture *capture, pcmvs_calibration *calibration) {
    pcmvs_calibration *cancelled = made(capture->cameras, capture->count);
    pcmvs_calibration_options options;
    pcmvs_calibration_report report;
    pcmvs_camera *cameras = cameras_of(calibration, capture->count), *again;
    pcmvs_error error;
    struct seen seen = {NULL, 0, 0, 0, 0};
    uint32_t whole, i;
    seen.calibration = cancelled;
    OK(pcmvs_calibration_options_init(&options, sizeof options));
    options.progress = watch;
    options.progress_user = &seen;
    for (i = 1; i <= capture->count + 1; i++) {
        seen.calls = 0;
        seen.cancel_at = i;
        EXPECT(pcmvs_calibration_add_frame(cancelled, capture->views, capture->count, &options), PCMVS_STATUS_CANCELLED);
        CHECK(seen.calls == i && seen.stage == PCMVS_STAGE_VIEWS);
    }
    OK(pcmvs_calibration_error(cancelled, &error, sizeof error));
    CHECK(error.stage == PCMVS_STAGE_VIEWS && error.frame == 0 && error.camera == -1);
    EXPECT(pcmvs_calibration_run(cancelled, NULL), PCMVS_STATUS_WRONG_ORDER);
    seen.calls = seen.cancel_at = 0;
    OK(pcmvs_calibration_add_frame(cancelled, capture->views, capture->count, &options));
    CHECK(seen.done == 1000);
    seen.calls = 0;
    OK(pcmvs_calibration_run(cancelled, &options));
    CHECK(seen.stage == PCMVS_STAGE_DETECT && seen.done == 1000);
    whole = seen.calls;
    for (i = 1; i <= whole; i += 1 + whole / 7) {
        seen.calls = 0;
        seen.cancel_at = i;
        EXPECT(pcmvs_calibration_run(cancelled, &options), PCMVS_STATUS_CANCELLED);
        CHECK(seen.calls == i);
        EXPECT(pcmvs_calibration_get_report(cancelled, &report, sizeof report), PCMVS_STATUS_WRONG_ORDER);
    }
    OK(pcmvs_calibration_run(cancelled, NULL));
    again = cameras_of(cancelled, capture->count);
    CHECK(memcmp(cameras, again, capture->count * sizeof *cameras) == 0);
    OK(pcmvs_calibration_free(cancelled));
    free(cameras);
    free(again);
}

/* Wrong counts, structs and numbers are refused, and change nothing. */
static void check_misuse(const struct capture *capture) {
    pcmvs_calibration *calibration = made(capture->cameras, capture->count);
    struct {
        pcmvs_calibration_options options;
        uint32_t unknown[4];
    } later;
    pcmvs_calibration_options options;
    pcmvs_calibration_report report;
    pcmvs_camera_report camera_report;
    pcmvs_camera camera;
    pcmvs_warning warning;
    pcmvs_error error;
    pcmvs_rig *empty = NULL;
    pcmvs_view *views = calloc(capture->count, sizeof *views);
    pcmvs_image image = *capture->views[3].image;
    uint32_t count = 7;
    if (views == NULL) {
        exit(3);
    }
    EXPECT(pcmvs_frame_hull((pcmvs_frame *)calibration), PCMVS_STATUS_INVALID_HANDLE);
    OK(pcmvs_rig_new(&empty));
    EXPECT(pcmvs_calibration_new(empty, &calibration), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_rig_free(empty));

    /* Results before the run. */
    EXPECT(pcmvs_calibration_run(calibration, NULL), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_calibration_error(calibration, &error, sizeof error));
    CHECK(error.frame == -1 && error.stage == -1 && strstr(error.message, "pcmvs_calibration_add_frame") != NULL);
    EXPECT(pcmvs_calibration_get_report(calibration, &report, sizeof report), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_calibration_error(calibration, &error, sizeof error));
    CHECK(strstr(error.message, "pcmvs_calibration_run") != NULL);
    EXPECT(pcmvs_calibration_get_camera_report(calibration, 0, &camera_report, sizeof camera_report),
           PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_calibration_get_camera(calibration, 0, &camera, sizeof camera), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_calibration_warning_count(calibration, &count), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_calibration_get_warning(calibration, 0, &warning, sizeof warning), PCMVS_STATUS_WRONG_ORDER);
    CHECK(count == 7);

    /* Views. */
    EXPECT(pcmvs_calibration_add_frame(calibration, capture->views, capture->count - 1, NULL),
           PCMVS_STATUS_INVALID_ARGUMENT);
    memcpy(views, capture->views, capture->count * sizeof *views);
    views[5].reserved = 1;
    EXPECT(pcmvs_calibration_add_frame(calibration, views, capture->count, NULL), PCMVS_STATUS_INVALID_STRUCT);
    OK(pcmvs_calibration_add_frame(calibration, capture->views, capture->count, NULL));
    views[5].reserved = 0;
    views[3].image = &image;
    image.width -= 1;
    EXPECT(pcmvs_calibration_add_frame(calibration, views, capture->count, NULL), PCMVS_STATUS_IMAGE);
    OK(pcmvs_calibration_error(calibration, &error, sizeof error));
    CHECK(error.frame == 1 && error.camera == 3 && error.stage == PCMVS_STAGE_VIEWS);
    CHECK(strncmp(error.message, "frame 1: camera 3: ", 19) == 0);
    views[3].image = NULL;
    EXPECT(pcmvs_calibration_add_frame(calibration, views, capture->count, NULL), PCMVS_STATUS_NULL_POINTER);

    /* Options. */
    memset(&options, 0, sizeof options);
    EXPECT(pcmvs_calibration_run(calibration, &options), PCMVS_STATUS_INVALID_STRUCT);
    EXPECT(pcmvs_calibration_options_init(&options, 3), PCMVS_STATUS_INVALID_STRUCT);
    OK(pcmvs_calibration_options_init(&options, sizeof options));
    options.intrinsics = 2;
    EXPECT(pcmvs_calibration_run(calibration, &options), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_calibration_add_frame(calibration, capture->views, capture->count, &options),
           PCMVS_STATUS_INVALID_ARGUMENT);
    memset(&later, 0, sizeof later);
    OK(pcmvs_calibration_options_init(&later.options, sizeof later));
    later.unknown[3] = 1;
    EXPECT(pcmvs_calibration_run(calibration, &later.options), PCMVS_STATUS_INVALID_STRUCT);
    later.unknown[3] = 0;
    OK(pcmvs_calibration_run(calibration, &later.options));

    /* Reading. The frames that were refused have not been added. */
    OK(pcmvs_calibration_get_report(calibration, &report, sizeof report));
    CHECK(report.frames == 1);
    EXPECT(pcmvs_calibration_get_report(calibration, &report, 8), PCMVS_STATUS_INVALID_STRUCT);
    EXPECT(pcmvs_calibration_get_camera(calibration, capture->count, &camera, sizeof camera),
           PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_calibration_get_camera(calibration, 1, &camera, 8), PCMVS_STATUS_INVALID_STRUCT);
    OK(pcmvs_calibration_error(calibration, &error, sizeof error));
    CHECK(error.camera == 1 && error.frame == -1);
    EXPECT(pcmvs_calibration_get_camera_report(calibration, capture->count, &camera_report, sizeof camera_report),
           PCMVS_STATUS_INVALID_ARGUMENT);
    OK(pcmvs_calibration_warning_count(calibration, &count));
    EXPECT(pcmvs_calibration_get_warning(calibration, count, &warning, sizeof warning), PCMVS_STATUS_INVALID_ARGUMENT);
    OK(pcmvs_calibration_free(calibration));
    free(views);
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_calibration *calibration;
    if (argc != 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    calibration = made(capture.cameras, capture.count);
    OK(pcmvs_calibration_add_frame(calibration, capture.views, capture.count, NULL));
    OK(pcmvs_calibration_run(calibration, NULL));
    check_results(&capture, calibration);
    check_options(&capture, calibration);
    check_exchanged(&capture, calibration);
    check_cancelling(&capture, calibration);
    check_misuse(&capture);
    OK(pcmvs_calibration_free(calibration));
    capture_free(&capture);
    return verdict();
}
