/* Replaces malloc by a wrapper around glibc's that counts allocations. For one thread only. */
#ifndef COUNTED_H
#define COUNTED_H

#include <errno.h>
#include <malloc.h>
#include <stdlib.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *memory);

/* Number of allocations and their bytes since the last `start`. Bytes in use now and at most, as rounded up by glibc. */
static struct counts {
    size_t calls, bytes, used, peak;
} counts;

static void *took(void *memory, size_t size) {
    counts.calls++;
    counts.bytes += size;
    counts.used += malloc_usable_size(memory);
    counts.peak = counts.peak > counts.used ? counts.peak : counts.used;
    return memory;
}

void *malloc(size_t size) { return took(__libc_malloc(size), size); }

void *calloc(size_t count, size_t size) { return took(__libc_calloc(count, size), count * size); }

void *realloc(void *old, size_t size) {
    const size_t before = malloc_usable_size(old);
    void *memory = __libc_realloc(old, size);
    if (memory != NULL || size == 0) {
        counts.used -= before;
    }
    return took(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size) { return took(__libc_memalign(alignment, size), size); }

int posix_memalign(void **memory, size_t alignment, size_t size) {
    *memory = aligned_alloc(alignment, size);
    return *memory == NULL ? ENOMEM : 0;
}

void free(void *memory) {
    counts.used -= malloc_usable_size(memory);
    __libc_free(memory);
}

static void start(void) {
    counts.calls = counts.bytes = 0;
    counts.peak = counts.used;
}

#endif
