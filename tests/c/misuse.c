/* Misuses every function. Each call must fail as the header says and have no effect. Usage: misuse FOLDER (see capture.h) */
#include "capture.h"
#include "files.h"

#define NULL_POINTER(call) EXPECT(call, PCMVS_STATUS_NULL_POINTER)

#define KEPT(frame, stage, camera, number, about) kept(__LINE__, frame, stage, camera, number, about)

/* Checks the frame's description of its last failure. `about` is part of the message. */
static void kept(int line, const pcmvs_frame *frame, int stage, int camera, int number, const char *about) {
    pcmvs_error error;
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    if (error.stage != stage || error.camera != camera || error.frame != number ||
        strstr(error.message, about) == NULL) {
        printf("line %d: stage %d, camera %d, frame %d: %s\n", line, (int)error.stage, (int)error.camera,
               (int)error.frame, error.message);
        failures++;
    }
}

/* Options that have no effect on PLY files are refused by their names, and so are upward directions that turn nothing. */
static void check_file_options(const pcmvs_frame *frame) {
    static const struct {
        uint32_t normals, upright, compact;
        const char *about;
    } only_glb[] = {
        {1, 1, 0, "upright is for GLB files"},
        {1, 0, 1, "compact is for GLB files"},
        {0, 0, 0, "normals is 0"},
    };
    pcmvs_export_options file;
    struct bytes bytes = {NULL, 0, 0};
    size_t i;
    OK(pcmvs_export_options_init(&file, sizeof file));
    file.has_up = 1;
    file.up[2] = 1;
    for (i = 0; i < sizeof only_glb / sizeof *only_glb; i++) {
        file.normals = only_glb[i].normals;
        file.upright = only_glb[i].upright;
        file.compact = only_glb[i].compact;
        file.format = PCMVS_FILE_FORMAT_PLY;
        EXPECT(pcmvs_frame_export_mesh(frame, 0, &file, append, &bytes), PCMVS_STATUS_INVALID_ARGUMENT);
        KEPT(frame, PCMVS_STAGE_MESH, -1, 7, only_glb[i].about);
        KEPT(frame, PCMVS_STAGE_MESH, -1, 7, "write a GLB, or set");
        CHECK(bytes.size == 0);
        file.format = PCMVS_FILE_FORMAT_GLB;
        OK(pcmvs_frame_export_mesh(frame, 0, &file, append, &bytes));
        bytes.size = 0;
    }
    OK(pcmvs_export_options_init(&file, sizeof file));
    file.has_up = 1;
    for (i = 0; i < 2; i++) {
        file.upright = (uint32_t)i;
        EXPECT(pcmvs_frame_export_mesh(frame, 0, &file, append, &bytes), PCMVS_STATUS_INVALID_ARGUMENT);
        KEPT(frame, PCMVS_STAGE_MESH, -1, 7, "up has no length");
    }
    free(bytes.data);
}

static int refuse(void *user, const void *data, size_t size) {
    (void)user, (void)data, (void)size;
    return 1;
}

/* Functions that read results describe their failures as stages do. The frame is complete and has the number 7. */
static void check_reading(const struct capture *capture, pcmvs_rig *rig, pcmvs_frame *frame) {
    pcmvs_rig *empty = NULL;
    pcmvs_frame *other = NULL;
    pcmvs_options options;
    pcmvs_export_options file;
    pcmvs_view view = capture->views[2];
    pcmvs_mesh mesh;
    pcmvs_silhouette silhouette;
    pcmvs_counts counts;
    pcmvs_stage_report stage;
    pcmvs_view_report view_report;
    pcmvs_warning warning;
    pcmvs_point point;
    pcmvs_error error;
    double origin[3];
    float few[3];
    uint32_t i;
    size_t count;

    EXPECT(pcmvs_frame_get_mesh(frame, 99, &mesh, sizeof mesh), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, -1, -1, 7, "mesh 99");
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_COARSE, &mesh, 3), PCMVS_STATUS_INVALID_STRUCT);
    KEPT(frame, PCMVS_STAGE_COARSE, -1, 7, "3 bytes");
    EXPECT(pcmvs_frame_copy_mesh(frame, 0, PCMVS_ATTRIBUTE_NORMAL, few, 1, 0, &count), PCMVS_STATUS_BUFFER_TOO_SMALL);
    KEPT(frame, PCMVS_STAGE_MESH, -1, 7, "room for 1 elements");
    EXPECT(pcmvs_frame_copy_mesh(frame, 0, 99, few, 1, 0, &count), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, PCMVS_STAGE_MESH, -1, 7, "attribute 99");
    EXPECT(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_HULL, PCMVS_ATTRIBUTE_COLOUR, NULL, 0, 0, &count),
           PCMVS_STATUS_WRONG_ORDER);
    KEPT(frame, PCMVS_STAGE_COLOUR, -1, 7, "no colours");
    EXPECT(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_DETECTED, 99, NULL, 0, 0, &count),
           PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, PCMVS_STAGE_MERGE, -1, 7, "no camera 99");
    EXPECT(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_IMPLICIT, 0, &point, 1, 8, &count),
           PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, PCMVS_STAGE_CONTOURS, -1, 7, "stride of 8");
    EXPECT(pcmvs_frame_get_silhouette(frame, 4, &silhouette, 1), PCMVS_STATUS_INVALID_STRUCT);
    KEPT(frame, PCMVS_STAGE_VIEWS, 4, 7, "silhouette");
    NULL_POINTER(pcmvs_frame_get_counts(frame, NULL, sizeof counts));
    KEPT(frame, PCMVS_STAGE_COLOUR, -1, 7, "`counts` is NULL");
    EXPECT(pcmvs_frame_get_stage_report(frame, 99, &stage, sizeof stage), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, -1, -1, 7, "stage 99");
    EXPECT(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_MERGE, &stage, 8), PCMVS_STATUS_INVALID_STRUCT);
    KEPT(frame, PCMVS_STAGE_MERGE, -1, 7, "8 bytes");
    EXPECT(pcmvs_frame_get_view_report(frame, 99, &view_report, sizeof view_report), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, PCMVS_STAGE_VIEWS, -1, 7, "no camera 99");
    EXPECT(pcmvs_frame_get_view_report(frame, 5, &view_report, 8), PCMVS_STATUS_INVALID_STRUCT);
    KEPT(frame, PCMVS_STAGE_VIEWS, 5, 7, "8 bytes");
    EXPECT(pcmvs_frame_get_warning(frame, 99, &warning, sizeof warning), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, -1, -1, 7, "no warning 99");
    EXPECT(pcmvs_frame_step(frame, 99), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, -1, -1, 7, "stage 99");
    EXPECT(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_HULL, NULL, refuse, NULL), PCMVS_STATUS_WRITE_FAILED);
    KEPT(frame, PCMVS_STAGE_HULL, -1, 7, "write callback");
    OK(pcmvs_export_options_init(&file, sizeof file));
    file.format = 99;
    EXPECT(pcmvs_frame_export_mesh_to_buffer(frame, 0, &file, few, 1, NULL), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, PCMVS_STAGE_MESH, -1, 7, "file format 99");
    EXPECT(pcmvs_frame_export_mesh_to_buffer(frame, 0, NULL, few, 1, NULL), PCMVS_STATUS_BUFFER_TOO_SMALL);
    KEPT(frame, PCMVS_STAGE_MESH, -1, 7, "room for 1");
    EXPECT(pcmvs_frame_export_cloud(frame, 99, 0, append, NULL), PCMVS_STATUS_INVALID_ARGUMENT);
    KEPT(frame, -1, -1, 7, "cloud 99");
    /* Asking for the error does not change it. */
    EXPECT(pcmvs_frame_error(frame, &error, 8), PCMVS_STATUS_INVALID_STRUCT);
    KEPT(frame, -1, -1, 7, "cloud 99");

    /* A frame that is not complete, and a view without a mask. */
    OK(pcmvs_frame_new(rig, &other));
    OK(pcmvs_options_init(&options, sizeof options));
    options.frame = 8;
    OK(pcmvs_frame_begin(other, &options));
    view.mask = NULL;
    for (i = 0; i < capture->count; i++) {
        OK(pcmvs_frame_view(other, i, i == 2 ? &view : &capture->views[i]));
    }
    EXPECT(pcmvs_frame_get_silhouette(other, 2, &silhouette, sizeof silhouette), PCMVS_STATUS_WRONG_ORDER);
    KEPT(other, PCMVS_STAGE_VIEWS, -1, 8, "`views`, which has not run");
    EXPECT(pcmvs_frame_get_view_report(other, 2, &view_report, sizeof view_report), PCMVS_STATUS_WRONG_ORDER);
    KEPT(other, PCMVS_STAGE_VIEWS, -1, 8, "`views`, which has not run");
    OK(pcmvs_frame_hull(other));
    OK(pcmvs_frame_get_silhouette(other, 3, &silhouette, sizeof silhouette));
    EXPECT(pcmvs_frame_get_silhouette(other, 2, &silhouette, sizeof silhouette), PCMVS_STATUS_WRONG_ORDER);
    KEPT(other, PCMVS_STAGE_VIEWS, 2, 8, "no silhouette");
    EXPECT(pcmvs_frame_get_mesh(other, 0, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
    KEPT(other, PCMVS_STAGE_MESH, -1, 8, "`mesh`, which has not run");
    EXPECT(pcmvs_frame_get_stage_report(other, PCMVS_STAGE_MERGE, &stage, sizeof stage), PCMVS_STATUS_WRONG_ORDER);
    KEPT(other, PCMVS_STAGE_MERGE, -1, 8, "`merge`, which has not run");
    EXPECT(pcmvs_frame_get_counts(other, &counts, sizeof counts), PCMVS_STATUS_WRONG_ORDER);
    KEPT(other, PCMVS_STAGE_COLOUR, -1, 8, "`colour`, which has not run");
    OK(pcmvs_frame_free(other));

    /* Rigs describe their failures too, including frames that could not be created. */
    OK(pcmvs_rig_new(&empty));
    EXPECT(pcmvs_rig_origin(empty, origin), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_rig_error(empty, &error, sizeof error));
    CHECK(error.status == PCMVS_STATUS_WRONG_ORDER && strstr(error.message, "pcmvs_rig_set_cameras") != NULL);
    NULL_POINTER(pcmvs_rig_camera_count(empty, NULL));
    EXPECT(pcmvs_frame_new(empty, &other), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_rig_error(empty, &error, sizeof error));
    CHECK(error.status == PCMVS_STATUS_WRONG_ORDER && error.frame == -1 && error.camera == -1 && error.stage == -1);
    OK(pcmvs_rig_free(empty));
}

/* Passes NULL for each pointer of each function in turn. The handles are valid and the frame is complete. */
static void check_null(const struct capture *capture, pcmvs_rig *rig, pcmvs_frame *frame) {
    const pcmvs_frame *no_frame = NULL;
    pcmvs_frame *untouched = frame;
    pcmvs_view view = capture->views[0];
    pcmvs_error error;
    pcmvs_mesh mesh;
    pcmvs_silhouette silhouette;
    pcmvs_counts counts;
    pcmvs_stage_report stage;
    pcmvs_view_report view_report;
    pcmvs_warning warning;
    pcmvs_point point;
    pcmvs_form_options form;
    pcmvs_texture texture;
    size_t count;
    uint32_t cameras, warnings;
    double origin[3];
    float gains[3];
    char buffer[16];

    OK(pcmvs_form_options_init(&form, sizeof form));
    NULL_POINTER(pcmvs_allocator_init(NULL, sizeof(pcmvs_allocator)));
    NULL_POINTER(pcmvs_set_allocator(NULL));
    NULL_POINTER(pcmvs_camera_init(NULL, sizeof(pcmvs_camera)));
    NULL_POINTER(pcmvs_image_init(NULL, sizeof(pcmvs_image)));
    NULL_POINTER(pcmvs_chroma_key_init(NULL, sizeof(pcmvs_chroma_key)));
    NULL_POINTER(pcmvs_view_init(NULL, sizeof(pcmvs_view)));
    NULL_POINTER(pcmvs_options_init(NULL, sizeof(pcmvs_options)));
    NULL_POINTER(pcmvs_form_options_init(NULL, sizeof(pcmvs_form_options)));
    NULL_POINTER(pcmvs_export_options_init(NULL, sizeof(pcmvs_export_options)));

    NULL_POINTER(pcmvs_rig_new(NULL));
    OK(pcmvs_rig_free(NULL));
    NULL_POINTER(pcmvs_rig_set_cameras(NULL, capture->cameras, capture->count));
    NULL_POINTER(pcmvs_rig_set_cameras(rig, NULL, capture->count));
    NULL_POINTER(pcmvs_rig_set_gains(NULL, gains, capture->count));
    NULL_POINTER(pcmvs_rig_set_gains(rig, NULL, capture->count));
    NULL_POINTER(pcmvs_rig_camera_count(NULL, &cameras));
    NULL_POINTER(pcmvs_rig_camera_count(rig, NULL));
    NULL_POINTER(pcmvs_rig_origin(NULL, origin));
    NULL_POINTER(pcmvs_rig_origin(rig, NULL));
    NULL_POINTER(pcmvs_rig_error(NULL, &error, sizeof error));
    NULL_POINTER(pcmvs_rig_error(rig, NULL, sizeof error));

    NULL_POINTER(pcmvs_frame_new(NULL, &untouched));
    CHECK(untouched == frame);
    NULL_POINTER(pcmvs_frame_new(rig, NULL));
    OK(pcmvs_frame_free(NULL));
    NULL_POINTER(pcmvs_frame_error(NULL, &error, sizeof error));
    NULL_POINTER(pcmvs_frame_error(frame, NULL, sizeof error));

    /* Reading results, which stay available. */
    NULL_POINTER(pcmvs_frame_get_mesh(NULL, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    NULL_POINTER(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, sizeof mesh));
    NULL_POINTER(pcmvs_frame_copy_mesh(NULL, PCMVS_MESH_KIND_FINAL, PCMVS_ATTRIBUTE_POSITION, NULL, 0, 0, &count));
    NULL_POINTER(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FINAL, PCMVS_ATTRIBUTE_POSITION, NULL, 1, 0, &count));
    NULL_POINTER(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FINAL, PCMVS_ATTRIBUTE_POSITION, NULL, 0, 0, NULL));
    NULL_POINTER(pcmvs_frame_copy_cloud(NULL, PCMVS_CLOUD_KIND_MERGED, 0, NULL, 0, 0, &count));
    NULL_POINTER(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, NULL, 1, 0, &count));
    NULL_POINTER(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, NULL, 0, 0, NULL));
    EXPECT(pcmvs_frame_copy_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, &point, 1, 0, NULL),
           PCMVS_STATUS_BUFFER_TOO_SMALL);
    NULL_POINTER(pcmvs_frame_get_silhouette(NULL, 0, &silhouette, sizeof silhouette));
    NULL_POINTER(pcmvs_frame_get_silhouette(frame, 0, NULL, sizeof silhouette));
    form.texture = 1;
    form.texture_size = 64;
    OK(pcmvs_frame_form(frame, &form));
    NULL_POINTER(pcmvs_frame_get_texture(NULL, &texture, sizeof texture));
    NULL_POINTER(pcmvs_frame_get_texture(frame, NULL, sizeof texture));
    NULL_POINTER(pcmvs_frame_export_mesh(NULL, PCMVS_MESH_KIND_FINAL, NULL, append, NULL));
    NULL_POINTER(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, NULL, NULL));
    NULL_POINTER(pcmvs_frame_export_mesh_to_buffer(NULL, PCMVS_MESH_KIND_FINAL, NULL, buffer, 16, &count));
    NULL_POINTER(pcmvs_frame_export_mesh_to_buffer(frame, PCMVS_MESH_KIND_FINAL, NULL, NULL, 16, &count));
    NULL_POINTER(pcmvs_frame_export_mesh_to_buffer(frame, PCMVS_MESH_KIND_FINAL, NULL, NULL, 0, NULL));
    NULL_POINTER(pcmvs_frame_export_cloud(NULL, PCMVS_CLOUD_KIND_MERGED, 0, append, NULL));
    NULL_POINTER(pcmvs_frame_export_cloud(frame, PCMVS_CLOUD_KIND_MERGED, 0, NULL, NULL));
    NULL_POINTER(pcmvs_frame_get_counts(NULL, &counts, sizeof counts));
    NULL_POINTER(pcmvs_frame_get_counts(frame, NULL, sizeof counts));
    OK(pcmvs_frame_get_counts(frame, &counts, sizeof counts));
    NULL_POINTER(pcmvs_frame_get_stage_report(NULL, PCMVS_STAGE_HULL, &stage, sizeof stage));
    NULL_POINTER(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_HULL, NULL, sizeof stage));
    OK(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_HULL, &stage, sizeof stage));
    NULL_POINTER(pcmvs_frame_get_view_report(NULL, 0, &view_report, sizeof view_report));
    NULL_POINTER(pcmvs_frame_get_view_report(frame, 0, NULL, sizeof view_report));
    OK(pcmvs_frame_get_view_report(frame, 0, &view_report, sizeof view_report));
    NULL_POINTER(pcmvs_frame_warning_count(NULL, &warnings));
    NULL_POINTER(pcmvs_frame_warning_count(frame, NULL));
    OK(pcmvs_frame_warning_count(frame, &warnings));
    NULL_POINTER(pcmvs_frame_get_warning(NULL, 0, &warning, sizeof warning));
    NULL_POINTER(pcmvs_frame_copy_gains(NULL, gains, 1, 0, &count));
    NULL_POINTER(pcmvs_frame_copy_gains(frame, NULL, 1, 0, &count));
    NULL_POINTER(pcmvs_frame_copy_gains(frame, NULL, 0, 0, NULL));
    EXPECT(pcmvs_frame_copy_gains(frame, gains, 1, 0, NULL), PCMVS_STATUS_BUFFER_TOO_SMALL);

    /* Making frames. */
    NULL_POINTER(pcmvs_frame_begin(NULL, NULL));
    NULL_POINTER(pcmvs_frame_view(NULL, 0, &view));
    NULL_POINTER(pcmvs_frame_step(NULL, PCMVS_STAGE_HULL));
    NULL_POINTER(pcmvs_frame_hull(NULL));
    NULL_POINTER(pcmvs_frame_contours(NULL));
    NULL_POINTER(pcmvs_frame_coarse(NULL));
    NULL_POINTER(pcmvs_frame_detect(NULL, 0));
    NULL_POINTER(pcmvs_frame_merge(NULL));
    NULL_POINTER(pcmvs_frame_mesh(NULL));
    NULL_POINTER(pcmvs_frame_colour(NULL));
    NULL_POINTER(pcmvs_frame_may_have_lost_part(NULL, frame, frame, &cameras));
    NULL_POINTER(pcmvs_frame_may_have_lost_part(frame, NULL, NULL, NULL));
    NULL_POINTER(pcmvs_frame_view_between(NULL, 0, &view, &view, &view, NULL));
    NULL_POINTER(pcmvs_frame_steady(NULL, NULL, 0));
    NULL_POINTER(pcmvs_frame_steady(frame, NULL, 1));
    NULL_POINTER(pcmvs_frame_steady(frame, &no_frame, 1));
    NULL_POINTER(pcmvs_frame_form(NULL, &form));
    NULL_POINTER(pcmvs_frame_form(frame, NULL));
    NULL_POINTER(pcmvs_frame_reconstruct(NULL, capture->views, capture->count, NULL));
    NULL_POINTER(pcmvs_frame_reconstruct(frame, NULL, capture->count, NULL));
    OK(pcmvs_frame_begin(frame, NULL));
    NULL_POINTER(pcmvs_frame_view(frame, 0, NULL));
    view.image = NULL;
    NULL_POINTER(pcmvs_frame_view(frame, 0, &view));
    pcmvs_frame_error(frame, &error, sizeof error);
    CHECK(error.status == PCMVS_STATUS_NULL_POINTER && error.camera == 0 && error.stage == PCMVS_STAGE_VIEWS);
    CHECK(strstr(error.message, "view.image") != NULL);
}

/* The same for the functions of a calibration. */
static void check_null_calibration(const struct capture *capture, pcmvs_rig *rig) {
    pcmvs_calibration *calibration = NULL;
    pcmvs_calibration_report report;
    pcmvs_camera_report camera_report;
    pcmvs_camera camera;
    pcmvs_warning warning;
    pcmvs_error error;
    uint32_t warnings;

    NULL_POINTER(pcmvs_calibration_options_init(NULL, sizeof(pcmvs_calibration_options)));
    NULL_POINTER(pcmvs_calibration_new(NULL, &calibration));
    CHECK(calibration == NULL);
    NULL_POINTER(pcmvs_calibration_new(rig, NULL));
    OK(pcmvs_calibration_free(NULL));
    OK(pcmvs_calibration_new(rig, &calibration));
    NULL_POINTER(pcmvs_calibration_error(NULL, &error, sizeof error));
    NULL_POINTER(pcmvs_calibration_error(calibration, NULL, sizeof error));
    NULL_POINTER(pcmvs_calibration_add_frame(NULL, capture->views, capture->count, NULL));
    NULL_POINTER(pcmvs_calibration_add_frame(calibration, NULL, capture->count, NULL));
    OK(pcmvs_calibration_add_frame(calibration, capture->views, capture->count, NULL));
    NULL_POINTER(pcmvs_calibration_run(NULL, NULL));
    OK(pcmvs_calibration_run(calibration, NULL));
    NULL_POINTER(pcmvs_calibration_get_report(NULL, &report, sizeof report));
    NULL_POINTER(pcmvs_calibration_get_report(calibration, NULL, sizeof report));
    NULL_POINTER(pcmvs_calibration_get_camera_report(NULL, 0, &camera_report, sizeof camera_report));
    NULL_POINTER(pcmvs_calibration_get_camera_report(calibration, 0, NULL, sizeof camera_report));
    NULL_POINTER(pcmvs_calibration_get_camera(NULL, 0, &camera, sizeof camera));
    NULL_POINTER(pcmvs_calibration_get_camera(calibration, 0, NULL, sizeof camera));
    NULL_POINTER(pcmvs_calibration_warning_count(NULL, &warnings));
    NULL_POINTER(pcmvs_calibration_warning_count(calibration, NULL));
    NULL_POINTER(pcmvs_calibration_get_warning(NULL, 0, &warning, sizeof warning));
    OK(pcmvs_calibration_free(calibration));
}

static void *allocate(void *user, size_t size, size_t alignment) {
    (void)user, (void)alignment;
    return malloc(size);
}

static void deallocate(void *user, void *memory, size_t size, size_t alignment) {
    (void)user, (void)size, (void)alignment;
    free(memory);
}

/* An allocator cannot be set after other calls. */
static void check_late_allocator(void) {
    pcmvs_allocator allocator;
    OK(pcmvs_allocator_init(&allocator, sizeof allocator));
    allocator.allocate = allocate;
    allocator.deallocate = deallocate;
    EXPECT(pcmvs_set_allocator(&allocator), PCMVS_STATUS_WRONG_ORDER);
}

/* Invalid handles, structs of other sizes, numbers out of range, calls in the wrong order. */
static void check_misuse(const struct capture *capture, pcmvs_rig *rig) {
    pcmvs_frame *frame = NULL, *freed;
    pcmvs_rig *empty = NULL;
    pcmvs_options options;
    pcmvs_image image;
    pcmvs_view view = capture->views[1];
    pcmvs_mesh mesh;
    pcmvs_counts counts;
    pcmvs_warning warning;
    pcmvs_error error;
    pcmvs_camera cameras[3];
    uint32_t count = 7;
    struct {
        pcmvs_options options;
        uint32_t unknown[4];
    } later;
    uint64_t words[64] = {0};
    const float gains[9] = {1, 1, 1, 1, 0, 1, 1, 1, 1};

    EXPECT(pcmvs_rig_camera_count((const pcmvs_rig *)words, &count), PCMVS_STATUS_INVALID_HANDLE);
    EXPECT(pcmvs_frame_hull((pcmvs_frame *)rig), PCMVS_STATUS_INVALID_HANDLE);
    EXPECT(pcmvs_frame_free((pcmvs_frame *)rig), PCMVS_STATUS_INVALID_HANDLE);
    EXPECT(pcmvs_frame_hull((pcmvs_frame *)((char *)words + 1)), PCMVS_STATUS_INVALID_HANDLE);
    CHECK(count == 7);

    OK(pcmvs_rig_new(&empty));
    OK(pcmvs_rig_camera_count(empty, &count));
    CHECK(count == 0);
    EXPECT(pcmvs_frame_new(empty, &frame), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_rig_set_cameras(empty, capture->cameras, 2), PCMVS_STATUS_TOO_FEW_VIEWS);
    EXPECT(pcmvs_rig_set_cameras(empty, capture->cameras, (size_t)-1), PCMVS_STATUS_INVALID_ARGUMENT);
    memcpy(cameras, capture->cameras, sizeof cameras);
    cameras[2].k[0] = -1;
    EXPECT(pcmvs_rig_set_cameras(empty, cameras, 3), PCMVS_STATUS_CAMERA);
    OK(pcmvs_rig_error(empty, &error, sizeof error));
    CHECK(error.status == PCMVS_STATUS_CAMERA && error.camera == 2 && error.frame == -1 && error.stage == -1);
    cameras[2] = cameras[1] = cameras[0];
    EXPECT(pcmvs_rig_set_cameras(empty, cameras, 3), PCMVS_STATUS_CAMERA);
    OK(pcmvs_rig_error(empty, &error, sizeof error));
    CHECK(error.camera == -1 && strstr(error.message, "all stand at one place") != NULL);
    cameras[2].reserved = 1;
    EXPECT(pcmvs_rig_set_cameras(empty, cameras, 3), PCMVS_STATUS_INVALID_STRUCT);
    cameras[1].struct_size -= 8;
    EXPECT(pcmvs_rig_set_cameras(empty, cameras, 3), PCMVS_STATUS_INVALID_STRUCT);
    EXPECT(pcmvs_rig_set_gains(empty, gains, 3), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_rig_set_cameras(empty, capture->cameras, 3));
    EXPECT(pcmvs_rig_set_gains(empty, gains, 2), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_rig_set_gains(empty, gains, 3), PCMVS_STATUS_CAMERA);
    OK(pcmvs_rig_error(empty, &error, sizeof error));
    CHECK(error.status == PCMVS_STATUS_CAMERA && error.camera == 1 && strstr(error.message, "gains") != NULL);
    OK(pcmvs_rig_free(empty));

    OK(pcmvs_frame_new(rig, &frame));
    EXPECT(pcmvs_frame_hull(frame), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(error.status == PCMVS_STATUS_WRONG_ORDER && error.camera == 0 && error.stage == PCMVS_STAGE_VIEWS);
    EXPECT(pcmvs_frame_step(frame, PCMVS_STAGE_VIEWS), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_step(frame, PCMVS_NO_STAGE), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_frame_contours(frame), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_coarse(frame), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_detect(frame, 0), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_merge(frame), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_mesh(frame), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_colour(frame), PCMVS_STATUS_WRONG_ORDER);
    /* A frame without views has no warnings. */
    OK(pcmvs_frame_warning_count(frame, &count));
    CHECK(count == 0);
    EXPECT(pcmvs_frame_get_warning(frame, 0, &warning, sizeof warning), PCMVS_STATUS_INVALID_ARGUMENT);
    memset(&mesh, 1, sizeof mesh);
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_get_mesh(frame, 99, &mesh, sizeof mesh), PCMVS_STATUS_INVALID_ARGUMENT);
    CHECK(mesh.vertex_count == 0x01010101);
    EXPECT(pcmvs_frame_get_counts(frame, &counts, sizeof counts), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_view(frame, capture->count, &capture->views[0]), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_frame_reconstruct(frame, capture->views, capture->count - 1, NULL), PCMVS_STATUS_INVALID_ARGUMENT);

    /* Structs of a newer version and structs whose size no version has. */
    memset(&later, 0, sizeof later);
    OK(pcmvs_options_init(&later.options, sizeof later));
    CHECK(later.options.struct_size == sizeof later);
    OK(pcmvs_frame_begin(frame, &later.options));
    later.unknown[3] = 1;
    EXPECT(pcmvs_frame_begin(frame, &later.options), PCMVS_STATUS_INVALID_STRUCT);
    memset(&options, 0, sizeof options);
    EXPECT(pcmvs_frame_begin(frame, &options), PCMVS_STATUS_INVALID_STRUCT);
    EXPECT(pcmvs_options_init(&options, 3), PCMVS_STATUS_INVALID_STRUCT);
    OK(pcmvs_options_init(&options, sizeof options));
    options.preset = 99;
    options.frame = 41;
    EXPECT(pcmvs_frame_begin(frame, &options), PCMVS_STATUS_INVALID_ARGUMENT);
    options.preset = PCMVS_PRESET_PREVIEW;
    OK(pcmvs_frame_begin(frame, &options));

    /* Pictures that do not fit. */
    image = *view.image;
    view.image = &image;
    image.format = 99;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_INVALID_ARGUMENT);
    image = *capture->views[1].image;
    image.width -= 1;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_IMAGE);
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(error.status == PCMVS_STATUS_IMAGE && error.camera == 1 && error.frame == 41);
    CHECK(error.stage == PCMVS_STAGE_VIEWS && strncmp(error.message, "frame 41: camera 1: ", 20) == 0);
    image.width += 1;
    /* Sizes are checked before a byte is read, also of pictures that are copied. */
    image.width = image.height = 100000;
    image.stride = -300000;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_IMAGE);
    image.format = PCMVS_PIXEL_FORMAT_GRAY16;
    image.stride = 0;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_IMAGE);
    image = *capture->views[1].image;
    image.stride = 1;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_IMAGE);
    image.stride = 0;
    view.clean_plate = &image;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_INVALID_ARGUMENT);
    view.clean_plate = NULL;
    OK(pcmvs_frame_view(frame, 1, &view));
    freed = frame;
    OK(pcmvs_frame_free(frame));
    EXPECT(pcmvs_frame_free(freed), PCMVS_STATUS_INVALID_HANDLE);
    EXPECT(pcmvs_frame_hull(freed), PCMVS_STATUS_INVALID_HANDLE);
    EXPECT(pcmvs_frame_hull((pcmvs_frame *)8), PCMVS_STATUS_INVALID_HANDLE);
    EXPECT(pcmvs_frame_hull((pcmvs_frame *)((char *)freed + 8)), PCMVS_STATUS_INVALID_HANDLE);
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    pcmvs_options options;
    struct bytes expected, bytes;
    if (argc != 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_options_init(&options, sizeof options));
    options.frame = 7;
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, &options));
    expected = glb(frame);
    check_reading(&capture, rig, frame);
    check_file_options(frame);
    check_null(&capture, rig, frame);
    check_null_calibration(&capture, rig);
    check_misuse(&capture, rig);
    check_late_allocator();
    /* None of these calls has changed the frame's results. */
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
    bytes = glb(frame);
    CHECK(same(&bytes, &expected));
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    free(bytes.data);
    free(expected.data);
    capture_free(&capture);
    return verdict();
}
