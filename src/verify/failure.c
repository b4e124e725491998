/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/failure.h"

#include "core/base/memory.h"

static RtStatus build_spec(const void *context, const RtScene *scene, int threads, RtAccel **out,
                           RtError *error) {
    return rt_accel_open_on(context, scene, threads, out, error);
}

RtAccelBuilder rt_accel_builder_of_spec(const char *spec) {
    return (RtAccelBuilder){build_spec, spec, 0};
}

RtStatus rt_accel_builder_run(const RtAccelBuilder *builder, const RtScene *scene, RtAccel **out,
                              RtError *error) {
    return builder->build(builder->context, scene, builder->threads, out, error);
}

/* The accelerators, and memory for the answers. */
typedef struct Session {
    RtAccel *brute, *accel;
    RtQuery truth, query;
    RtHit *expected, *got; /* [count] */
    bool *blocked;         /* [count] */
} Session;

static RtStatus open_session(Session *s, const RtFailure *failure, const RtScene *scene,
                             RtAccelBuilder builder, RtError *error) {
    size_t count = failure->count;
    s->expected = rt_alloc(count, sizeof(RtHit));
    s->got = rt_alloc(count, sizeof(RtHit));
    s->blocked = rt_alloc(count, sizeof(bool));
    if (!s->expected || !s->got || !s->blocked) {
        return rt_fail_memory(error, "answers", count * (2 * sizeof(RtHit) + sizeof(bool)));
    }
    RT_TRY(rt_accel_open(rt_accel_truth(), scene, &s->brute, error));
    RT_TRY(rt_query_init(&s->truth, s->brute, error));
    rt_nearest(&s->truth, failure->rays, count, s->expected, NULL);
    RT_TRY(rt_accel_builder_run(&builder, scene, &s->accel, error));
    RT_TRY(rt_accel_learn(s->accel, failure->rays, s->expected, count, error));
    return rt_query_init(&s->query, s->accel, error);
}

static void close_session(Session *s) {
    rt_query_clear(&s->query);
    rt_query_clear(&s->truth);
    rt_accel_destroy(s->accel);
    rt_accel_destroy(s->brute);
    rt_free(s->expected);
    rt_free(s->got);
    rt_free(s->blocked);
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

RtStatus rt_failure_ask(const RtFailure *failure, const RtScene *scene, RtAccelBuilder builder,
                        RtAnswer *answer, RtError *error) {
    Session session = {0};
    RtStatus status = open_session(&session, failure, scene, builder, error);
    if (status == RT_OK) status = ask(&session, failure, answer, error);
    if (status == RT_OK) status = rt_accel_check(session.accel, error);
    close_session(&session);
    return status;
}

RtStatus rt_failure_of(const RtReference *reference, const RtWrongAnswer *wrong, RtAccelBuilder builder,
                       RtFailure *failure, RtAnswer *answer, RtError *error) {
    *failure = (RtFailure){.rays = reference->rays + wrong->index,
                           .count = 1,
                           .stream = 1,
                           .occluded = wrong->occluded,
                           .counted = wrong->counted};
    RT_TRY(rt_failure_ask(failure, reference->scene, builder, answer, error));
    if (answer->wrong) return RT_OK;
    size_t first;
    rt_wrong_answer_context(reference, wrong, &first, &failure->count);
    failure->rays = reference->rays + first;
    failure->asked = wrong->index - first;
    failure->stream = wrong->stream;
    return rt_failure_ask(failure, reference->scene, builder, answer, error);
}
