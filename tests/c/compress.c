/* Compressed files, by meshoptimizer that the program links. Usage: compress FOLDER OUT (see capture.h). Writes full.glb, web.glb
 * and mobile.glb to the folder OUT. */
#include "capture.h"
#include "files.h"

#include <meshoptimizer.h>

static pcmvs_export_options compressed(void) {
    pcmvs_export_options options;
    OK(pcmvs_export_options_init(&options, sizeof options));
    options.normals = 0;
    options.has_up = 1;
    options.up[2] = 1;
    options.compact = 1;
    options.meshopt_optimizeVertexCacheStrip = meshopt_optimizeVertexCacheStrip;
    options.meshopt_optimizeVertexFetchRemap = meshopt_optimizeVertexFetchRemap;
    options.meshopt_encodeVertexBufferBound = meshopt_encodeVertexBufferBound;
    options.meshopt_encodeVertexBufferLevel = meshopt_encodeVertexBufferLevel;
    options.meshopt_encodeIndexBufferBound = meshopt_encodeIndexBufferBound;
    options.meshopt_encodeIndexBuffer = meshopt_encodeIndexBuffer;
    return options;
}

static void write_file(const pcmvs_frame *frame, uint32_t kind, uint32_t upright, const char *folder, const char *name) {
    struct bytes bytes = {NULL, 0, 0};
    pcmvs_export_options options = compressed();
    char path[4096];
    FILE *file;
    options.upright = upright;
    OK(pcmvs_frame_export_mesh(frame, kind, &options, append, &bytes));
    CHECK(snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path);
    file = fopen(path, "wb");
    CHECK(file != NULL && fwrite(bytes.data, 1, bytes.size, file) == bytes.size && fclose(file) == 0);
    free(bytes.data);
}

static void make_form(pcmvs_frame *frame, uint32_t faces, uint32_t size) {
    pcmvs_form_options options;
    OK(pcmvs_form_options_init(&options, sizeof options));
    options.faces = faces;
    options.texture = 1;
    options.texture_size = size;
    OK(pcmvs_frame_form(frame, &options));
}

/* Functions that are not those of meshoptimizer. */

static void no_order(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    (void)destination, (void)indices, (void)index_count, (void)vertex_count;
}

static void wrong_vertices(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    memcpy(destination, indices, index_count * sizeof *indices);
    destination[index_count - 1] = (unsigned int)vertex_count;
}

static size_t no_places(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    (void)destination, (void)indices, (void)index_count;
    return vertex_count;
}

static size_t one_place(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    (void)indices, (void)index_count;
    memset(destination, 0, vertex_count * sizeof *destination);
    return 1;
}

static size_t far_place(unsigned int *destination, const unsigned int *indices, size_t index_count, size_t vertex_count) {
    const size_t count = meshopt_optimizeVertexFetchRemap(destination, indices, index_count, vertex_count);
    destination[0] = (unsigned int)vertex_count;
    return count;
}

static size_t no_bound(size_t count, size_t of) {
    (void)count, (void)of;
    return 0;
}

static size_t vast_bound(size_t count, size_t of) {
    (void)count, (void)of;
    return (size_t)-1;
}

static size_t no_triangles(unsigned char *buffer, size_t size, const unsigned int *indices, size_t count) {
    (void)buffer, (void)size, (void)indices, (void)count;
    return 0;
}

static size_t other_triangles(unsigned char *buffer, size_t size, const unsigned int *indices, size_t count) {
    return meshopt_encodeIndexSequence(buffer, size, indices, count);
}

static size_t many_triangles(unsigned char *buffer, size_t size, const unsigned int *indices, size_t count) {
    (void)buffer, (void)indices, (void)count;
    return size + 1;
}

static size_t no_vertices(unsigned char *buffer, size_t size, const void *vertices, size_t count, size_t of, int level,
                          int version) {
    (void)buffer, (void)size, (void)vertices, (void)count, (void)of, (void)level, (void)version;
    return 0;
}

static size_t many_vertices(unsigned char *buffer, size_t size, const void *vertices, size_t count, size_t of, int level,
                            int version) {
    (void)buffer, (void)vertices, (void)count, (void)of, (void)level, (void)version;
    return size + 1;
}

static size_t newer_vertices(unsigned char *buffer, size_t size, const void *vertices, size_t count, size_t of, int level,
                             int version) {
    (void)version;
    return meshopt_encodeVertexBufferLevel(buffer, size, vertices, count, of, level, 1);
}

/* Exports with one wrong function, and checks the status and that the message names the function. */
#define REFUSED(function, value, status)                                                                                   \
    do {                                                                                                                   \
        pcmvs_export_options options = compressed();                                                                       \
        options.function = value;                                                                                          \
        refused(frame, &options, status, #function, __LINE__);                                                             \
    } while (0)

static void refused(const pcmvs_frame *frame, const pcmvs_export_options *options, pcmvs_status expected,
                    const char *function, int line) {
    struct bytes bytes = {NULL, 0, 0};
    pcmvs_error error;
    const pcmvs_status status = pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, options, append, &bytes);
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    if (status != expected || bytes.size != 0 || strstr(error.message, function) == NULL) {
        printf("line %d: status %u, %s\n", line, (unsigned)status, error.message);
        failures++;
    }
    free(bytes.data);
}

static void check_misuse(const pcmvs_frame *frame) {
    const pcmvs_status null = PCMVS_STATUS_NULL_POINTER, strange = PCMVS_STATUS_INVALID_ARGUMENT;
    pcmvs_export_options options = compressed();
    struct bytes before = glb(frame), after;
    REFUSED(meshopt_optimizeVertexCacheStrip, NULL, null);
    REFUSED(meshopt_optimizeVertexFetchRemap, NULL, null);
    REFUSED(meshopt_encodeVertexBufferBound, NULL, null);
    REFUSED(meshopt_encodeVertexBufferLevel, NULL, null);
    REFUSED(meshopt_encodeIndexBufferBound, NULL, null);
    REFUSED(meshopt_encodeIndexBuffer, NULL, null);
    REFUSED(meshopt_optimizeVertexCacheStrip, no_order, strange);
    REFUSED(meshopt_optimizeVertexCacheStrip, wrong_vertices, strange);
    REFUSED(meshopt_optimizeVertexFetchRemap, no_places, strange);
    REFUSED(meshopt_optimizeVertexFetchRemap, one_place, strange);
    REFUSED(meshopt_optimizeVertexFetchRemap, far_place, strange);
    REFUSED(meshopt_encodeVertexBufferBound, vast_bound, strange);
    REFUSED(meshopt_encodeVertexBufferLevel, no_vertices, strange);
    REFUSED(meshopt_encodeVertexBufferLevel, many_vertices, strange);
    REFUSED(meshopt_encodeVertexBufferLevel, newer_vertices, strange);
    REFUSED(meshopt_encodeIndexBufferBound, vast_bound, strange);
    REFUSED(meshopt_encodeIndexBuffer, no_triangles, strange);
    REFUSED(meshopt_encodeIndexBuffer, many_triangles, strange);
    REFUSED(meshopt_encodeIndexBuffer, other_triangles, strange);
    /* Nothing fits into a buffer of no bytes. */
    options.meshopt_encodeIndexBufferBound = no_bound;
    refused(frame, &options, strange, "meshopt_encodeIndexBuffer", __LINE__);
    options = compressed();
    options.format = PCMVS_FILE_FORMAT_PLY;
    refused(frame, &options, strange, "PLY", __LINE__);
    after = glb(frame);
    CHECK(same(&before, &after));
    free(before.data), free(after.data);
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
    write_file(frame, PCMVS_MESH_KIND_FINAL, 0, argv[2], "full.glb");
    make_form(frame, 20000, 1024);
    write_file(frame, PCMVS_MESH_KIND_FORM, 1, argv[2], "web.glb");
    make_form(frame, 5000, 512);
    write_file(frame, PCMVS_MESH_KIND_FORM, 1, argv[2], "mobile.glb");
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    capture_free(&capture);
    return verdict();
}
