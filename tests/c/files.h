/* Files in memory. */
#ifndef FILES_H
#define FILES_H

#include "check.h"

#include <stdlib.h>
#include <string.h>

struct bytes {
    char *data;
    size_t size, capacity;
};

static int append(void *user, const void *data, size_t size) {
    struct bytes *bytes = user;
    if (bytes->capacity < bytes->size + size) {
        bytes->capacity = 2 * (bytes->size + size);
        bytes->data = realloc(bytes->data, bytes->capacity);
        if (bytes->data == NULL) {
            exit(3);
        }
    }
    memcpy(bytes->data + bytes->size, data, size);
    bytes->size += size;
    return 0;
}

/* Exports the mesh as GLB to memory that the caller frees. */
static struct bytes glb(const pcmvs_frame *frame) {
    struct bytes bytes = {NULL, 0, 0};
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, append, &bytes));
    return bytes;
}

static int same(const struct bytes *a, const struct bytes *b) {
    return a->size == b->size && memcmp(a->data, b->data, a->size) == 0;
}

#endif
