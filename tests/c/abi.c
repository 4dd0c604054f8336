/* Prints the values, sizes and offsets that a C compiler computes from the header. ffi/tests/layout.rs compares them with
 * those of Rust. */
#include <pcmvs.h>
#include <stdio.h>

#define VALUE(name) printf(#name " %lu\n", (unsigned long)(name))
#define SIZE(type) printf("sizeof " #type " %lu\n", (unsigned long)sizeof(type))
#define OFFSET(type, member) printf("offsetof " #type " " #member " %lu\n", (unsigned long)offsetof(type, member))

int main(void) {
#include "abi.inc"
    printf("composed %d\n",
           PCMVS_VERSION == PCMVS_VERSION_MAJOR * 1000000 + PCMVS_VERSION_MINOR * 1000 + PCMVS_VERSION_PATCH);
    printf("library %lu %s\n", (unsigned long)pcmvs_version(), pcmvs_version_string());
    return 0;
}
