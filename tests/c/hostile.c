/* Calls functions in a random order with random arguments, the same for a given seed. No call may crash, panic or write a
 * number that is none. Usage: hostile FOLDER SEED CALLS (see capture.h) */
#include "capture.h"
#include "check.h"

#include <math.h>
#include <string.h>

#define RIGS 2
#define FRAMES 3

static uint64_t state;

static uint32_t draw(uint32_t below) {
    uint64_t x;
    state = state * 6364136223846793005u + 1442695040888963407u;
    x = state ^ state >> 33;
    x *= 0xff51afd7ed558ccdu;
    return (uint32_t)((x ^ x >> 33) >> 32) % below;
}

/* A number that a file may hold by mistake. */
static double extreme(void) {
    static const double numbers[] = {0,    1e-300, 1e-30, 1e-6, 1e-3, 0.1,   0.5,  -1,   2,        10,
                                     1e2,  1e3,    1e5,   1e9,  1e19, 1e38,  1e39, 1e300, HUGE_VAL, -HUGE_VAL};
    const uint32_t i = draw(sizeof numbers / sizeof *numbers + 1);
    return i == sizeof numbers / sizeof *numbers ? (double)NAN : numbers[i];
}

static struct capture capture;
static pcmvs_rig *rigs[RIGS];
static pcmvs_frame *frames[FRAMES];
static pcmvs_frame *stale; /* a frame that has been freed */
static pcmvs_calibration *calibration;
static pcmvs_frame *busy; /* the frame whose progress is reported */
static int cancel_after;
static uint64_t calls[PCMVS_STATUS_OTHER + 1];

/* Counts a status. None may be that of a bug. */
static pcmvs_status counted(int line, pcmvs_status status) {
    if (status >= PCMVS_STATUS_OTHER || status == PCMVS_STATUS_PANIC) {
        pcmvs_error error;
        printf("line %d: status %u\n", line, (unsigned)status);
        if (busy != NULL && pcmvs_frame_error(busy, &error, sizeof error) == PCMVS_STATUS_OK) {
            printf("%s\n", error.message);
        }
        failures++;
    } else {
        calls[status]++;
    }
    return status;
}

#define TRY(call) counted(__LINE__, call)

/* Calls back into the frame that is at work: what excludes the running call is busy. */
static int progress(void *user, uint32_t stage, uint32_t done, uint32_t total) {
    pcmvs_error error;
    (void)user;
    CHECK(stage <= PCMVS_STAGE_STEADY && done <= total);
    if (draw(8) == 0) {
        EXPECT(pcmvs_frame_hull(busy), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_frame_begin(busy, NULL), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_frame_free(busy), PCMVS_STATUS_BUSY);
        OK(pcmvs_frame_error(busy, &error, sizeof error));
        CHECK(error.status == PCMVS_STATUS_BUSY);
    }
    return cancel_after-- == 0;
}

/* Runs jobs badly: some twice, some never, some that do not exist. */
static void parallel(void *user, uint32_t count, pcmvs_job_fn run, void *job) {
    static pcmvs_job_fn last_run;
    static void *last_job;
    uint32_t i;
    (void)user;
    if (last_run != NULL) {
        last_run(last_job, 0); /* a job of a batch that is over */
    }
    last_run = run, last_job = job;
    for (i = draw(count + 1); i > 0; i--) {
        run(job, draw(count + 3));
    }
}

static void draw_options(pcmvs_options *options) {
    OK(pcmvs_options_init(options, sizeof *options));
    options->preset = draw(16) == 0 ? draw(100) : draw(4);
    options->frame = draw(1000);
    options->voxel_pixels = draw(4) == 0 ? (float)extreme() : 0;
    options->max_memory = draw(3) == 0 ? (uint64_t)1 << draw(64) : 0;
    options->progress = draw(2) == 0 ? progress : NULL;
    options->parallel = draw(4) == 0 ? parallel : NULL;
    cancel_after = draw(4) == 0 ? (int)draw(40) : -1;
    if (draw(40) == 0) {
        options->struct_size = draw(200);
    }
}

/* Spoils some of a view. Pointers stay valid for what the pictures say. */
static pcmvs_view draw_view(uint32_t camera, pcmvs_image pictures[2]) {
    static unsigned char spare[64 * 64 * 4];
    pcmvs_view view = capture.views[camera];
    uint32_t i;
    if (draw(4) != 0) {
        return view;
    }
    pictures[0] = *view.image, pictures[1] = *view.mask;
    for (i = 0; i < 2; i++) {
        pcmvs_image *picture = &pictures[i];
        switch (draw(8)) {
        case 0: picture->width = draw(2) == 0 ? draw(100) : 0xFFFFFFFFu - draw(2); break;
        case 1: picture->height = draw(2) == 0 ? draw(100) : 0x80000000u + draw(2); break;
        case 2: picture->data = NULL; break;
        case 3: /* bottom up */
            picture->stride = -(ptrdiff_t)(picture->width * (i == 0 ? 3 : 1));
            picture->data = (const char *)picture->data - picture->stride * (ptrdiff_t)(picture->height - 1);
            break;
        case 4: /* any format */
            picture->format = draw(9);
            picture->data = spare, picture->chroma = draw(3) == 0 ? NULL : spare;
            break;
        case 5: picture->struct_size = draw(2) == 0 ? 0xFFFFFFFFu : draw(sizeof *picture + 1); break;
        default: break;
        }
    }
    view.image = draw(16) == 0 ? NULL : &pictures[0];
    view.mask = draw(16) == 0 ? NULL : &pictures[1];
    if (draw(16) == 0) {
        view.clean_plate = &pictures[0], view.mask = draw(2) == 0 ? NULL : view.mask;
    }
    if (draw(32) == 0) {
        view.reserved = 1;
    }
    return view;
}

static void set_cameras(void) {
    pcmvs_camera cameras[16];
    const uint32_t count = capture.count;
    uint32_t i, changes = draw(3);
    memcpy(cameras, capture.cameras, count * sizeof *cameras);
    for (i = 0; i < changes; i++) {
        pcmvs_camera *camera = &cameras[draw(count)];
        switch (draw(8)) {
        case 0: camera->k[draw(9)] = extreme(); break;
        case 1: camera->k[4 * draw(2)] *= extreme(); break;
        case 2: camera->t[draw(3)] *= extreme(); break;
        case 3: camera->distortion[draw(5)] = extreme(); break;
        case 4: camera->width = draw(2) == 0 ? 0xFFFFFFFFu : draw(100000); break;
        case 5: camera->r[draw(9)] *= extreme(); break;
        case 6: camera->reserved = draw(2); break;
        default: memcpy(camera, &cameras[draw(count)], sizeof *camera); break;
        }
    }
    TRY(pcmvs_rig_set_cameras(rigs[draw(RIGS)], draw(20) == 0 ? NULL : cameras,
                              draw(10) == 0 ? (size_t)draw(3) : count));
}

/* Sum over the edges of triangles of a number that mixes both ends; an edge that runs the other way has the opposite sign. It
 * is 0 if every edge has a neighbour that runs the other way, and hardly ever otherwise. */
static uint64_t open_edges(const uint32_t *triangles, uint32_t count) {
    uint64_t sum = 0;
    uint32_t i, k;
    for (i = 0; i < count; i++) {
        for (k = 0; k < 3; k++) {
            const uint64_t a = triangles[3 * i + k], b = triangles[3 * i + (k + 1) % 3];
            uint64_t edge = a < b ? b << 32 | a : a << 32 | b;
            edge = (edge ^ edge >> 29) * 0x9E3779B97F4A7C15u;
            edge = (edge ^ edge >> 32) * 0xBF58476D1CE4E5B9u;
            edge ^= edge >> 31;
            sum += a < b ? edge : 0 - edge;
        }
    }
    return sum;
}

/* A result is closed, and its numbers are finite. */
static void check_mesh(pcmvs_frame *frame) {
    pcmvs_mesh mesh;
    uint32_t i;
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    CHECK(mesh.triangle_count > 0 && mesh.colours != NULL);
    for (i = 0; i < 3 * mesh.vertex_count; i++) {
        if (!(fabsf(mesh.positions[i]) < 1e30f && fabsf(mesh.normals[i]) < 1.01f)) {
            printf("vertex %u is no number\n", (unsigned)(i / 3));
            failures++;
            return;
        }
    }
    for (i = 0; i < mesh.triangle_count; i++) {
        const uint32_t *t = mesh.triangles + 3 * i;
        CHECK(t[0] < mesh.vertex_count && t[1] < mesh.vertex_count && t[2] < mesh.vertex_count);
        CHECK(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    }
    CHECK(open_edges(mesh.triangles, mesh.triangle_count) == 0);
    CHECK(open_edges(mesh.triangles, mesh.triangle_count - 1) != 0);
}

static void reconstruct(pcmvs_frame *frame) {
    pcmvs_image pictures[32];
    pcmvs_view views[16];
    pcmvs_options options;
    pcmvs_mesh mesh;
    uint32_t i;
    pcmvs_status status;
    draw_options(&options);
    for (i = 0; i < capture.count; i++) {
        views[i] = draw_view(i, pictures + 2 * i);
    }
    status = TRY(pcmvs_frame_reconstruct(frame, draw(50) == 0 ? NULL : views, draw(50) == 0 ? 3 : capture.count,
                                         draw(8) == 0 ? NULL : &options));
    if (status == PCMVS_STATUS_OK) {
        check_mesh(frame);
    } else {
        EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
    }
}

static int swallow(void *user, const void *data, size_t size) {
    (void)user, (void)data, (void)size;
    return draw(10) == 0;
}

static void read_results(pcmvs_frame *frame) {
    static float buffer[3 * 4096];
    pcmvs_silhouette silhouette;
    pcmvs_counts counts;
    pcmvs_stage_report stage;
    pcmvs_view_report view;
    pcmvs_warning warning;
    pcmvs_error error;
    struct {
        pcmvs_mesh mesh;
        char later[64]; /* members of a later version */
    } room;
    size_t count;
    uint32_t warnings = 0;
    TRY(pcmvs_frame_get_mesh(frame, draw(5), &room.mesh, draw(9) == 0 ? draw(sizeof room + 1) : sizeof room.mesh));
    TRY(pcmvs_frame_copy_mesh(frame, draw(5), draw(6), buffer, draw(4096), draw(2) * 12, &count));
    TRY(pcmvs_frame_copy_cloud(frame, draw(5), draw(6), (pcmvs_point *)(void *)buffer, draw(1024), 0, &count));
    TRY(pcmvs_frame_get_silhouette(frame, draw(6), &silhouette, sizeof silhouette));
    TRY(pcmvs_frame_get_counts(frame, &counts, sizeof counts));
    TRY(pcmvs_frame_get_stage_report(frame, draw(10), &stage, sizeof stage));
    TRY(pcmvs_frame_get_view_report(frame, draw(6), &view, sizeof view));
    TRY(pcmvs_frame_copy_gains(frame, buffer, draw(20), 0, &count));
    TRY(pcmvs_frame_warning_count(frame, &warnings));
    TRY(pcmvs_frame_get_warning(frame, draw(warnings + 2), &warning, sizeof warning));
    TRY(pcmvs_frame_export_mesh(frame, draw(5), NULL, swallow, NULL));
    TRY(pcmvs_frame_export_cloud(frame, draw(5), draw(6), swallow, NULL));
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(memchr(error.message, 0, sizeof error.message) != NULL);
}

static void average(pcmvs_frame *frame) {
    const pcmvs_frame *neighbours[2];
    neighbours[0] = frames[draw(FRAMES)];
    neighbours[1] = draw(3) == 0 ? NULL : frames[draw(FRAMES)];
    TRY(pcmvs_frame_steady(frame, neighbours, draw(3)));
}

/* Functions in the place of meshoptimizer's. They write only where they may, and return any number. */

static size_t any_size(size_t bound) {
    switch (draw(4)) {
    case 0: return 0;
    case 1: return bound + draw(3);
    case 2: return (size_t)-1 - draw(3);
    default: return draw((uint32_t)bound + 1);
    }
}

static void any_order(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    memcpy(destination, indices, index_count * sizeof *indices);
    if (draw(3) == 0) {
        destination[draw((uint32_t)index_count)] = draw(0xFFFFFFFF);
    }
    if (draw(3) == 0) {
        destination[draw((uint32_t)index_count)] = draw((uint32_t)vertex_count);
    }
}

static size_t any_places(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    size_t i;
    (void)indices, (void)index_count;
    for (i = 0; i < vertex_count; i++) {
        destination[i] = (unsigned int)i;
    }
    if (draw(2) == 0) {
        destination[draw((uint32_t)vertex_count)] = draw(2) == 0 ? draw((uint32_t)vertex_count) : 0xFFFFFFFFu - draw(2);
    }
    return any_size(vertex_count);
}

static size_t any_bound(size_t count, size_t of) {
    return draw(8) == 0 ? any_size(count * of) : 16 * count + 64;
}

static size_t any_triangles(unsigned char *buffer, size_t size, const unsigned int *indices, size_t count) {
    (void)indices, (void)count;
    memset(buffer, draw(3) == 0 ? (int)draw(256) : 0xE1, size);
    return draw(3) == 0 ? any_size(size) : size;
}

static size_t any_vertices(unsigned char *buffer, size_t size, const void *vertices, size_t count, size_t of, int level,
                           int version) {
    (void)vertices, (void)count, (void)of;
    CHECK(level == 2 && version == 0);
    memset(buffer, draw(6) == 0 ? (int)draw(256) : 0xA0, size);
    return draw(6) == 0 ? any_size(size) : size;
}

static void draw_functions(pcmvs_export_options *options) {
    options->meshopt_optimizeVertexCacheStrip = draw(20) == 0 ? NULL : any_order;
    options->meshopt_optimizeVertexFetchRemap = draw(20) == 0 ? NULL : any_places;
    options->meshopt_encodeVertexBufferBound = draw(20) == 0 ? NULL : any_bound;
    options->meshopt_encodeVertexBufferLevel = draw(20) == 0 ? NULL : any_vertices;
    options->meshopt_encodeIndexBufferBound = draw(20) == 0 ? NULL : any_bound;
    options->meshopt_encodeIndexBuffer = draw(20) == 0 ? NULL : any_triangles;
}

static void make_form(pcmvs_frame *frame) {
    pcmvs_form_options form;
    pcmvs_export_options file;
    pcmvs_texture texture;
    OK(pcmvs_form_options_init(&form, sizeof form));
    form.faces = draw(3) == 0 ? draw(0xFFFFFFFF) : draw(2000);
    form.texture = draw(3);
    form.texture_size = draw(3) == 0 ? draw(0xFFFFFFFF) : draw(1000);
    TRY(pcmvs_frame_form(frame, &form));
    TRY(pcmvs_frame_get_texture(frame, &texture, sizeof texture));
    OK(pcmvs_export_options_init(&file, sizeof file));
    file.format = draw(3);
    file.has_up = draw(3);
    file.up[draw(3)] = extreme();
    file.upright = draw(3);
    file.compact = draw(3);
    file.jpeg_quality = draw(110);
    TRY(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &file, swallow, NULL));
    OK(pcmvs_export_options_init(&file, sizeof file));
    file.compact = draw(2);
    draw_functions(&file);
    TRY(pcmvs_frame_export_mesh(frame, draw(5), &file, swallow, NULL));
}

static void calibrate(void) {
    pcmvs_calibration_report report;
    pcmvs_camera_report of_camera;
    pcmvs_camera camera;
    pcmvs_calibration_options options;
    OK(pcmvs_calibration_options_init(&options, sizeof options));
    options.parallel = draw(3) == 0 ? parallel : NULL;
    TRY(pcmvs_calibration_add_frame(calibration, capture.views, capture.count, &options));
    TRY(pcmvs_calibration_run(calibration, &options));
    TRY(pcmvs_calibration_get_report(calibration, &report, sizeof report));
    TRY(pcmvs_calibration_get_camera_report(calibration, draw(6), &of_camera, sizeof of_camera));
    TRY(pcmvs_calibration_get_camera(calibration, draw(6), &camera, sizeof camera));
    TRY(pcmvs_calibration_free(calibration));
    calibration = NULL;
    TRY(pcmvs_calibration_new(rigs[draw(RIGS)], &calibration));
}

static void one_call(void) {
    const uint32_t place = draw(FRAMES);
    pcmvs_frame *frame = frames[place];
    pcmvs_image pictures[2];
    pcmvs_options options;
    pcmvs_view view;
    uint32_t camera = draw(capture.count + 1);
    float gains[48];
    uint32_t i;
    busy = frame;
    switch (draw(22)) {
    case 0: set_cameras(); break;
    case 1: reconstruct(frame); break;
    case 2:
        draw_options(&options);
        TRY(pcmvs_frame_begin(frame, &options));
        break;
    case 3: case 4: case 5: case 6:
        view = draw_view(camera % capture.count, pictures);
        TRY(pcmvs_frame_view(frame, camera, draw(60) == 0 ? NULL : &view));
        break;
    case 7: TRY(pcmvs_frame_step(frame, draw(10))); break;
    case 8: TRY(pcmvs_frame_hull(frame)); break;
    case 9: TRY(pcmvs_frame_coarse(frame)); break;
    case 10: case 11: TRY(pcmvs_frame_detect(frame, camera)); break;
    case 12: TRY(pcmvs_frame_merge(frame)); break;
    case 13: TRY(pcmvs_frame_colour(frame)); break;
    case 14: read_results(frame); break;
    case 15: /* every camera has its view */
        TRY(pcmvs_frame_begin(frame, NULL));
        for (i = 0; i < capture.count; i++) {
            TRY(pcmvs_frame_view(frame, i, &capture.views[i]));
        }
        break;
    case 16: /* a new handle for a rig that may have other cameras now */
        if (stale != NULL) {
            EXPECT(pcmvs_frame_hull(stale), PCMVS_STATUS_INVALID_HANDLE);
            EXPECT(pcmvs_frame_free(stale), PCMVS_STATUS_INVALID_HANDLE);
        }
        if (pcmvs_frame_new(rigs[draw(RIGS)], &frames[place]) == PCMVS_STATUS_OK) {
            OK(pcmvs_frame_free(frame));
            stale = frame;
        }
        break;
    case 17:
        EXPECT(pcmvs_frame_mesh((pcmvs_frame *)(void *)rigs[0]), PCMVS_STATUS_INVALID_HANDLE);
        EXPECT(pcmvs_frame_mesh((pcmvs_frame *)(uintptr_t)(1 + draw(100000))), PCMVS_STATUS_INVALID_HANDLE);
        EXPECT(pcmvs_rig_free((pcmvs_rig *)(void *)&options), PCMVS_STATUS_INVALID_HANDLE);
        break;
    case 18:
        for (i = 0; i < 3 * capture.count; i++) {
            gains[i] = draw(4) == 0 ? (float)extreme() : 1;
        }
        TRY(pcmvs_rig_set_gains(rigs[draw(RIGS)], gains, capture.count));
        break;
    case 19: make_form(frame); break;
    case 20: average(frame); break;
    default:
        if (draw(4) == 0) {
            calibrate();
        }
        break;
    }
}

int main(int argc, char **argv) {
    int i, count;
    if (argc != 4 || !capture_read(argv[1], &capture) || capture.count > 16) {
        return 2;
    }
    state = (uint64_t)strtoul(argv[2], NULL, 10);
    count = (int)strtol(argv[3], NULL, 10);
    for (i = 0; i < RIGS; i++) {
        OK(pcmvs_rig_new(&rigs[i]));
        OK(pcmvs_rig_set_cameras(rigs[i], capture.cameras, capture.count));
    }
    for (i = 0; i < FRAMES; i++) {
        OK(pcmvs_frame_new(rigs[0], &frames[i]));
    }
    OK(pcmvs_calibration_new(rigs[0], &calibration));
    for (i = 0; i < count && failures == 0; i++) {
        one_call();
        if (failures > 0) {
            printf("seed %s, call %d\n", argv[2], i);
        }
    }
    for (i = 0; i < FRAMES; i++) {
        OK(pcmvs_frame_free(frames[i]));
    }
    for (i = 0; i < RIGS; i++) {
        OK(pcmvs_rig_free(rigs[i]));
    }
    OK(pcmvs_calibration_free(calibration));
    for (i = 0; i < PCMVS_STATUS_OTHER; i++) {
        printf("%s: %lu\n", pcmvs_status_name((uint32_t)i), (unsigned long)calls[i]);
    }
    capture_free(&capture);
    return verdict();
}
