/* Checks that count failures. */
#ifndef CHECK_H
#define CHECK_H

#include <pcmvs.h>
#include <stdio.h>

static int failures;

#define CHECK(condition)                                                                                              \
    do {                                                                                                              \
        if (!(condition)) {                                                                                           \
            printf("line %d: %s\n", __LINE__, #condition);                                                            \
            failures++;                                                                                               \
        }                                                                                                             \
    } while (0)

#define EXPECT(call, expected)                                                                                        \
    do {                                                                                                              \
        pcmvs_status got = (call);                                                                                    \
        if (got != (expected)) {                                                                                      \
            printf("line %d: %s is %s\n", __LINE__, #call, pcmvs_status_name(got));                                    \
            failures++;                                                                                               \
        }                                                                                                             \
    } while (0)

#define OK(call) EXPECT(call, PCMVS_STATUS_OK)

/* Prints the number of failures and returns the exit status. */
static int verdict(void) {
    if (failures > 0) {
        printf("%d failures\n", failures);
    }
    return failures > 0;
}

#endif
