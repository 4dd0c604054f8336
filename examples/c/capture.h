/*
 * Reads a capture from a folder of plain files, for the examples and tests in C. The folder holds cameras.txt and, for
 * each camera NN of the rig, the picture camNN.ppm and the mask camNN.pgm, which is white on the object. Both are binary.
 *
 * cameras.txt holds the number of cameras, then for each camera its width and height, K (9 numbers, row by row),
 * k1 k2 p1 p2 k3, R (9 numbers, row by row) and t (3 numbers), in OpenCV's convention.
 */
#ifndef CAPTURE_H
#define CAPTURE_H

#include <pcmvs.h>
#include <stdio.h>
#include <stdlib.h>

struct capture {
    uint32_t count;
    pcmvs_camera *cameras;
    pcmvs_image *pictures; /* count pictures, then count masks */
    pcmvs_view *views;
};

static int capture_read_netpbm(const char *path, pcmvs_image *image) {
    FILE *file = fopen(path, "rb");
    char kind;
    unsigned width, height, maximum;
    size_t bytes;
    void *data;
    if (file == NULL || fscanf(file, "P%c %u %u %u", &kind, &width, &height, &maximum) != 4 || fgetc(file) == EOF ||
        (kind != '5' && kind != '6') || maximum != 255) {
        fprintf(stderr, "%s: this is not a binary PGM or PPM file of 8 bits\n", path);
        if (file != NULL) {
            fclose(file);
        }
        return 0;
    }
    bytes = (size_t)width * height * (kind == '6' ? 3 : 1);
    data = malloc(bytes);
    if (data == NULL || fread(data, 1, bytes, file) != bytes) {
        fprintf(stderr, "%s: the file is truncated\n", path);
        free(data);
        fclose(file);
        return 0;
    }
    fclose(file);
    pcmvs_image_init(image, sizeof *image);
    image->format = kind == '6' ? PCMVS_PIXEL_FORMAT_RGB8 : PCMVS_PIXEL_FORMAT_GRAY8;
    image->width = width;
    image->height = height;
    image->data = data;
    return 1;
}

static int capture_read_numbers(FILE *file, double *numbers, int count) {
    int i;
    for (i = 0; i < count; i++) {
        if (fscanf(file, "%lf", &numbers[i]) != 1) {
            return 0;
        }
    }
    return 1;
}

static void capture_free(struct capture *capture) {
    uint32_t i;
    for (i = 0; capture->pictures != NULL && i < 2 * capture->count; i++) {
        free((void *)capture->pictures[i].data);
    }
    free(capture->cameras);
    free(capture->pictures);
    free(capture->views);
}

static int capture_read(const char *folder, struct capture *capture) {
    char path[1024];
    FILE *file;
    uint32_t i, n = 0;
    capture->count = 0;
    capture->cameras = NULL;
    capture->pictures = NULL;
    capture->views = NULL;
    snprintf(path, sizeof path, "%s/cameras.txt", folder);
    file = fopen(path, "r");
    if (file == NULL || fscanf(file, "%u", &n) != 1 || n > PCMVS_MAX_CAMERAS) {
        fprintf(stderr, "%s: cannot be read\n", path);
        if (file != NULL) {
            fclose(file);
        }
        return 0;
    }
    capture->cameras = (pcmvs_camera *)calloc(n, sizeof *capture->cameras);
    capture->pictures = (pcmvs_image *)calloc(2 * (size_t)n, sizeof *capture->pictures);
    capture->views = (pcmvs_view *)calloc(n, sizeof *capture->views);
    if (capture->cameras == NULL || capture->pictures == NULL || capture->views == NULL) {
        fclose(file);
        return 0;
    }
    capture->count = n;
    for (i = 0; i < n; i++) {
        pcmvs_camera *camera = &capture->cameras[i];
        pcmvs_camera_init(camera, sizeof *camera);
        if (fscanf(file, "%u %u", &camera->width, &camera->height) != 2 || !capture_read_numbers(file, camera->k, 9) ||
            !capture_read_numbers(file, camera->distortion, 5) || !capture_read_numbers(file, camera->r, 9) ||
            !capture_read_numbers(file, camera->t, 3)) {
            fprintf(stderr, "%s: camera %u is incomplete\n", path, i);
            fclose(file);
            return 0;
        }
    }
    fclose(file);
    for (i = 0; i < n; i++) {
        pcmvs_view *view = &capture->views[i];
        pcmvs_view_init(view, sizeof *view);
        view->image = &capture->pictures[i];
        view->mask = &capture->pictures[n + i];
        snprintf(path, sizeof path, "%s/cam%02u.ppm", folder, i);
        if (!capture_read_netpbm(path, &capture->pictures[i])) {
            return 0;
        }
        snprintf(path, sizeof path, "%s/cam%02u.pgm", folder, i);
        if (!capture_read_netpbm(path, &capture->pictures[n + i])) {
            return 0;
        }
    }
    return 1;
}

#endif
