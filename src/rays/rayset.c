/* SPDX-License-Identifier: Apache-2.0 */
/* Ray sets. A frame records the rays that it traces; diffuse and random rays are made here. Each ray has its
 * own stream of random numbers, numbered by kind and index. */
#include "rays/rayset.h"

#include "core/base/parallel.h"

#include <assert.h>
#include <string.h>
#include <xxhash.h>

_Static_assert(sizeof(RtRay) == 10 * sizeof(uint32_t), "a ray has no padding, so its bytes may be hashed");

/* Rays made by one item of parallel work. */
#define CHUNK 4096

typedef struct Recorder {
    const RtRecording *recording;
    const RtScene *scene;
    RtFrame frame;
    RtRaySet *sets; /* [RT_RAY_KIND_COUNT] */
} Recorder;

static uint64_t stream_of(RtRayKind kind, uint64_t index) {
    return (uint64_t)kind << 56 | index;
}

RtStatus rt_rayset_init(RtRaySet *set, RtRayKind kind, uint64_t count, RtError *error) {
    *set = (RtRaySet){.kind = kind, .count = count, .rays = rt_alloc_unset(count, sizeof(RtRay))};
    return set->rays ? RT_OK : rt_fail_memory(error, "a ray set", count * sizeof(RtRay));
}

void rt_rayset_seal(RtRaySet *set) {
    set->fingerprint = XXH3_64bits(set->rays, set->count * sizeof(RtRay));
}

/* ---- diffuse rays ---- */

/* The diffuse ray from the hit of `primary`, on the side that it came from. */
static RtRay bounce(const Recorder *recorder, const RtRay *primary, RtHitMemory *hit_memory) {
    uint32_t sample = primary->source;
    RtHit hit = {recorder->frame.depth[sample], recorder->frame.object[sample]};
    RtSurface surface = rt_surface(recorder->scene, primary, hit, hit_memory);
    RtRandom random = rt_random(recorder->recording->seed, stream_of(RT_RAY_DIFFUSE, sample));
    return (RtRay){.org = rt_narrow(rt_add_scaledd(surface.point, surface.side, surface.offset)),
                   .dir = rt_narrow(rt_random_cosine(&random, surface.side)),
                   .tmin = 0,
                   .tmax = INFINITY,
                   .kind = RT_RAY_DIFFUSE,
                   .source = sample};
}

static RtStatus make_diffuse(Recorder *recorder, RtError *error) {
    const RtRaySet *primary = &recorder->sets[RT_RAY_PRIMARY];
    RtRaySet *set = &recorder->sets[RT_RAY_DIFFUSE];
    RT_TRY(rt_rayset_init(set, RT_RAY_DIFFUSE, primary->count, error));
    set->count = 0;
    RtHitMemory *hit_memory;
    RT_TRY(rt_hit_memory_alloc(&recorder->scene->geometry, &hit_memory, error));
    for (uint64_t i = 0; i < primary->count; i++) {
        if (recorder->frame.object[primary->rays[i].source] == RT_NO_OBJECT) continue;
        RtRay ray = bounce(recorder, &primary->rays[i], hit_memory);
        if (rt_ray_is_valid(&ray)) set->rays[set->count++] = ray;
    }
    rt_free(hit_memory);
    return RT_OK;
}

/* The same rays, as any-hit queries. */
static RtStatus make_occlusion(Recorder *recorder, RtError *error) {
    const RtRaySet *diffuse = &recorder->sets[RT_RAY_DIFFUSE];
    RtRaySet *set = &recorder->sets[RT_RAY_OCCLUSION];
    RT_TRY(rt_rayset_init(set, RT_RAY_OCCLUSION, diffuse->count, error));
    for (uint64_t i = 0; i < diffuse->count; i++) {
        set->rays[i] = diffuse->rays[i];
        set->rays[i].kind = RT_RAY_OCCLUSION;
    }
    return RT_OK;
}

/* ---- random rays ---- */

static RtVec3 point_of_sphere(RtRandom *random, const RtBall *sphere) {
    RtVec3 p = rt_narrow(rt_add_scaledd(sphere->center, rt_random_direction(random), sphere->radius));
    for (int a = 0; a < 3; a++) p.at[a] = rt_maxf(-RT_MAX_COORDINATE, rt_minf(p.at[a], RT_MAX_COORDINATE));
    return p;
}

RtBall rt_bounding_sphere(const RtBox *box) {
    if (rt_box_is_empty(*box)) return (RtBall){{0, 0, 0}, 1};
    RtVec3d center = rt_widen(rt_box_center(*box));
    return (RtBall){center, rt_lengthd(rt_subd(rt_widen(box->hi), center))};
}

RtRay rt_sphere_chord(const RtBall *sphere, RtRandom *random) {
    RtVec3 from = point_of_sphere(random, sphere);
    RtVec3 to = point_of_sphere(random, sphere);
    RtVec3 dir = rt_sub(to, from);
    /* The points of a very small or distant sphere coincide in float32: any direction. */
    if (dir.x == 0 && dir.y == 0 && dir.z == 0) dir = rt_narrow(rt_random_direction(random));
    return (RtRay){.org = from, .dir = dir, .tmin = 0, .tmax = INFINITY, .kind = RT_RAY_RANDOM};
}

RtRay rt_random_chord(const RtBox *box, RtRandom *random) {
    RtBall sphere = rt_bounding_sphere(box);
    return rt_sphere_chord(&sphere, random);
}

static RtStatus make_chunk(void *context, size_t item, int thread, RtError *error) {
    (void)thread, (void)error;
    Recorder *recorder = context;
    RtRaySet *set = &recorder->sets[RT_RAY_RANDOM];
    for (uint64_t i = (uint64_t)item * CHUNK; i < set->count && i < (uint64_t)(item + 1) * CHUNK; i++) {
        RtRandom random = rt_random(recorder->recording->seed, stream_of(RT_RAY_RANDOM, i));
        set->rays[i] = rt_random_chord(&recorder->scene->geometry.box, &random);
    }
    return RT_OK;
}

static RtStatus make_random(Recorder *recorder, RtError *error) {
    uint64_t count = recorder->scene->geometry.object_count ? recorder->recording->random : 0;
    RT_TRY(rt_rayset_init(&recorder->sets[RT_RAY_RANDOM], RT_RAY_RANDOM, count, error));
    return rt_parallel_for((count + CHUNK - 1) / CHUNK, recorder->recording->threads, make_chunk, recorder,
                           error);
}

/* ---- recording ---- */

#define BIT(kind) (1u << RT_RAY_##kind)

/* The kinds that the frame's hits make, and those that its whole ray tree makes. */
enum {
    OF_HITS = BIT(PRIMARY) | BIT(DIFFUSE) | BIT(OCCLUSION),
    OF_TREE = BIT(SHADOW) | BIT(REFLECTION) | BIT(TRANSMISSION)
};

static RtStatus trace_frame(Recorder *recorder, const RtAccel *accel, uint32_t kinds, RtError *error) {
    RtFrame *frame = &recorder->frame;
    const RtFrameOptions options = {.depth = kinds & OF_TREE ? recorder->recording->depth : 1,
                                    .threads = recorder->recording->threads,
                                    .light_from_outside = recorder->recording->light_from_outside,
                                    .keep_rays = true};
    RT_TRY(rt_frame_trace(frame, accel, &options, error));
    for (int kind = RT_RAY_PRIMARY; kind <= RT_RAY_TRANSMISSION; kind++) {
        if (kind != RT_RAY_PRIMARY && !(kinds & 1u << kind)) continue;
        recorder->sets[kind].count = frame->ray_count[kind];
        recorder->sets[kind].rays = frame->rays[kind];
        frame->rays[kind] = NULL; /* the set owns them now */
    }
    if (kinds & (BIT(DIFFUSE) | BIT(OCCLUSION))) RT_TRY(make_diffuse(recorder, error));
    return kinds & BIT(OCCLUSION) ? make_occlusion(recorder, error) : RT_OK;
}

RtStatus rt_rayset_record(RtRaySet *sets, const RtAccel *accel, const RtRecording *recording,
                          RtError *error) {
    const uint32_t kinds = recording->kinds ? recording->kinds : RT_ALL_RAY_KINDS;
    Recorder recorder = {.recording = recording, .scene = accel->scene, .sets = sets};
    RtStatus status = RT_OK;
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) sets[kind] = (RtRaySet){.kind = (RtRayKind)kind};
    if (kinds & (OF_HITS | OF_TREE)) status = trace_frame(&recorder, accel, kinds, error);
    if (status == RT_OK && kinds & BIT(RANDOM)) status = make_random(&recorder, error);
    rt_frame_clear(&recorder.frame);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        if (status == RT_OK)
            rt_rayset_seal(&sets[kind]);
        else
            rt_rayset_clear(&sets[kind]);
    }
    return status;
}

/* ---- thinning ---- */

RtStatus rt_rayset_thin(const RtRaySet *from, uint64_t stride, RtRaySet *to, RtError *error) {
    assert(stride > 0);
    RT_TRY(rt_rayset_init(to, from->kind, (from->count + stride - 1) / stride, error));
    for (uint64_t i = 0; i < to->count; i++) to->rays[i] = from->rays[i * stride];
    rt_rayset_seal(to);
    return RT_OK;
}

/* The run of a group of `stride` runs that is kept. It is random, because a constant would pick columns of
 * the image where `stride` divides the runs of a row. */
static uint64_t pick(uint64_t group, uint64_t stride) {
    RtRandom random = rt_random(0, group);
    return (uint64_t)rt_random_bits(&random) * stride >> 32;
}

RtStatus rt_rayset_limit(const RtRaySet *from, uint64_t limit, uint64_t run, RtRaySet *to, RtError *error) {
    assert(limit > 0 && run > 0);
    uint64_t stride = (from->count + limit - 1) / limit;
    if (run > limit / 64) run = limit / 64;
    if (run > RT_TILE_BLOCK) run -= run % RT_TILE_BLOCK;
    if (stride <= 1 || run <= 1) return rt_rayset_thin(from, stride ? stride : 1, to, error);
    RT_TRY(rt_rayset_init(to, from->kind, limit, error));
    to->count = 0;
    for (uint64_t group = 0; group * stride * run < from->count; group++) {
        uint64_t first = (group * stride + pick(group, stride)) * run;
        for (uint64_t i = first; i < first + run && i < from->count && to->count < limit; i++)
            to->rays[to->count++] = from->rays[i];
    }
    rt_rayset_seal(to);
    return RT_OK;
}

void rt_rayset_clear(RtRaySet *set) {
    rt_free(set->rays);
    *set = (RtRaySet){.kind = set->kind};
}
