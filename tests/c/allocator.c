/* Tests the caller's allocator. Usage: allocator FOLDER GLB [growing] (see capture.h). With `growing` the allocator has a
 * function that resizes memory; without it the library copies. */
#include "capture.h"
#include "files.h"
#ifdef COUNT_MALLOC
#include "counted.h"
#endif

/* Stored in front of every block. */
struct block {
    size_t size, alignment;
    uint64_t mark;
    void *start;
};

#define MARK 0x70636d7673616c6cu

static struct heap {
    size_t blocks, bytes, calls, grown, all_bytes;
} heap;

static struct block block_of(const void *memory) {
    struct block block;
    memcpy(&block, (const char *)memory - sizeof block, sizeof block);
    return block;
}

/* Allocates memory that is not aligned to more than `alignment` and not zero. */
static void *allocate(void *user, size_t size, size_t alignment) {
    struct heap *h = user;
    const size_t before = sizeof(struct block) + alignment;
    struct block block;
    char *memory;
    CHECK(h == &heap && size > 0 && alignment > 0 && (alignment & (alignment - 1)) == 0);
    block.start = malloc(before + size);
    if (block.start == NULL) {
        return NULL;
    }
    block.size = size;
    block.alignment = alignment;
    block.mark = MARK;
    memory = (char *)block.start + before - ((uintptr_t)block.start + before) % alignment;
    memset(memory, 0xA5, size);
    memcpy(memory - sizeof block, &block, sizeof block);
    h->calls++;
    h->blocks++;
    h->bytes += size;
    h->all_bytes += size;
    return memory;
}

static void deallocate(void *user, void *memory, size_t size, size_t alignment) {
    struct heap *h = user;
    const struct block block = block_of(memory);
    CHECK(h == &heap && block.mark == MARK && block.size == size && block.alignment == alignment);
    CHECK((uintptr_t)memory % alignment == 0);
    memset((char *)memory - sizeof block, 0, sizeof block);
    h->blocks--;
    h->bytes -= size;
    free(block.start);
}

static void one_by_one(void *user, uint32_t count, pcmvs_job_fn run, void *job) {
    uint32_t i;
    (void)user;
    for (i = 0; i < count; i++) {
        run(job, i);
    }
}

static void *reallocate(void *user, void *memory, size_t old_size, size_t size, size_t alignment) {
    void *moved = allocate(user, size, alignment);
    if (moved != NULL) {
        memcpy(moved, memory, old_size < size ? old_size : size);
        deallocate(user, memory, old_size, alignment);
        heap.grown++;
    }
    return moved;
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_allocator allocator;
    pcmvs_options options;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    pcmvs_calibration *calibration = NULL;
    struct bytes bytes, again;
    FILE *file;
    int growing = argc == 4 && strcmp(argv[3], "growing") == 0;
    /* Reading the capture calls init functions. An allocator can still be set after them. */
    if (argc < 3 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    CHECK(pcmvs_version() == PCMVS_VERSION && pcmvs_status_name(0) != NULL);
    CHECK(pcmvs_stage_count() > 0 && pcmvs_stage_name(pcmvs_stage_at(0)) != NULL);
    OK(pcmvs_allocator_init(&allocator, sizeof allocator));
    /* It can also be set after calls that fail. */
    EXPECT(pcmvs_set_allocator(NULL), PCMVS_STATUS_NULL_POINTER);
    EXPECT(pcmvs_set_allocator(&allocator), PCMVS_STATUS_INVALID_ARGUMENT);
    allocator.user = &heap;
    allocator.allocate = allocate;
    EXPECT(pcmvs_set_allocator(&allocator), PCMVS_STATUS_INVALID_ARGUMENT);
    allocator.deallocate = deallocate;
    allocator.reallocate = growing ? reallocate : NULL;
    allocator.struct_size = 8;
    EXPECT(pcmvs_set_allocator(&allocator), PCMVS_STATUS_INVALID_STRUCT);
    allocator.struct_size = sizeof allocator;
    allocator.reserved = 1;
    EXPECT(pcmvs_set_allocator(&allocator), PCMVS_STATUS_INVALID_STRUCT);
    allocator.reserved = 0;
    OK(pcmvs_set_allocator(&allocator));
    /* It can be set only once. */
    EXPECT(pcmvs_set_allocator(&allocator), PCMVS_STATUS_WRONG_ORDER);
    CHECK(heap.calls == 0);

#ifdef COUNT_MALLOC
    start();
#endif
    OK(pcmvs_rig_new(&rig));
    CHECK(heap.blocks > 0);
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
    OK(pcmvs_calibration_new(rig, &calibration));
    OK(pcmvs_calibration_add_frame(calibration, capture.views, capture.count, NULL));
    OK(pcmvs_calibration_run(calibration, NULL));
    OK(pcmvs_calibration_free(calibration));
#ifdef COUNT_MALLOC
    /* Only the allocator above has called malloc. */
    CHECK(counts.calls == heap.calls);
#endif
    /* At least the pictures are held in its memory. */
    CHECK(heap.bytes > 6u * capture.count * capture.cameras[0].width * capture.cameras[0].height);
    CHECK(growing == (heap.grown > 0));
    bytes = glb(frame);
    file = fopen(argv[2], "wb");
    CHECK(file != NULL && fwrite(bytes.data, 1, bytes.size, file) == bytes.size && fclose(file) == 0);
    /* Reused memory does not change the result. */
    OK(pcmvs_options_init(&options, sizeof options));
    options.parallel = one_by_one;
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, &options));
    again = glb(frame);
    CHECK(same(&bytes, &again));
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    printf("%lu blocks with %lu bytes were allocated, %lu are left\n", (unsigned long)heap.calls, (unsigned long)heap.all_bytes,
           (unsigned long)heap.blocks);
    CHECK(heap.blocks == 0 && heap.bytes == 0);
    free(bytes.data);
    free(again.data);
    capture_free(&capture);
    return verdict();
}
