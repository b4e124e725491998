/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/verify_choice.h"

#include "scenes/builtin.h"
#include "scenes/open.h"
#include "verify/spread.h"

#include <stdio.h>
#include <string.h>

/* The limit of small scenes. */
enum { QUICK_OBJECTS = 100 };

/* Verified by default, beside the families: their cameras see materials that reflect and transmit. */
static const char *const default_scenes[] = {"balls:size=2",
                                             "tetra:size=3",
                                             "random:n=0",
                                             "random:n=1",
                                             "random:n=2,shape=mixed",
                                             "random:n=200,shape=mixed",
                                             "random:n=500,shape=triangle",
                                             "random:n=500,distribution=clustered",
                                             "random:n=40,shape=mixed,distribution=coincident",
                                             "random:n=100,shape=mixed,distribution=line",
                                             "random:n=100,shape=mixed,distribution=plane",
                                             "random:n=200,shape=mixed,distribution=stadium"};

/* ---- scenes ---- */

static RtStatus add_scene(RtVerifyChoice *choice, const char *spec, RtError *error) {
    if (choice->scene_count == RT_VERIFY_MAX_SCENES) {
        return rt_fail(error, RT_BAD_INPUT, "more than %d scenes: verify fewer at a time",
                       RT_VERIFY_MAX_SCENES);
    }
    choice->scenes[choice->scene_count++] = spec;
    return RT_OK;
}

static RtStatus add_families(RtVerifyChoice *choice, uint64_t seed, RtError *error) {
    for (size_t i = 0; i < rt_family_count() && i < RT_VERIFY_MAX_SCENES; i++) {
        rt_family_spec(i, seed, choice->families[i]);
        RT_TRY(add_scene(choice, choice->families[i], error));
    }
    return RT_OK;
}

static RtStatus add_default(RtVerifyChoice *choice, uint64_t seed, RtError *error) {
    for (size_t i = 0; i < sizeof default_scenes / sizeof default_scenes[0]; i++) {
        RT_TRY(add_scene(choice, default_scenes[i], error));
    }
    return add_families(choice, seed, error);
}

/* The default scenes that have no other shapes. */
static RtStatus add_triangles(RtVerifyChoice *choice, uint64_t seed, RtError *error) {
    uint32_t kept = choice->scene_count;
    RT_TRY(add_default(choice, seed, error));
    for (uint32_t i = kept; i < choice->scene_count; i++) {
        RtScene scene;
        RT_TRY(rt_scene_open(choice->scenes[i], &scene, error));
        const RtGeometry *g = &scene.geometry;
        if (g->triangle_count == g->object_count) choice->scenes[kept++] = choice->scenes[i];
        rt_scene_clear(&scene);
    }
    choice->scene_count = kept;
    return RT_OK;
}

/* Sorts built-in scenes by number of objects; with `quick` drops the large ones. */
static RtStatus sort_scenes(RtVerifyChoice *choice, bool quick, RtError *error) {
    uint64_t objects[RT_VERIFY_MAX_SCENES];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < choice->scene_count; i++) {
        const char *scene = choice->scenes[i];
        uint64_t count;
        RT_TRY(rt_builtin_objects(scene, &count, error));
        if (quick && count > QUICK_OBJECTS) continue;
        uint32_t place = kept++;
        for (; place > 0 && objects[place - 1] > count; place--) {
            objects[place] = objects[place - 1];
            choice->scenes[place] = choice->scenes[place - 1];
        }
        objects[place] = count;
        choice->scenes[place] = scene;
    }
    choice->scenes_left_out = choice->scene_count - kept;
    choice->scene_count = kept;
    return RT_OK;
}

RtStatus rt_verify_choose_scenes(RtVerifyChoice *choice, const char *const *given, uint32_t count,
                                 uint64_t seed, bool quick, RtError *error) {
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(given[i], RT_VERIFY_FAMILIES) == 0)
            RT_TRY(add_families(choice, seed, error));
        else if (strcmp(given[i], RT_VERIFY_TRIANGLES) == 0)
            RT_TRY(add_triangles(choice, seed, error));
        else
            RT_TRY(add_scene(choice, given[i], error));
    }
    if (count > 0) return RT_OK;
    RT_TRY(add_default(choice, seed, error));
    return sort_scenes(choice, quick, error);
}

/* ---- accelerators ---- */

static RtStatus add_spec(RtVerifyChoice *choice, const char *spec, bool named, bool judged, RtError *error) {
    if (choice->spec_count == RT_VERIFY_MAX_SPECS) {
        return rt_fail(error, RT_BAD_INPUT, "more than %d accelerators: verify fewer at a time",
                       RT_VERIFY_MAX_SPECS);
    }
    RtVerifySpec *c = &choice->specs[choice->spec_count++];
    *c = (RtVerifySpec){.named = named, .judged = judged};
    snprintf(c->spec, sizeof c->spec, "%s", spec);
    return RT_OK;
}

/* Adds its defaults and its trial, the first two of its spread, unless !`own` (it was named, and these are
 * there); with `spread` the rest. */
static RtStatus add_registered(RtVerifyChoice *choice, const RtAccelOps *ops, bool own, bool spread,
                               RtError *error) {
    char spec[RT_MAX_SPEC_CHARS];
    size_t whole = ops->trial ? 2 : 1;
    for (size_t n = own ? 0 : whole; (n < whole || spread) && rt_spread_spec(ops, n, spec); n++) {
        RT_TRY(add_spec(choice, spec, false, !own, error));
    }
    return RT_OK;
}

static RtStatus add_named(RtVerifyChoice *choice, const char *text, bool spread, RtError *error) {
    RtSpec spec;
    char trial[RT_MAX_SPEC_CHARS];
    RT_TRY(rt_spec_parse(text, &spec, error));
    RT_TRY(add_spec(choice, text, true, true, error));
    if (rt_trial_spec(text, trial)) RT_TRY(add_spec(choice, trial, true, true, error));
    return add_registered(choice, spec.layers[0].ops, false, spread, error);
}

RtStatus rt_verify_choose_specs(RtVerifyChoice *choice, const char *const *given, uint32_t count, bool spread,
                                RtError *error) {
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(given[i], "all") != 0) {
            RT_TRY(add_named(choice, given[i], spread, error));
            continue;
        }
        for (size_t k = 0; k < rt_accel_count(); k++) {
            RT_TRY(add_registered(choice, rt_accel_at(k), true, spread, error));
        }
    }
    return RT_OK;
}
