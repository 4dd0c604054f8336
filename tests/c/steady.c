/* A frame averaged with its neighbours. Usage: steady FOLDER0 FOLDER1 FOLDER2 OUT.glb (see capture.h), with the frames of a
 * take. Writes the mean of the second one. */
#include "capture.h"
#include "files.h"

enum { FRAMES = 3 };

static struct bytes form(pcmvs_frame *frame) {
    struct bytes bytes = {NULL, 0, 0};
    pcmvs_form_options options;
    OK(pcmvs_form_options_init(&options, sizeof options));
    options.faces = 1000;
    OK(pcmvs_frame_form(frame, &options));
    OK(pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FORM, NULL, append, &bytes));
    return bytes;
}

/* Checks that an error's message contains something. */
static void check_message(const pcmvs_frame *frame, const char *part) {
    pcmvs_error error;
    OK(pcmvs_frame_error(frame, &error, sizeof error));
    CHECK(error.stage == PCMVS_STAGE_STEADY);
    if (strstr(error.message, part) == NULL) {
        printf("`%s` is not in: %s\n", part, error.message);
        failures++;
    }
}

static void check_misuse(const struct capture *capture, pcmvs_rig *rig, pcmvs_frame *const *frames) {
    const pcmvs_frame *others[17];
    pcmvs_frame *empty;
    pcmvs_rig *rig_of_others;
    pcmvs_camera *moved = malloc(capture->count * sizeof *moved);
    int i;
    for (i = 0; i < 17; i++) {
        others[i] = frames[0];
    }
    EXPECT(pcmvs_frame_steady(frames[1], others, 17), PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frames[1], "at most 16");
    others[0] = frames[1];
    EXPECT(pcmvs_frame_steady(frames[1], others, 1), PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frames[1], "its own neighbour");
    OK(pcmvs_frame_new(rig, &empty));
    others[0] = empty;
    EXPECT(pcmvs_frame_steady(frames[1], others, 1), PCMVS_STATUS_WRONG_ORDER);
    EXPECT(pcmvs_frame_steady(empty, NULL, 0), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_free(empty));
    EXPECT(pcmvs_frame_steady(frames[1], others, 1), PCMVS_STATUS_INVALID_HANDLE);

    if (moved == NULL) {
        exit(3);
    }
    memcpy(moved, capture->cameras, capture->count * sizeof *moved);
    for (i = 0; i < (int)capture->count; i++) {
        moved[i].t[0] += 0.1 * moved[i].r[0];
        moved[i].t[1] += 0.1 * moved[i].r[3];
        moved[i].t[2] += 0.1 * moved[i].r[6];
    }
    OK(pcmvs_rig_new(&rig_of_others));
    OK(pcmvs_rig_set_cameras(rig_of_others, moved, capture->count));
    OK(pcmvs_frame_new(rig_of_others, &empty));
    OK(pcmvs_frame_reconstruct(empty, capture->views, capture->count, NULL));
    others[0] = empty;
    EXPECT(pcmvs_frame_steady(frames[1], others, 1), PCMVS_STATUS_INVALID_ARGUMENT);
    check_message(frames[1], "same rig");
    OK(pcmvs_frame_free(empty));
    OK(pcmvs_rig_free(rig_of_others));
    free(moved);
}

int main(int argc, char **argv) {
    struct capture captures[FRAMES];
    pcmvs_rig *rig;
    pcmvs_frame *frames[FRAMES];
    const pcmvs_frame *neighbours[2];
    struct bytes alone, mean, other_alone, alone_form, mean_form;
    FILE *file;
    int i;
    if (argc != FRAMES + 2) {
        return 2;
    }
    OK(pcmvs_rig_new(&rig));
    for (i = 0; i < FRAMES; i++) {
        if (!capture_read(argv[1 + i], &captures[i])) {
            return 2;
        }
        if (i == 0) {
            OK(pcmvs_rig_set_cameras(rig, captures[0].cameras, captures[0].count));
        }
        OK(pcmvs_frame_new(rig, &frames[i]));
        OK(pcmvs_frame_reconstruct(frames[i], captures[i].views, captures[i].count, NULL));
    }
    check_misuse(&captures[0], rig, frames);
    alone = glb(frames[1]);
    alone_form = form(frames[1]);
    other_alone = glb(frames[0]);

    neighbours[0] = frames[0];
    neighbours[1] = frames[2];
    OK(pcmvs_frame_steady(frames[1], neighbours, 2));
    mean = glb(frames[1]);
    mean_form = form(frames[1]);
    CHECK(!same(&mean, &alone) && mean.size == alone.size);
    CHECK(!same(&mean_form, &alone_form));

    /* The order of averaging does not matter, and doing it twice changes nothing. */
    neighbours[0] = frames[1];
    OK(pcmvs_frame_steady(frames[0], neighbours, 1));
    neighbours[0] = frames[0];
    OK(pcmvs_frame_steady(frames[1], neighbours, 2));
    {
        struct bytes again = glb(frames[1]);
        CHECK(same(&again, &mean));
        free(again.data);
    }
    /* Without neighbours the frame has its own mesh again. */
    OK(pcmvs_frame_steady(frames[0], NULL, 0));
    {
        struct bytes again = glb(frames[0]);
        CHECK(same(&again, &other_alone));
        free(again.data);
    }
    file = fopen(argv[FRAMES + 1], "wb");
    CHECK(file != NULL && fwrite(mean.data, 1, mean.size, file) == mean.size && fclose(file) == 0);

    for (i = 0; i < FRAMES; i++) {
        OK(pcmvs_frame_free(frames[i]));
        capture_free(&captures[i]);
    }
    OK(pcmvs_rig_free(rig));
    free(alone.data);
    free(mean.data);
    free(other_alone.data);
    free(alone_form.data);
    free(mean_form.data);
    return verdict();
}
