/* A parallel callback that returns before its jobs have, and threads that come when a batch is over. The result is the same.
 * Usage: early FOLDER (see capture.h) */
#define _POSIX_C_SOURCE 200809L
#include "capture.h"
#include "check.h"

#include <pthread.h>
#include <time.h>

#define MOST 4096

struct late {
    pcmvs_job_fn run;
    void *job;
    uint32_t count;
};

static struct late batches[MOST];
static pthread_t threads[MOST];
static uint32_t started;

static void wait_ms(long ms) {
    struct timespec time;
    time.tv_sec = 0, time.tv_nsec = ms * 1000000;
    nanosleep(&time, NULL);
}

static void *work(void *argument) {
    const struct late *batch = argument;
    batch->run(batch->job, 0);
    wait_ms(2);
    batch->run(batch->job, batch->count - 1);
    wait_ms(20);
    batch->run(batch->job, batch->count / 2);
    return NULL;
}

static void returns_early(void *user, uint32_t count, pcmvs_job_fn run, void *job) {
    (void)user;
    if (started < MOST) {
        struct late *batch = &batches[started];
        batch->run = run, batch->job = job, batch->count = count;
        CHECK(pthread_create(&threads[started], NULL, work, batch) == 0);
        started++;
        wait_ms(1);
    }
}

static uint64_t hash(const pcmvs_frame *frame) {
    pcmvs_stage_report report;
    report.hash = 0;
    OK(pcmvs_frame_get_stage_report(frame, PCMVS_STAGE_COLOUR, &report, sizeof report));
    return report.hash;
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    pcmvs_options options;
    uint64_t expected;
    uint32_t i;
    if (argc != 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, capture.cameras, capture.count));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, NULL));
    expected = hash(frame);
    OK(pcmvs_options_init(&options, sizeof options));
    options.parallel = returns_early;
    for (i = 0; i < 5; i++) {
        OK(pcmvs_frame_reconstruct(frame, capture.views, capture.count, &options));
        CHECK(hash(frame) == expected);
    }
    CHECK(started > 5);
    for (i = 0; i < started; i++) {
        CHECK(pthread_join(threads[i], NULL) == 0);
    }
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_rig_free(rig));
    capture_free(&capture);
    return verdict();
}
