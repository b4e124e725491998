/* SPDX-License-Identifier: Apache-2.0 */
/* The list of accelerators. To add one: README.md of this folder. Plugins register theirs at run time. */
#include "accel/accel.h"
#include "accel/plugin.h"

#include "core/base/words.h"

#include <string.h>

/* X(name, colour in plots). The colours of brute to octree, and black, are those of Okabe & Ito (2008), told
 * apart by colour-blind readers too; the others differ from them in lightness. */
#define ACCELERATORS(X)                                                                                      \
    X(brute, 0x7f7f7f)                                                                                       \
    X(bvh, 0xd55e00)                                                                                         \
    X(wide, 0x0072b2)                                                                                        \
    X(clusters, 0xcc79a7)                                                                                    \
    X(extents, 0xe69f00)                                                                                     \
    X(grid, 0x009e73)                                                                                        \
    X(octree, 0x56b4e9)                                                                                      \
    X(kd, 0x5b4a9f)                                                                                          \
    X(ideal, 0x222222)                                                                                       \
    X(item, 0xa6761d)                                                                                        \
    X(cache, 0x66a61e)                                                                                       \
    X(light, 0xb2182b)
#define EMBREE(X) X(embree, 0x7b3294)

#ifdef RT_WITH_EMBREE
#define BUILT_IN_ACCELERATORS(X) ACCELERATORS(X) EMBREE(X)
#else
#define BUILT_IN_ACCELERATORS(X) ACCELERATORS(X)
#endif

#define DECLARE(name, color) extern const RtAccelOps rt_##name##_ops;
BUILT_IN_ACCELERATORS(DECLARE)
#undef DECLARE

#define ENTRY(name, color) &rt_##name##_ops,
#define ONE(name, color)   +1
enum { BUILT_IN = 0 BUILT_IN_ACCELERATORS(ONE) };
static const RtAccelOps *registry[BUILT_IN + RT_MAX_PLUGIN_ACCELS] = {BUILT_IN_ACCELERATORS(ENTRY)};
static size_t count = BUILT_IN;

size_t rt_accel_count(void) {
    return count;
}

/* Letters of the C locale. */
#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

RtStatus rt_accel_name_is_free(const char *name, RtError *error) {
    if (strspn(name, LETTERS) == 0 || name[strspn(name, LETTERS "0123456789_-")])
        return rt_fail(error, RT_BAD_INPUT,
                       "'%.80s' cannot be the name of an accelerator: a name is a letter, then letters, "
                       "digits, '_' and '-'",
                       name);
    if (strlen(name) >= RT_MAX_NAME)
        return rt_fail(error, RT_BAD_INPUT, "'%.80s' is too long for a name: at most %d letters", name,
                       RT_MAX_NAME - 1);
    if (strcmp(name, "all") == 0)
        return rt_fail(error, RT_BAD_INPUT, "'all' means every accelerator: choose another name");
    for (size_t i = 0; i < count; i++) {
        if (strcmp(registry[i]->name, name) == 0)
            return rt_fail(error, RT_BAD_INPUT, "an accelerator '%s' already exists: choose another name",
                           name);
    }
    return RT_OK;
}

RtStatus rt_accel_has_room(size_t more, RtError *error) {
    if (more <= BUILT_IN + RT_MAX_PLUGIN_ACCELS - count) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "more than %d accelerators of plugins", RT_MAX_PLUGIN_ACCELS);
}

RtStatus rt_accel_register(const RtAccelOps *ops, RtError *error) {
    RT_TRY(rt_accel_has_room(1, error));
    RT_TRY(rt_accel_name_is_free(ops->name, error));
    registry[count++] = ops;
    return RT_OK;
}

const RtAccelOps *rt_accel_at(size_t i) {
    return registry[i];
}

uint32_t rt_accel_color(const char *spec) {
    enum { OF_PLUGINS = 0x17becf };
#define COLOR(name, color) {#name, color},
    static const struct {
        const char *name;
        uint32_t color;
    } colors[] = {ACCELERATORS(COLOR) EMBREE(COLOR)};
    const size_t top = strcspn(spec, ":+/");
    for (size_t i = 0; i < sizeof colors / sizeof colors[0]; i++) {
        if (strlen(colors[i].name) == top && strncmp(colors[i].name, spec, top) == 0) return colors[i].color;
    }
    return OF_PLUGINS;
}

const char *rt_accel_default(void) {
    return "bvh";
}

const char *rt_accel_truth(void) {
    return "brute";
}

const char *rt_accel_yardstick(void) {
    return "ideal";
}

const char *rt_accel_plugin_hint = "raytally_plugin_load";

RtStatus rt_accel_find(const char *name, const RtAccelOps **out, RtError *error) {
    const char *names[BUILT_IN + RT_MAX_PLUGIN_ACCELS];
    for (size_t i = 0; i < count; i++) {
        names[i] = registry[i]->name;
        if (strcmp(names[i], name) != 0) continue;
        *out = registry[i];
        return RT_OK;
    }
#ifndef RT_WITH_EMBREE
    if (strcmp(name, "embree") == 0)
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "this raytally was built without Embree: install its package and build again");
#endif
    char suggestion[RT_MAX_SUGGESTION];
    rt_suggest(name, names, count, suggestion);
    return rt_fail(error, RT_BAD_INPUT,
                   "there is no accelerator '%s'%s%s `raytally accels` lists them; an accelerator of a "
                   "plugin needs %s",
                   name, suggestion, *suggestion ? "" : ";", rt_accel_plugin_hint);
}
