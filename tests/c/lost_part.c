/* A frame whose masks lack a part that those of the frames before and after it have. Usage: lost_part FOLDER0 FOLDER1 FOLDER2
 * OUT.glb (see capture.h), with the frames of a take. Writes the second one, made again and averaged. */
#include "capture.h"
#include "files.h"

enum { FRAMES = 3 };

int main(int argc, char **argv) {
    struct capture captures[FRAMES];
    pcmvs_rig *rig;
    pcmvs_frame *frames[FRAMES], *again;
    const pcmvs_frame *neighbours[2];
    pcmvs_view missing;
    struct bytes lacking, whole, mean;
    uint32_t may_have = 7, pixels = 7, restored = 0, named = 0, warnings, i;
    FILE *file;
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
        EXPECT(pcmvs_frame_may_have_lost_part(frames[i], frames[0], frames[0], &may_have),
               i == 0 ? PCMVS_STATUS_INVALID_ARGUMENT : PCMVS_STATUS_WRONG_ORDER);
        OK(pcmvs_frame_reconstruct(frames[i], captures[i].views, captures[i].count, NULL));
    }
    CHECK(may_have == 7);
    lacking = glb(frames[1]);
    OK(pcmvs_frame_may_have_lost_part(frames[0], frames[2], frames[2], &may_have));
    CHECK(may_have == 0);
    OK(pcmvs_frame_may_have_lost_part(frames[1], frames[0], frames[2], &may_have));
    CHECK(may_have == 1);

    OK(pcmvs_frame_new(rig, &again));
    EXPECT(pcmvs_frame_may_have_lost_part(frames[1], frames[0], again, &may_have), PCMVS_STATUS_WRONG_ORDER);
    OK(pcmvs_frame_begin(again, NULL));
    EXPECT(pcmvs_frame_view_between(again, captures[1].count, captures[1].views, captures[0].views, captures[2].views, NULL),
           PCMVS_STATUS_INVALID_ARGUMENT);
    /* Without one of the pictures it is pcmvs_frame_view. */
    OK(pcmvs_view_init(&missing, sizeof missing));
    OK(pcmvs_frame_view_between(again, 0, captures[1].views, captures[0].views, &missing, &pixels));
    CHECK(pixels == 0);
    for (i = 0; i < captures[1].count; i++) {
        OK(pcmvs_frame_view_between(again, i, captures[1].views + i, captures[0].views + i, captures[2].views + i, &pixels));
        restored += pixels > 0;
    }
    CHECK(restored > 0);
    OK(pcmvs_frame_colour(again));
    OK(pcmvs_frame_warning_count(again, &warnings));
    for (i = 0; i < warnings; i++) {
        pcmvs_warning warning;
        OK(pcmvs_frame_get_warning(again, i, &warning, sizeof warning));
        named += strcmp(warning.code, "silhouette-restored") == 0;
    }
    CHECK(named == restored);
    whole = glb(again);
    CHECK(!same(&whole, &lacking));

    neighbours[0] = frames[0];
    neighbours[1] = frames[2];
    OK(pcmvs_frame_steady(again, neighbours, 2));
    mean = glb(again);
    file = fopen(argv[FRAMES + 1], "wb");
    CHECK(file != NULL && fwrite(mean.data, 1, mean.size, file) == mean.size && fclose(file) == 0);

    for (i = 0; i < FRAMES; i++) {
        OK(pcmvs_frame_free(frames[i]));
        capture_free(&captures[i]);
    }
    OK(pcmvs_frame_free(again));
    OK(pcmvs_rig_free(rig));
    free(lacking.data);
    free(whole.data);
    free(mean.data);
    return verdict();
}
