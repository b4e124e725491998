/* SPDX-License-Identifier: Apache-2.0 */
/* The interface of accelerators: structures that answer `nearest` and `occluded` for rays.
 *
 * Every accelerator returns the same hits, bit for bit (see core/base/ray.h for why that is possible); they
 * differ in what it costs. One that is not exact says so (RtAccel.exact) and is judged by verdicts.
 *
 * Queries come in streams: arrays of rays, one of them as a special case. Each accelerator answers them by
 * four kernels: nearest and occluded, timed and counted. The body of a traversal is written once, as an
 * inline function with an RtTally pointer, and RT_DEFINE_KERNELS expands it twice: with the tally of the
 * ray's kind, and with a constant NULL, of which the compiler leaves nothing. A timed kernel has no tally to
 * count in.
 *
 * An accelerator is built over a scene that must outlive it, and is read only from then on. What a traversal
 * writes to (mailboxes, the room of hit functions) lies in an RtQuery, one per thread, and is all there
 * before the first ray: kernels allocate nothing and cannot fail.
 *
 * Overlays. An overlay answers rays of some kinds (RtAccelOps.kinds) and hands the others, and those that it
 * cannot decide with certainty, to the accelerator below it, which may be an overlay in turn; a base, which
 * answers every ray, lies at the bottom. rt_accel_build stacks them and hands back the topmost. A ray is
 * counted in `rays` and `hits` once, by the layer that answers it, and in `passed_on` by each overlay that
 * ought to have. */
#ifndef RT_ACCEL_ACCEL_H
#define RT_ACCEL_ACCEL_H

#include "core/base/param.h"
#include "core/base/ray.h"
#include "core/base/tally.h"
#include "core/scene/scene.h"

typedef struct RtAccelOps RtAccelOps;

/* The first member of every accelerator's own struct. */
typedef struct RtAccel {
    const RtAccelOps *ops; /* set by rt_accel_build */
    const RtScene *scene;  /* borrowed */
    struct RtAccel *below; /* owned; NULL for a base. Set by rt_accel_build */
    size_t scratch_room;  /* bytes of a query's scratch memory that are this layer's. Set by rt_accel_build */
    bool exact;           /* bit for bit like brute; false: judged by verdicts */
    bool counts;          /* its counts are the same on every machine and belong into counts.csv */
    double build_seconds; /* wall seconds that building it took, with all below. Set by rt_accel_build */
    RtTally build_tally;  /* what hit functions were asked while building; kept apart from tracing */
} RtAccel;

/* Expectations of a random line through the box of a structure, if nothing stopped it and no mailbox knew
 * an object again, by the ratios of areas (MacDonald & Booth 1990). NaN where none is known. Each of X(name,
 * meaning). */
#define RT_PREDICTIONS(X)                                                                                    \
    X(predicted_cost, "expected cost in object tests, by the structure's own cost of a step (SAH)")          \
    X(predicted_tests, "expected object tests")                                                              \
    X(predicted_steps, "expected steps")

/* What hierarchies of boxes are like beside that (Aila, Karras & Laine 2013; accel/tree/quality.c). NaN
 * elsewhere. Each of X(name, meaning). */
#define RT_QUALITIES(X)                                                                                      \
    X(end_point_overlap, "expected cost, at a point of the surface, of nodes that contain it but not its "   \
                         "object; triangles only")                                                           \
    X(leaf_count_variability, "standard deviation of the leaves that a random line meets")

/* What a structure looks like. Zero where a figure does not apply. */
typedef struct RtDescription {
    uint64_t interior;     /* inner nodes */
    uint64_t leaves;       /* leaves, or voxels */
    uint64_t empty_leaves; /* of them, those without an object */
    uint64_t references;   /* entries in all lists of objects */
    uint64_t depth;        /* of the deepest leaf, the root being 0 */
    uint64_t bytes;        /* of its arrays: without the scene, and without what is one per accelerator */
    RtTally build;         /* the build_tally. Set by rt_accel_describe */
#define RT_PREDICTION_FIELD(name, meaning) double name;
    RT_PREDICTIONS(RT_PREDICTION_FIELD)
    RT_QUALITIES(RT_PREDICTION_FIELD)
#undef RT_PREDICTION_FIELD
} RtDescription;

/* Initialise the qualities of an RtDescription, or the predictions too, as unknown. */
#define RT_NO_QUALITY    .end_point_overlap = NAN, .leaf_count_variability = NAN
#define RT_NO_PREDICTION .predicted_cost = NAN, .predicted_tests = NAN, .predicted_steps = NAN, RT_NO_QUALITY

/* The limit of rt_accel_build. */
#define RT_ACCEL_MAX_BYTES (UINT64_C(4) << 30)

/* What the kernels of a layer may write to. */
typedef struct RtScratch {
    void *own;        /* scratch_bytes of it; NULL where no layer asks for any */
    RtCrossing *room; /* for hit functions (rt_hit_ray) */
} RtScratch;

/* The four kernels. rays[0..count) are valid (rt_ray_is_valid); scratch[0] is the layer's, and those of the
 * layers below follow; answers go to hits[0..count) and occluders[0..count); tallies[RT_RAY_KIND_COUNT] are
 * added to, by the kind of each ray. A occluder is any object that lies on the ray, RT_NO_OBJECT where none
 * does, or RT_UNNAMED_OBJECT from those who know only that there is one. */
#define RT_UNNAMED_OBJECT (UINT32_MAX - 1)

typedef void RtNearestKernel(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             RtHit *hits);
typedef void RtOccludedKernel(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                              uint32_t *occluders);
typedef void RtNearestCounted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                              RtHit *hits, RtTally *tallies);
typedef void RtOccludedCounted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                               size_t count, uint32_t *occluders, RtTally *tallies);

/* A box of a structure. */
typedef struct RtBoxView {
    const RtBox *box;                  /* valid during the call */
    uint32_t depth;                    /* below the root */
    bool leaf;                         /* it lists objects */
    const struct RtExtentSet *extents; /* that it is the box of one of (accel/extent.h), or NULL ... */
    uint32_t extent;                   /* ... and of which */
} RtBoxView;

/* Who looks at the boxes of a structure: one call of `show` each. */
typedef struct RtBoxViewer {
    void (*show)(void *context, const RtBoxView *view);
    void *context;
} RtBoxViewer;

/* What an overlay has in a cell: a sample of the image, or a direction as seen from a light. */
typedef struct RtCellView {
    uint32_t number; /* of the cell */
    uint32_t length; /* objects in its list */
    uint32_t
        object; /* the first of them; RT_NO_OBJECT if there is none, RT_UNNAMED_OBJECT if it is undecided */
    bool cut;   /* a ray that finds nothing in it is passed on */
} RtCellView;

/* Who looks at the leaves of a structure, or its voxels: one call of `show` each, with the number of objects
 * in its list and its depth below the root. */
typedef struct RtLeafViewer {
    void (*show)(void *context, uint32_t objects, uint32_t depth);
    void *context;
} RtLeafViewer;

/* What an accelerator is built from. */
typedef struct RtBuild {
    const RtAccelOps *ops; /* of the accelerator itself */
    const RtScene *scene;  /* finished; it may hold no object at all */
    const RtValue *values; /* [param_count], in range */
    int threads;           /* 0 = all processors; does not change the structure */
    uint64_t limit;        /* one that would take more bytes, as far as its own folder counts, is refused */
} RtBuild;

/* Parameters that several accelerators have. */
#define RT_MAILBOX_PARAM                                                                                     \
    "mailbox", RT_FLAG("on"), "do not test an object twice for one ray", "Kirk & Arvo 1991"
#define RT_MARGIN_PARAM(what)                                                                                \
    "margin", RT_FLOAT("0", 0, 1, "0.01|1"),                                                                 \
        "how much wider than the scene's box " what " is, as a part of it",                                  \
        "the published scene boxes are a little wider than tight"

/* A name under which several settings of an accelerator stand together as one competitor, the fastest of them
 * on the rays at hand: `embree:best`. It is what others are compared with, and cannot be built itself. */
typedef struct RtBestOf {
    const char *name;
    const char *settings; /* "isa=avx2|avx512,query=1|8": every combination; the other parameters' defaults */
    const char *meaning;  /* one line */
} RtBestOf;

/* One accelerator, as a const table in its own file. Optional members may be NULL. */
struct RtAccelOps {
    const char *name;    /* as in a spec */
    const char *summary; /* one line */
    const char *paper;   /* author, year, title, venue */
    const RtParam *params;
    size_t param_count;
    uint32_t kinds; /* of an overlay: the rays it answers, bits 1 << RtRayKind; 0: a base, for all rays */
    bool remote;    /* a plugin's: built in another process (accel/remote.h) */
    /* Optional: a spec of it alone, "light:cells=100", that is verified beside the default where that, over
     * few objects or rays, chooses to leave its own ways unused. */
    const char *trial;
    const RtBestOf *bests; /* [best_count], or NULL */
    size_t best_count;

    /* On failure nothing is left behind. *out is owned by the caller: `destroy`, which leaves what lies below
     * alone. An overlay is built without regard to what it will lie on. */
    RtStatus (*build)(const RtBuild *build, RtAccel **out, RtError *error);
    void (*destroy)(RtAccel *accel);

    RtNearestKernel *nearest;
    RtOccludedKernel *occluded;
    RtNearestCounted *nearest_counted;
    RtOccludedCounted *occluded_counted;

    /* Optional: bytes of scratch memory per query; it starts zeroed and 64-byte aligned. */
    size_t (*scratch_bytes)(const RtAccel *accel);

    /* Optional, both or none: what scratch memory needs that is not memory, before the first ray and after
     * the last. Where `open` fails nothing is to be closed. */
    RtStatus (*open)(const RtAccel *accel, void *scratch, RtError *error);
    void (*close)(const RtAccel *accel, void *scratch);

    /* Optional: brings the scratch memory back to what a fresh query has, as far as later counts could tell
     * (rt_query_begin). */
    void (*begin)(const RtAccel *accel, void *scratch);

    /* Of this layer alone. */
    void (*describe)(const RtAccel *accel, RtDescription *out);

    /* RT_OK, or RT_MISMATCH with a message that names the first broken invariant. */
    RtStatus (*validate)(const RtAccel *accel, RtError *error);

    /* Optional: shows the boxes of the structure, for pictures. */
    void (*each_box)(const RtAccel *accel, RtBoxViewer viewer);

    /* Optional, of an overlay, for pictures: the cell in which it looks up `ray`, one of those that it
     * answers, of which only the direction and the source matter. False if there is no cell: nothing is seen
     * there. */
    bool (*look_up)(const RtAccel *accel, const RtRay *ray, RtCellView *cell);

    /* Optional: shows all leaves, the empty ones included: those that `describe` counts. RT_NO_MEMORY. */
    RtStatus (*each_leaf)(const RtAccel *accel, RtLeafViewer viewer, RtError *error);

    /* Optional: RT_OK, or what went wrong while rays were traced, which kernels cannot say. To be asked where
     * no thread traces. */
    RtStatus (*check)(const RtAccel *accel, RtError *error);

    /* Optional: takes recorded answers for rays[0..count), which stay where they are while the accelerator is
     * asked about them. */
    RtStatus (*learn)(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error);

    /* Optional: RT_OK, or RT_NOT_AVAILABLE and why this machine, or the library at hand, cannot do what
     * values[param_count] ask for. `build` is called only where it is RT_OK. */
    RtStatus (*available)(const RtValue *values, RtError *error);

    /* Optional: the version of the library that does the work, and what it runs on here, "3.13.5 avx512", to
     * out[0..room); false, and "", where it cannot be had. */
    bool (*library)(char *out, size_t room);
};

/* For `build`, in accel.c: `bytes` for the own struct of the accelerator, zeroed but for the RtAccel that it
 * begins with, which is exact and counts; to *out, to be freed with rt_free. */
RtStatus rt_accel_new(const RtBuild *what, size_t bytes, RtAccel **out, RtError *error);

/* What `build` ends with: *out is the accelerator or, if it failed, nothing is left of it. Gives `status`. */
RtStatus rt_accel_built(RtAccel *accel, RtStatus status, RtAccel **out);

/* ---- the registry ---- */

/* The registered accelerators, in the order in which they are listed: brute first. */
size_t rt_accel_count(void);
const RtAccelOps *rt_accel_at(size_t i);

/* RT_BAD_INPUT where `name` is that of an accelerator, or means all of them. */
RtStatus rt_accel_name_is_free(const char *name, RtError *error);

/* Adds one of a plugin behind them; it stays where it is. RT_BAD_INPUT where its name is not free. */
RtStatus rt_accel_register(const RtAccelOps *ops, RtError *error);

/* By name, to *out; where there is none, RT_BAD_INPUT and a message that suggests the nearest name. */
RtStatus rt_accel_find(const char *name, const RtAccelOps **out, RtError *error);

/* The spec that is used where none is asked for: exact, and fast on every scene. */
const char *rt_accel_default(void);

/* The spec whose answers are right by definition: it tests every object. */
const char *rt_accel_truth(void);

/* The spec that knows the answers beforehand: the least that any can do, and no competitor. */
const char *rt_accel_yardstick(void);

/* ---- specs ---- */

#define RT_MAX_LAYERS 4

/* An accelerator with a value for each of its parameters. */
typedef struct RtSpecLayer {
    const RtAccelOps *ops;
    RtValue values[RT_MAX_PARAMS];
} RtSpecLayer;

/* Overlays, topmost first, and then the base: layers[layer_count - 1]. */
typedef struct RtSpec {
    uint32_t layer_count; /* 1..RT_MAX_LAYERS */
    RtSpecLayer layers[RT_MAX_LAYERS];
} RtSpec;

/* Parses `name[:key=value[,key=value]...]`, several of them joined by '+': overlays over one base. */
RtStatus rt_spec_parse(const char *text, RtSpec *spec, RtError *error);

/* Whether one of its layers is a plugin's, so that all of it is remote (accel/remote.h). */
bool rt_spec_is_remote(const RtSpec *spec);

/* The same of a text, which may be no spec. */
bool rt_spec_text_is_remote(const char *text);

/* RT_OK, or RT_NOT_AVAILABLE and why this machine, or a library, cannot do what a layer asks for. */
RtStatus rt_spec_available(const RtSpec *spec, RtError *error);

/* The spec with every effective parameter, "grid:rule=woo,density=10,...", to out[0..RT_MAX_SPEC_CHARS). */
void rt_spec_format(const RtSpec *spec, char *out);

#define RT_MAX_BEST 32

/* Whether `text` is written like a best of, NAME:WORD; no spec is. */
bool rt_best_is(const char *text);

/* The specs that `text` ("embree:best") stands for, as far as they are available here, to specs[0..*count).
 * RT_BAD_INPUT where there is no such name, RT_NOT_AVAILABLE where none is available. */
RtStatus rt_best_specs(const char *text, char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS], size_t *count,
                       RtError *error);

/* ---- using an accelerator ---- */

/* Builds what the spec says over `scene`, on `threads` threads (0 = all processors), which does not change
 * the structure; remotely (accel/remote.h) where a layer asks for that, but not by rt_accel_build_here.
 * rt_accel_open_on takes the spec as text, rt_accel_open too, and all processors. Destroy with
 * rt_accel_destroy. */
RtStatus rt_accel_build_here(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error);
RtStatus rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out, RtError *error);
RtStatus rt_accel_open_on(const char *spec, const RtScene *scene, int threads, RtAccel **out, RtError *error);
RtStatus rt_accel_open(const char *spec, const RtScene *scene, RtAccel **out, RtError *error);
void rt_accel_destroy(RtAccel *accel); /* with all below it; NULL is allowed */

/* The layer at the bottom. */
const RtAccel *rt_accel_base(const RtAccel *accel);

/* All layers together: sums, the largest depth, and the predicted cost of the base. What an overlay itself
 * has is the difference to the same base alone. */
void rt_accel_describe(const RtAccel *accel, RtDescription *out);

/* Of every layer. */
RtStatus rt_accel_validate(const RtAccel *accel, RtError *error);

/* To be asked after tracing: RT_OK, or why the answers of some layer are not to be believed. */
RtStatus rt_accel_check(const RtAccel *accel, RtError *error);

/* Hands recorded answers to the layers that take them: see `learn` above. */
RtStatus rt_accel_learn(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error);

/* The state of one thread's queries. */
typedef struct RtQuery {
    const RtAccel *accel;
    RtScratch scratch[RT_MAX_LAYERS]; /* of each layer, topmost first. The first owns all there is */
} RtQuery;

RtStatus rt_query_init(RtQuery *query, const RtAccel *accel, RtError *error);
void rt_query_clear(RtQuery *query);

/* The room of hit functions that a query has, for whoever asks them on the same thread. */
static inline RtCrossing *rt_query_room(const RtQuery *query) {
    return query->scratch[0].room;
}

/* Forgets what the rays before have left behind (the last occluders of a shadow cache), so that the counts of
 * the rays that follow depend on them alone. To be called where a piece of work begins that is the same at
 * any number of threads: a tile of a frame, a chunk of a ray set. Answers never depend on it. */
void rt_query_begin(RtQuery *query);

/* Nearest hits of a stream of valid rays: timed where `tallies` is NULL, else counted into
 * tallies[RT_RAY_KIND_COUNT]. */
void rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);

/* Whether anything lies on each ray within [tmin, tmax]. */
void rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);

#endif
