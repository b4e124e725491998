/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * An accelerator of your own. A plugin is a shared library that exports a table of functions for each of its
 * accelerators. raytally then provides specs, parameters, help, `verify`, `bench`, `run`, plots and reports
 * for them, as for its own. A plugin is compiled against these headers alone and linked with nothing: it
 * calls raytally through the table of functions in its query (raytally_host).
 *
 * The contract, which `raytally verify` checks (RAYTALLY_OWN_HITS relaxes the first two rules):
 *  - the nearest hit is the least (t, object) of all hits, bit for bit: of two objects at the same t, the one
 *    with the lower number. raytally_object_hits tests objects and keeps that order; prune only by
 *    raytally_box_hit (box.h);
 *  - `occluded` names any object on the ray, or RAYTALLY_NO_OBJECT;
 *  - a structure is read-only once it is built. A traversal writes only to the memory of its query; each
 *    thread has its own query;
 *  - tracing allocates nothing and cannot fail;
 *  - the same rays give the same counts, and the same build the same structure, independent of memory
 *    addresses and of the number of threads. (`raytally reproduce`, which builds again, checks the latter.)
 *
 * A plugin runs in a process of its own. If it crashes, hangs, returns invalid answers or writes outside the
 * memory of its query, it loses its own results and no others. */
#ifndef RAYTALLY_ACCEL_H
#define RAYTALLY_ACCEL_H

#include "raytally/hit.h"
#include "raytally/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The version of this interface. Plugins of another version are rejected. docs/interface.md says what a
 * plugin of version 1 may rely on, and what may grow. */
#define RAYTALLY_ACCEL_ABI 1

/* ---- parameters ---- */

/** The type of a parameter. */
enum raytally_param_type {
    RAYTALLY_INT,    /**< A whole number. */
    RAYTALLY_FLOAT,  /**< A finite number. */
    RAYTALLY_CHOICE, /**< One of several words. */
    RAYTALLY_FLAG    /**< on or off. */
};

/** The most parameters that an accelerator may have. */
#define RAYTALLY_MAX_PARAMS 16

/** One parameter, as in NAME:KEY=VALUE. This table drives parsing, range checks, help, and the values that
 * `verify --spread` tries. */
typedef struct raytally_param {
    const char *name;         /**< The key: up to 63 letters, digits and '_'. */
    uint32_t type;            /**< One of ::raytally_param_type. */
    const char *default_text; /**< The default value, as text. */
    double lo;                /**< The least number, inclusive; 0 for choices and flags. */
    double hi;                /**< The largest number, inclusive; 0 for choices and flags. */
    const char *choices;      /**< "sah|median" for a choice; else NULL. */
    const char *test_values;  /**< Values to test, "1|4|20"; NULL for choices and flags: all are tested. */
    const char *meaning;      /**< One line, with the unit if there is one. */
    const char *source;       /**< Source of the default: a paper, a measurement. */
} raytally_param;

/** The value of a parameter, by its type. */
typedef union raytally_value {
    int64_t integer; /**< A ::RAYTALLY_INT. */
    double number;   /**< A ::RAYTALLY_FLOAT. */
    uint32_t choice; /**< A ::RAYTALLY_CHOICE: index of the word, from 0. */
    uint32_t flag;   /**< A ::RAYTALLY_FLAG: 1 is on. */
} raytally_value;

/* ---- functions that raytally provides ---- */

typedef struct raytally_query raytally_query;

/** Functions of raytally. Call them by raytally_prepare and raytally_object_hits below. */
typedef struct raytally_host {
    uint32_t abi;  /**< RAYTALLY_ACCEL_ABI of the program. */
    uint32_t size; /**< Of this struct, in bytes: later versions may add members at the end. */
    /** See raytally_prepare. */
    void (*prepare)(raytally_query *query, const raytally_ray *ray, raytally_prepared *out);
    /** See raytally_object_hits. */
    int (*object_hits)(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, int any,
                       raytally_hit *best, raytally_counters *counters);
    /** The hit function of an object that is neither a triangle nor a sphere: 1 and *t, or 0. */
    int (*other_hit)(const raytally_prepared *ray, uint32_t id, float *t);
    /** See raytally_nearest_below. */
    void (*nearest_below)(raytally_query *query, const raytally_ray *rays, size_t count, raytally_hit *hits);
    /** See raytally_occluded_below. */
    void (*occluded_below)(raytally_query *query, const raytally_ray *rays, size_t count,
                           uint32_t *occluders);
    /** See raytally_show. NULL unless `raytally trace` follows the ray. */
    void (*show)(const raytally_prepared *ray, uint32_t counter, uint32_t number, const raytally_box *box);
} raytally_host;

/** The state of one thread's rays. Plugins use only its first member; the functions below use the others. */
struct raytally_query {
    const raytally_host *host;        /**< Functions of raytally. */
    const raytally_ray *volatile ray; /**< The last one prepared, for reports of crashes. */
    void *crossings;                  /**< For raytally_prepared. */
    const raytally_box *boxes;        /**< As in raytally_build_input. */
    const float *triangles;           /**< The same. */
    const float *spheres;             /**< The same. */
    const uint32_t *objects; /**< [object_count] shape << RAYTALLY_INDEX_BITS | index in its array. */
    uint32_t object_count;   /**< 0 while raytally counts: it then makes all object tests itself. */
    raytally_box box;        /**< Around all objects. */
};

/** The shapes in raytally_query.objects that are tested here. */
enum { RAYTALLY_SHAPE_SPHERE = 0, RAYTALLY_SHAPE_TRIANGLE = 2, RAYTALLY_INDEX_BITS = 28 };

/** Prepares a ray for tests of boxes and objects: reciprocals, signs, thickness.
 * @param query  the argument of the kernel
 * @param ray    a valid ray; it must outlive `out`
 * @param out    the prepared ray */
RAYTALLY_INLINE void raytally_prepare(raytally_query *query, const raytally_ray *ray,
                                      raytally_prepared *out) {
    query->ray = ray;
    raytally_prepare_in(out, ray, &query->box);
    out->query = query;
    out->crossings = query->crossings;
}

/** The exact hit function of one object, which must exist: 1 and *t, or 0. */
RAYTALLY_INLINE int raytally_object_hit(const raytally_prepared *ray, uint32_t id, float *t) {
    const raytally_query *query = ray->query;
    const uint32_t shape = query->objects[id] >> RAYTALLY_INDEX_BITS;
    const size_t index = query->objects[id] & ((UINT32_C(1) << RAYTALLY_INDEX_BITS) - 1);
    if (shape == RAYTALLY_SHAPE_TRIANGLE)
        return raytally_triangle_hit(query->triangles + 9 * index, 3, 1, ray, t);
    if (shape == RAYTALLY_SHAPE_SPHERE)
        return raytally_sphere_hit(query->spheres + 4 * index, &query->boxes[id], ray, t);
    return query->host->other_hit(ray, id, t);
}

/** Tests objects: calls the exact hit function of each and keeps the best hit, the least (t, object). Counts
 * RAYTALLY_OBJECT_TESTS, RAYTALLY_OBJECT_HITS and RAYTALLY_CSG_TESTS. In streams that are counted, raytally
 * makes the tests and checks the counts; otherwise triangles and spheres are tested inline (hit.h).
 * @param ray       from raytally_prepare
 * @param ids       [count] numbers of objects, each below raytally_build_input.object_count
 * @param count     number of objects, possibly 0
 * @param any       1: any hit is sufficient, and the first one ends the search
 * @param best      the best hit so far, or {INFINITY, RAYTALLY_NO_OBJECT}; updated
 * @param counters  of the ray's kind, or NULL if nothing is counted
 * @return 1 if the search is over, because `any` is set and there is a hit; else 0 */
RAYTALLY_INLINE int raytally_object_hits(const raytally_prepared *ray, const uint32_t *ids, uint32_t count,
                                         int any, raytally_hit *best, raytally_counters *counters) {
    const raytally_query *query = ray->query;
    if (counters) return query->host->object_hits(ray, ids, count, any, best, counters);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t id = ids[i];
        float t;
        if (id >= query->object_count) { /* raytally counts, or reports an object that does not exist */
            raytally_hit kept = *best;   /* so that *best may stay in registers */
            const int over = query->host->object_hits(ray, ids + i, count - i, any, &kept, counters);
            *best = kept;
            return over;
        }
        if (!raytally_object_hit(ray, id, &t)) continue;
        if (t < best->t || (t == best->t && id < best->object)) {
            best->t = t;
            best->object = id;
        }
        if (any) return 1;
    }
    return 0;
}

/** Nearest hits in the accelerator below an overlay (::RAYTALLY_OVERLAY). In streams that are counted,
 * raytally counts what that does; the overlay counts only what it does itself.
 * @param query  the argument of the kernel
 * @param rays   [count] of the kernel's rays, or other valid rays
 * @param count  number of rays, possibly 0; long streams take less time
 * @param hits   [count] out */
RAYTALLY_INLINE void raytally_nearest_below(raytally_query *query, const raytally_ray *rays, size_t count,
                                            raytally_hit *hits) {
    query->host->nearest_below(query, rays, count, hits);
}

/** The same for occluders: each is an object on the ray, RAYTALLY_NO_OBJECT, or RAYTALLY_UNNAMED_OBJECT if
 * the accelerator below does not name it. */
RAYTALLY_INLINE void raytally_occluded_below(raytally_query *query, const raytally_ray *rays, size_t count,
                                             uint32_t *occluders) {
    query->host->occluded_below(query, rays, count, occluders);
}

/** Adds `n` to one of ::raytally_counter. With a constant NULL it compiles to nothing. */
#define RAYTALLY_COUNT(counters, counter, n)                                                                 \
    do {                                                                                                     \
        if (counters) (counters)->at[counter] += (uint64_t)(n);                                              \
    } while (0)

/** Optional: shows a step or an extent test, which has been counted, to `raytally trace`. Without it the
 * ray's path says only how many there were between object tests. With constant NULL counters it compiles to
 * nothing.
 * @param ray       from raytally_prepare
 * @param counter   RAYTALLY_STEPS or RAYTALLY_EXTENT_TESTS
 * @param number    of the node or voxel
 * @param box       its box; of a step possibly NULL
 * @param counters  of the ray's kind, or NULL */
RAYTALLY_INLINE void raytally_show(const raytally_prepared *ray, uint32_t counter, uint32_t number,
                                   const raytally_box *box, const raytally_counters *counters) {
    if (!counters) return;
    const raytally_host *host = ray->query->host;
    if (host->size > offsetof(raytally_host, show) && host->show) host->show(ray, counter, number, box);
}

/* ---- functions that a plugin provides ---- */

/** What `build` returns. */
enum raytally_build_result {
    RAYTALLY_BUILD_OK = 0,       /**< *self is the structure. */
    RAYTALLY_BUILD_REFUSED = 1,  /**< This scene or these values are not supported: `message` says why. */
    RAYTALLY_BUILD_NO_MEMORY = 2 /**< Out of memory, or the structure would exceed the limit. */
};

/** Input of `build`, valid during the call. All arrays are borrowed and outlive the structure; boxes, which
 * every accelerator gets, suffice unless it has its own hit functions (::RAYTALLY_OWN_HITS). */
typedef struct raytally_build_input {
    uint32_t size;                /**< Of this struct, in bytes: later versions may add members at the end. */
    uint32_t object_count;        /**< Objects of the scene, numbered from 0; possibly none. */
    const raytally_box *boxes;    /**< [object_count] the box of each object. */
    raytally_box box;             /**< Around all objects. */
    const raytally_value *values; /**< [param_count] in the order of the table, each within its range. */
    int32_t threads;              /**< To build with, at least 1; must not change the structure. */
    uint64_t byte_limit;          /**< A structure that needs more must fail: RAYTALLY_BUILD_NO_MEMORY. */
    char *message;                /**< [message_room] out: why it failed, a sentence for the user. */
    size_t message_room;          /**< In bytes. */

    /* The geometry of each object: in one of three lists, each ascending by object. Arrays of no entries may
     * be NULL. */

    const float *triangles; /**< [9 * triangle_count] three vertices x, y, z. Aligned to 64 bytes; 4 bytes
                               beyond the last may be read, so a vertex can be loaded as 16 bytes. */
    const uint32_t *triangle_objects; /**< [triangle_count] the object that each triangle is. */
    const float *spheres;             /**< [4 * sphere_count] centre x, y, z and radius; aligned likewise. */
    const uint32_t *sphere_objects;   /**< [sphere_count] the object that each sphere is. */
    const uint32_t *other_objects;    /**< [other_count] polygons, cones, CSG trees and instances, which only
                                         raytally_object_hits can test. An instance is one object. */
    uint32_t triangle_count;          /**< Triangles, those without area included, which are never hit. */
    uint32_t sphere_count;            /**< Spheres. */
    uint32_t other_count;             /**< All other objects. */
    uint32_t reserved;                /**< 0. */
} raytally_build_input;

/** Statistics of a structure. Numbers are 0 and predictions NaN unless `describe` sets them. */
typedef struct raytally_description {
    uint64_t interior;      /**< Inner nodes. */
    uint64_t leaves;        /**< Leaves, or voxels. */
    uint64_t empty_leaves;  /**< Leaves without an object. */
    uint64_t references;    /**< Entries in all lists of objects. */
    uint64_t depth;         /**< Of the deepest leaf, the root being 0. */
    uint64_t bytes;         /**< Of its arrays. */
    double predicted_cost;  /**< Expected cost of a random line through the box, in object tests (SAH). */
    double predicted_tests; /**< Its expected object tests. */
    double predicted_steps; /**< Its expected steps. */
    double reserved[7];     /**< For later versions. Do not set. */
} raytally_description;

/** Visits the boxes of a structure, for pictures: called once for each box.
 * @param context  the argument of `each_box`
 * @param box      of a node
 * @param depth    below the root, which has depth 0
 * @param leaf     1 if it lists objects */
typedef void raytally_box_visitor(void *context, const raytally_box *box, uint32_t depth, int leaf);

/** Nearest hits of a stream of rays.
 * @param self      the structure
 * @param memory    of the query: query_bytes bytes, or NULL if that is 0
 * @param query     for raytally_prepare
 * @param rays      [count] valid rays of any kinds
 * @param count     at least 1
 * @param hits      [count] out: the answers; {INFINITY, RAYTALLY_NO_OBJECT} for a miss
 * @param counters  [RAYTALLY_RAY_KINDS] to add to, by the kind of each ray; or NULL if nothing is counted.
 *                  Do not count RAYTALLY_RAYS and RAYTALLY_HITS: raytally does */
typedef void raytally_nearest_kernel(const void *self, void *memory, raytally_query *query,
                                     const raytally_ray *rays, size_t count, raytally_hit *hits,
                                     raytally_counters *counters);

/** An occluder without a name: something lies on the ray. Only with ::RAYTALLY_OWN_HITS, or above an
 * accelerator that has it. */
#define RAYTALLY_UNNAMED_OBJECT (UINT32_MAX - 1)

/** Whether anything lies on each ray. As ::raytally_nearest_kernel, except that an answer is any object on
 * the ray, or RAYTALLY_NO_OBJECT; with ::RAYTALLY_OWN_HITS also RAYTALLY_UNNAMED_OBJECT. */
typedef void raytally_occluded_kernel(const void *self, void *memory, raytally_query *query,
                                      const raytally_ray *rays, size_t count, uint32_t *occluders,
                                      raytally_counters *counters);

/** Properties of an accelerator, to be combined by |. */
enum raytally_accel_flag {
    /** It answers by its own hit functions, as a library does that is measured as it is. `verify` then judges
     * each answer (equal, tie, marginal or wrong) instead of comparing bits; `bench` and `run` time it
     * whatever it answers, and report how many answers differ. An answer must still name an existing object
     * at a t with tmin <= t <= tmax, or be a miss. Object tests are counted as its own code counts them. */
    RAYTALLY_OWN_HITS = 1,
    /** It counts nothing: `counters` is always NULL, and its rows have times but no counts. */
    RAYTALLY_NO_COUNTS = 2,
    /** It is an overlay, written before a '+': it answers some rays, and passes the others on to the
     * accelerator below by raytally_nearest_below and raytally_occluded_below. In RAYTALLY_PASSED_ON it
     * counts those that it is made for and cannot answer. */
    RAYTALLY_OVERLAY = 4,
    /** With RAYTALLY_OWN_HITS: it computes with absolute coordinates, without subtracting a ray's origin
     * first. Then `verify` allows errors of 2^-21 of the scene's largest coordinate, and far from the origin
     * it may be unable to decide. Since version 1.1. */
    RAYTALLY_ABSOLUTE_HITS = 8
};

/** One accelerator. Optional members may be NULL.
 *
 * Threads: the main thread of the plugin's process calls `build`, `query_bytes`, `describe`, `validate`,
 * `each_box` and, when no query is left, `destroy`, one after the other. Each query has a thread that calls
 * `nearest`, `occluded` and `begin`; these threads run at the same time, possibly during `validate` and
 * `each_box`. */
typedef struct raytally_accel_ops {
    uint32_t abi;        /**< RAYTALLY_ACCEL_ABI. */
    uint32_t size;       /**< sizeof(raytally_accel_ops): later versions may add members at the end. */
    const char *name;    /**< As in a spec: a letter, and then letters, digits, '_' and '-', at most 63
                            characters; not the name of another accelerator, and not "all". */
    const char *summary; /**< One line. */
    const char *paper;   /**< Author, year, title, venue. */
    const raytally_param *params; /**< [param_count], or NULL. */
    uint32_t param_count;         /**< Up to RAYTALLY_MAX_PARAMS. */

    /** Builds *self. Returns one of ::raytally_build_result; on failure it has freed everything. */
    int (*build)(const raytally_build_input *input, void **self);
    /** Frees what `build` made. */
    void (*destroy)(void *self);

    raytally_nearest_kernel *nearest;   /**< RAYTALLY_DEFINE_KERNELS defines it from a search for one ray. */
    raytally_occluded_kernel *occluded; /**< The same. */

    /** Optional: the bytes of memory that each query needs; zeroed and 64-byte aligned. Called once, after
     * `build`. Without it, or if it returns 0, `memory` is NULL everywhere. */
    size_t (*query_bytes)(const void *self);
    /** Optional: resets the memory of a query, so that later counts do not depend on earlier rays. */
    void (*begin)(const void *self, void *memory);
    /** Optional: writes statistics of the structure. */
    void (*describe)(const void *self, raytally_description *out);
    /** Optional: 0, or 1 and a sentence in message[0..size) that names the first broken invariant. */
    int (*validate)(const void *self, char *message, size_t size);
    /** Optional: visits every box of the structure. It may be called several times and must visit them in the
     * same order. */
    void (*each_box)(const void *self, raytally_box_visitor *visit, void *context);

    uint64_t flags; /**< Of ::raytally_accel_flag; 0: it answers by raytally_object_hits, and counts. */
} raytally_accel_ops;

/** The function that a plugin exports under the name `raytally_plugin`: returns its table number `index`,
 * from 0, and NULL after the last. The tables must stay valid. */
typedef const raytally_accel_ops *raytally_plugin_function(uint32_t index);

/** Begins the definition of raytally_plugin: RAYTALLY_PLUGIN { return index == 0 ? &mine : NULL; } */
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

/** Defines the kernels NAME_nearest and NAME_occluded from a search for one ray. The search is inlined twice
 * into each kernel: with counters, and with a constant NULL, so that no counting code remains when rays are
 * timed:
 *
 *     RAYTALLY_INLINE void NAME(const Type *self, void *memory, const raytally_prepared *ray, int any,
 *                               raytally_hit *best, raytally_counters *counters);
 *
 * It updates *best, and may return as soon as raytally_object_hits returns 1. */
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
