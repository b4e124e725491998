/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/host.h"

#include "accel/plugin/query.h"
#include "accel/plugin/wire.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <string.h>

/* ---- the structure ---- */

static void destroy(RtAccel *accel) {
    RtPluginAccel *self = (RtPluginAccel *)accel;
    self->table->destroy(self->self);
    pthread_mutex_destroy(&self->lock);
    rt_free(self);
}

/* What the plugin says of a failure, or that it says nothing. */
static RtStatus refuse(const raytally_accel_ops *table, int result, const char *message, RtError *error) {
    if (result == RAYTALLY_BUILD_NO_MEMORY)
        return rt_fail(error, RT_NO_MEMORY, "%s: memory is short%s%s", table->name, *message ? ": " : "",
                       message);
    if (result != RAYTALLY_BUILD_REFUSED)
        return rt_fail(error, RT_BROKEN, "%s: its `build` returned %d, which means nothing", table->name,
                       result);
    return rt_fail(error, RT_BAD_INPUT, "%s: %s", table->name,
                   *message ? message : "it refuses this scene and does not say why");
}

static void take_values(const RtBuild *what, raytally_value *values) {
    for (size_t i = 0; i < what->ops->param_count; i++) {
        const RtValue value = what->values[i];
        switch (what->ops->params[i].type) {
        case RT_PARAM_INT: values[i].integer = value.i; break;
        case RT_PARAM_FLOAT: values[i].number = value.f; break;
        case RT_PARAM_CHOICE: values[i].choice = value.choice; break;
        case RT_PARAM_FLAG: values[i].flag = value.flag; break;
        case RT_PARAM_RESOLUTION: break; /* no parameter of a plugin is one */
        }
    }
}

static RtStatus build(const RtBuild *what, RtAccel **out, RtError *error) {
    const raytally_accel_ops *table = &((const RtPluginOps *)what->ops)->table;
    const RtGeometry *geometry = &what->scene->geometry;
    raytally_value values[RAYTALLY_MAX_PARAMS] = {0};
    char message[900] = "";
    take_values(what, values);
    raytally_build asked = {.size = sizeof asked,
                            .object_count = geometry->object_count,
                            .boxes = (const raytally_box *)geometry->boxes,
                            .values = values,
                            .threads = rt_thread_count(what->threads),
                            .byte_limit = what->limit,
                            .message = message,
                            .message_room = sizeof message - 1};
    memcpy(&asked.box, &geometry->box, sizeof asked.box);
    RT_TRY(rt_accel_new(what, sizeof(RtPluginAccel), out, error));
    RtPluginAccel *self = (RtPluginAccel *)*out;
    int result = table->build(&asked, &self->self);
    if (result != RAYTALLY_BUILD_OK) {
        rt_free(self);
        return refuse(table, result, message, error);
    }
    self->table = table;
    self->query_bytes = table->query_bytes ? table->query_bytes(self->self) : 0;
    pthread_mutex_init(&self->lock, NULL);
    return RT_OK;
}

/* Those that no structure has: below zero, as a rule. */
static void refuse_numbers(RtPluginAccel *accel, const raytally_description *said) {
    const uint64_t numbers[] = {said->interior,   said->leaves, said->empty_leaves,
                                said->references, said->depth,  said->bytes};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (numbers[i] <= UINT64_C(1) << 53) continue;
        RtError error;
        rt_fail(&error, RT_BROKEN, "it describes itself by a number of %llu", (unsigned long long)numbers[i]);
        rt_plugin_say(accel, &error);
    }
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    raytally_description said = {.predicted_cost = NAN, .predicted_tests = NAN, .predicted_steps = NAN};
    if (self->table->describe) self->table->describe(self->self, &said);
    refuse_numbers((RtPluginAccel *)accel, &said);
    *out = (RtDescription){.interior = said.interior,
                           .leaves = said.leaves,
                           .empty_leaves = said.empty_leaves,
                           .references = said.references,
                           .depth = said.depth,
                           .bytes = said.bytes,
                           .predicted_cost = said.predicted_cost,
                           .predicted_tests = said.predicted_tests,
                           .predicted_steps = said.predicted_steps,
                           RT_NO_QUALITY};
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    char message[900] = "";
    if (!self->table->validate || self->table->validate(self->self, message, sizeof message - 1) == 0)
        return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%s: %s", self->table->name,
                   *message ? message : "it is not valid and does not say why");
}

typedef struct Showing {
    RtPluginAccel *accel;
    RtBoxViewer viewer;
} Showing;

static void show_box(void *context, const raytally_box *theirs, uint32_t depth, int leaf) {
    const Showing *showing = context;
    RtBox box;
    RtError said;
    if (theirs) memcpy(&box, theirs, sizeof box);
    if (!theirs || !rt_wire_is_box(&box, depth)) {
        if (theirs)
            rt_fail(&said, RT_BROKEN, "it showed a box at depth %u from (%g, %g, %g) to (%g, %g, %g)", depth,
                    (double)box.lo.x, (double)box.lo.y, (double)box.lo.z, (double)box.hi.x, (double)box.hi.y,
                    (double)box.hi.z);
        else
            rt_fail(&said, RT_BROKEN, "it showed a box that is NULL");
        rt_plugin_say(showing->accel, &said);
        return;
    }
    showing->viewer.show(showing->viewer.context,
                         &(RtBoxView){.box = &box, .depth = depth, .leaf = leaf != 0});
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    Showing showing = {(RtPluginAccel *)accel, viewer};
    showing.accel->table->each_box(showing.accel->self, show_box, &showing);
}

/* ---- the table ---- */

void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table) {
    static const RtParamType types[] = {[RAYTALLY_INT] = RT_PARAM_INT,
                                        [RAYTALLY_FLOAT] = RT_PARAM_FLOAT,
                                        [RAYTALLY_CHOICE] = RT_PARAM_CHOICE,
                                        [RAYTALLY_FLAG] = RT_PARAM_FLAG};
    for (uint32_t i = 0; i < table->param_count; i++) {
        const raytally_param *p = &table->params[i];
        ops->params[i] = (RtParam){p->name,    types[p->type], p->default_text, p->lo,    p->hi,
                                   p->choices, p->test_values, p->meaning,      p->source};
    }
    ops->ops = (RtAccelOps){.name = table->name,
                            .summary = table->summary,
                            .paper = table->paper,
                            .params = ops->params,
                            .param_count = table->param_count,
                            .remote = true,
                            .build = build,
                            .destroy = destroy,
                            .describe = describe,
                            .validate = validate,
                            .each_box = table->each_box ? each_box : NULL};
    rt_plugin_query_ops(&ops->ops);
}
