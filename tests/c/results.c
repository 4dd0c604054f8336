/* Checks results of frames in every way in which they can be made. Usage: results FOLDER (see capture.h) */
#include "capture.h"
#include "files.h"

/* Refuses a file. While the export runs, the frame can be read but not changed. */
static int refuse(void *user, const void *data, size_t size) {
    pcmvs_frame *frame = user;
    size_t count = 0;
    CHECK(data != NULL && size > 0);
    OK(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_POSITION, NULL, 0, 0, &count));
    CHECK(count > 0);
    EXPECT(pcmvs_frame_colour(frame), PCMVS_STATUS_BUSY);
    EXPECT(pcmvs_frame_free(frame), PCMVS_STATUS_BUSY);
    return 1;
}

/* A progress sink that checks the order of the calls and cancels at one of them. `place` is the stage's in the order. */
struct sink {
    pcmvs_frame *frame;
    uint32_t calls, cancel_at;
    uint32_t stage, place, done;
};

static int follow(void *user, uint32_t stage, uint32_t done, uint32_t total) {
    struct sink *sink = user;
    uint32_t place = 0;
    while (place < pcmvs_stage_count() && pcmvs_stage_at(place) != stage) {
        place++;
    }
    CHECK(place < pcmvs_stage_count() && done <= total && total > 0);
    CHECK(place > sink->place || (place == sink->place && done >= sink->done));
    sink->stage = stage;
    sink->place = place;
    sink->done = done;
    if (sink->calls == 0) {
        pcmvs_error error;
        size_t count;
        EXPECT(pcmvs_frame_hull(sink->frame), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_frame_step(sink->frame, PCMVS_STAGE_HULL), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_frame_detect(sink->frame, 0), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_frame_free(sink->frame), PCMVS_STATUS_BUSY);
        EXPECT(pcmvs_frame_copy_mesh(sink->frame, 0, 0, NULL, 0, 0, &count), PCMVS_STATUS_BUSY);
        OK(pcmvs_frame_error(sink->frame, &error, sizeof error));
        CHECK(error.status == PCMVS_STATUS_BUSY);
    }
    sink->calls += 1;
    return sink->calls == sink->cancel_at;
}

/* The call at which to cancel after call k: the next one, or with FEW_CALLS a later one, but always the last two. */
static uint32_t next(uint32_t k, uint32_t total) {
#ifdef FEW_CALLS
    const uint32_t wide = k + 1 + k / 8;
    return wide < total - 1 ? wide : k + 1;
#else
    (void)total;
    return k + 1;
#endif
}

static void check_cancel(const struct capture *capture, pcmvs_frame *frame, const struct bytes *expected) {
    pcmvs_options options;
    struct sink sink = {frame, 0, 0, 0, 0, 0};
    struct bytes bytes;
    uint32_t total, k;
    pcmvs_options_init(&options, sizeof options);
    options.progress = follow;
    options.progress_user = &sink;
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, &options));
    CHECK(sink.stage == PCMVS_STAGE_COLOUR && sink.done == 1000);
    total = sink.calls;
    CHECK(total > 20);
    for (k = 1; k <= total; k = next(k, total)) {
        pcmvs_error error;
        size_t count = 7;
        memset(&sink, 0, sizeof sink);
        sink.frame = frame;
        sink.cancel_at = k;
        EXPECT(pcmvs_frame_reconstruct(frame, capture->views, capture->count, &options), PCMVS_STATUS_CANCELLED);
        CHECK(sink.calls == k);
        OK(pcmvs_frame_error(frame, &error, sizeof error));
        CHECK(error.status == PCMVS_STATUS_CANCELLED && error.stage == (int32_t)sink.stage);
        EXPECT(pcmvs_frame_copy_mesh(frame, 0, 0, NULL, 0, 0, &count), PCMVS_STATUS_WRONG_ORDER);
        CHECK(count == 7);
    }
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, NULL));
    bytes = glb(frame);
    CHECK(same(&bytes, expected));
    free(bytes.data);
    printf("cancelled at calls 1 to %u\n", total);
}

/* Runs the jobs backwards, leaves one out and runs another twice. */
static void backwards(void *user, uint32_t count, pcmvs_job_fn run, void *job) {
    uint32_t i;
    (void)user;
    for (i = count; i-- > 1;) {
        run(job, i);
    }
    run(job, count - 1);
}

static void check_stages(const struct capture *capture, pcmvs_frame *frame, const struct bytes *expected) {
    pcmvs_options options;
    struct bytes bytes;
    uint32_t i;
    pcmvs_options_init(&options, sizeof options);
    options.parallel = backwards;
    OK(pcmvs_frame_begin(frame, &options));
    for (i = capture->count; i-- > 0;) {
        OK(pcmvs_frame_view(frame, i, &capture->views[i]));
    }
    OK(pcmvs_frame_hull(frame));
    OK(pcmvs_frame_contours(frame));
    OK(pcmvs_frame_coarse(frame));
    for (i = capture->count; i-- > 0;) {
        OK(pcmvs_frame_detect(frame, i));
    }
    OK(pcmvs_frame_merge(frame));
    EXPECT(pcmvs_frame_detect(frame, 0), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_mesh(frame));
    OK(pcmvs_frame_mesh(frame)); /* a stage can run again */
    OK(pcmvs_frame_colour(frame));
    bytes = glb(frame);
    CHECK(same(&bytes, expected));
    free(bytes.data);
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, &options));
    bytes = glb(frame);
    CHECK(same(&bytes, expected));
    free(bytes.data);
}

/* Checks that a frame has the same result as `expected`, and the same hash of every stage. */
static void check_same(const pcmvs_frame *frame, const struct bytes *expected, const uint64_t *hashes) {
    struct bytes bytes = glb(frame);
    uint32_t i;
    CHECK(same(&bytes, expected));
    free(bytes.data);
    for (i = 0; i < pcmvs_stage_count(); i++) {
        pcmvs_stage_report report;
        OK(pcmvs_frame_get_stage_report(frame, pcmvs_stage_at(i), &report, sizeof report));
        CHECK(report.hash == hashes[i]);
    }
}

static void begin_with_views(const struct capture *capture, pcmvs_frame *frame) {
    uint32_t i;
    OK(pcmvs_frame_begin(frame, NULL));
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_view(frame, i, &capture->views[i]));
    }
}

/* A function runs the stages before its own that have not run. A host therefore gets the same result if it does not know
 * some stages. */
static void check_left_out_stages(const struct capture *capture, pcmvs_frame *frame, const struct bytes *expected) {
    uint64_t hashes[64];
    pcmvs_stage_report report;
    pcmvs_silhouette silhouette;
    size_t count;
    uint32_t i;
    CHECK(pcmvs_stage_count() <= 64 && pcmvs_stage_at(pcmvs_stage_count()) == PCMVS_NO_STAGE);
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, NULL));
    for (i = 0; i < pcmvs_stage_count(); i++) {
        OK(pcmvs_frame_get_stage_report(frame, pcmvs_stage_at(i), &report, sizeof report));
        hashes[i] = report.hash;
    }

    /* One call after the views. */
    begin_with_views(capture, frame);
    OK(pcmvs_frame_colour(frame));
    check_same(frame, expected, hashes);

    /* Detection on the host's threads, and no other function but the last one. */
    begin_with_views(capture, frame);
    EXPECT(pcmvs_frame_detect(frame, 0), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_coarse(frame));
    OK(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_CONTOURS, &report, sizeof report));
    OK(pcmvs_frame_detect(frame, 1)); /* the other views are detected by the next call */
    OK(pcmvs_frame_mesh(frame));
    EXPECT(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_COLOUR, &report, sizeof report), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_colour(frame));
    check_same(frame, expected, hashes);

    /* Every stage by its number. */
    begin_with_views(capture, frame);
    for (i = 0; i < pcmvs_stage_count(); i++) {
        EXPECT(pcmvs_frame_get_stage_report(frame, pcmvs_stage_at(i), &report, sizeof report), PCMVS_STATUS_WRONG_ORDER);
        OK(pcmvs_frame_step(frame, pcmvs_stage_at(i)));
        OK(pcmvs_frame_get_stage_report(frame, pcmvs_stage_at(i), &report, sizeof report));
        CHECK(report.hash == hashes[i]);
    }
    check_same(frame, expected, hashes);

    /* Running a stage again discards the stages after it. */
    OK(pcmvs_frame_step(frame, PCMVS_STAGE_VIEWS));
    OK(pcmvs_frame_get_silhouette(frame, 0, &silhouette, sizeof silhouette));
    EXPECT(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_HULL, PCMVS_ATTRIBUTE_POSITION, NULL, 0, 0, &count),
           PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_step(frame, PCMVS_STAGE_COLOUR));
    check_same(frame, expected, hashes);
}

/* The same pictures in another format give the same bytes. */
static void check_formats(const struct capture *capture, pcmvs_frame *frame, const struct bytes *expected) {
    uint32_t n = capture->count, i, x, y;
    uint32_t width = capture->pictures[0].width, height = capture->pictures[0].height;
    size_t stride = 4 * (size_t)width + 12, mask_stride = 2 * (size_t)width + 6;
    unsigned char *pixels = malloc(n * stride * height);
    unsigned char *masks = malloc(n * mask_stride * height);
    pcmvs_image *images = calloc(2 * (size_t)n, sizeof *images);
    pcmvs_view *views = calloc(n, sizeof *views);
    struct bytes bytes;
    if (pixels == NULL || masks == NULL || images == NULL || views == NULL) {
        exit(3);
    }
    for (i = 0; i < n; i++) {
        const unsigned char *rgb = capture->pictures[i].data, *mask = capture->pictures[n + i].data;
        unsigned char *bgra = pixels + i * stride * height, *gray16 = masks + i * mask_stride * height;
        for (y = 0; y < height; y++) {
            for (x = 0; x < width; x++) {
                const unsigned char *from = rgb + 3 * ((size_t)y * width + x);
                /* Rows are stored from the bottom up. */
                unsigned char *to = bgra + (height - 1 - y) * stride + 4 * (size_t)x;
                uint16_t wide = (uint16_t)(mask[(size_t)y * width + x] * 257);
                to[0] = from[2], to[1] = from[1], to[2] = from[0], to[3] = (unsigned char)x;
                memcpy(gray16 + y * mask_stride + 2 * (size_t)x, &wide, 2);
            }
        }
        images[i] = capture->pictures[i];
        images[i].format = PCMVS_PIXEL_FORMAT_BGRA8;
        images[i].data = bgra + (height - 1) * stride;
        images[i].stride = -(ptrdiff_t)stride;
        images[n + i] = capture->pictures[n + i];
        images[n + i].format = PCMVS_PIXEL_FORMAT_GRAY16;
        images[n + i].data = gray16;
        images[n + i].stride = (ptrdiff_t)mask_stride;
        views[i] = capture->views[i];
        views[i].image = &images[i];
        views[i].mask = &images[n + i];
    }
    OK(pcmvs_frame_reconstruct(frame, views, n, NULL));
    bytes = glb(frame);
    CHECK(same(&bytes, expected));
    free(bytes.data);
    free(pixels);
    free(masks);
    free(images);
    free(views);
}

/* A buffer belongs to the caller again once `pcmvs_frame_view` has returned: one for all cameras is enough. */
static void check_buffers(const struct capture *capture, pcmvs_frame *frame, const struct bytes *expected) {
    uint32_t n = capture->count, i;
    size_t pixels = (size_t)capture->pictures[0].width * capture->pictures[0].height;
    unsigned char *buffer = malloc(4 * pixels);
    struct bytes bytes;
    if (buffer == NULL) {
        exit(3);
    }
    OK(pcmvs_frame_begin(frame, NULL));
    for (i = 0; i < n; i++) {
        pcmvs_image picture = capture->pictures[i], mask = capture->pictures[n + i];
        pcmvs_view view = capture->views[i];
        memcpy(buffer, picture.data, 3 * pixels);
        memcpy(buffer + 3 * pixels, mask.data, pixels);
        picture.data = buffer;
        mask.data = buffer + 3 * pixels;
        view.image = &picture;
        view.mask = &mask;
        OK(pcmvs_frame_view(frame, i, &view));
        memset(buffer, 0x55, 4 * pixels);
    }
    OK(pcmvs_frame_step(frame, PCMVS_STAGE_COLOUR));
    bytes = glb(frame);
    CHECK(same(&bytes, expected));
    free(bytes.data);
    free(buffer);
}

static void check_outputs(const struct capture *capture, const pcmvs_rig *rig, pcmvs_frame *frame) {
    struct vertex {
        float position[3];
        unsigned char colour[3], alpha;
        float normal[3];
    } *vertices;
    pcmvs_mesh mesh, hull;
    pcmvs_counts counts;
    pcmvs_stage_report stage;
    pcmvs_view_report view;
    pcmvs_silhouette silhouette;
    pcmvs_export_options options;
    pcmvs_point *points;
    struct bytes bytes = {NULL, 0, 0};
    uint32_t (*triangles)[3];
    double origin[3];
    size_t count = 0, size = 0, i, k, detected = 0;
    uint32_t warnings = 7;
    float *gains;
    char *buffer;

    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_HULL, &hull, sizeof hull));
    CHECK(mesh.vertex_count > 100 && mesh.colours != NULL && hull.vertex_count > 100 && hull.colours == NULL);
    OK(pcmvs_rig_origin(rig, origin));
    CHECK(memcmp(origin, mesh.origin, sizeof origin) == 0);

    OK(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_POSITION, NULL, 0, 0, &count));
    CHECK(count == mesh.vertex_count);
    vertices = malloc(count * sizeof *vertices);
    triangles = malloc(mesh.triangle_count * sizeof *triangles);
    if (vertices == NULL || triangles == NULL) {
        exit(3);
    }
    memset(vertices, 0xAB, count * sizeof *vertices);
    OK(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_POSITION, vertices[0].position, count, sizeof *vertices, NULL));
    OK(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_NORMAL, vertices[0].normal, count, sizeof *vertices, NULL));
    OK(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_COLOUR, vertices[0].colour, count, sizeof *vertices, NULL));
    for (i = 0; i < count; i++) {
        int k;
        for (k = 0; k < 3; k++) {
            CHECK(vertices[i].position[k] == (float)(mesh.origin[k] + mesh.positions[3 * i + k]));
            CHECK(vertices[i].normal[k] == mesh.normals[3 * i + k]);
            CHECK(vertices[i].colour[k] == mesh.colours[3 * i + k]);
        }
        CHECK(vertices[i].alpha == 0xAB);
    }
    count = 7;
    EXPECT(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_POSITION, vertices, mesh.vertex_count - 1, 0, &count),
           PCMVS_STATUS_BUFFER_TOO_SMALL);
    EXPECT(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_POSITION, vertices, mesh.vertex_count, 11, &count),
           PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_frame_copy_mesh(frame, 0, 99, vertices, mesh.vertex_count, 0, &count), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_HULL, PCMVS_ATTRIBUTE_COLOUR, NULL, 0, 0, &count),
           PCMVS_STATUS_WRONG_ORDER);
    CHECK(count == 7);
    OK(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_TRIANGLE, triangles, mesh.triangle_count, 0, &count));
    CHECK(count == mesh.triangle_count);
    CHECK(memcmp(triangles, mesh.triangles, count * sizeof *triangles) == 0);
    for (i = 0; i < count; i++) {
        CHECK(triangles[i][0] < mesh.vertex_count && triangles[i][1] < mesh.vertex_count);
    }
    free(vertices);
    free(triangles);

    OK(pcmvs_frame_get_counts(frame, &counts, sizeof counts));
    CHECK(counts.vertices == mesh.vertex_count && counts.faces == mesh.triangle_count);
    for (i = 0; i < pcmvs_stage_count(); i++) {
        OK(pcmvs_frame_get_stage_report(frame, pcmvs_stage_at((uint32_t)i), &stage, sizeof stage));
        CHECK(stage.seconds > 0 && stage.hash != 0);
    }
    OK(pcmvs_frame_warning_count(frame, &warnings));
    CHECK(warnings == 0);
    OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, NULL, 0, 0, &count));
    CHECK(count == counts.merged);
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_DETECTED, (uint32_t)i, NULL, 0, 0, &size));
        OK(pcmvs_frame_get_view_report(frame, (uint32_t)i, &view, sizeof view));
        CHECK(view.detected > 0 && view.detected + view.substituted == size);
        detected += size;
    }
    gains = malloc(3 * capture->count * sizeof *gains);
    if (gains == NULL) {
        exit(3);
    }
    OK(pcmvs_frame_copy_gains(frame, gains, capture->count, 0, NULL));
    for (i = 0; i < capture->count; i++) {
        size_t pixels, inside = 0;
        OK(pcmvs_frame_get_view_report(frame, (uint32_t)i, &view, sizeof view));
        CHECK(memcmp(view.gains, &gains[3 * i], sizeof view.gains) == 0);
        OK(pcmvs_frame_get_silhouette(frame, (uint32_t)i, &silhouette, sizeof silhouette));
        pixels = (size_t)silhouette.width * silhouette.height;
        for (k = 0; k < pixels; k++) {
            inside += silhouette.distances[k] > 0;
        }
        CHECK(view.carves == 1 && view.inside > 0 && view.inside < 1);
        CHECK(view.inside == (float)inside / (float)pixels);
    }
    free(gains);
    OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_IMPLICIT, 0, NULL, 0, 0, &size));
    CHECK(size == counts.implicit);
    OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_FRONTIER, 0, NULL, 0, 0, &size));
    CHECK(size == counts.frontier && detected + counts.frontier + counts.implicit == count);
    points = malloc(count * sizeof *points);
    if (points == NULL) {
        exit(3);
    }
    OK(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, points, count, 0, NULL));
    for (i = 0; i < count; i++) {
        CHECK(points[i].rank <= PCMVS_RANK_FRONTIER && points[i].camera < (int32_t)capture->count);
        CHECK((points[i].camera == -1) == (points[i].rank == PCMVS_RANK_IMPLICIT));
    }
    free(points);
    EXPECT(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_DETECTED, 99, NULL, 0, 0, &count),
           PCMVS_STATUS_INVALID_ARGUMENT);
    OK(pcmvs_frame_get_silhouette(frame, 3, &silhouette, sizeof silhouette));
    CHECK(silhouette.width == capture->pictures[3].width && silhouette.height == capture->pictures[3].height);
    EXPECT(pcmvs_frame_get_silhouette(frame, 99, &silhouette, sizeof silhouette), PCMVS_STATUS_INVALID_ARGUMENT);

    OK(pcmvs_export_options_init(&options, sizeof options));
    options.format = PCMVS_FILE_FORMAT_PLY;
    OK(pcmvs_frame_export_mesh(frame, 0, &options, append, &bytes));
    OK(pcmvs_frame_export_mesh_to_buffer(frame, 0, &options, NULL, 0, &size));
    CHECK(size == bytes.size && memcmp(bytes.data, "ply\n", 4) == 0);
    buffer = malloc(size);
    if (buffer == NULL) {
        exit(3);
    }
    EXPECT(pcmvs_frame_export_mesh_to_buffer(frame, 0, &options, buffer, size - 1, NULL), PCMVS_STATUS_BUFFER_TOO_SMALL);
    OK(pcmvs_frame_export_mesh_to_buffer(frame, 0, &options, buffer, size, NULL));
    CHECK(memcmp(buffer, bytes.data, size) == 0);
    free(buffer);
    options.format = 99;
    EXPECT(pcmvs_frame_export_mesh(frame, 0, &options, append, &bytes), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_frame_export_mesh(frame, 0, NULL, refuse, frame), PCMVS_STATUS_WRITE_FAILED);
    OK(pcmvs_frame_export_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, append, &bytes));
    free(bytes.data);
}

/* Fixing the gains that a frame estimated gives the same bytes; other gains give others. */
static void check_gains(const struct capture *capture, pcmvs_rig *rig, const pcmvs_frame *found,
                        const struct bytes *expected) {
    pcmvs_frame *frame = NULL;
    struct bytes bytes;
    float(*gains)[3] = malloc(capture->count * sizeof *gains), (*again)[3] = malloc(capture->count * sizeof *again);
    size_t count = 0;
    if (gains == NULL || again == NULL) {
        exit(3);
    }
    OK(pcmvs_frame_copy_gains(found, NULL, 0, 0, &count));
    CHECK(count == capture->count);
    OK(pcmvs_frame_copy_gains(found, gains[0], count, 0, NULL));
    OK(pcmvs_rig_set_gains(rig, gains[0], count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, NULL));
    OK(pcmvs_frame_copy_gains(frame, again[0], count, 0, NULL));
    CHECK(memcmp(gains, again, count * sizeof *gains) == 0);
    bytes = glb(frame);
    CHECK(same(&bytes, expected));
    free(bytes.data);
    OK(pcmvs_frame_free(frame));
    gains[1][2] *= 1.5f;
    OK(pcmvs_rig_set_gains(rig, gains[0], count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, NULL));
    bytes = glb(frame);
    CHECK(!same(&bytes, expected));
    free(bytes.data);
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_set_cameras(rig, capture->cameras, capture->count));
    free(gains);
    free(again);
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    struct bytes expected;
    if (argc != 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
    expected = glb(frame);
    check_outputs(&capture, rig, frame);
    check_gains(&capture, rig, frame, &expected);
    check_cancel(&capture, frame, &expected);
    check_stages(&capture, frame, &expected);
    check_left_out_stages(&capture, frame, &expected);
    check_formats(&capture, frame, &expected);
    check_buffers(&capture, frame, &expected);
    /* A frame outlives its rig. */
    OK(pcmvs_rig_free(rig));
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
    OK(pcmvs_frame_free(frame));
    free(expected.data);
    capture_free(&capture);
    return verdict();
}
