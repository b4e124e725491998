/* SPDX-License-Identifier: Apache-2.0 */
/* The interface of accelerators: structures that answer `nearest` and `occluded` queries for rays.
 *
 * Every accelerator returns the same hits, bit for bit; they differ in cost. (core/base/ray.h proves why this
 * is possible.) One that is not exact clears RtAccel.exact, and `verify` judges its answers one by one.
 *
 * Queries come in streams, arrays of rays; a single ray is a stream of one. Each accelerator has four
 * kernels: nearest and occluded, timed and counted. The body of a traversal is written once, as an inline
 * function with an RtTally pointer. RT_DEFINE_KERNELS (kernel.h) expands it with the tally of the ray's kind,
 * and again with a constant NULL, so the timed kernel contains no counting code.
 *
 * An accelerator is built over a scene, which must outlive it, and is read-only afterwards. What a traversal
 * writes (mailboxes, buffers of hit functions) is in an RtQuery, one per thread, allocated before the first
 * ray: kernels allocate nothing and cannot fail.
 *
 * Overlays. An overlay answers rays of some kinds (RtAccelOps.kinds). It hands all other rays, and those that
 * it cannot decide with certainty, to the accelerator below it, which may be an overlay, too. At the bottom
 * is a base, which answers every ray. rt_accel_build stacks the layers and returns the topmost. A ray counts
 * in `rays` and `hits` once, in the layer that answers it, and in `passed_on` in each overlay that should
 * have.
 *
 * Specs are parsed in spec.c and find their accelerators in registry.c; accel.c has layers and
 * queries; plugin/ runs plugins in processes of their own. */
#ifndef RT_ACCEL_ACCEL_H
#define RT_ACCEL_ACCEL_H

#include "core/base/memory.h"
#include "core/base/param.h"
#include "core/base/ray.h"
#include "core/base/tally.h"
#include "core/scene/scene.h"

typedef struct RtAccelOps RtAccelOps;
typedef struct RtKernels RtKernels;

/* The first member of every accelerator's own struct. */
typedef struct RtAccel {
    const RtAccelOps *ops;
    const RtScene *scene;     /* borrowed */
    struct RtAccel *below;    /* owned; NULL for a base */
    struct RtAccel **parts;   /* of a base: [scene->part_count] owned; an accelerator for each part */
    const RtKernels *kernels; /* of its ops, or those that its `build` has chosen */
    size_t scratch_bytes;     /* of a query: memory that is zeroed and 64-byte aligned; as its kernels say, or
                                 its `build` */
    bool exact;               /* its hits equal brute's bit for bit; false: judged by verdicts */
    bool absolute;            /* not exact, and computes with absolute coordinates (exact/margin.h) */
    bool counts;              /* its counts are the same on every machine, so counts.csv has them */
    const char *idle;     /* why this overlay passes on every ray, as its build decided; NULL: it does not */
    double build_seconds; /* wall seconds to build it and all layers below. Set by spec.c */
    RtTally build_tally;  /* hit functions called while building; not part of tracing */
    RtArena memory;       /* of the structure: `build` allocates from it, and need not check; freed with it */
} RtAccel;

/* Expected values for a random line through the box of a structure, by ratios of areas (MacDonald & Booth
 * 1990), without early exit and without mailboxes. NaN if unknown. X(name, meaning). */
#define RT_PREDICTIONS(X)                                                                                    \
    X(predicted_cost, "expected cost in object tests, by the structure's own cost of a step (SAH)")          \
    X(predicted_tests, "expected object tests")                                                              \
    X(predicted_steps, "expected steps")

/* Further quality metrics of hierarchies of boxes (Aila, Karras & Laine 2013; accel/tree/hierarchy.c).
 * NaN for other structures. X(name, meaning). */
#define RT_QUALITIES(X)                                                                                      \
    X(end_point_overlap,                                                                                     \
      "expected cost of the nodes that contain a point of the surface but not its object; triangles only")   \
    X(leaf_count_variability, "standard deviation of the number of leaves that a random line hits")

/* Statistics of a structure. Zero where a figure does not apply. */
typedef struct RtDescription {
    uint64_t interior;     /* inner nodes */
    uint64_t leaves;       /* leaves, or voxels */
    uint64_t empty_leaves; /* leaves without an object */
    uint64_t references;   /* entries in all lists of objects */
    uint64_t depth;        /* of the deepest leaf; the root has depth 0 */
    uint64_t bytes;        /* of its arrays, without the scene and without what exists once per accelerator */
    RtTally build;         /* the build_tally. Set by rt_accel_describe */
#define RT_PREDICTION_FIELD(name, meaning) double name;
    RT_PREDICTIONS(RT_PREDICTION_FIELD)
    RT_QUALITIES(RT_PREDICTION_FIELD)
#undef RT_PREDICTION_FIELD
} RtDescription;

/* Initialisers of an RtDescription: unknown qualities; unknown predictions and qualities. */
#define RT_NO_QUALITY    .end_point_overlap = NAN, .leaf_count_variability = NAN
#define RT_NO_PREDICTION .predicted_cost = NAN, .predicted_tests = NAN, .predicted_steps = NAN, RT_NO_QUALITY

#define RT_ACCEL_MAX_BYTES    (UINT64_C(4) << 30)
#define RT_ACCEL_OBJECT_BYTES UINT64_C(128)

/* RtBuild.limit: RT_ACCEL_MAX_BYTES, or RT_ACCEL_OBJECT_BYTES for each object, whichever is more. */
uint64_t rt_accel_byte_limit(const RtScene *scene);

/* The memory that the kernels of a layer may write to. */
typedef struct RtScratch {
    void *own;               /* [scratch_bytes]; NULL if no layer needs any */
    RtHitMemory *hit_memory; /* of hit functions (rt_hit_ray) */
} RtScratch;

/* A kernel. rays[0..count) are valid (rt_ray_is_valid). scratch[0] belongs to the layer; those of the layers
 * below follow. Answers go to hits[0..count) or occluders[0..count). Counts are added to
 * tallies[RT_RAY_KIND_COUNT], by the kind of each ray. An occluder is any object that the ray hits,
 * RT_NO_OBJECT if there is none, or RT_UNNAMED_OBJECT if the accelerator knows only that there is one. */
#define RT_UNNAMED_OBJECT (UINT32_MAX - 1)
typedef void RtKernel(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                      RtHit *hits, uint32_t *occluders, RtTally *tallies);

/* The kernels of an accelerator, as accel/kernel.h defines them. */
struct RtKernels {
    RtKernel *nearest, *occluded, *nearest_counted, *occluded_counted;
    size_t scratch_bytes; /* of a query */
};

/* A node or voxel of a structure. */
typedef struct RtBoxView {
    const RtBox *box; /* valid during the call */
    uint32_t depth;   /* below the root */
    bool leaf;
    const struct RtExtentSet *extents; /* the set that contains its extent (accel/extent.h), or NULL */
    uint32_t extent;                   /* index in that set */
    uint32_t objects;                  /* of a leaf: in its list, if RtAccelOps.shows_lists */
    uint32_t children;                 /* shown one level deeper; 0: none, or unknown */
} RtBoxView;

/* Receives the boxes of a structure, one per call of `show`. */
typedef struct RtBoxViewer {
    void (*show)(void *context, const RtBoxView *view);
    void *context;
} RtBoxViewer;

/* A cell of an overlay: a sample of the image, or a direction as seen from a light. */
typedef struct RtCellView {
    uint32_t number; /* of the cell */
    uint32_t length; /* objects in its list */
    uint32_t object; /* the first of them; RT_NO_OBJECT if there is none */
    bool cut;        /* a ray that finds nothing in it is passed on */
} RtCellView;

/* For `describe`: sums over the boxes of a structure that shows_lists, and a viewer that adds to them and to
 * the counts of *out. */
typedef struct RtBoxSums {
    RtDescription *out;
    double inner, leaves, tests; /* half areas; of leaves also times the lengths of their lists */
} RtBoxSums;
void rt_box_sums_add(void *context, const RtBoxView *view);

/* Sets the predictions: a random line through the root meets a box with the ratio of their areas. */
void rt_box_sums_predict(const RtBoxSums *sums, const RtBox *root, double traversal_cost);

/* The arguments of `build`. */
typedef struct RtBuild {
    const RtScene *scene;  /* finished; it may be empty */
    const RtValue *values; /* [param_count], in range */
    int threads;           /* 0 = all processors; does not change the structure */
    uint64_t limit;        /* a structure of more bytes, as its `build` estimates them, is refused */
    RtAccel **parts; /* [part_count] borrowed, of the scene's parts; those not built yet are NULL. NULL if
                        it has none */
} RtBuild;

/* Parameters of several accelerators. */
#define RT_MAILBOX_PARAM "mailbox", RT_FLAG("on"), "test an object at most once per ray", "Kirk & Arvo 1991"
#define RT_MARGIN_PARAM(what)                                                                                \
    "margin", RT_FLOAT("0", 0, 1, "0.01|1"), "fraction by which " what " is wider than the scene's box",     \
        "0: tight; published scene boxes are slightly wider"

/* A name for the fastest of several settings of an accelerator, `octree:best`: an experiment chooses one for
 * each scene and kind of rays (experiment/experiment.h). It cannot be built itself. */
typedef struct RtBestOf {
    const char *name;
    /* "max_leaf_size=1|4|16,depth=8|16": all combinations, at most RT_MAX_BEST; the first is the default.
     * Other parameters have their defaults. */
    const char *settings;
    const char *meaning; /* one line */
} RtBestOf;

/* In the table of an accelerator: NAME:best stands for these settings. */
#define RT_BEST(settings)                                                                                    \
    .bests = (const RtBestOf[]){{"best", settings, "its fastest setting for each scene and ray kind"}},      \
    .best_count = 1

#define RT_ALL_RAY_KINDS ((1u << RT_RAY_KIND_COUNT) - 1)

/* The operations of an accelerator: a const table in its own file. Optional members may be NULL. */
struct RtAccelOps {
    const char *name;    /* as in a spec */
    const char *summary; /* one line */
    const char *paper;   /* author, year, title, venue */
    const RtParam *params;
    size_t param_count;
    uint32_t kinds; /* of an overlay: the rays it answers, bits 1 << RtRayKind; 0: a base, for all rays. Which
                       rays a plugin's answers is unknown: RT_ALL_RAY_KINDS */
    bool remote;    /* a plugin's, which is built in a process of its own (accel/plugin.h) */
    /* Optional: a spec, "light:cells=100", that is verified in addition to the default. For accelerators that
     * do not use their own structure over few objects or rays by default. */
    const char *trial;
    const RtBestOf *bests; /* [best_count], or NULL */
    size_t best_count;

    size_t bytes; /* of the accelerator's own struct */

    /* Optional: builds the accelerator in its own struct, which is zeroed except for the RtAccel that it
     * begins with; that one is exact and counts if the layer below does. An overlay may trace rays in the
     * layer below. After a failure `destroy` is called. */
    RtStatus (*build)(RtAccel *accel, const RtBuild *what, RtError *error);

    /* Optional: frees what the accelerator owns, except its own struct and the layer below. */
    void (*destroy)(RtAccel *accel);

    const RtKernels *kernels; /* NULL: `build` chooses them (accel/isa.h) */

    /* Optional, both or none: set up and tear down resources in the scratch memory, before the first ray and
     * after the last. If `open` fails, `close` is not called. */
    RtStatus (*open)(const RtAccel *accel, void *scratch, RtError *error);
    void (*close)(const RtAccel *accel, void *scratch);

    /* Optional: resets the state in the scratch memory that would affect later counts (rt_query_begin). */
    void (*begin)(const RtAccel *accel, void *scratch);

    /* Describes this layer alone. */
    void (*describe)(const RtAccel *accel, RtDescription *out);

    /* Optional: RT_OK, or RT_MISMATCH and a message that names the first broken invariant. */
    RtStatus (*validate)(const RtAccel *accel, RtError *error);

    /* Optional: shows the boxes of the structure, for pictures and distributions. If `shows_lists`, the
     * leaves shown are exactly those that `describe` counts, empty ones included, with the lengths of their
     * lists. Parents come before their children, which come together and in the order of their parents. */
    void (*each_box)(const RtAccel *accel, RtBoxViewer viewer);
    bool shows_lists;

    /* Optional, of an overlay, for pictures: the cell in which it looks up `ray`, of a kind that it answers.
     * Only the direction and the source of the ray matter. False if no cell contains it. */
    bool (*find_cell)(const RtAccel *accel, const RtRay *ray, RtCellView *cell);

    /* Optional: RT_OK, or the error that occurred while rays were traced, which kernels cannot return. Not to
     * be called while a thread traces. */
    RtStatus (*check)(const RtAccel *accel, RtError *error);

    /* Optional: records answers for rays[0..count). The rays must stay at their addresses while they are
     * queried. */
    RtStatus (*learn)(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error);

    /* Optional: RT_OK, or RT_NOT_AVAILABLE and why this machine, or the installed library, does not support
     * values[param_count]. `build` is called only after RT_OK. */
    RtStatus (*available)(const RtValue *values, RtError *error);

    /* Optional: writes the version of the underlying library and its instruction set, "3.13.5 avx512", to
     * out[0..size); false, and "", if it is not available. */
    bool (*library)(char *out, size_t size);
};

/* ---- the registry ---- */

/* The registered accelerators in the order of lists, brute first. */
size_t rt_accel_count(void);
const RtAccelOps *rt_accel_at(size_t i);

/* The colour in plots, 0xrrggbb, of the topmost accelerator of a spec. Those of plugins share one. */
uint32_t rt_accel_color(const char *spec);

/* RT_BAD_INPUT if `name` is an accelerator's, or "all", or not a name. */
RtStatus rt_accel_name_is_free(const char *name, RtError *error);

/* Appends an accelerator of a plugin; borrows `ops`. RT_BAD_INPUT if its name is not free. */
RtStatus rt_accel_register(const RtAccelOps *ops, RtError *error);

/* How users load a plugin, for the message of rt_accel_find: a function of the library, or an option, once a
 * program has set it. */
extern const char *rt_accel_plugin_hint;

/* Finds one by name; if there is none, RT_BAD_INPUT and a message that suggests the nearest name. */
RtStatus rt_accel_find(const char *name, const RtAccelOps **out, RtError *error);

/* The default spec: exact, and fast on every scene. */
const char *rt_accel_default(void);

/* The spec whose answers are right by definition: it tests every object. */
const char *rt_accel_truth(void);

/* The spec that knows the answers in advance: a lower bound on the cost of any accelerator. */
const char *rt_accel_yardstick(void);

/* ---- specs ---- */

#define RT_MAX_LAYERS 4

/* An accelerator with a value for each of its parameters. */
typedef struct RtSpecLayer {
    const RtAccelOps *ops;
    RtValue values[RT_MAX_PARAMS];
} RtSpecLayer;

/* Overlays, topmost first, then the base, layers[layer_count - 1]; and the accelerator of the scene's parts,
 * or without `of_parts` one like the base. */
typedef struct RtSpec {
    uint32_t layer_count; /* 1..RT_MAX_LAYERS */
    RtSpecLayer layers[RT_MAX_LAYERS];
    bool of_parts;
    RtSpecLayer part;
} RtSpec;

/* Parses `name[:key=value[,key=value]...]`, several of them joined by '+': overlays over one base.
 * After a '/' comes the accelerator of the scene's parts. */
RtStatus rt_spec_parse(const char *text, RtSpec *spec, RtError *error);

/* Whether one of its layers is a plugin's; then the whole stack is built in a process of its own. */
bool rt_spec_is_remote(const RtSpec *spec);

/* The same for a text; false if it is not a spec. */
bool rt_spec_text_is_remote(const char *text);

/* RT_OK, or RT_NOT_AVAILABLE and why this machine, or a library, does not support a layer. */
RtStatus rt_spec_available(const RtSpec *spec, RtError *error);

/* Writes the spec with all its parameters, "grid:rule=woo,density=10,...", to out[0..RT_MAX_SPEC_CHARS). */
void rt_spec_format(const RtSpec *spec, char *out);

#define RT_MAX_BEST 32

/* Whether `text` has a layer of the form of an RtBestOf, NAME:WORD, which no spec has. */
bool rt_best_is(const char *text);

/* Expands `text` ("octree:best", "light:best+wide") to specs: specs[0..*count) are available here,
 * specs[*count..*all) on other machines. RT_BAD_INPUT if there is no such name, RT_NOT_AVAILABLE if no spec
 * is available. */
RtStatus rt_best_specs(const char *text, char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS], size_t *count,
                       size_t *all, RtError *error);

/* ---- using an accelerator ---- */

/* Builds the accelerator of a spec over `scene`, on `threads` threads (0 = all processors), which do not
 * change the structure; on one, which needs least memory, if more exceed a limit of memory. rt_accel_build
 * builds a remote spec in a process of its own (accel/plugin.h); rt_accel_build_here builds any spec in this
 * process. rt_accel_open_on takes the spec as text; rt_accel_open also uses all processors. Destroy with
 * rt_accel_destroy. */
RtStatus rt_accel_build_here(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error);
RtStatus rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out, RtError *error);
RtStatus rt_accel_open_on(const char *spec, const RtScene *scene, int threads, RtAccel **out, RtError *error);
RtStatus rt_accel_open(const char *spec, const RtScene *scene, RtAccel **out, RtError *error);
void rt_accel_destroy(RtAccel *accel); /* and the layers below; NULL is allowed */
void rt_accel_destroy_parts(RtAccel **parts, const RtScene *scene); /* and the array; NULL is allowed */

/* For RT_OWNED(RtAccel *, ...). */
static inline void rt_accel_destroy_at(RtAccel **accel) {
    rt_accel_destroy(*accel);
}

/* Whether a build that ended with `status` refuses the scene: for a limit of its own, or of memory. Only the
 * accelerator's own results are lost. */
bool rt_accel_refuses(RtStatus status);

/* Builds one layer over `below`, or a base if that is NULL. On failure nothing is left behind, and `below`
 * still exists. */
RtStatus rt_accel_build_layer(const RtAccelOps *ops, const RtBuild *what, RtAccel *below, RtAccel **out,
                              RtError *error);

/* The bottom layer. */
const RtAccel *rt_accel_base(const RtAccel *accel);

/* Describes the whole stack: sums over the layers, the largest depth, and the predictions of the base. */
void rt_accel_describe(const RtAccel *accel, RtDescription *out);

/* Validates every layer. */
RtStatus rt_accel_validate(const RtAccel *accel, RtError *error);

/* After tracing: RT_OK, or why the answers of some layer or part are invalid. */
RtStatus rt_accel_check(const RtAccel *accel, RtError *error);

/* Hands recorded answers to the layers that have `learn`. */
RtStatus rt_accel_learn(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error);

/* The state of queries, one per thread. */
typedef struct RtQuery {
    const RtAccel *accel;
    RtScratch scratch[RT_MAX_LAYERS]; /* of each layer, topmost first; scratch[0] owns all memory */
    struct RtQuery *parts; /* [part_count] owned, a query in each part of the scene; NULL in those */
    uint32_t part_count;
} RtQuery;

RtStatus rt_query_init(RtQuery *query, const RtAccel *accel, RtError *error);
void rt_query_clear(RtQuery *query);

/* The query's buffer of hit functions, for other calls of hit functions on the same thread. */
static inline RtHitMemory *rt_query_hit_memory(const RtQuery *query) {
    return query->scratch[0].hit_memory;
}

/* Forgets the state left by earlier rays (the last occluders of a shadow cache), so that later counts depend
 * on later rays alone. Called at the start of each unit of work that is the same on any number of threads: a
 * tile of a frame, a chunk of a ray set. Answers never depend on it. */
void rt_query_begin(RtQuery *query);

/* Calls one of the four kernels: answers to `hits` or, if that is NULL, to `occluders`; timed if `tallies` is
 * NULL. */
static inline void rt_trace_stream(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                                   size_t count, RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    const RtKernels *k = accel->kernels;
    RtKernel *kernel =
        tallies ? (hits ? k->nearest_counted : k->occluded_counted) : (hits ? k->nearest : k->occluded);
    kernel(accel, scratch, rays, count, hits, occluders, tallies);
}

/* Nearest hits of a stream of valid rays: timed if `tallies` is NULL, otherwise counted in
 * tallies[RT_RAY_KIND_COUNT]. */
void rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);

/* Whether each ray hits anything within [tmin, tmax]. */
void rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);

#endif
