/* Forms of a finished mesh. Usage: forms FOLDER OUT.glb (see capture.h). Writes a textured, upright form of 2,000 triangles. */
#include "capture.h"
#include "files.h"

static pcmvs_form_options textured(uint32_t faces, uint32_t size) {
    pcmvs_form_options options;
    OK(pcmvs_form_options_init(&options, sizeof options));
    options.faces = faces;
    options.texture = 1;
    options.texture_size = size;
    return options;
}

/* Checks that an error's message contains something. */
static void check_message(const pcmvs_frame *frame, const char *part) {
    pcmvs_error error;
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(error.stage == PCMVS_STAGE_FORM);
    if (strstr(error.message, part) == NULL) {
        printf("`%s` is not in: %s\n", part, error.message);
        failures++;
    }
}

static void check_misuse(pcmvs_frame *frame) {
    pcmvs_form_options options;
    pcmvs_mesh mesh;
    pcmvs_texture texture;
    size_t count;
    OK(pcmvs_form_options_init(&options, sizeof options));
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
    check_message(frame, "pcmvs_frame_form");
    EXPECT(pcmvs_frame_get_texture(frame, &texture, sizeof texture), PCMVS_STATUS_WRONG_ORDER);
    options.texture = 2;
    EXPECT(pcmvs_frame_form(frame, &options), PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frame, "0 or 1");
    options.texture = 0;
    options.texture_size = 512;
    EXPECT(pcmvs_frame_form(frame, &options), PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frame, "texture is 0");
    options = textured(0, 63);
    EXPECT(pcmvs_frame_form(frame, &options), PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frame, "64");

    /* A form without a texture has its vertices' colours. */
    OK(pcmvs_form_options_init(&options, sizeof options));
    options.faces = 3000;
    OK(pcmvs_frame_form(frame, &options));
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &mesh, sizeof mesh));
    CHECK(mesh.triangle_count <= 3000 && mesh.triangle_count > 2900);
    CHECK(mesh.colours != NULL && mesh.texture_coordinates == NULL);
    EXPECT(pcmvs_frame_get_texture(frame, &texture, sizeof texture), PCMVS_STATUS_WRONG_ORDER);
    check_message(frame, "no texture");
    EXPECT(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FORM, PCMVS_ATTRIBUTE_TEXTURE_COORDINATES, NULL, 0, 0, &count),
           PCMVS_STATUS_WRONG_ORDER);

    /* After a failure there is no form. */
    options.texture = 2;
    EXPECT(pcmvs_frame_form(frame, &options), PCMVS_STATUS_INVALID_ARGUMENT);
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
}

/* Texture coordinates and texels are there, and the finished mesh stays as it is. */
static void check_texture(pcmvs_frame *frame) {
    const pcmvs_form_options options = textured(2000, 256);
    struct bytes before = glb(frame), after;
    pcmvs_mesh form;
    pcmvs_texture texture;
    float *copied;
    size_t count = 0;
    uint32_t i;
    OK(pcmvs_frame_form(frame, &options));
    after = glb(frame);
    CHECK(same(&before, &after));
    free(before.data), free(after.data);
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &form, sizeof form));
    CHECK(form.triangle_count <= 2000 && form.colours == NULL && form.texture_coordinates != NULL);
    OK(pcmvs_frame_get_texture(frame, &texture, sizeof texture));
    CHECK(texture.width == 256 && texture.height == 256);
    OK(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FORM, PCMVS_ATTRIBUTE_TEXTURE_COORDINATES, NULL, 0, 0, &count));
    CHECK(count == form.vertex_count);
    copied = malloc(count * 2 * sizeof *copied);
    if (copied == NULL) {
        exit(3);
    }
    OK(pcmvs_frame_copy_mesh(frame, PCMVS_MESH_KIND_FORM, PCMVS_ATTRIBUTE_TEXTURE_COORDINATES, copied, count, 0, NULL));
    CHECK(memcmp(copied, form.texture_coordinates, count * 2 * sizeof *copied) == 0);
    for (i = 0; i < 2 * form.vertex_count; i++) {
        CHECK(copied[i] >= 0 && copied[i] <= 1);
    }
    free(copied);
}

static void check_files(pcmvs_frame *frame, const char *path) {
    struct bytes plain = {NULL, 0, 0}, compact = {NULL, 0, 0}, coarse = {NULL, 0, 0};
    const double up[3] = {0, 0, 1};
    pcmvs_export_options options;
    FILE *file;
    OK(pcmvs_export_options_init(&options, sizeof options));
    options.upright = 1;
    EXPECT(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &options, append, &plain),
           PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frame, "has_up");
    options.has_up = 1;
    memcpy(options.up, up, sizeof up);
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &options, append, &plain));
    options.compact = 1;
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &options, append, &compact));
    CHECK(compact.size < plain.size);
    options.jpeg_quality = 20;
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &options, append, &coarse));
    CHECK(coarse.size < compact.size);
    options.jpeg_quality = 101;
    EXPECT(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &options, append, &coarse),
           PCMVS_STATUS_INVALID_ARGUMENT);
    options.jpeg_quality = 90;
    options.format = PCMVS_FILE_FORMAT_PLY;
    EXPECT(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, &options, append, &coarse),
           PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frame, "PLY");
    file = fopen(path, "wb");
    CHECK(file != NULL && fwrite(plain.data, 1, plain.size, file) == plain.size && fclose(file) == 0);
    free(plain.data), free(compact.data), free(coarse.data);
}

/* The state of `on_progress`: when to cancel, and how often it was called. */
struct watch {
    int cancel_at, calls;
    uint32_t last;
};

static int on_progress(void *user, uint32_t stage, uint32_t done, uint32_t total) {
    struct watch *watch = user;
    if (stage != PCMVS_STAGE_FORM) {
        return 0;
    }
    CHECK(done >= watch->last && done <= total);
    watch->last = done;
    return ++watch->calls == watch->cancel_at;
}

/* A form reports progress and can be cancelled, after which there is none. Beginning a frame and running a stage again
 * discard it. */
static void check_cancelling(const struct capture *capture, pcmvs_frame *frame) {
    const pcmvs_form_options form = textured(2000, 256);
    struct watch watch = {0, 0, 0};
    pcmvs_options options;
    pcmvs_mesh mesh;
    OK(pcmvs_options_init(&options, sizeof options));
    options.preset = PCMVS_PRESET_HULL;
    options.progress = on_progress;
    options.progress_user = &watch;
    OK(pcmvs_frame_begin(frame, &options));
    EXPECT(pcmvs_frame_form(frame, &form), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_reconstruct(frame, capture->views, capture->count, &options));
    OK(pcmvs_frame_form(frame, &form));
    CHECK(watch.calls > 10 && strcmp(pcmvs_stage_name(PCMVS_STAGE_FORM), "form") == 0);
    watch.cancel_at = watch.calls / 2;
    watch.calls = 0;
    watch.last = 0;
    EXPECT(pcmvs_frame_form(frame, &form), PCMVS_STATUS_CANCELLED);
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
    watch.cancel_at = 0;
    watch.last = 0;
    OK(pcmvs_frame_form(frame, &form));
    OK(pcmvs_frame_step(frame, PCMVS_STAGE_COLOUR));
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
    watch.last = 0;
    OK(pcmvs_frame_form(frame, &form));
    OK(pcmvs_frame_begin(frame, &options));
    EXPECT(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FORM, &mesh, sizeof mesh), PCMVS_STATUS_WRONG_ORDER);
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig;
    pcmvs_frame *frame;
    if (argc != 3 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
    check_misuse(frame);
    check_texture(frame);
    check_files(frame, argv[2]);
    check_cancelling(&capture, frame);
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    capture_free(&capture);
    return verdict();
}
