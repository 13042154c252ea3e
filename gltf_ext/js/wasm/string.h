/* What nmc_decode.h uses of the C library's header of this name; the build has no C library. */
#ifndef NMC_WASM_STRING_H
#define NMC_WASM_STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t size);
void *memset(void *to, int value, size_t size);

#endif /* NMC_WASM_STRING_H */
