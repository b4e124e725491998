/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/equivalence.h"

#include "accel/plugin.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/measure.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Rays per work item, and the longest stream: more than any accelerator processes at once. */
#define CHUNK 1500

static const size_t stream_lengths[] = {1, 11, 64, CHUNK};
enum { STREAM_LENGTHS = sizeof stream_lengths / sizeof stream_lengths[0], KERNELS = 2, PASSES = 2 };

/* One of the modes in which a chunk is traced. */
typedef struct Mode {
    bool counted;
    size_t stream; /* rays per stream */
} Mode;

/* The queries of a chunk. */
typedef struct Plan {
    size_t count; /* of rays */
    Mode modes[PASSES * KERNELS];
    int mode_count;
    bool recount; /* count twice and compare */
} Plan;

/* The answers to a chunk in all modes, in one block, for a remote accelerator. */
typedef struct Answers {
    Plan plan;
    RtTally tallies[RT_RAY_KIND_COUNT];
    RtTally recounts[2][RT_RAY_KIND_COUNT];
    RtHit hits[PASSES * KERNELS][CHUNK];
    bool blocked[PASSES * KERNELS][CHUNK];
} Answers;

_Static_assert(sizeof(Answers) <= RT_REMOTE_BYTES && CHUNK <= RT_REMOTE_RAYS, "it fits");

/* One thread's memory. It has its own copy of the plan, because a plugin's process may have overwritten
 * the one in `answers`. */
typedef struct Worker {
    RtQuery query;
    Plan plan;
    Answers answers;
} Worker;

typedef struct Job {
    const RtReference *reference;
    const RtAccel *accel;
    int threads;
    Worker *workers;       /* [threads] */
    const RtHit *recorded; /* answers to judge instead of an accelerator's */
    RtEquivalence *parts;  /* [chunks] parts of the result, when checking */
    RtError recounted;     /* RT_BROKEN if chunk 0 was counted differently twice */
} Job;

/* Both kernels, in streams of one length; for an exact accelerator, whose answers must not depend on it,
 * in short and long streams. */
static void choose_modes(Worker *worker, size_t chunk) {
    int passes = worker->query.accel->exact ? PASSES : 1;
    worker->plan.mode_count = 0;
    for (size_t i = 0; i < (size_t)passes * KERNELS; i++) {
        size_t pass = i / KERNELS, counted = i % KERNELS;
        size_t length = (chunk + counted + pass * STREAM_LENGTHS / PASSES) % STREAM_LENGTHS;
        worker->plan.modes[worker->plan.mode_count++] = (Mode){counted, stream_lengths[length]};
    }
}

/* ---- work in chunks ---- */

static size_t chunks_of(const Job *job) {
    return (job->reference->count + CHUNK - 1) / CHUNK;
}

static RtStatus run(Job *job, RtWork work, RtError *error) {
    job->threads = rt_thread_count(job->threads);
    RT_ARENA(memory);
    job->workers = rt_arena_alloc(&memory, (size_t)job->threads, sizeof(Worker));
    RtStatus status = rt_arena_check(&memory, "answers", error);
    for (int i = 0; i < job->threads && status == RT_OK; i++) {
        status = rt_query_init(&job->workers[i].query, job->accel, error);
    }
    if (status == RT_OK) status = rt_parallel_for(chunks_of(job), job->threads, work, job, error);
    if (status == RT_OK) status = rt_accel_check(job->accel, error);
    for (int i = 0; job->workers && i < job->threads; i++) rt_query_clear(&job->workers[i].query);
    return status;
}

static size_t chunk_count(const Job *job, size_t chunk) {
    size_t left = job->reference->count - chunk * CHUNK;
    return left < CHUNK ? left : CHUNK;
}

/* ---- the reference ---- */

static RtStatus refer_chunk(void *context, size_t chunk, int thread, RtError *error) {
    (void)error;
    Job *job = context;
    rt_nearest(&job->workers[thread].query, job->reference->rays + chunk * CHUNK, chunk_count(job, chunk),
               job->reference->hits + chunk * CHUNK, NULL);
    return RT_OK;
}

RtStatus rt_reference_init(RtReference *reference, const RtAccel *oracle, const RtRay *rays, size_t count,
                           int threads, RtError *error) {
    *reference = (RtReference){.scene = oracle->scene,
                               .rays = rays,
                               .count = count,
                               .hits = rt_alloc(count, sizeof(RtHit)),
                               .differs = rt_alloc(count, sizeof(bool))};
    Job job = {.reference = reference, .accel = oracle, .threads = threads};
    RtStatus status = reference->hits && reference->differs
                          ? run(&job, refer_chunk, error)
                          : rt_fail_memory(error, "reference answers", count * sizeof(RtHit));
    if (status != RT_OK) rt_reference_clear(reference);
    return status;
}

void rt_reference_clear(RtReference *reference) {
    rt_free(reference->hits);
    rt_free(reference->differs);
    *reference = (RtReference){0};
}

/* ---- certain rays ---- */

/* Margins of objects, and how many of them a solid of a CSG tree takes the time of. */
#define CERTAIN_WORK   (UINT64_C(1) << 31)
#define WORK_PER_SOLID 10000
enum { FEWEST_SAMPLED = 2000, NEEDED = 1000 };

typedef struct CertainJob {
    const RtReference *reference;
    bool absolute;
    uint64_t stride, count; /* rays 0, stride, 2 stride, ... */
    RtCertain *parts;       /* [chunks] */
} CertainJob;

static RtStatus count_chunk(void *context, size_t chunk, int thread, RtError *error) {
    const CertainJob *job = context;
    RtCertain *part = &job->parts[chunk];
    (void)thread;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < job->count; i++) {
        bool certain, must_hit;
        const RtJudge judge =
            rt_judge(&job->reference->scene->geometry, &job->reference->rays[i * job->stride], job->absolute);
        RT_TRY(rt_verdict_certain(judge, &certain, &must_hit, error));
        part->rays++;
        part->hits += job->reference->hits[i * job->stride].object != RT_NO_OBJECT;
        part->certain += certain;
        part->must_hit += must_hit;
    }
    return RT_OK;
}

RtStatus rt_reference_certain(const RtReference *reference, bool absolute, int threads, RtCertain *out,
                              RtError *error) {
    const RtGeometry *g = &reference->scene->geometry;
    uint64_t solids = g->csg_count > 0 ? g->forest.set.solid_count / g->csg_count : 0;
    if (g->part_crossings / 4 > solids) solids = g->part_crossings / 4; /* at most 4 in a solid */
    uint64_t most = CERTAIN_WORK / (rt_geometry_id_count(g) + WORK_PER_SOLID * solids + 1);
    if (most < FEWEST_SAMPLED) most = FEWEST_SAMPLED;
    CertainJob job = {.reference = reference, .absolute = absolute, .stride = reference->count / most + 1};
    job.count = (reference->count + job.stride - 1) / job.stride;
    size_t chunks = (size_t)(job.count + CHUNK - 1) / CHUNK;
    RT_ARENA(memory);
    job.parts = rt_arena_alloc(&memory, chunks, sizeof(RtCertain));
    RT_TRY(rt_arena_check(&memory, "certain rays", error));
    RT_TRY(rt_parallel_for(chunks, rt_thread_count(threads), count_chunk, &job, error));
    *out = (RtCertain){0};
    for (size_t i = 0; i < chunks; i++) {
        out->rays += job.parts[i].rays;
        out->hits += job.parts[i].hits;
        out->certain += job.parts[i].certain;
        out->must_hit += job.parts[i].must_hit;
    }
    return RT_OK;
}

/* At least how many of `rays` rays have what `found` of `sampled` have, with 97.5 % confidence? */
static double at_least(uint64_t found, uint64_t sampled, uint64_t rays) {
    double n = (double)sampled, share = n > 0 ? (double)found / n : 0;
    if (sampled < rays) share -= 1.96 * sqrt(share * (1 - share) / n);
    return share * (double)rays;
}

bool rt_certain_suffices(const RtCertain *c, uint64_t rays, bool given) {
    double hits = c->rays > 0 ? (double)c->hits / (double)c->rays * (double)rays : 0;
    double needed = given ? (double)rays / 2 : NEEDED;
    double needed_hits = given ? fmax(hits, 1) / 2 : fmin(hits / 10, NEEDED);
    return at_least(c->certain, c->rays, rays) >= needed &&
           at_least(c->must_hit, c->rays, rays) >= needed_hits;
}

void rt_certain_undecided(const RtCertain *c, uint64_t rays, bool given, bool absolute, char *out,
                          size_t size) {
    snprintf(
        out, size,
        "undecided: of %" PRIu64 " %srays, %" PRIu64 " of which hit, %" PRIu64
        " have one answer, whatever rounding%s does, and %" PRIu64 " must hit something. Needed are %s. %s",
        c->rays, c->rays < rays ? "sampled " : "", c->hits, c->certain,
        absolute ? " in absolute coordinates" : "", c->must_hit,
        given ? "half of the rays and half of the hits, of which there must be some"
              : "1000 rays, and a tenth of the hits or 1000",
        given
            ? "Use rays that hit, farther from edges and coincident objects, and start farther from surfaces"
            : "Trace more rays, or move the scene nearer to the origin of coordinates");
}

/* ---- parts of a result ---- */

static RtStatus make_parts(Job *job, RtArena *memory, RtError *error) {
    job->parts = rt_arena_alloc(memory, chunks_of(job), sizeof(RtEquivalence));
    return rt_arena_check(memory, "verdicts", error);
}

static RtEquivalence sum_of_parts(const Job *job) {
    RtEquivalence sum = {0};
    for (const RtEquivalence *part = job->parts; part < job->parts + chunks_of(job); part++) {
        sum.rays += part->rays;
        sum.occluded_wrong += part->occluded_wrong;
        for (int v = 0; v < RT_VERDICT_COUNT; v++) sum.verdicts[v] += part->verdicts[v];
        for (int s = 0; s < RT_SIDE_COUNT; s++) sum.sides[s] += part->sides[s];
        sum.missed += part->missed;
        sum.largest_off = fmax(sum.largest_off, part->largest_off);
        for (int f = 0; f < RT_FAULT_COUNT; f++) sum.faults[f] += part->faults[f];
        if (part->any_wrong && !sum.any_wrong) sum.first_wrong = part->first_wrong;
        sum.any_wrong |= part->any_wrong;
    }
    return sum;
}

/* ---- checking ---- */

/* Traces a chunk in all modes. */
static void answer(RtQuery *query, const Plan *plan, const RtRay *rays, Answers *answers) {
    for (int w = 0; w < plan->mode_count; w++) {
        size_t stream = plan->modes[w].stream;
        RtTally *tallies = plan->modes[w].counted ? answers->tallies : NULL;
        for (size_t first = 0; first < plan->count; first += stream) {
            size_t n = plan->count - first < stream ? plan->count - first : stream;
            rt_nearest(query, rays + first, n, answers->hits[w] + first, tallies);
            rt_remote_progress();
            rt_occluded(query, rays + first, n, answers->blocked[w] + first, tallies);
            rt_remote_progress();
        }
    }
}

/* Counts a chunk twice from the same initial state, over the hits of earlier queries. */
static void recount(RtQuery *query, const Plan *plan, const RtRay *rays, Answers *answers) {
    for (int i = 0; i < 2; i++) {
        rt_query_begin(query);
        rt_remote_progress();
        memset(answers->recounts[i], 0, sizeof answers->recounts[i]);
        rt_nearest(query, rays, plan->count, answers->hits[plan->mode_count - 1], answers->recounts[i]);
    }
}

/* Where the accelerator is. */
static RtStatus answer_chunk(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)error;
    Answers *answers = message;
    const Plan plan = answers->plan;
    if (plan.recount) recount(query, &plan, rays, answers);
    answer(query, &plan, rays, answers);
    return RT_OK;
}

static RtJudge judge_of(const RtAccel *accel, const RtRay *ray) {
    return rt_judge(&accel->scene->geometry, ray, accel->absolute);
}

RtStatus rt_answer_verdict(const RtQuery *query, const RtWrongAnswer *answer, RtVerdict *verdict,
                           RtError *error) {
    const RtHit expected = answer->expected, got = answer->got;
    const bool hit = expected.object != RT_NO_OBJECT;
    const bool equal = answer->occluded ? hit == answer->blocked : memcmp(&expected, &got, sizeof got) == 0;
    *verdict = equal ? RT_EQUAL : RT_WRONG;
    if (equal || query->accel->exact) return RT_OK;
    const RtJudge judge = judge_of(query->accel, &answer->ray);
    return answer->occluded ? rt_verdict_occluded(judge, hit, answer->blocked, verdict, error)
                            : rt_verdict_nearest(judge, expected, got, verdict, error);
}

void rt_wrong_answer_context(const RtReference *reference, const RtWrongAnswer *wrong, size_t *first,
                             size_t *count) {
    size_t place = wrong->index % CHUNK;
    *first = wrong->index - place;
    size_t end = (place / wrong->stream + 1) * wrong->stream;
    size_t left = reference->count - *first;
    if (end > CHUNK) end = CHUNK;
    *count = end < left ? end : left;
}

static void keep_wrong_answer(RtEquivalence *part, const RtWrongAnswer *wrong) {
    if (!part->any_wrong) part->first_wrong = *wrong;
    part->any_wrong = true;
}

/* Of an answer to `nearest` that is marginal or wrong: which side is exactly right? */
static RtStatus add_side(RtJudge judge, RtHit expected, RtHit got, RtEquivalence *part, RtError *error) {
    RtSide side;
    RT_TRY(rt_verdict_side(judge, expected, got, &side, error));
    part->sides[side]++;
    part->missed += got.object == RT_NO_OBJECT && (side == RT_SIDE_EXPECTED || side == RT_SIDE_NEITHER);
    return RT_OK;
}

static void add_difference(RtHit expected, RtHit got, RtEquivalence *part) {
    const double off = fabs((double)got.t / (double)expected.t - 1); /* NaN of two misses */
    if (off > part->largest_off && off < HUGE_VAL) part->largest_off = off;
}

static RtStatus add_fault(RtJudge judge, RtHit got, RtEquivalence *part, RtError *error) {
    RtFault fault;
    RT_TRY(rt_verdict_fault(judge, got, &fault, error));
    part->faults[fault]++;
    return RT_OK;
}

/* Judges ray `i` of a chunk, and adds the verdict to the chunk's part. */
static RtStatus judge(const Job *job, const Worker *worker, size_t chunk, size_t i, RtError *error) {
    RtEquivalence *part = &job->parts[chunk];
    size_t index = chunk * CHUNK + i;
    const RtRay *ray = &job->reference->rays[index];
    RtHit expected = job->reference->hits[index];
    RtVerdict worst = RT_EQUAL;
    bool occluded_wrong = false;
    const RtHit *doubtful = NULL, *faulty = NULL;
    for (int w = 0; w < worker->plan.mode_count; w++) {
        RtWrongAnswer wrong = {.index = index,
                               .counted = worker->plan.modes[w].counted,
                               .stream = worker->plan.modes[w].stream,
                               .ray = *ray,
                               .expected = expected,
                               .got = worker->answers.hits[w][i],
                               .blocked = worker->answers.blocked[w][i]};
        RtVerdict verdict;
        RT_TRY(rt_answer_verdict(&worker->query, &wrong, &verdict, error));
        if (verdict == RT_WRONG) keep_wrong_answer(part, &wrong);
        if (verdict < RT_MARGINAL && !job->accel->exact) add_difference(expected, wrong.got, part);
        if (verdict >= RT_MARGINAL) doubtful = &worker->answers.hits[w][i];
        if (verdict == RT_WRONG) faulty = doubtful;
        if (verdict > worst) worst = verdict;
        wrong.occluded = true;
        RT_TRY(rt_answer_verdict(&worker->query, &wrong, &verdict, error));
        if (verdict == RT_WRONG) keep_wrong_answer(part, &wrong);
        occluded_wrong |= verdict == RT_WRONG;
        if (verdict != RT_WRONG && verdict > worst) worst = verdict;
    }
    part->rays++;
    part->verdicts[worst]++;
    job->reference->differs[index] |= worst >= RT_MARGINAL || occluded_wrong;
    part->occluded_wrong += occluded_wrong;
    if (doubtful && !job->accel->exact)
        RT_TRY(add_side(judge_of(job->accel, ray), expected, *doubtful, part, error));
    if (faulty && !job->accel->exact) RT_TRY(add_fault(judge_of(job->accel, ray), *faulty, part, error));
    return RT_OK;
}

/* The plugin's process has checked its hits, but may have overwritten them since. */
static bool hits_are_possible(const RtAccel *accel, const Plan *plan, const RtRay *rays,
                              const Answers *answers) {
    const uint32_t objects = rt_geometry_id_count(&accel->scene->geometry);
    for (int w = 0; w < plan->mode_count; w++) {
        for (size_t i = 0; i < plan->count; i++) {
            if (!rt_hit_is_possible(objects, &rays[i], answers->hits[w][i])) return false;
        }
    }
    return true;
}

static RtStatus check_chunk(void *context, size_t chunk, int thread, RtError *error) {
    Job *job = context;
    Worker *worker = &job->workers[thread];
    Answers *answers = &worker->answers;
    choose_modes(worker, chunk);
    worker->plan.count = chunk_count(job, chunk);
    worker->plan.recount = chunk == 0;
    answers->plan = worker->plan;
    const RtRay *rays = job->reference->rays + chunk * CHUNK;
    if (rt_remote_do(&worker->query, answer_chunk, rays, worker->plan.count, answers, sizeof *answers,
                     NULL) != RT_OK)
        return RT_OK; /* rt_accel_check reports it */
    if (rt_accel_is_remote(job->accel) && !hits_are_possible(job->accel, &worker->plan, rays, answers)) {
        rt_remote_break(job->accel, "it overwrote its answers", "it was traced");
        return RT_OK;
    }
    for (int k = 0; k < RT_RAY_KIND_COUNT && worker->plan.recount && job->recounted.status == RT_OK; k++)
        rt_counts_check(job->accel, &answers->recounts[0][k], &answers->recounts[1][k], (RtRayKind)k,
                        &job->recounted);
    for (size_t i = 0; i < worker->plan.count; i++) RT_TRY(judge(job, worker, chunk, i, error));
    return RT_OK;
}

RtStatus rt_equivalence_check(const RtReference *reference, RtAccel *accel, int threads, RtEquivalence *out,
                              RtError *error) {
    Job job = {.reference = reference, .accel = accel, .threads = threads};
    RT_ARENA(memory);
    RT_TRY(rt_accel_learn(accel, reference->rays, reference->hits, reference->count, error));
    RT_TRY(make_parts(&job, &memory, error));
    RT_TRY(run(&job, check_chunk, error));
    *out = sum_of_parts(&job);
    if (out->any_wrong || job.recounted.status == RT_OK) return RT_OK;
    return rt_fail(error, RT_BROKEN, "%s", job.recounted.message);
}

/* ---- recorded answers ---- */

static RtStatus judge_chunk(void *context, size_t chunk, int thread, RtError *error) {
    (void)thread;
    const Job *job = context;
    RtEquivalence *part = &job->parts[chunk];
    for (size_t i = 0; i < chunk_count(job, chunk); i++) {
        const size_t index = chunk * CHUNK + i;
        const RtRay *ray = &job->reference->rays[index];
        const RtHit expected = job->reference->hits[index];
        const RtWrongAnswer answer = {
            .index = index, .ray = *ray, .expected = expected, .got = job->recorded[index]};
        const RtJudge judge = rt_judge(&job->reference->scene->geometry, ray, false);
        RtHit got = answer.got;
        RtVerdict verdict = RT_EQUAL;
        RT_TRY(rt_verdict_name_object(judge, expected, &got, error));
        if (memcmp(&expected, &got, sizeof got) != 0)
            RT_TRY(rt_verdict_nearest(judge, expected, got, &verdict, error));
        part->rays++;
        part->verdicts[verdict]++;
        job->reference->differs[index] |= verdict >= RT_MARGINAL;
        if (verdict < RT_MARGINAL) add_difference(expected, got, part);
        if (verdict >= RT_MARGINAL) RT_TRY(add_side(judge, expected, got, part, error));
        if (verdict < RT_WRONG) continue;
        RT_TRY(add_fault(judge, got, part, error));
        keep_wrong_answer(part, &answer);
    }
    return RT_OK;
}

RtStatus rt_equivalence_judge(const RtReference *reference, const RtHit *hits, int threads,
                              RtEquivalence *out, RtError *error) {
    Job job = {.reference = reference, .recorded = hits};
    RT_ARENA(memory);
    RT_TRY(make_parts(&job, &memory, error));
    RT_TRY(rt_parallel_for(chunks_of(&job), rt_thread_count(threads), judge_chunk, &job, error));
    *out = sum_of_parts(&job);
    return RT_OK;
}

/* ---- results as text ---- */

/* Nine significant digits restore the same float32. */
static json_t *float_json(float x) {
    char text[32];
    snprintf(text, sizeof text, "%.9g", (double)x);
    return json_string(text);
}

static json_t *vector_json(RtVec3 v) {
    return json_pack("[o, o, o]", float_json(v.x), float_json(v.y), float_json(v.z));
}

static json_t *hit_json(RtHit hit) {
    json_t *object = hit.object >= RT_UNNAMED_OBJECT ? json_null() : json_integer(hit.object);
    return json_pack("{s:o, s:o}", "t", float_json(hit.t), "object", object);
}

static json_t *wrong_answer_json(const RtWrongAnswer *w) {
    json_t *expected = w->occluded ? json_boolean(w->expected.object != RT_NO_OBJECT) : hit_json(w->expected);
    json_t *got = w->occluded ? json_boolean(w->blocked) : hit_json(w->got);
    char says[512];
    rt_wrong_answer_format(w, says, sizeof says);
    const char *kernel = w->stream == 0 ? NULL : w->counted ? "counted" : "timed";
    return json_pack("{s:I, s:s, s:s, s:s?, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "index",
                     (json_int_t)w->index, "says", says, "query", w->occluded ? "occluded" : "nearest",
                     "kernel", kernel, "stream", kernel ? json_integer((json_int_t)w->stream) : json_null(),
                     "org", vector_json(w->ray.org), "dir", vector_json(w->ray.dir), "tmin",
                     float_json(w->ray.tmin), "tmax", float_json(w->ray.tmax), "expected", expected, "got",
                     got);
}

json_t *rt_equivalence_json(const RtEquivalence *result, const char *scene, const char *accel,
                            const char *against) {
    json_t *row = json_pack("{s:s, s:s, s:s, s:I}", "scene", scene, "accel", accel, "against", against,
                            "rays", (json_int_t)result->rays);
    for (int v = 0; v < RT_VERDICT_COUNT; v++) {
        json_object_set_new(row, rt_verdict_name((RtVerdict)v),
                            json_integer((json_int_t)result->verdicts[v]));
    }
    json_t *sides = json_object(), *faults = json_object();
    for (int s = 0; s < RT_SIDE_COUNT; s++) {
        json_object_set_new(sides, rt_side_name((RtSide)s), json_integer((json_int_t)result->sides[s]));
    }
    for (int f = 0; f < RT_FAULT_COUNT; f++) {
        json_object_set_new(faults, rt_fault_name((RtFault)f), json_integer((json_int_t)result->faults[f]));
    }
    json_object_set_new(row, "exactly_right", sides);
    json_object_set_new(row, "largest_off", json_real(result->largest_off));
    json_object_set_new(row, "missed", json_integer((json_int_t)result->missed));
    json_object_set_new(row, "faults", faults);
    json_object_set_new(row, "certain", json_null());
    json_object_set_new(row, "must_hit", json_null());
    json_object_set_new(row, "certain_of", json_null());
    json_object_set_new(row, "occluded_wrong", json_integer((json_int_t)result->occluded_wrong));
    json_object_set_new(row, "first_wrong",
                        result->any_wrong ? wrong_answer_json(&result->first_wrong) : json_null());
    return row;
}

static void format_hit(RtHit hit, char *out, size_t size) {
    if (hit.object == RT_NO_OBJECT) {
        snprintf(out, size, "no hit");
    } else if (hit.object == RT_UNNAMED_OBJECT) {
        snprintf(out, size, "a hit at t = %.9g", (double)hit.t);
    } else {
        snprintf(out, size, "object %u at t = %.9g", hit.object, (double)hit.t);
    }
}

void rt_wrong_answer_format(const RtWrongAnswer *w, char *out, size_t size) {
    char expected[64], got[64], ray[RT_RAY_TEXT], how[64] = "";
    format_hit(w->expected, expected, sizeof expected);
    format_hit(w->got, got, sizeof got);
    if (w->occluded) snprintf(got, sizeof got, "%s", w->blocked ? "blocked" : "not blocked");
    rt_ray_format(&w->ray, ray, sizeof ray);
    if (w->stream > 0)
        snprintf(how, sizeof how, ", %s, %s kernel, streams of %zu", w->occluded ? "occluded" : "nearest",
                 w->counted ? "counted" : "timed", w->stream);
    snprintf(out, size, "ray %zu%s: %s: expected %s, got %s", w->index, how, ray, expected, got);
}
