// Runs the README's program on a folder of plain files. Usage: readme FOLDER OUT.glb (see capture.h)
#include "readme.inc"

#include "capture.h"

int main(int argc, char **argv) {
    capture capture;
    if (argc != 3 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    std::vector<const void *> pictures, masks;
    for (std::uint32_t i = 0; i < capture.count; i++) {
        pictures.push_back(capture.pictures[i].data);
        masks.push_back(capture.pictures[capture.count + i].data);
    }
    frame_to_glb({capture.cameras, capture.cameras + capture.count}, pictures, masks, argv[2]);
    capture_free(&capture);
    return 0;
}
