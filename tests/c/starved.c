/* Makes the caller's allocator fail. Usage: starved FOLDER STEP (see capture.h). Every STEP-th allocation of a frame and of a
 * calibration fails in its turn: that one alone, and that one and all after it. */
#include "capture.h"
#include "check.h"
#include "files.h"

static struct heap {
    size_t calls, blocks, refused;
    /* Allocations with these numbers fail. */
    size_t first, last;
} heap;

/* Allocates memory, and keeps the address that malloc has given in front of it. */
static void *allocate(void *user, size_t size, size_t alignment) {
    char *start, *memory;
    (void)user;
    heap.calls++;
    if (heap.calls >= heap.first && heap.calls <= heap.last) {
        heap.refused++;
        return NULL;
    }
    start = malloc(size + alignment + sizeof start);
    CHECK(start != NULL);
    memory = start + sizeof start;
    memory += (alignment - (uintptr_t)memory % alignment) % alignment;
    memcpy(memory - sizeof start, &start, sizeof start);
    heap.blocks++;
    return memory;
}

static void deallocate(void *user, void *memory, size_t size, size_t alignment) {
    char *start;
    (void)user;
    (void)size;
    (void)alignment;
    memcpy(&start, (char *)memory - sizeof start, sizeof start);
    heap.blocks--;
    free(start);
}

static void fail(size_t first, size_t last) {
    heap.calls = heap.refused = 0;
    heap.first = first;
    heap.last = last;
}

/* Makes a frame and a calibration. Returns the first status that is not OK. */
static pcmvs_status make(const struct capture *capture, pcmvs_rig *rig, pcmvs_frame *frame) {
    pcmvs_calibration *calibration = NULL;
    pcmvs_status status = pcmvs_frame_reconstruct(frame, capture->views, capture->count, NULL);
    if (status == PCMVS_STATUS_OK) {
        status = pcmvs_calibration_new(rig, &calibration);
    }
    if (status == PCMVS_STATUS_OK) {
        status = pcmvs_calibration_add_frame(calibration, capture->views, capture->count, NULL);
        if (status == PCMVS_STATUS_OK) {
            status = pcmvs_calibration_run(calibration, NULL);
        }
        OK(pcmvs_calibration_free(calibration));
    }
    return status;
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_allocator allocator;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    pcmvs_error error;
    struct bytes expected, bytes;
    size_t all, k, step, runs = 0, failed = 0, refused = 0;
    int rest;
    if (argc != 3 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    step = (size_t)strtoul(argv[2], NULL, 10);
    OK(pcmvs_allocator_init(&allocator, sizeof allocator));
    allocator.allocate = allocate;
    allocator.deallocate = deallocate;
    OK(pcmvs_set_allocator(&allocator));
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    fail(0, 0);
    OK(make(&capture, rig, frame));
    all = heap.calls;
    expected = glb(frame);
    OK(pcmvs_frame_free(frame));
    for (k = 1; k <= all; k += step) {
        for (rest = 0; rest < 2; rest++) {
            pcmvs_status status;
            fail(0, 0);
            OK(pcmvs_frame_new(rig, &frame));
            fail(k, rest ? SIZE_MAX : k);
            status = make(&capture, rig, frame);
            refused += heap.refused;
            CHECK(status == PCMVS_STATUS_OK || status == PCMVS_STATUS_OUT_OF_MEMORY);
            failed += status != PCMVS_STATUS_OK;
            fail(0, 0);
            if (status != PCMVS_STATUS_OK && pcmvs_frame_error(frame, &error, sizeof error) == PCMVS_STATUS_OK) {
                CHECK(error.status == PCMVS_STATUS_OUT_OF_MEMORY || error.status == PCMVS_STATUS_OK);
            }
            /* The handle can be used, and what it makes does not depend on what has failed. */
            if (runs++ % 16 == 0) {
                OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
                bytes = glb(frame);
                CHECK(same(&bytes, &expected));
                free(bytes.data);
            }
            OK(pcmvs_frame_free(frame));
        }
    }
    fail(0, 0);
    OK(pcmvs_rig_free(rig));
    printf("%lu allocations, %lu runs, %lu of them failed, %lu allocations refused, %lu blocks left\n", (unsigned long)all,
           (unsigned long)runs, (unsigned long)failed, (unsigned long)refused, (unsigned long)heap.blocks);
    CHECK(heap.blocks == 0 && failed > 0);
    free(expected.data);
    capture_free(&capture);
    return verdict();
}
