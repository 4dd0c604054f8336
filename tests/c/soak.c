/* Reconstructs many frames with one handle. Usage: soak FOLDER FRAMES STEADY (see capture.h). If STEADY is 1, the program
 * fails if memory grows. */
#include "capture.h"

static long resident_pages(void) {
    long pages = -1;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file != NULL) {
        if (fscanf(file, "%*d %ld", &pages) != 1) {
            pages = -1;
        }
        fclose(file);
    }
    return pages;
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL;
    pcmvs_options options;
    pcmvs_status status;
    uint32_t frames;
    long early = 0, late;
    if (argc != 4 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    frames = (uint32_t)strtoul(argv[2], NULL, 10);
    pcmvs_options_init(&options, sizeof options);
    status = pcmvs_rig_new(&rig);
    if (status == PCMVS_STATUS_OK) {
        status = pcmvs_rig_set_cameras(rig, capture.cameras, capture.count);
    }
    if (status == PCMVS_STATUS_OK) {
        status = pcmvs_frame_new(rig, &frame);
    }
    for (options.frame = 0; options.frame < frames && status == PCMVS_STATUS_OK; options.frame++) {
        if (options.frame == frames / 5) {
            early = resident_pages();
        }
        options.preset = options.frame % 4;
        status = pcmvs_frame_reconstruct(frame, capture.views, capture.count, &options);
    }
    late = resident_pages();
    printf("%s after %u frames, %ld pages, then %ld\n", pcmvs_status_name(status), options.frame, early, late);
    pcmvs_frame_free(frame);
    pcmvs_rig_free(rig);
    capture_free(&capture);
    if (argv[3][0] == '1' && late > early + early / 20) {
        printf("memory grows\n");
        return 1;
    }
    return status == PCMVS_STATUS_OK ? 0 : 1;
}
