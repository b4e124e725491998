#include "experiments/question.h"

#include "base/memory.h"

static RtStatus build_spec(const void *context, const RtScene *scene, int threads, RtAccel **out,
                           RtError *error) {
    RtSpec spec;
    RT_TRY(rt_spec_parse(context, &spec, error));
    return rt_accel_build(&spec, scene, threads, out, error);
}

RtMaker rt_maker_of_spec(const char *spec) {
    return (RtMaker){build_spec, spec, 0};
}

RtStatus rt_maker_build(const RtMaker *maker, const RtScene *scene, RtAccel **out, RtError *error) {
    return maker->build(maker->context, scene, maker->threads, out, error);
}

/* What is asked of, and room for the answers. */
typedef struct Session {
    RtAccel *brute, *accel;
    RtQuery truth, query;
    RtHit *expected, *got; /* [count] */
    bool *blocked;         /* [count] */
} Session;

static RtStatus open_session(Session *s, const RtQuestion *question, const RtScene *scene, RtMaker maker,
                             RtError *error) {
    size_t count = question->count;
    s->expected = rt_alloc(count, sizeof(RtHit));
    s->got = rt_alloc(count, sizeof(RtHit));
    s->blocked = rt_alloc(count, sizeof(bool));
    if (!s->expected || !s->got || !s->blocked) {
        return rt_fail_memory(error, "answers", count * (2 * sizeof(RtHit) + sizeof(bool)));
    }
    RT_TRY(rt_accel_open("brute", scene, &s->brute, error));
    RT_TRY(rt_query_init(&s->truth, s->brute, error));
    rt_nearest(&s->truth, question->rays, count, s->expected, NULL);
    RT_TRY(rt_maker_build(&maker, scene, &s->accel, error));
    RT_TRY(rt_accel_learn(s->accel, question->rays, s->expected, count, error));
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

static RtStatus ask(Session *s, const RtQuestion *question, RtReply *reply, RtError *error) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0}, *counted = question->counted ? tallies : NULL;
    for (size_t first = 0; first < question->count; first += question->stream) {
        size_t left = question->count - first, n = left < question->stream ? left : question->stream;
        rt_nearest(&s->query, question->rays + first, n, s->got + first, counted);
        rt_occluded(&s->query, question->rays + first, n, s->blocked + first, counted);
    }
    size_t i = question->asked;
    const RtRay *ray = &question->rays[i];
    RtVerdict verdict;
    *reply = (RtReply){.expected = s->expected[i], .got = s->got[i], .blocked = s->blocked[i]};
    RT_TRY(question->occluded
               ? rt_blocked_verdict(&s->query, ray, reply->expected, reply->blocked, &verdict, error)
               : rt_answer_verdict(&s->query, ray, reply->expected, reply->got, &verdict, error));
    reply->wrong = verdict == RT_WRONG;
    return RT_OK;
}

RtStatus rt_question_ask(const RtQuestion *question, const RtScene *scene, RtMaker maker, RtReply *reply,
                         RtError *error) {
    Session session = {0};
    RtStatus status = open_session(&session, question, scene, maker, error);
    if (status == RT_OK) status = ask(&session, question, reply, error);
    if (status == RT_OK) status = rt_accel_check(session.accel, error);
    close_session(&session);
    return status;
}

RtStatus rt_question_of_witness(const RtReference *reference, const RtWitness *witness, RtMaker maker,
                                RtQuestion *question, RtReply *reply, RtError *error) {
    *question = (RtQuestion){.rays = reference->rays + witness->index,
                             .count = 1,
                             .stream = 1,
                             .occluded = witness->occluded,
                             .counted = witness->counted};
    RT_TRY(rt_question_ask(question, reference->scene, maker, reply, error));
    if (reply->wrong) return RT_OK;
    size_t first;
    rt_witness_context(reference, witness, &first, &question->count);
    question->rays = reference->rays + first;
    question->asked = witness->index - first;
    question->stream = witness->stream;
    return rt_question_ask(question, reference->scene, maker, reply, error);
}
