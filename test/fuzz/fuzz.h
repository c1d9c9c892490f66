/* What the parts of the fuzzer share. */
#ifndef FUZZ_H
#define FUZZ_H
#include <stddef.h>
#include <stdint.h>

uint64_t fuzz_random(void);
size_t fuzz_below(size_t n); /* 0 to n - 1 */

/* Each runs one input and answers a status of the library, or -1 for a broken promise. entry.f90: */
int fuzz_scene(const void *bytes, size_t length, const void *folder, size_t folder_length, int run);
int fuzz_restart(const void *scene, size_t length, const void *file, size_t file_length, const void *folder, size_t folder_length);
/* abi.c: the bytes choose calls and arguments */
int fuzz_abi(const unsigned char *bytes, size_t length);

#endif
