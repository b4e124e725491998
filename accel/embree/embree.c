/* SPDX-License-Identifier: Apache-2.0 */
/* embree: Intel's ray tracing kernels, as a competitor and as a reference.
 *
 *   mode=native  Triangles and spheres are Embree's own geometry, with its own arithmetic: fast, and judged
 *                by verdicts. Polygons and cones, which Embree lacks, use our hit functions.
 *   mode=user    Everything uses our hit functions in Embree's hierarchy: the same bits as brute (embree.h
 *                proves it), independent of our structures. Its time is that of the callbacks; never quote
 *                it as Embree's.
 *
 * Instances are Embree's own in native mode if the accelerator of their parts is native, too.
 *
 * Paper: Wald, Woop, Benthin, Johnson & Ernst 2014, "Embree: A Kernel Framework for Efficient CPU Ray
 * Tracing", ACM TOG 33(4). Object tests are counted in user mode only. Embree exposes no extent tests, steps
 * or structure, so these are reported as 0.
 *
 * A stream of rays goes to Embree in chunks: as single rays, packets of 8 or 16, or streams. The loop is
 * written once; after inlining, the kind of query and whether it counts are constants. In Embree 3 and 4 a
 * packet of N rays is an array of 32-bit words: field f of lane i is word f * N + i. A single ray is a packet
 * of one.
 *
 * Rays are valid (rt_ray_is_valid), so they satisfy Embree's assertions, except that a direction may exceed
 * 1.8e18. Such directions, and directions so short that Embree would change them, are scaled.
 *
 * In native mode converting rays and hits must cost almost nothing. Rays are written to packets four at a
 * time, by transposing 4 x 4 words; the only arithmetic replaces -0 and tiny components of dir by 0. Fields
 * that are the same for all rays are written once per call. Consecutive object ids are computed, not looked
 * up. A chunk with a direction that is not ordinary takes a slow path. Denormals are disabled from the first
 * ray to the last, except where the slow path uses double. */
#include "accel/embree/embree.h"
#include "accel/kernel.h"
#include "core/base/memory.h"
#include "core/base/simd_across.h"

#include <string.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

/* ---- one interface to Embree 3 and 4 ---- */

#if RT_WITH_EMBREE >= 4
typedef struct RTCRayQueryContext Context;
#else
typedef struct RTCIntersectContext Context;
#endif

typedef union Word {
    float f;
    uint32_t u;
} Word;

/* The fields of a packet, in the order of RTCRayN and RTCHitN. */
enum {
    FIELD_ORG, /* x, y, z */
    FIELD_TNEAR = 3,
    FIELD_DIR, /* x, y, z */
    FIELD_TIME = 7,
    FIELD_TFAR,
    FIELD_MASK,
    FIELD_ID,
    FIELD_FLAGS,
    FIELD_NG, /* x, y, z */
    FIELD_U = 15,
    FIELD_V,
    FIELD_PRIMITIVE,
    FIELD_GEOMETRY,
    FIELD_INSTANCE
};

/* A field of one lane. */
RT_KERNEL Word *word_at(Word *packet, size_t lanes, size_t field, size_t lane) {
    return &packet[field * lanes + lane];
}

/* Words from one packet of rays and hits to the next. */
RT_KERNEL size_t packet_words(unsigned lanes) {
    size_t bytes = lanes == 1   ? sizeof(struct RTCRayHit)
                   : lanes == 8 ? sizeof(struct RTCRayHit8)
                                : sizeof(struct RTCRayHit16);
    return bytes / sizeof(Word);
}

RT_KERNEL void init_context(Context *context, bool coherent) {
#if RT_WITH_EMBREE >= 4
    (void)coherent;
    rtcInitRayQueryContext(context);
#else
    rtcInitIntersectContext(context);
    if (coherent) context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif
}

/* Traces one packet of 1, 8 or 16 lanes: nearest hits, or with `any` occlusion, where tfar becomes -inf for a
 * ray that hits anything. */
RT_KERNEL void trace_packet(RTCScene scene, Context *context, bool coherent, const int *valid, Word *packet,
                            unsigned lanes, bool any) {
#if RT_WITH_EMBREE >= 4
    struct RTCIntersectArguments nearest;
    struct RTCOccludedArguments occluded;
    rtcInitIntersectArguments(&nearest);
    rtcInitOccludedArguments(&occluded);
    nearest.context = occluded.context = context;
    if (coherent) nearest.flags = occluded.flags = RTC_RAY_QUERY_FLAG_COHERENT;
#define TRACE_RAY(trace, Type, arguments)    trace(scene, (struct Type *)packet, &arguments)
#define TRACE_PACKET(trace, Type, arguments) trace(valid, scene, (struct Type *)packet, &arguments)
#else
    (void)coherent;
#define TRACE_RAY(trace, Type, arguments)    trace(scene, context, (struct Type *)packet)
#define TRACE_PACKET(trace, Type, arguments) trace(valid, scene, context, (struct Type *)packet)
#endif
    if (any) {
        if (lanes == 1) TRACE_RAY(rtcOccluded1, RTCRay, occluded);
        if (lanes == 8) TRACE_PACKET(rtcOccluded8, RTCRay8, occluded);
        if (lanes == 16) TRACE_PACKET(rtcOccluded16, RTCRay16, occluded);
    } else {
        if (lanes == 1) TRACE_RAY(rtcIntersect1, RTCRayHit, nearest);
        if (lanes == 8) TRACE_PACKET(rtcIntersect8, RTCRayHit8, nearest);
        if (lanes == 16) TRACE_PACKET(rtcIntersect16, RTCRayHit16, nearest);
    }
#undef TRACE_RAY
#undef TRACE_PACKET
}

/* Traces a stream of `count` packets of one lane; never called if RT_EMBREE_STREAMS is 0. */
RT_KERNEL void trace_stream(RTCScene scene, Context *context, Word *packets, unsigned count, bool any) {
#if RT_EMBREE_STREAMS
    if (any)
        rtcOccluded1M(scene, context, (struct RTCRay *)packets, count, sizeof(struct RTCRayHit));
    else
        rtcIntersect1M(scene, context, (struct RTCRayHit *)packets, count, sizeof(struct RTCRayHit));
#else
    (void)scene, (void)context, (void)packets, (void)count, (void)any;
#endif
}

/* ---- batches of rays in Embree's layout, the scratch memory of a query ---- */

/* Rays per chunk as single rays or packets: 32 to 128 were slower by up to a tenth. */
#define PACKET_RAYS 16
#define STREAM_RAYS 256 /* and as a stream */

/* A ray of user mode, and its best hit. */
typedef struct Search {
    RtPreparedRay ray;
    double shrink; /* Embree's t is t * shrink, a power of two */
    RtHit best;
    RtTally *tally; /* NULL in the timed kernels */
} Search;

/* Embree's context of one call, extended for the callbacks. Those of user mode are called through it, so one
 * structure serves the timed and the counted kernels. */
typedef struct Trace {
    Context context; /* first, because callbacks get a pointer to it */
    RTCIntersectFunctionN intersect;
    RTCOccludedFunctionN occluded;
    Search *searches;        /* by ray id */
    RtHitMemory *hit_memory; /* of hit functions */
    unsigned denormals;      /* of native mode: how they were before */
} Trace;

typedef struct Batch {
    _Alignas(RT_CACHE_LINE) struct RTCRayHit packets[STREAM_RAYS]; /* or packets of 8 or 16 */
    int valid[STREAM_RAYS];                                        /* -1: active, 0: inactive */
    Search searches[STREAM_RAYS];
} Batch;

_Static_assert(sizeof(struct RTCRayHit16) <= PACKET_RAYS * sizeof(struct RTCRayHit),
               "a packet takes no more room than its rays");

/* ---- denormals: Embree's documentation recommends to disable them; our own arithmetic needs them ---- */

RT_KERNEL unsigned denormals_off(void) {
#if defined(__x86_64__)
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040u); /* flush to zero, denormals are zero */
    return before;
#else
    return 0;
#endif
}

RT_KERNEL void restore_denormals(unsigned before) {
#if defined(__x86_64__)
    _mm_setcsr(before);
#else
    (void)before;
#endif
}

/* ---- rays in ---- */

/* Embree replaces smaller components of dir by +LEAST_DIR, even negative ones, so a stream may lose
 * hits. Therefore they, and -0, are passed as 0. */
#define LEAST_DIR 1e-18f

RT_KERNEL float longest_of(RtVec3 dir) {
    return rt_maxf(fabsf(dir.x), rt_maxf(fabsf(dir.y), fabsf(dir.z)));
}

RT_KERNEL bool is_ordinary(RtVec3 dir) {
    float longest = longest_of(dir);
    return longest >= RT_EMBREE_SHORT && longest <= RT_EMBREE_LONG;
}

/* The power of two that makes dir ordinary: nearly always 1. */
RT_KERNEL double stretch_of(RtVec3 dir) {
    double longest = (double)longest_of(dir), stretch = 1;
    while (longest * stretch < (double)RT_EMBREE_SHORT) stretch *= 0x1p16;
    while (longest * stretch > (double)RT_EMBREE_LONG) stretch *= 0x1p-16;
    return stretch;
}

RT_KERNEL Word *at_lane(Batch *batch, unsigned lanes, size_t i, size_t field) {
    Word *packet = (Word *)batch->packets + i / lanes * packet_words(lanes);
    return word_at(packet, lanes, field, i % lanes);
}

/* The fields that are the same for all rays. */
RT_KERNEL void put_constants(Batch *batch, unsigned lanes, size_t i) {
    at_lane(batch, lanes, i, FIELD_TIME)->f = 0;
    at_lane(batch, lanes, i, FIELD_MASK)->u = UINT32_MAX;
    at_lane(batch, lanes, i, FIELD_ID)->u = (uint32_t)i;
    at_lane(batch, lanes, i, FIELD_FLAGS)->u = 0;
    at_lane(batch, lanes, i, FIELD_GEOMETRY)->u = RTC_INVALID_GEOMETRY_ID;
    at_lane(batch, lanes, i, FIELD_INSTANCE)->u = RTC_INVALID_GEOMETRY_ID;
    batch->valid[i] = -1;
}

RT_KERNEL void put_ray(Batch *batch, unsigned lanes, size_t i, const RtRay *ray, double stretch, float tnear,
                       float tfar) {
    for (unsigned a = 0; a < 3; a++) {
        at_lane(batch, lanes, i, FIELD_ORG + a)->f = ray->org.at[a];
        float dir = (float)((double)ray->dir.at[a] * stretch);
        at_lane(batch, lanes, i, FIELD_DIR + a)->f = fabsf(dir) < LEAST_DIR ? 0 : dir;
    }
    at_lane(batch, lanes, i, FIELD_TNEAR)->f = rt_minf(tnear, FLT_MAX) + 0.0f; /* -0 becomes 0 */
    at_lane(batch, lanes, i, FIELD_TFAR)->f = tfar;
}

/* ---- tracing ---- */

/* Primary and shadow rays come in tiles, so neighbours are coherent. For occluders in instances, only packets
 * of 8 say so: of coherent packets of 16, into which it also cuts coherent streams, Debian's Embree 3.13 for
 * AVX-512 reads 64 bits of a mask of 16 there, by a fault of gcc's, and may never end. */
RT_KERNEL bool is_coherent(const RtEmbree *self, const RtRay *ray, bool any, unsigned lanes) {
    if (any && lanes != 8 && self->base.scene->geometry.instance_count > 0) return false;
    return ray->kind == RT_RAY_PRIMARY || ray->kind == RT_RAY_SHADOW;
}

/* Traces the first `count` rays of the batch. */
RT_KERNEL void trace_batch(const RtEmbree *self, Batch *batch, Context *context, bool coherent, size_t count,
                           bool any, unsigned lanes, bool stream) {
    Word *words = (Word *)batch->packets;
    if (stream) {
        trace_stream(self->scene, context, words, (unsigned)count, any);
        return;
    }
    for (size_t i = count; i % lanes != 0; i++) batch->valid[i] = 0;
    for (size_t i = 0; i < count; i += lanes, words += packet_words(lanes)) {
        const int *valid = &batch->valid[i];
        if (lanes == 1 && !*valid) continue;
        trace_packet(self->scene, context, coherent, valid, words, lanes, any);
    }
}

/* ---- user mode: our rays and hits; only tfar of Embree's ray is updated ---- */

RT_KERNEL void search_lanes(const RtEmbreeSlot *slot, const void *context, uint32_t primitive,
                            const int *valid, Word *rays, unsigned lanes, bool any, bool counted) {
    const RtGeometry *geometry = &slot->self->base.scene->geometry;
    const Trace *trace = context;
    uint32_t id = slot->ids[primitive];
    for (unsigned i = 0; i < lanes; i++) {
        if (!valid[i]) continue;
        Search *search = &trace->searches[word_at(rays, lanes, FIELD_ID, i)->u];
        float *tfar = &word_at(rays, lanes, FIELD_TFAR, i)->f;
        bool over =
            rt_test_object(geometry, id, &search->ray, any, &search->best, counted ? search->tally : NULL);
        if (over)
            *tfar = -INFINITY;
        else if (search->best.object != RT_NO_OBJECT) /* perhaps one in the instance `id` */
            *tfar = rt_embree_limit(search->best.t, search->shrink);
    }
}

#define DEFINE_SEARCHES(suffix, counted)                                                                     \
    static void search_nearest_##suffix(const struct RTCIntersectFunctionNArguments *a) {                    \
        search_lanes(a->geometryUserPtr, a->context, a->primID, a->valid, (Word *)a->rayhit, a->N, false,    \
                     counted);                                                                               \
    }                                                                                                        \
    static void search_any_##suffix(const struct RTCOccludedFunctionNArguments *a) {                         \
        search_lanes(a->geometryUserPtr, a->context, a->primID, a->valid, (Word *)a->ray, a->N, true,        \
                     counted);                                                                               \
    }
DEFINE_SEARCHES(timed, false)
DEFINE_SEARCHES(counted, true)
#undef DEFINE_SEARCHES

/* ---- native mode: Embree's rays, for shapes that Embree lacks ---- */

/* hit->object is the primitive id of the hit: for an instance, the id of the object. */
static bool lane_hit(const RtEmbreeSlot *slot, uint32_t primitive, const Trace *trace, Word *rays,
                     unsigned lanes, unsigned i, bool any, RtHit *hit) {
    const RtGeometry *geometry = &slot->self->base.scene->geometry;
    const uint32_t id = slot->ids[primitive];
    RtRay ray = {.tmin = word_at(rays, lanes, FIELD_TNEAR, i)->f,
                 .tmax = word_at(rays, lanes, FIELD_TFAR, i)->f};
    for (unsigned a = 0; a < 3; a++) {
        ray.org.at[a] = word_at(rays, lanes, FIELD_ORG + a, i)->f;
        ray.dir.at[a] = word_at(rays, lanes, FIELD_DIR + a, i)->f;
    }
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, geometry, &ray, trace->hit_memory);
    *hit = (RtHit){INFINITY, primitive};
    if (!rt_is_instance(geometry, id)) return rt_object_hit(geometry, id, &prepared, &hit->t, NULL);
    *hit = RT_MISS;
    restore_denormals(trace->denormals); /* for the accelerator of the part */
    rt_test_object(geometry, id, &prepared, any, hit, NULL);
    denormals_off();
    return hit->object != RT_NO_OBJECT;
}

/* Sets tfar of the lanes that hit: to t, or with `any` to -inf. Without `any`, `instance` is also written as
 * part of the hit. */
RT_KERNEL void test_lanes(const RtEmbreeSlot *slot, const void *context, uint32_t geometry,
                          uint32_t primitive, const int *valid, Word *rays, unsigned lanes, bool any,
                          uint32_t instance) {
    for (unsigned i = 0; i < lanes; i++) {
        RtHit hit;
        if (!valid[i] || !lane_hit(slot, primitive, context, rays, lanes, i, any, &hit)) continue;
        word_at(rays, lanes, FIELD_TFAR, i)->f = any ? -INFINITY : hit.t;
        if (any) continue;
        for (unsigned field = FIELD_NG; field <= FIELD_V; field++) word_at(rays, lanes, field, i)->f = 0;
        word_at(rays, lanes, FIELD_PRIMITIVE, i)->u = hit.object;
        word_at(rays, lanes, FIELD_GEOMETRY, i)->u = geometry;
        word_at(rays, lanes, FIELD_INSTANCE, i)->u = instance;
    }
}

static void test_nearest(const struct RTCIntersectFunctionNArguments *a) {
    test_lanes(a->geometryUserPtr, a->context, a->geomID, a->primID, a->valid, (Word *)a->rayhit, a->N, false,
               a->context->instID[0]);
}

static void test_any(const struct RTCOccludedFunctionNArguments *a) {
    test_lanes(a->geometryUserPtr, a->context, a->geomID, a->primID, a->valid, (Word *)a->ray, a->N, true, 0);
}

/* ---- the callbacks ---- */

void rt_embree_intersect(const struct RTCIntersectFunctionNArguments *arguments) {
    ((const Trace *)(const void *)arguments->context)->intersect(arguments);
}

void rt_embree_occluded(const struct RTCOccludedFunctionNArguments *arguments) {
    ((const Trace *)(const void *)arguments->context)->occluded(arguments);
}

/* A context for one chunk of rays. */
static Trace begin_trace(const RtEmbree *self, const RtScratch *scratch, bool coherent, bool counted) {
    Trace trace = {.searches = ((Batch *)scratch->own)->searches, .hit_memory = scratch->hit_memory};
    trace.intersect = !self->user ? test_nearest : counted ? search_nearest_counted : search_nearest_timed;
    trace.occluded = !self->user ? test_any : counted ? search_any_counted : search_any_timed;
    init_context(&trace.context, coherent);
    return trace;
}

/* ---- user mode ---- */

/* Whether Embree proposes all objects that this ray hits (embree.h). |dir| is at most 2^17 * shrink. */
RT_KERNEL bool is_in_reach(const RtEmbree *self, const RtRay *ray, double shrink) {
    return rt_thickness(ray->org, &self->base.scene->geometry.box) <= self->max_thickness &&
           0x1p-150 * 0x1p17 * shrink <= 0.25 * (double)self->growth;
}

/* Writes a ray to the batch; one out of reach is answered at once, and is inactive in the batch. */
RT_KERNEL void put_search(const RtEmbree *self, Batch *batch, unsigned lanes, size_t i, const RtRay *ray,
                          RtHitMemory *hit_memory, bool any, RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    double stretch = stretch_of(ray->dir);
    Search *search = &batch->searches[i];
    rt_hit_ray(&search->ray, geometry, ray, hit_memory);
    search->shrink = 1 / stretch;
    search->best = RT_MISS;
    search->tally = tally;
    float tnear = (float)((double)ray->tmin * search->shrink * (1 - 0x1p-20));
    put_constants(batch, lanes, i);
    put_ray(batch, lanes, i, ray, stretch, tnear, rt_embree_limit(ray->tmax, search->shrink));
    if (is_in_reach(self, ray, search->shrink)) return;
    rt_test_all(geometry, &search->ray, any, &search->best, tally);
    batch->valid[i] = 0;
    at_lane(batch, lanes, i, FIELD_TFAR)->f = -INFINITY;
}

/* Writes nearest hits to `hits`, or if that is NULL, occluders to `occluders`. */
RT_KERNEL void answer_user(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                           RtHit *hits, uint32_t *occluders, RtTally *tallies, unsigned lanes, bool stream) {
    const size_t chunk = stream ? STREAM_RAYS : PACKET_RAYS;
    const bool any = !hits;
    Batch *batch = scratch->own;
    for (size_t begin = 0; begin < count; begin += chunk) {
        const RtRay *ray = rays + begin;
        size_t n = count - begin < chunk ? count - begin : chunk;
        for (size_t i = 0; i < n; i++) {
            RtTally *tally = tallies ? &tallies[ray[i].kind] : NULL;
            put_search(self, batch, lanes, i, &ray[i], scratch->hit_memory, any, tally);
        }
        bool coherent = is_coherent(self, ray, any, lanes);
        Trace trace = begin_trace(self, scratch, coherent, tallies != NULL);
        trace_batch(self, batch, &trace.context, coherent, n, any, lanes, stream);
        for (size_t i = 0; i < n; i++)
            rt_put_answer(&batch->searches[i].best, begin + i, any, hits, occluders, NULL);
    }
}

/* ---- native mode: rays in ---- */

/* The words of an RtRay: org, tmin, dir, tmax are eight in a row. */
enum { ORG_WORDS = 0, DIR_WORDS = 4 };
_Static_assert(offsetof(RtRay, tmin) == 12 && offsetof(RtRay, dir) == 16 && offsetof(RtRay, tmax) == 28,
               "a ray is read as two vectors of four words");

RT_KERNEL RtFloat4 read_words(const RtRay *ray, size_t first) {
    return rt_loadu4((const char *)ray + first * sizeof(float));
}

RT_KERNEL void write_words(Word *to, RtFloat4 words) {
    memcpy(to, &words, sizeof words);
}

RT_KERNEL RtFloat4 without_tiny(RtFloat4 dir) {
    return (RtFloat4)((RtInt4)dir & (rt_abs(dir) >= LEAST_DIR));
}

/* Writes four rays to lanes i, i + 1, ... of a packet as if their directions were ordinary. Returns -1 for
 * each ray whose direction is. */
RT_KERNEL RtInt4 put_four(Batch *batch, unsigned lanes, size_t i, const RtRay *rays) {
    RtFloat4 org[4], dir[4];
    RtInt4 is_short = {-1, -1, -1, -1}, is_long = {0, 0, 0, 0};
    for (size_t k = 0; k < 4; k++) {
        org[k] = read_words(&rays[k], ORG_WORDS) + 0.0f; /* -0 becomes 0, which matters to tnear */
        dir[k] = read_words(&rays[k], DIR_WORDS);
    }
    rt_transpose4(org);
    rt_transpose4(dir);
    for (unsigned a = 0; a < 4; a++) write_words(at_lane(batch, lanes, i, FIELD_ORG + a), org[a]);
    for (unsigned a = 0; a < 3; a++) {
        is_short &= rt_abs(dir[a]) < RT_EMBREE_SHORT;
        is_long |= rt_abs(dir[a]) > RT_EMBREE_LONG;
        write_words(at_lane(batch, lanes, i, FIELD_DIR + a), without_tiny(dir[a]));
    }
    write_words(at_lane(batch, lanes, i, FIELD_TFAR), dir[3]);
    return ~(is_short | is_long);
}

/* The same for a ray that is a packet of its own. */
RT_KERNEL bool put_one(Batch *batch, size_t i, const RtRay *ray) {
    RtFloat4 org = read_words(ray, ORG_WORDS) + 0.0f, dir = without_tiny(read_words(ray, DIR_WORDS));
    write_words(at_lane(batch, 1, i, FIELD_ORG), org);
    write_words(at_lane(batch, 1, i, FIELD_DIR), dir);
    at_lane(batch, 1, i, FIELD_TIME)->f = 0; /* where tmax was written */
    at_lane(batch, 1, i, FIELD_TFAR)->f = ray->tmax;
    return is_ordinary(ray->dir);
}

/* Rays of any direction: the slow path, out of line. */
static __attribute__((noinline)) void put_any(Batch *batch, unsigned lanes, const RtRay *rays, size_t first,
                                              size_t end) {
    for (size_t i = first; i < end; i++) {
        double stretch = stretch_of(rays[i].dir), shrink = 1 / stretch;
        put_ray(batch, lanes, i, &rays[i], stretch, (float)((double)rays[i].tmin * shrink),
                (float)((double)rt_minf(rays[i].tmax, FLT_MAX) * shrink));
    }
}

/* Writes a chunk of rays; false if one of their directions is not ordinary, in which case all took the slow
 * path. */
RT_KERNEL bool put_chunk(Batch *batch, unsigned lanes, const RtRay *rays, size_t count, unsigned denormals) {
    bool ordinary = true;
    if (lanes == 1) {
        for (size_t i = 0; i < count; i++) ordinary &= put_one(batch, i, &rays[i]);
    } else {
        RtInt4 all = {-1, -1, -1, -1};
        size_t i = 0;
        for (; i + 4 <= count; i += 4) all &= put_four(batch, lanes, i, &rays[i]);
        ordinary = (all[0] & all[1] & all[2] & all[3]) == -1;
        for (size_t k = i; k < count; k++) ordinary &= is_ordinary(rays[k].dir);
        if (ordinary && i < count) put_any(batch, lanes, rays, i, count);
    }
    if (ordinary) return true;
    restore_denormals(denormals);
    put_any(batch, lanes, rays, 0, count);
    denormals_off();
    return false;
}

/* ---- native mode: hits out ---- */

/* A hit at infinity, where Embree's products overflow, counts as a miss. */
RT_KERNEL RtHit take_hit(const RtEmbree *self, Batch *batch, unsigned lanes, size_t i, double stretch) {
    uint32_t geometry = at_lane(batch, lanes, i, FIELD_GEOMETRY)->u;
    if (geometry == RTC_INVALID_GEOMETRY_ID) return RT_MISS;
    float t = (float)((double)at_lane(batch, lanes, i, FIELD_TFAR)->f * stretch);
    if (!(t <= FLT_MAX)) return RT_MISS;
    uint32_t primitive = at_lane(batch, lanes, i, FIELD_PRIMITIVE)->u, first = 0;
    uint32_t instance = at_lane(batch, lanes, i, FIELD_INSTANCE)->u;
    if (instance != RTC_INVALID_GEOMETRY_ID) {
        const RtInstance *in = &self->base.scene->geometry.instances[instance - RT_SHAPE_INSTANCE];
        first = in->first;
        self = (const RtEmbree *)self->parts[in->part];
    }
    const RtEmbreeSlot *slot = &self->slots[geometry];
    return (RtHit){t, first + (slot->consecutive ? slot->first + primitive : slot->ids[primitive])};
}

static __attribute__((noinline)) void take_any(const RtEmbree *self, Batch *batch, unsigned lanes,
                                               const RtRay *rays, size_t count, RtHit *hits) {
    for (size_t i = 0; i < count; i++) hits[i] = take_hit(self, batch, lanes, i, stretch_of(rays[i].dir));
}

/* Prefetches the rays of the next chunk while this one is traced. */
RT_KERNEL void prefetch_rays(const RtRay *rays, size_t count) {
    for (size_t i = 0; i < count * sizeof(RtRay); i += RT_CACHE_LINE)
        __builtin_prefetch((const char *)rays + i);
}

RT_KERNEL void answer_chunk(const RtEmbree *self, Batch *batch, Context *context, const RtRay *rays,
                            size_t count, RtHit *hits, uint32_t *occluders, unsigned lanes, bool stream,
                            unsigned denormals) {
    const bool any = !hits;
    bool ordinary = put_chunk(batch, lanes, rays, count, denormals);
    for (size_t i = 0; !any && i < count; i++)
        at_lane(batch, lanes, i, FIELD_GEOMETRY)->u = RTC_INVALID_GEOMETRY_ID;
    trace_batch(self, batch, context, is_coherent(self, rays, any, lanes), count, any, lanes, stream);
    if (any) {
        for (size_t i = 0; i < count; i++) {
            bool blocked = at_lane(batch, lanes, i, FIELD_TFAR)->f < 0;
            occluders[i] = blocked ? RT_UNNAMED_OBJECT : RT_NO_OBJECT;
        }
    } else if (ordinary) {
        for (size_t i = 0; i < count; i++) hits[i] = take_hit(self, batch, lanes, i, 1);
    } else {
        restore_denormals(denormals);
        take_any(self, batch, lanes, rays, count, hits);
        denormals_off();
    }
}

RT_KERNEL void answer_native(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                             RtHit *hits, uint32_t *occluders, unsigned lanes, bool stream) {
    const size_t chunk = stream ? STREAM_RAYS : PACKET_RAYS;
    Batch *batch = scratch->own;
    if (count == 0) return;
    Trace trace = begin_trace(self, scratch, is_coherent(self, rays, !hits, lanes), false);
    for (size_t i = 0; i < chunk && i < count; i++) put_constants(batch, lanes, i);
    unsigned denormals = trace.denormals = denormals_off();
    for (size_t begin = 0; begin < count; begin += chunk) {
        size_t left = count - begin, n = left < chunk ? left : chunk;
        prefetch_rays(rays + begin + n, left - n < chunk ? left - n : chunk);
        answer_chunk(self, batch, &trace.context, rays + begin, n, hits ? hits + begin : NULL,
                     hits ? NULL : occluders + begin, lanes, stream, denormals);
    }
    restore_denormals(denormals);
}

/* ---- the kernels ---- */

/* Calls the inlined function answer(..., lanes, stream) with constants for each kind of query. */
#define BY_QUERY(query, answer, ...)                                                                         \
    do {                                                                                                     \
        switch (query) {                                                                                     \
        case RT_EMBREE_ONE: answer(__VA_ARGS__, 1, false); break;                                            \
        case RT_EMBREE_EIGHT: answer(__VA_ARGS__, 8, false); break;                                          \
        case RT_EMBREE_SIXTEEN: answer(__VA_ARGS__, 16, false); break;                                       \
        case RT_EMBREE_STREAM: answer(__VA_ARGS__, 1, true); break;                                          \
        }                                                                                                    \
    } while (0)

RT_KERNEL void answer_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    const RtEmbree *self = (const RtEmbree *)accel;
    if (self->user)
        BY_QUERY(self->query, answer_user, self, scratch, rays, count, hits, occluders, tallies);
    else
        BY_QUERY(self->query, answer_native, self, scratch, rays, count, hits, occluders);
    for (size_t i = 0; counted && i < count; i++)
        rt_count_answer((any ? occluders[i] : hits[i].object) != RT_NO_OBJECT, &tallies[rays[i].kind]);
}

RT_DEFINE_STREAM_KERNELS(answer_all, sizeof(Batch))

const RtKernels *const rt_embree_kernels = &kernels;
