/* Reconstructs the capture in a folder (see capture.h) with one call. Usage: reconstruct FOLDER OUT.glb */
#include "capture.h"

static int show(void *user, uint32_t stage, uint32_t done, uint32_t total) {
    (void)user;
    fprintf(stderr, "\r%-8s %3u %%", pcmvs_stage_name(stage), done * 100 / total);
    return 0; /* any other value cancels */
}

static int write_to_file(void *file, const void *data, size_t size) {
    return fwrite(data, 1, size, file) != size;
}

static pcmvs_status reconstruct(const struct capture *capture, pcmvs_rig *rig, const char *path) {
    pcmvs_frame *frame = NULL;
    pcmvs_status status = pcmvs_frame_new(rig, &frame);
    pcmvs_options options;
    FILE *file;
    if (status != PCMVS_STATUS_OK) {
        return status;
    }
    pcmvs_options_init(&options, sizeof options);
    options.progress = show;
    status = pcmvs_frame_reconstruct(frame, capture->views, capture->count, &options);
    fputc('\n', stderr);
    if (status != PCMVS_STATUS_OK) {
        pcmvs_error error;
        pcmvs_frame_error(frame, &error, sizeof error);
        fprintf(stderr, "%s\n", error.message);
    } else if ((file = fopen(path, "wb")) == NULL) {
        perror(path);
        status = PCMVS_STATUS_WRITE_FAILED;
    } else {
        status = pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, write_to_file, file);
        if (fclose(file) != 0) {
            status = PCMVS_STATUS_WRITE_FAILED;
        }
    }
    pcmvs_frame_free(frame);
    return status;
}

int main(int argc, char **argv) {
    struct capture capture;
    pcmvs_rig *rig = NULL;
    pcmvs_status status;
    if (argc != 3) {
        fprintf(stderr, "usage: %s FOLDER OUT.glb\n", argv[0]);
        return 2;
    }
    if (!capture_read(argv[1], &capture)) {
        capture_free(&capture);
        return 2;
    }
    status = pcmvs_rig_new(&rig);
    if (status == PCMVS_STATUS_OK) {
        status = pcmvs_rig_set_cameras(rig, capture.cameras, capture.count);
    }
    if (status == PCMVS_STATUS_OK) {
        status = reconstruct(&capture, rig, argv[2]);
    } else if (rig != NULL) {
        pcmvs_error error;
        pcmvs_rig_error(rig, &error, sizeof error);
        fprintf(stderr, "%s\n", error.message);
    }
    pcmvs_rig_free(rig);
    capture_free(&capture);
    if (status != PCMVS_STATUS_OK) {
        fprintf(stderr, "failed: %s\n", pcmvs_status_name(status));
    }
    return status == PCMVS_STATUS_OK ? 0 : 1;
}
