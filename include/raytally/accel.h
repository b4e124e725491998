/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * An accelerator of your own. A plugin is a shared library that hands raytally one table of functions for
 * each accelerator in it; raytally then gives them specs, parameters, help, `verify`, `bench`, `run`, plots
 * and reports like those that it has. A plugin is compiled against these headers alone and linked with
 * nothing: what it needs of raytally it calls through the table of functions in its query (raytally_host).
 *
 * The contract, which `raytally verify` checks:
 *  - the nearest hit is the least (t, object) of all hits, bit for bit: of two objects at the same t the one
 *    with the lower number. raytally_object_hits tests objects and keeps that order; raytally_box_hit (box.h)
 *    is the only test of boxes to prune by;
 *  - `occluded` names any object on the ray, or RAYTALLY_NO_OBJECT;
 *  - a structure is read only once it is built. What a traversal writes to lies in the memory of its query,
 *    of which each thread has one;
 *  - tracing allocates nothing and cannot fail;
 *  - the same rays give the same counts, and the same build the same structure, wherever its memory lies and
 *    on any number of threads. (That of a build `raytally reproduce` checks, which builds anew.)
 *
 * What may go wrong stays where it is: a plugin runs in a process of its own, and one that crashes, hangs,
 * answers nonsense or writes beside the memory of its query loses its own results and no others. */
#ifndef RAYTALLY_ACCEL_H
#define RAYTALLY_ACCEL_H

#include "raytally/box.h"
#include "raytally/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The version of this interface. A plugin of another one is refused. */
#define RAYTALLY_ACCEL_ABI 1

/* ---- parameters ---- */

/** What a parameter is. */
enum raytally_param_type {
    RAYTALLY_INT,    /**< A whole number. */
    RAYTALLY_FLOAT,  /**< A finite number. */
    RAYTALLY_CHOICE, /**< One of several words. */
    RAYTALLY_FLAG    /**< on or off. */
};

/** The most parameters that an accelerator may have. */
#define RAYTALLY_MAX_PARAMS 16

/** One parameter, as in NAME:KEY=VALUE. From this table come parsing, range checks, help, and the values that
 * `verify --spread` tries. */
typedef struct raytally_param {
    const char *name;         /**< The key: up to 63 letters, digits and '_'. */
    uint32_t type;            /**< One of ::raytally_param_type. */
    const char *default_text; /**< The default, as text. */
    double lo;                /**< The least number, inclusive; 0 for choices and flags. */
    double hi;                /**< The largest number, inclusive; 0 for choices and flags. */
    const char *choices;      /**< "sah|median" for a choice; else NULL. */
    const char *test_values;  /**< Values worth testing, "1|4|20"; NULL for choices and flags: all of them. */
    const char *meaning;      /**< One line, with the unit where there is one. */
    const char *source;       /**< Where the default comes from: a paper, a measurement. */
} raytally_param;

/** The value of a parameter, by its type. */
typedef union raytally_value {
    int64_t integer; /**< Of a ::RAYTALLY_INT. */
    double number;   /**< Of a ::RAYTALLY_FLOAT. */
    uint32_t choice; /**< Of a ::RAYTALLY_CHOICE: which of them, from 0 on. */
    uint32_t flag;   /**< Of a ::RAYTALLY_FLAG: 1 is on. */
} raytally_value;

/* ---- what raytally does for a plugin ---- */

typedef struct raytally_query raytally_query;

/** Functions of raytally. Call them through raytally_prepare and raytally_object_hits below. */
typedef struct raytally_host {
    uint32_t abi;  /**< RAYTALLY_ACCEL_ABI of the program. */
    uint32_t size; /**< Of this struct, in bytes: later ones may have more at the end. */
    /** See raytally_prepare. */
    void (*prepare)(raytally_query *query, const raytally_ray *ray, raytally_prepared *out);
    /** See raytally_object_hits. */
    int (*object_hits)(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, int any,
                       raytally_hit *best, raytally_counters *counters);
} raytally_host;

/** The state of one thread's rays. Only what is here is a plugin's business. */
struct raytally_query {
    const raytally_host *host; /**< What raytally does for the plugin. */
};

/** Prepares a ray for tests of boxes and objects: reciprocals, signs, thickness.
 * @param query  of the kernel that was called
 * @param ray    valid; it must outlive `out`
 * @param out    what to test with */
RAYTALLY_INLINE void raytally_prepare(raytally_query *query, const raytally_ray *ray,
                                      raytally_prepared *out) {
    query->host->prepare(query, ray, out);
}

/** Tests objects: calls the exact hit function of each, and keeps the best hit, the least (t, object). Counts
 * RAYTALLY_OBJECT_TESTS, RAYTALLY_OBJECT_HITS and RAYTALLY_CSG_TESTS.
 * @param ray       of raytally_prepare
 * @param ids       [count] numbers of objects, each below raytally_build.object_count
 * @param count     how many, possibly 0
 * @param any       1: any hit will do; the first one ends it
 * @param best      the best hit so far, or {INFINITY, RAYTALLY_NO_OBJECT}; improved
 * @param counters  of the ray's kind, or NULL where nothing is counted
 * @return 1 if the search is over: any hit will do, and here is one; else 0 */
RAYTALLY_INLINE int raytally_object_hits(const raytally_prepared *ray, const uint32_t *ids, uint32_t count,
                                         int any, raytally_hit *best, raytally_counters *counters) {
    return ray->query->host->object_hits(ray, ids, count, any, best, counters);
}

/** Adds `n` to one of ::raytally_counter. With a NULL that the compiler knows of nothing is left of it. */
#define RAYTALLY_COUNT(counters, counter, n)                                                                 \
    do {                                                                                                     \
        if (counters) (counters)->at[counter] += (uint64_t)(n);                                              \
    } while (0)

/* ---- what a plugin does ---- */

/** What `build` returns. */
enum raytally_built {
    RAYTALLY_BUILD_OK = 0,       /**< *self is the structure. */
    RAYTALLY_BUILD_REFUSED = 1,  /**< Not from this scene with these values: `message` says why. */
    RAYTALLY_BUILD_NO_MEMORY = 2 /**< Memory is short, or the structure would go beyond the limit. */
};

/** What a structure is built from, valid during the call of `build`. */
typedef struct raytally_build {
    uint32_t size;         /**< Of this struct, in bytes: later ones may have more at the end. */
    uint32_t object_count; /**< Objects of the scene, numbered from 0 on; possibly 0. */
    const raytally_box
        *boxes;       /**< [object_count] the box of each object. Borrowed; outlives the structure. */
    raytally_box box; /**< Around all of them. */
    const raytally_value *values; /**< [param_count] in the order of the table, each within its range. */
    int32_t threads;              /**< To build on, at least 1; must not change the structure. */
    uint64_t byte_limit; /**< A structure that takes more is to be refused: RAYTALLY_BUILD_NO_MEMORY. */
    char *message;       /**< [message_room] why it failed: a sentence for the user. */
    size_t message_room; /**< In bytes. */
} raytally_build;

/** What a structure looks like. All is 0, and what is expected NaN, unless `describe` sets it. */
typedef struct raytally_description {
    uint64_t interior;      /**< Inner nodes. */
    uint64_t leaves;        /**< Leaves, or voxels. */
    uint64_t empty_leaves;  /**< Of them, those without an object. */
    uint64_t references;    /**< Entries in all lists of objects. */
    uint64_t depth;         /**< Of the deepest leaf, the root being 0. */
    uint64_t bytes;         /**< Of its arrays. */
    double predicted_cost;  /**< Expected cost of a random line through the box, in object tests (SAH). */
    double predicted_tests; /**< Its expected object tests. */
    double predicted_steps; /**< Its expected steps. */
    double reserved[7];     /**< Room for what later ones say. Not to be set. */
} raytally_description;

/** Who looks at the boxes of a structure, for pictures: to be called once for each.
 * @param viewer  as it was given
 * @param box     of a node
 * @param depth   below the root, which is at 0
 * @param leaf    1 if it lists objects */
typedef void raytally_show_box(void *viewer, const raytally_box *box, uint32_t depth, int leaf);

/** Nearest hits of a stream of rays.
 * @param self      the structure
 * @param memory    of the query: what query_bytes asked for; NULL where that was nothing
 * @param query     for raytally_prepare
 * @param rays      [count] valid, of any kinds
 * @param count     at least 1
 * @param hits      [count] the answers: {INFINITY, RAYTALLY_NO_OBJECT} where there is no hit
 * @param counters  [RAYTALLY_RAY_KINDS] to add to, by the kind of each ray; or NULL: the rays are timed, and
 *                  nothing is counted. RAYTALLY_RAYS and RAYTALLY_HITS are raytally's to count */
typedef void raytally_nearest_kernel(const void *self, void *memory, raytally_query *query,
                                     const raytally_ray *rays, size_t count, raytally_hit *hits,
                                     raytally_counters *counters);

/** Whether anything lies on each ray; as ::raytally_nearest_kernel, but for the answers: any object on the
 * ray, or RAYTALLY_NO_OBJECT. */
typedef void raytally_occluded_kernel(const void *self, void *memory, raytally_query *query,
                                      const raytally_ray *rays, size_t count, uint32_t *occluders,
                                      raytally_counters *counters);

/** One accelerator. Members that are optional may be NULL.
 *
 * Who calls: `build`, `query_bytes`, `describe`, `validate`, `each_box` and `destroy` are called by the main
 * thread of the plugin's process, one after the other, `destroy` when no query is left; but `validate` and
 * `each_box` perhaps while others trace. `nearest`, `occluded` and `begin` are called by a thread for each
 * query, all at the same time. */
typedef struct raytally_accel_ops {
    uint32_t abi;                 /**< RAYTALLY_ACCEL_ABI. */
    uint32_t size;                /**< sizeof(raytally_accel_ops): later ones may have more at the end. */
    const char *name;             /**< As in a spec: a letter, and then letters, digits, '_' and '-', 63 at
                                     most; of no other accelerator, and not "all". */
    const char *summary;          /**< One line. */
    const char *paper;            /**< Author, year, title, venue. */
    const raytally_param *params; /**< [param_count], or NULL. */
    uint32_t param_count;         /**< Up to RAYTALLY_MAX_PARAMS. */

    /** One of ::raytally_built. On failure nothing is left behind. */
    int (*build)(const raytally_build *build, void **self);
    /** Frees what `build` made. */
    void (*destroy)(void *self);

    raytally_nearest_kernel *nearest;   /**< RAYTALLY_DEFINE_KERNELS makes one of a search for a ray. */
    raytally_occluded_kernel *occluded; /**< The same. */

    /** Optional: bytes of memory for each query; zeroed, and 64-byte aligned. Asked once, behind `build`.
     * Where it is NULL, or says 0, `memory` is NULL wherever it is handed over. */
    size_t (*query_bytes)(const void *self);
    /** Optional: brings the memory of a query back to what a fresh one has, as far as later counts could
     * tell. */
    void (*begin)(const void *self, void *memory);
    /** Optional: what the structure looks like. */
    void (*describe)(const void *self, raytally_description *out);
    /** Optional: 0, or 1 with a sentence in message[0..room) that names the first broken invariant. */
    int (*validate)(const void *self, char *message, size_t room);
    /** Optional: shows every box of the structure; where there are many it is called again, and is to show
     * them in the same order. */
    void (*each_box)(const void *self, raytally_show_box *show, void *viewer);
} raytally_accel_ops;

/** What a plugin exports, by the name `raytally_plugin`: the table number `index` of those that it has, from
 * 0 on, and NULL beyond the last. The tables stay where they are. */
typedef const raytally_accel_ops *raytally_plugin_function(uint32_t index);

/** The definition of raytally_plugin begins with this: RAYTALLY_PLUGIN { return index == 0 ? &mine : NULL; }
 */
#ifdef __cplusplus
#define RAYTALLY_PLUGIN                                                                                      \
    extern "C" __attribute__((visibility("default"))) const raytally_accel_ops *raytally_plugin(             \
        uint32_t index);                                                                                     \
    const raytally_accel_ops *raytally_plugin(uint32_t index)
#else
#define RAYTALLY_PLUGIN                                                                                      \
    __attribute__((visibility("default"))) const raytally_accel_ops *raytally_plugin(uint32_t index);        \
    const raytally_accel_ops *raytally_plugin(uint32_t index)
#endif

/** Defines NAME_nearest and NAME_occluded from a search for one ray, which is inlined into each of them
 * twice, with counters and with a constant NULL, so that nothing is left of counting where rays are timed:
 *
 *     RAYTALLY_INLINE void NAME(const Type *self, void *memory, const raytally_prepared *ray, int any,
 *                               raytally_hit *best, raytally_counters *counters);
 *
 * It improves *best, and may return as soon as raytally_object_hits says that the search is over. */
#define RAYTALLY_DEFINE_KERNELS(Type, name)                                                                  \
    RAYTALLY_INLINE raytally_hit name##_one(const Type *self, void *memory, raytally_query *query,           \
                                            const raytally_ray *ray, int any, raytally_counters *counters) { \
        raytally_hit best = {__builtin_inff(), RAYTALLY_NO_OBJECT};                                          \
        raytally_prepared prepared;                                                                          \
        raytally_prepare(query, ray, &prepared);                                                             \
        name(self, memory, &prepared, any, &best, counters);                                                 \
        return best;                                                                                         \
    }                                                                                                        \
    static void name##_nearest(const void *self, void *memory, raytally_query *query,                        \
                               const raytally_ray *rays, size_t count, raytally_hit *hits,                   \
                               raytally_counters *counters) {                                                \
        const Type *own = (const Type *)self;                                                                \
        if (counters) {                                                                                      \
            for (size_t i = 0; i < count; i++)                                                               \
                hits[i] = name##_one(own, memory, query, &rays[i], 0, &counters[rays[i].kind]);              \
        } else {                                                                                             \
            for (size_t i = 0; i < count; i++) hits[i] = name##_one(own, memory, query, &rays[i], 0, NULL);  \
        }                                                                                                    \
    }                                                                                                        \
    static void name##_occluded(const void *self, void *memory, raytally_query *query,                       \
                                const raytally_ray *rays, size_t count, uint32_t *occluders,                 \
                                raytally_counters *counters) {                                               \
        const Type *own = (const Type *)self;                                                                \
        if (counters) {                                                                                      \
            for (size_t i = 0; i < count; i++)                                                               \
                occluders[i] = name##_one(own, memory, query, &rays[i], 1, &counters[rays[i].kind]).object;  \
        } else {                                                                                             \
            for (size_t i = 0; i < count; i++)                                                               \
                occluders[i] = name##_one(own, memory, query, &rays[i], 1, NULL).object;                     \
        }                                                                                                    \
    }

#ifdef __cplusplus
}
#endif

#endif
