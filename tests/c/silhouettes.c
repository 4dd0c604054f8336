/* Tests pictures with luma and colour differences, and silhouettes from masks, a chroma key and a clean plate. The scene is a ball in front of a green
 * backdrop, which this program renders. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CAMERAS = 8, WIDTH = 161, HEIGHT = 121 }; /* odd, so that NV12's last chroma column and row cover one pixel */

static const double RADIUS = 0.8, DISTANCE = 4.0, FOCAL = 200.0;

/* The pictures of one camera. NV12's planes have padded rows, stored from the bottom up. */
struct shot {
    unsigned char rgb[HEIGHT][WIDTH][3], plate[HEIGHT][WIDTH][3], mask[HEIGHT][WIDTH];
    unsigned char luma[HEIGHT][WIDTH + 7], chroma[(HEIGHT + 1) / 2][WIDTH + 1 + 10];
    unsigned char decoded[HEIGHT][WIDTH][3];
    /* The same values as in NV12, in the layouts of the other formats. */
    unsigned char cb[(HEIGHT + 1) / 2][(WIDTH + 1) / 2], cr[(HEIGHT + 1) / 2][(WIDTH + 1) / 2];
    uint16_t luma10[HEIGHT][WIDTH], chroma10[(HEIGHT + 1) / 2][WIDTH + 1];
    unsigned char yuy2[HEIGHT][(WIDTH + 1) / 2][4];
};

struct scene {
    pcmvs_camera cameras[CAMERAS];
    struct shot shots[CAMERAS];
    pcmvs_image images[CAMERAS][2];
    pcmvs_view views[CAMERAS];
    pcmvs_chroma_key key;
};

/* Places camera `i` on a ring around the origin, looking at it. */
static void aim(pcmvs_camera *camera, int i) {
    const double turn = 2 * 3.14159265358979 * i / CAMERAS, tilt = i % 2 ? 0.5 : -0.3;
    const double x[3] = {-sin(turn), cos(turn), 0};
    const double z[3] = {-cos(turn) * cos(tilt), -sin(turn) * cos(tilt), -sin(tilt)};
    const double y[3] = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]};
    OK(pcmvs_camera_init(camera, sizeof *camera));
    camera->width = WIDTH;
    camera->height = HEIGHT;
    camera->k[0] = camera->k[4] = FOCAL;
    camera->k[2] = (WIDTH - 1) / 2.0;
    camera->k[5] = (HEIGHT - 1) / 2.0;
    memcpy(&camera->r[0], x, sizeof x);
    memcpy(&camera->r[3], y, sizeof y);
    memcpy(&camera->r[6], z, sizeof z);
    camera->t[2] = DISTANCE; /* the origin is on the optical axis */
}

/* Distance in pixels by which (x, y) is inside the ball's outline, a circle around the centre. */
static double inside(int x, int y) {
    const double outline = FOCAL * RADIUS / sqrt(DISTANCE * DISTANCE - RADIUS * RADIUS);
    return outline - hypot(x - (WIDTH - 1) / 2.0, y - (HEIGHT - 1) / 2.0);
}

static unsigned char byte(double value) {
    return (unsigned char)(value < 0 ? 0 : value > 255 ? 255 : value + 0.5);
}

static void shoot(struct shot *shot, int i) {
    static const double backdrop[3] = {46, 158, 66};
    int x, y, k;
    for (y = 0; y < HEIGHT; y++) {
        for (x = 0; x < WIDTH; x++) {
            const double light = 0.75 + 0.25 * x / WIDTH, cover = inside(x, y) + 0.5;
            const double a = cover < 0 ? 0 : cover > 1 ? 1 : cover;
            const double stripes = 40 * sin(x * 0.4 + i) * cos(y * 0.3);
            const double ball[3] = {190 + stripes, 110 - stripes, 120};
            for (k = 0; k < 3; k++) {
                shot->plate[y][x][k] = byte(backdrop[k] * light);
                shot->rgb[y][x][k] = byte(backdrop[k] * light * (1 - a) + ball[k] * a);
            }
            shot->mask[y][x] = byte(255 * a);
        }
    }
}

/* Converts to NV12 and back to RGB, by the definitions of BT.601 and BT.709. */
static void encode(struct shot *shot, uint32_t ycbcr) {
    const int is_full = ycbcr == PCMVS_YCBCR_BT601_FULL || ycbcr == PCMVS_YCBCR_BT709_FULL;
    const int is_601 = ycbcr == PCMVS_YCBCR_BT601_VIDEO || ycbcr == PCMVS_YCBCR_BT601_FULL;
    const double kr = is_601 ? 0.299 : 0.2126, kb = is_601 ? 0.114 : 0.0722, kg = 1 - kr - kb;
    const double black = is_full ? 0 : 16, light = is_full ? 1 : 219 / 255.0, difference = is_full ? 1 : 224 / 255.0;
    int x, y, k;
    memset(shot->luma, 0, sizeof shot->luma);
    memset(shot->chroma, 0, sizeof shot->chroma);
    for (y = 0; y < HEIGHT; y++) {
        for (x = 0; x < WIDTH; x++) {
            const unsigned char *p = shot->rgb[y][x];
            const double grey = kr * p[0] + kg * p[1] + kb * p[2];
            unsigned char *pair = &shot->chroma[(HEIGHT - 1) / 2 - y / 2][x / 2 * 2];
            shot->luma[HEIGHT - 1 - y][x] = byte(black + grey * light);
            if (x % 2 == 0 && y % 2 == 0) {
                pair[0] = byte(128 + (p[2] - grey) / (2 * (1 - kb)) * difference);
                pair[1] = byte(128 + (p[0] - grey) / (2 * (1 - kr)) * difference);
            }
        }
    }
    for (y = 0; y < HEIGHT; y++) {
        for (x = 0; x < WIDTH; x++) {
            const unsigned char *pair = &shot->chroma[(HEIGHT - 1) / 2 - y / 2][x / 2 * 2];
            const unsigned char luma = shot->luma[HEIGHT - 1 - y][x];
            const double grey = (luma - black) / light;
            const double blue = 2 * (1 - kb) * (pair[0] - 128) / difference, red = 2 * (1 - kr) * (pair[1] - 128) / difference;
            const double rgb[3] = {grey + red, grey - kb / kg * blue - kr / kg * red, grey + blue};
            for (k = 0; k < 3; k++) {
                shot->decoded[y][x][k] = byte(rgb[k]);
            }
            shot->cb[y / 2][x / 2] = pair[0];
            shot->cr[y / 2][x / 2] = pair[1];
            shot->luma10[y][x] = (uint16_t)(luma << 8);
            for (k = 0; k < 2; k++) {
                shot->chroma10[y / 2][x / 2 * 2 + k] = (uint16_t)(pair[k] << 8);
                shot->yuy2[y][x / 2][2 * k + 1] = pair[k];
            }
            shot->yuy2[y][x / 2][x % 2 * 2] = luma;
        }
    }
}

static void describe(pcmvs_image *image, uint32_t format, const void *data) {
    OK(pcmvs_image_init(image, sizeof *image));
    image->format = format;
    image->width = WIDTH;
    image->height = HEIGHT;
    image->data = data;
}

static void nv12(pcmvs_image *image, const struct shot *shot) {
    describe(image, PCMVS_PIXEL_FORMAT_NV12, shot->luma[HEIGHT - 1]);
    image->stride = -(ptrdiff_t)sizeof shot->luma[0];
    image->chroma = shot->chroma[(HEIGHT - 1) / 2];
    image->chroma_stride = -(ptrdiff_t)sizeof shot->chroma[0];
}

static void i420(pcmvs_image *image, const struct shot *shot) {
    describe(image, PCMVS_PIXEL_FORMAT_I420, shot->luma[HEIGHT - 1]);
    image->stride = -(ptrdiff_t)sizeof shot->luma[0];
    image->chroma = shot->cb;
    image->cr = shot->cr;
}

static void p010(pcmvs_image *image, const struct shot *shot) {
    describe(image, PCMVS_PIXEL_FORMAT_P010, shot->luma10);
    image->chroma = shot->chroma10;
}

static void yuy2(pcmvs_image *image, const struct shot *shot) {
    describe(image, PCMVS_PIXEL_FORMAT_YUY2, shot->yuy2);
}

enum silhouette { MASK, CHROMA_KEY, CLEAN_PLATE };

enum pictures { RGB, NV12, FROM_NV12, I420, P010, YUY2 }; /* FROM_NV12 are NV12's colours as RGB */

/* How the pictures code colours. */
static uint32_t coding = PCMVS_YCBCR_BT601_VIDEO;

/* Reconstructs the ball. */
static void reconstruct(struct scene *scene, pcmvs_frame *frame, enum pictures pictures, enum silhouette kind) {
    pcmvs_options options;
    int i;
    OK(pcmvs_options_init(&options, sizeof options));
    options.preset = PCMVS_PRESET_HULL;
    for (i = 0; i < CAMERAS; i++) {
        struct shot *shot = &scene->shots[i];
        pcmvs_image *images = scene->images[i];
        pcmvs_view *view = &scene->views[i];
        OK(pcmvs_view_init(view, sizeof *view));
        view->image = &images[0];
        switch (pictures) {
        case RGB:
        case FROM_NV12:
            describe(&images[0], PCMVS_PIXEL_FORMAT_RGB8, pictures == RGB ? shot->rgb[0] : shot->decoded[0]);
            break;
        case NV12:
            nv12(&images[0], shot);
            break;
        case I420:
            i420(&images[0], shot);
            break;
        case P010:
            p010(&images[0], shot);
            break;
        case YUY2:
            yuy2(&images[0], shot);
            break;
        }
        images[0].ycbcr = coding;
        if (kind == MASK) {
            describe(&images[1], PCMVS_PIXEL_FORMAT_GRAY8, shot->mask);
            view->mask = &images[1];
        } else if (kind == CLEAN_PLATE) {
            describe(&images[1], PCMVS_PIXEL_FORMAT_RGB8, shot->plate);
            view->clean_plate = &images[1];
        } else {
            view->chroma_key = &scene->key;
        }
    }
    OK(pcmvs_frame_reconstruct(frame, scene->views, CAMERAS, &options));
}

/* Checks that every silhouette is the ball's, and returns the largest error of its outline in pixels. */
static double outline_error(const pcmvs_frame *frame) {
    double worst = 0;
    int i, x, y;
    for (i = 0; i < CAMERAS; i++) {
        pcmvs_silhouette found;
        OK(pcmvs_frame_get_silhouette(frame, (uint32_t)i, &found, sizeof found));
        CHECK(found.width == WIDTH && found.height == HEIGHT);
        for (y = 0; y < HEIGHT; y++) {
            for (x = 0; x < WIDTH; x++) {
                const double distance = found.distances[y * WIDTH + x] / 64.0, truth = inside(x, y);
                CHECK(fabs(truth) < 1.5 || (distance > 0) == (truth > 0));
                if (fabs(truth) < 1.5 && fabs(distance - truth) > worst) {
                    worst = fabs(distance - truth);
                }
            }
        }
    }
    return worst;
}

/* Volume of the final mesh. */
static double volume(const pcmvs_frame *frame) {
    pcmvs_mesh mesh;
    double sum = 0;
    uint32_t i;
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    for (i = 0; i < mesh.triangle_count; i++) {
        const uint32_t *corners = &mesh.triangles[3 * i];
        const float *a = &mesh.positions[3 * corners[0]], *b = &mesh.positions[3 * corners[1]];
        const float *c = &mesh.positions[3 * corners[2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

/* The frame's error message, which must be about a camera's view. Valid until the next call of this function. */
static const char *view_error(const pcmvs_frame *frame, int camera) {
    static pcmvs_error error;
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(error.camera == camera && error.stage == PCMVS_STAGE_VIEWS);
    return error.message;
}

/* Mean of one channel of the mesh's colours. */
static double mean_colour(const pcmvs_frame *frame, int channel) {
    pcmvs_mesh mesh;
    double sum = 0;
    uint32_t i;
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &mesh, sizeof mesh));
    for (i = 0; i < mesh.vertex_count; i++) {
        sum += mesh.colours[3 * i + (uint32_t)channel];
    }
    return sum / mesh.vertex_count;
}

/* The meshes of two frames have the same colours on average. */
static void check_colours(const pcmvs_frame *frame, const pcmvs_frame *other) {
    int channel;
    for (channel = 0; channel < 3; channel++) {
        CHECK(fabs(mean_colour(frame, channel) - mean_colour(other, channel)) < 0.5);
    }
}

/* View 1 with a picture of its own, which can be changed. */
static pcmvs_view with_image(const struct scene *scene, pcmvs_image *image) {
    pcmvs_view view = scene->views[1];
    *image = *view.image;
    view.image = image;
    return view;
}

/* NV12 gives the shape and the colours of the same pictures in RGB. They are not equal byte for byte: colours are rounded
 * differently, and contours follow the photograph. */
static void check_nv12(struct scene *scene, pcmvs_frame *frame, pcmvs_frame *other) {
    pcmvs_view view;
    pcmvs_image image;
    double error, volumes;
    reconstruct(scene, frame, NV12, MASK);
    reconstruct(scene, other, FROM_NV12, MASK);
    error = outline_error(frame);
    volumes = volume(frame) / volume(other);
    printf("NV12: outlines to %.2f pixels, %.5f of the volume from RGB\n", error, volumes);
    CHECK(error < outline_error(other) + 0.02);
    CHECK(fabs(volumes - 1) < 0.0005);
    check_colours(frame, other);
    /* A chroma key works with NV12 too. */
    reconstruct(scene, frame, NV12, CHROMA_KEY);
    error = outline_error(frame);
    printf("NV12 and chroma key: outlines to %.2f pixels\n", error);
    CHECK(error < 1.3); /* four pixels share one colour */

    /* Missing planes and planes that are too narrow. */
    OK(pcmvs_frame_begin(frame, NULL));
    view = with_image(scene, &image);
    image.chroma = NULL;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_NULL_POINTER);
    CHECK(strstr(view_error(frame, 1), "view.image.chroma") != NULL);
    image = *scene->views[1].image;
    image.chroma_stride = WIDTH; /* a row has one byte more, because the width is odd */
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_IMAGE);
}

/* Whether two frames have the same mesh. */
static int is_same_mesh(const pcmvs_frame *frame, const pcmvs_frame *other) {
    pcmvs_mesh a, b;
    OK(pcmvs_frame_get_mesh(frame, PCMVS_MESH_KIND_FINAL, &a, sizeof a));
    OK(pcmvs_frame_get_mesh(other, PCMVS_MESH_KIND_FINAL, &b, sizeof b));
    return a.vertex_count == b.vertex_count && a.triangle_count == b.triangle_count &&
           memcmp(a.positions, b.positions, 12u * a.vertex_count) == 0 && memcmp(a.colours, b.colours, 3u * a.vertex_count) == 0 &&
           memcmp(a.triangles, b.triangles, 12u * a.triangle_count) == 0;
}

/* The same values in another layout give the same mesh, and each standard gives the colours of its definition. */
static void check_layouts(struct scene *scene, pcmvs_frame *frame, pcmvs_frame *other) {
    static const enum pictures layouts[] = {I420, P010, YUY2};
    pcmvs_view view;
    pcmvs_image image;
    int i;
    for (coding = PCMVS_YCBCR_BT601_VIDEO; coding <= PCMVS_YCBCR_BT709_FULL; coding++) {
        for (i = 0; i < CAMERAS; i++) {
            encode(&scene->shots[i], coding);
        }
        reconstruct(scene, frame, NV12, MASK);
        for (i = 0; i < 3; i++) {
            reconstruct(scene, other, layouts[i], MASK);
            CHECK(is_same_mesh(frame, other));
        }
        reconstruct(scene, other, FROM_NV12, MASK);
        check_colours(frame, other);
    }
    /* A plane that is missing, and a standard that does not exist. */
    coding = PCMVS_YCBCR_BT601_VIDEO;
    reconstruct(scene, other, I420, MASK);
    OK(pcmvs_frame_begin(frame, NULL));
    view = with_image(scene, &image);
    image.cr = NULL;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_NULL_POINTER);
    CHECK(strstr(view_error(frame, 1), "view.image.cr") != NULL);
    image = *scene->views[1].image;
    image.cr_stride = WIDTH / 2; /* one byte too short, because the width is odd */
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_IMAGE);
    image = *scene->views[1].image;
    image.ycbcr = 4;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_INVALID_ARGUMENT);
    CHECK(strstr(view_error(frame, 1), "view.image.ycbcr") != NULL);
    image = *scene->views[1].image;
    image.reserved = 1;
    EXPECT(pcmvs_frame_view(frame, 1, &view), PCMVS_STATUS_INVALID_STRUCT);
}

/* A chroma key and a clean plate give the same silhouettes as masks. */
static void check_silhouettes(struct scene *scene, pcmvs_frame *frame) {
    static const char *const names[] = {"mask", "chroma key", "clean plate"};
    const double ball = 4.18879 * RADIUS * RADIUS * RADIUS;
    double volumes[3], errors[3];
    int kind;
    for (kind = MASK; kind <= CLEAN_PLATE; kind++) {
        reconstruct(scene, frame, RGB, (enum silhouette)kind);
        errors[kind] = outline_error(frame);
        volumes[kind] = volume(frame);
        printf("%s: outlines to %.2f pixels, volume %.4f\n", names[kind], errors[kind], volumes[kind]);
        CHECK(errors[kind] < (kind == MASK ? 0.1 : 0.6));
        CHECK(fabs(volumes[kind] / volumes[MASK] - 1) < 0.02);
    }
    /* The hull is slightly larger than the ball. */
    CHECK(volumes[MASK] > ball && volumes[MASK] < 1.2 * ball);
}

/* Unusable keys and plates are reported as the camera's silhouette. */
static void check_refusals(struct scene *scene, pcmvs_frame *frame) {
    pcmvs_view view = scene->views[3];
    pcmvs_image plate = scene->images[3][1];
    pcmvs_chroma_key key = scene->key;
    OK(pcmvs_frame_begin(frame, NULL));
    view.clean_plate = &plate;
    plate.height -= 1;
    EXPECT(pcmvs_frame_view(frame, 3, &view), PCMVS_STATUS_SILHOUETTE);
    CHECK(strstr(view_error(frame, 3), "clean plate") != NULL);
    view.clean_plate = NULL;
    view.chroma_key = &key;
    memset(key.rgb, 128, 3);
    EXPECT(pcmvs_frame_view(frame, 3, &view), PCMVS_STATUS_SILHOUETTE);
    CHECK(strstr(view_error(frame, 3), "gray") != NULL);
    key.struct_size = 1;
    EXPECT(pcmvs_frame_view(frame, 3, &view), PCMVS_STATUS_INVALID_STRUCT);
    CHECK(strstr(view_error(frame, 3), "view.chroma_key") != NULL);
    view.mask = &plate;
    EXPECT(pcmvs_frame_view(frame, 3, &view), PCMVS_STATUS_INVALID_ARGUMENT);
    CHECK(strstr(view_error(frame, 3), "give one") != NULL);
}

int main(void) {
    struct scene *scene = calloc(1, sizeof *scene);
    pcmvs_rig *rig = NULL;
    pcmvs_frame *frame = NULL, *other = NULL;
    int i;
    if (scene == NULL) {
        return 3;
    }
    for (i = 0; i < CAMERAS; i++) {
        aim(&scene->cameras[i], i);
        shoot(&scene->shots[i], i);
        encode(&scene->shots[i], coding);
    }
    OK(pcmvs_chroma_key_init(&scene->key, sizeof scene->key));
    OK(pcmvs_rig_new(&rig));
    OK(pcmvs_rig_set_cameras(rig, scene->cameras, CAMERAS));
    OK(pcmvs_frame_new(rig, &frame));
    OK(pcmvs_frame_new(rig, &other));
    check_nv12(scene, frame, other);
    check_layouts(scene, frame, other);
    check_silhouettes(scene, frame);
    check_refusals(scene, frame);
    OK(pcmvs_frame_free(frame));
    OK(pcmvs_frame_free(other));
    OK(pcmvs_rig_free(rig));
    free(scene);
    return verdict();
}
