/* Which Embree this build uses, for the manifest of a result. Needs no Embree itself. */
#ifndef RT_ACCEL_EMBREE_INFO_H
#define RT_ACCEL_EMBREE_INFO_H

#include <stdbool.h>
#include <stddef.h>

/* Writes the version at run time and the instruction set that isa=default stands for on this machine,
 * "3.13.5 avx512", to out[0..room). False, and "", where raytally was built without Embree or no device can
 * be had. */
#ifdef RT_WITH_EMBREE
bool rt_embree_info(char *out, size_t room);
#else
static inline bool rt_embree_info(char *out, size_t room) {
    if (room > 0) out[0] = '\0';
    return false;
}
#endif

#endif
