/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/shrink.h"

#include "core/base/memory.h"

#include <string.h>

/* The fixed cost of a try, in objects. */
#define TRY_COST 32

typedef struct Shrinking {
    const RtScene *scene;
    const RtFailure *failure;
    RtAccelBuilder builder;
    const RtShrinkObserver *observer;
    uint64_t left;  /* remaining budget */
    uint32_t *part; /* [object_count] the objects of the current try */
    RtShrunk *out;
    RtError *error;
} Shrinking;

/* Repeats the query over s->part[0..count); if the answer is still wrong, those objects remain. */
static RtStatus try_part(Shrinking *s, uint32_t count, bool *shrunk) {
    RtScene scene;
    RtAnswer answer = {.wrong = false};
    uint64_t cost = (uint64_t)count + TRY_COST;
    *shrunk = false;
    s->left = cost < s->left ? s->left - cost : 0;
    if (s->left == 0) return RT_OK;
    RT_TRY(rt_scene_subset(s->scene, s->part, count, &scene, s->error));
    RtStatus status = rt_failure_ask(s->failure, &scene, s->builder, &answer, s->error);
    rt_scene_clear(&scene);
    if (status != RT_OK && status != RT_BAD_INPUT) return status;
    s->out->tries++;
    if (answer.wrong) {
        memcpy(s->out->ids, s->part, count * sizeof *s->part);
        s->out->count = count;
        s->out->answer = answer;
        *shrunk = true;
    }
    if (s->observer) s->observer->tried(s->observer->context, s->out->count, s->out->tries);
    return RT_OK;
}

/* Copies to s->part the remaining objects first..end-1, or all others. */
static uint32_t choose(Shrinking *s, uint32_t first, uint32_t end, bool others) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->out->count; i++) {
        if ((i >= first && i < end) != others) s->part[count++] = s->out->ids[i];
    }
    return count;
}

/* Tries each of `pieces` equal pieces of the remaining objects, or the complement of each if `others`. */
static RtStatus try_pieces(Shrinking *s, uint32_t pieces, bool others, bool *shrunk) {
    uint64_t count = s->out->count;
    *shrunk = false;
    for (uint64_t i = 0; i < pieces && !*shrunk && s->left > 0; i++) {
        uint32_t first = (uint32_t)(count * i / pieces), end = (uint32_t)(count * (i + 1) / pieces);
        RT_TRY(try_part(s, choose(s, first, end, others), shrunk));
    }
    return RT_OK;
}

/* Most failures involve just the two objects of the answers. */
static RtStatus try_those_named(Shrinking *s, const RtAnswer *answer) {
    uint32_t a = answer->expected.object, b = s->failure->occluded ? RT_NO_OBJECT : answer->got.object;
    uint32_t count = 0, objects = s->out->count;
    bool shrunk;
    if (a > b) {
        uint32_t swap = a;
        a = b, b = swap;
    }
    if (a < objects) s->part[count++] = a;
    if (b < objects && b != a) s->part[count++] = b;
    return count > 0 && count < objects ? try_part(s, count, &shrunk) : RT_OK;
}

static RtStatus shrink(Shrinking *s, const RtAnswer *answer) {
    RT_TRY(try_those_named(s, answer));
    uint32_t pieces = 2;
    while (s->out->count > 1 && s->left > 0) {
        bool shrunk;
        if (pieces > s->out->count) pieces = s->out->count;
        RT_TRY(try_pieces(s, pieces, false, &shrunk));
        if (shrunk) {
            pieces = 2;
            continue;
        }
        /* The complement of one half is the other half. */
        if (pieces > 2) RT_TRY(try_pieces(s, pieces, true, &shrunk));
        if (shrunk) {
            pieces = pieces > 3 ? pieces - 1 : 2;
        } else if (pieces == s->out->count) {
            break;
        } else {
            pieces *= 2;
        }
    }
    s->out->minimal = s->left > 0;
    return RT_OK;
}

RtStatus rt_shrink(const RtScene *scene, const RtFailure *failure, const RtAnswer *answer,
                   RtAccelBuilder builder, uint64_t budget, const RtShrinkObserver *observer, RtShrunk *out,
                   RtError *error) {
    uint32_t count = scene->geometry.object_count;
    *out = (RtShrunk){.ids = rt_alloc(count, sizeof(uint32_t)), .count = count, .answer = *answer};
    Shrinking s = {.scene = scene,
                   .failure = failure,
                   .builder = builder,
                   .observer = observer,
                   .left = budget,
                   .part = rt_alloc(count, sizeof(uint32_t)),
                   .out = out,
                   .error = error};
    RtStatus status = out->ids && s.part ? RT_OK : rt_fail_memory(error, "ids of objects", 8 * (size_t)count);
    if (status == RT_OK) {
        for (uint32_t i = 0; i < count; i++) out->ids[i] = i;
        status = shrink(&s, answer);
    }
    rt_free(s.part);
    if (status != RT_OK) {
        rt_free(out->ids);
        out->ids = NULL;
    }
    return status;
}
