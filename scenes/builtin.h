/* Built-in scenes: one generator a file, listed in scenes/builtin.c. */
#ifndef RT_SCENES_BUILTIN_H
#define RT_SCENES_BUILTIN_H

#include "base/param.h"
#include "scene/scene.h"

typedef struct RtBuiltin {
    const char *name, *summary, *source; /* source: where the scene comes from */
    const RtParam *params;
    size_t param_count;
    /* Fills an initialised scene (rt_scene_init); the caller finishes it, or clears it after a failure. */
    RtStatus (*generate)(RtScene *scene, const RtValue *values, RtError *error);
} RtBuiltin;

size_t rt_builtin_count(void);
const RtBuiltin *rt_builtin_at(size_t i);

/* "name[:key=value,...]" to a finished scene, whose name is the spec with every parameter. */
RtStatus rt_builtin_open(const char *spec, RtScene *scene, RtError *error);

#endif
