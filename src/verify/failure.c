/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/failure.h"

#include "core/base/memory.h"

#include <string.h>

/* The accelerators, and memory for the answers. */
typedef struct Session {
    RtAccel *brute, *accel;
    RtQuery truth, query;
    RtArena memory;
    RtHit *expected, *got; /* [count] */
    bool *blocked;         /* [count] */
} Session;

static RtStatus open_session(Session *s, const RtFailure *failure, const RtScene *scene, RtError *error) {
    size_t count = failure->count;
    s->expected = rt_arena_alloc(&s->memory, count, sizeof(RtHit));
    s->got = rt_arena_alloc(&s->memory, count, sizeof(RtHit));
    s->blocked = rt_arena_alloc(&s->memory, count, sizeof(bool));
    RT_TRY(rt_arena_check(&s->memory, "answers", error));
    RT_TRY(rt_accel_open(rt_accel_truth(), scene, &s->brute, error));
    RT_TRY(rt_query_init(&s->truth, s->brute, error));
    rt_nearest(&s->truth, failure->rays, count, s->expected, NULL);
    RT_TRY(rt_accel_open_on(failure->spec, scene, failure->threads, &s->accel, error));
    RT_TRY(rt_accel_learn(s->accel, failure->rays, s->expected, count, error));
    return rt_query_init(&s->query, s->accel, error);
}

static void close_session(Session *s) {
    rt_query_clear(&s->query);
    rt_query_clear(&s->truth);
    rt_accel_destroy(s->accel);
    rt_accel_destroy(s->brute);
    rt_arena_clear(&s->memory);
}

static RtStatus ask(Session *s, const RtFailure *failure, RtAnswer *answer, RtError *error) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0}, *counted = failure->counted ? tallies : NULL;
    for (size_t first = 0; first < failure->count; first += failure->stream) {
        size_t left = failure->count - first, n = left < failure->stream ? left : failure->stream;
        rt_nearest(&s->query, failure->rays + first, n, s->got + first, counted);
        rt_occluded(&s->query, failure->rays + first, n, s->blocked + first, counted);
    }
    size_t i = failure->asked;
    const RtRay *ray = &failure->rays[i];
    RtVerdict verdict;
    *answer = (RtAnswer){.expected = s->expected[i], .got = s->got[i], .blocked = s->blocked[i]};
    RT_TRY(failure->occluded
               ? rt_blocked_verdict(&s->query, ray, answer->expected, answer->blocked, &verdict, error)
               : rt_answer_verdict(&s->query, ray, answer->expected, answer->got, &verdict, error));
    answer->wrong = verdict == RT_WRONG;
    return RT_OK;
}

RtStatus rt_failure_ask(const RtFailure *failure, const RtScene *scene, RtAnswer *answer, RtError *error) {
    Session session = {0};
    RtStatus status = open_session(&session, failure, scene, error);
    if (status == RT_OK) status = ask(&session, failure, answer, error);
    if (status == RT_OK) status = rt_accel_check(session.accel, error);
    close_session(&session);
    return status;
}

RtStatus rt_failure_of(const RtReference *reference, const RtWrongAnswer *wrong, const char *spec,
                       int threads, RtFailure *failure, RtAnswer *answer, RtError *error) {
    *failure = (RtFailure){.spec = spec,
                           .threads = threads,
                           .rays = reference->rays + wrong->index,
                           .count = 1,
                           .stream = 1,
                           .occluded = wrong->occluded,
                           .counted = wrong->counted};
    RT_TRY(rt_failure_ask(failure, reference->scene, answer, error));
    if (answer->wrong) return RT_OK;
    size_t first;
    rt_wrong_answer_context(reference, wrong, &first, &failure->count);
    failure->rays = reference->rays + first;
    failure->asked = wrong->index - first;
    failure->stream = wrong->stream;
    return rt_failure_ask(failure, reference->scene, answer, error);
}

/* ---- shrinking ---- */

/* The fixed cost of a try, in objects. */
#define TRY_COST 32

typedef struct Shrinking {
    const RtScene *scene;
    const RtFailure *failure;
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
    RtStatus status = rt_failure_ask(s->failure, &scene, &answer, s->error);
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

RtStatus rt_shrink(const RtScene *scene, const RtFailure *failure, const RtAnswer *answer, uint64_t budget,
                   const RtShrinkObserver *observer, RtShrunk *out, RtError *error) {
    RT_ARENA(memory);
    uint32_t count = scene->geometry.object_count;
    *out = (RtShrunk){.ids = rt_alloc(count, sizeof(uint32_t)), .count = count, .answer = *answer};
    Shrinking s = {.scene = scene,
                   .failure = failure,
                   .observer = observer,
                   .left = budget,
                   .part = rt_arena_alloc(&memory, count, sizeof(uint32_t)),
                   .out = out,
                   .error = error};
    RtStatus status =
        out->ids && s.part ? RT_OK : rt_fail_memory(error, "ids of objects", count * sizeof(uint32_t));
    for (uint32_t i = 0; i < count && status == RT_OK; i++) out->ids[i] = i;
    if (status == RT_OK) status = shrink(&s, answer);
    if (status == RT_OK) return RT_OK;
    rt_free(out->ids);
    out->ids = NULL;
    return status;
}
