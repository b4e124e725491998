/* SPDX-License-Identifier: Apache-2.0 */
/* Building, describing, validating and destroying a plugin's structure; query.c has its queries. The plugin's
 * numbers are checked before use, and failures take its message. */
#include "accel/plugin/host.h"

#include "accel/plugin/channel.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <inttypes.h>
#include <string.h>

/* ---- the structure ---- */

/* Without a table its build has failed. */
static void destroy(RtAccel *accel) {
    RtPluginAccel *self = (RtPluginAccel *)accel;
    if (self->table) {
        self->table->destroy(self->self);
        pthread_mutex_destroy(&self->lock);
    }
    rt_free(self->other_objects);
}

/* Reports that `build` failed, with the plugin's message if it wrote one. */
static RtStatus refuse(const raytally_accel_ops *table, int result, const char *message, RtError *error) {
    if (result == RAYTALLY_BUILD_NO_MEMORY)
        return rt_fail(error, RT_NO_MEMORY, "%s: memory is short%s%s", table->name, *message ? ": " : "",
                       message);
    if (result != RAYTALLY_BUILD_REFUSED)
        return rt_fail(error, RT_BROKEN, "its `build` returned %d, which is not a valid result", result);
    return rt_fail(error, RT_BAD_INPUT, "%s: %s", table->name,
                   *message ? message : "it refuses this scene without giving a reason");
}

static void copy_values(const RtAccelOps *ops, const RtValue *from, raytally_value *values) {
    for (size_t i = 0; i < ops->param_count; i++) {
        const RtValue value = from[i];
        switch (ops->params[i].type) {
        case RT_PARAM_INT: values[i].integer = value.i; break;
        case RT_PARAM_FLOAT: values[i].number = value.f; break;
        case RT_PARAM_CHOICE: values[i].choice = value.choice; break;
        case RT_PARAM_FLAG: values[i].flag = value.flag; break;
        case RT_PARAM_RESOLUTION: break; /* plugins have none */
        }
    }
}

/* The arrays of triangles and spheres are the scene's own. */
_Static_assert(sizeof(RtTriangle) == 9 * sizeof(float) && sizeof(RtSphere) == 4 * sizeof(float) &&
                   offsetof(RtSphere, radius) == 3 * sizeof(float),
               "triangles and spheres are arrays of floats");

static RtStatus add_geometry(RtPluginAccel *self, const RtGeometry *geometry, raytally_build_input *input,
                             RtError *error) {
    input->triangles = (const float *)geometry->triangles;
    input->triangle_objects = geometry->triangle_ids;
    input->triangle_count = geometry->triangle_count;
    input->spheres = (const float *)geometry->spheres;
    input->sphere_objects = geometry->sphere_ids;
    input->sphere_count = geometry->sphere_count;
    const uint32_t others = geometry->object_count - geometry->triangle_count - geometry->sphere_count;
    if (others == 0) return RT_OK;
    self->other_objects = rt_alloc_unset(others, sizeof(uint32_t));
    if (!self->other_objects) return rt_fail_memory(error, "a list of objects", others * sizeof(uint32_t));
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        const RtShape shape = rt_ref_shape(geometry->objects[id]);
        if (shape != RT_SHAPE_TRIANGLE && shape != RT_SHAPE_SPHERE)
            self->other_objects[input->other_count++] = id;
    }
    input->other_objects = self->other_objects;
    return RT_OK;
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    RtPluginAccel *self = (RtPluginAccel *)accel;
    const raytally_accel_ops *table = &((const RtPluginOps *)accel->ops)->table;
    const RtGeometry *geometry = &what->scene->geometry;
    const uint64_t memory = rt_memory_current_limit();
    raytally_value values[RAYTALLY_MAX_PARAMS] = {0};
    char message[900] = "";
    copy_values(accel->ops, what->values, values);
    raytally_build_input input = {.size = sizeof input,
                                  .object_count = geometry->object_count,
                                  .boxes = rt_public_box(geometry->boxes),
                                  .values = values,
                                  .threads = rt_thread_count(what->threads),
                                  .byte_limit = memory < UINT64_MAX ? memory : what->limit,
                                  .message = message,
                                  .message_room = sizeof message - 1};
    memcpy(&input.box, &geometry->box, sizeof input.box);
    RT_TRY(add_geometry(self, geometry, &input, error));
    int result = table->build(&input, &self->self);
    if (result != RAYTALLY_BUILD_OK) return refuse(table, result, message, error);
    self->table = table;
    accel->exact &= !(table->flags & RAYTALLY_OWN_HITS);
    accel->absolute |= (table->flags & RAYTALLY_ABSOLUTE_HITS) != 0;
    accel->counts &= !(table->flags & RAYTALLY_NO_COUNTS);
    rt_plugin_query_init(self);
    return RT_OK;
}

uint64_t rt_description_impossible(const RtDescription *d) {
    enum { SIZES = 6 };
    const uint64_t sizes[SIZES] = {d->interior,   d->leaves, d->empty_leaves,
                                   d->references, d->depth,  d->bytes};
    for (size_t i = 0; i < SIZES + RT_TALLY_COUNTER_COUNT; i++) {
        const uint64_t number = i < SIZES ? sizes[i] : rt_tally_get(&d->build, i - SIZES);
        if (number > UINT64_C(1) << 53) return number;
    }
    return 0;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    raytally_description d = {.predicted_cost = NAN, .predicted_tests = NAN, .predicted_steps = NAN};
    if (self->table->describe) self->table->describe(self->self, &d);
    *out = (RtDescription){.interior = d.interior,
                           .leaves = d.leaves,
                           .empty_leaves = d.empty_leaves,
                           .references = d.references,
                           .depth = d.depth,
                           .bytes = d.bytes,
                           .predicted_cost = d.predicted_cost,
                           .predicted_tests = d.predicted_tests,
                           .predicted_steps = d.predicted_steps,
                           RT_NO_QUALITY};
    const uint64_t impossible = rt_description_impossible(out);
    if (impossible)
        rt_plugin_break((RtPluginAccel *)accel, "its description has the impossible number %" PRIu64,
                        impossible);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    char message[900] = "";
    if (!self->table->validate || self->table->validate(self->self, message, sizeof message - 1) == 0)
        return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%s: %s", self->table->name,
                   *message ? message : "it is not valid and gives no reason");
}

typedef struct Showing {
    RtPluginAccel *accel;
    RtBoxViewer viewer;
} Showing;

static void show_box(void *context, const raytally_box *theirs, uint32_t depth, int leaf) {
    const Showing *showing = context;
    RtBox box;
    if (!theirs) {
        rt_plugin_break(showing->accel, "one of its boxes is NULL");
        return;
    }
    memcpy(&box, theirs, sizeof box);
    if (!rt_box_can_be_shown(&box, depth)) {
        rt_plugin_break(showing->accel, "it showed a box at depth %u from (%g, %g, %g) to (%g, %g, %g)",
                        depth, (double)box.lo.x, (double)box.lo.y, (double)box.lo.z, (double)box.hi.x,
                        (double)box.hi.y, (double)box.hi.z);
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
                            .kinds = table->flags & RAYTALLY_OVERLAY ? RT_ALL_RAY_KINDS : 0,
                            .remote = true,
                            .bytes = sizeof(RtPluginAccel),
                            .build = build,
                            .destroy = destroy,
                            .describe = describe,
                            .validate = validate,
                            .each_box = table->each_box ? each_box : NULL};
    rt_plugin_query_ops(&ops->ops);
}
