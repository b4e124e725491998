/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * raytally as a library: scenes, accelerators, tracers, recorded rays, verification, measuring and pictures.
 *
 * **Errors.** A function that can fail returns a raytally_status. If that is not RAYTALLY_OK, it describes
 * the failure in *error, which may be NULL, and sets *out to NULL; on success it leaves *error unchanged.
 * Nothing is printed, and nothing ends the process. Pointers must not be NULL unless their description allows
 * it.
 *
 * **Ownership.** The caller owns every object it gets, and frees it with the `_free` function of its type,
 * which accepts NULL. An object must outlive the objects made from it: a scene its accelerators, an
 * accelerator its tracers. Strings and arrays passed to a function are copied; those that a function returns
 * belong to the object it was called for.
 *
 * **Threads.** Different objects may be used by different threads at once. Many threads may read one object;
 * functions that take it without `const` need exclusive access. A tracer belongs to one thread at a time. A
 * parameter `threads` is the number of threads to work with, 1..1024, or 0 for all processors; it changes no
 * answer, no count and no picture. The library keeps no threads running between calls. An accelerator of a
 * plugin may reject, with RAYTALLY_BAD_INPUT, more threads and tracers at once than there are processors and
 * than it was built with.
 *
 * **Numbers** in specs, files and messages follow the locale "C", whatever the program has set by setlocale.
 * Lengths are in the units of the scene, times in seconds. Answers are the same bits everywhere in the
 * default floating-point environment of C: rounding to nearest, denormals kept. A thread that has set FTZ or
 * DAZ must reset them before it calls; so must a program linked with -ffast-math, which sets them.
 *
 * **Versions.** Structs of options begin with their size, so programs built with older and newer headers
 * work. Members that a program does not have get their defaults; a member that it sets and this library does
 * not know is RAYTALLY_NOT_AVAILABLE. Structs of results have room for new members, which are 0; arrays of
 * counters must have RAYTALLY_MAX_RAY_KINDS elements. docs/interface.md says what a program may rely on. */
#ifndef RAYTALLY_RAYTALLY_H
#define RAYTALLY_RAYTALLY_H

#include "raytally/types.h"

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Marks exported functions. */
#define RAYTALLY_API __attribute__((visibility("default")))

/** @name Version and errors
 * @{ */

/** The version of the binary interface: a program runs with every library that has the number it was built
 * with. It is also the number of the shared library, libraytally.so.N. */
#define RAYTALLY_ABI_VERSION 1

/** The RAYTALLY_ABI_VERSION that the library was built with. */
RAYTALLY_API int raytally_abi_version(void);

/** The version of the library, "MAJOR.MINOR.PATCH". */
RAYTALLY_API const char *raytally_version(void);

/** How a call ended. */
typedef enum raytally_status {
    RAYTALLY_OK = 0,        /**< Success. */
    RAYTALLY_MISMATCH,      /**< A check failed: answers or counts differ, or a structure is broken. */
    RAYTALLY_BROKEN,        /**< An accelerator of a plugin crashed, hung or returned invalid answers. */
    RAYTALLY_BAD_INPUT,     /**< A file, a spec or an argument is wrong. */
    RAYTALLY_NOT_AVAILABLE, /**< This build or machine does not support the request. */
    RAYTALLY_NO_MEMORY,     /**< An allocation failed. */
    RAYTALLY_IO             /**< Reading or writing failed. */
} raytally_status;

/** Why a call failed. */
typedef struct raytally_error {
    raytally_status status; /**< What the call returned. */
    char message[1024];     /**< The place, the problem and a remedy, in sentences. */
} raytally_error;

/** @}
 * @name Scenes
 * Objects, lights and a camera. Only the camera and the sampling of a scene can change, and only while no
 * accelerator is built over it.
 * @{ */

/** A scene. */
typedef struct raytally_scene raytally_scene;

/** Opens a built-in scene by its spec ("balls:size=4"), or a file: YAML, NFF, or a mesh in one of the formats
 * that the program reads. Files are not trusted: all of their contents is checked. What is odd in a file, but
 * has one sensible reading, is a warning of the scene. */
RAYTALLY_API raytally_status raytally_scene_open(const char *spec, raytally_scene **out,
                                                 raytally_error *error);

/** Objects of the caller: triangles with shared vertices, and spheres. Initialise with RAYTALLY_OBJECTS. */
typedef struct raytally_objects {
    size_t size;             /**< sizeof(raytally_objects). */
    const float *vertices;   /**< [vertex_count][3]: x, y, z, each finite and within 5e17; NULL for none. */
    uint32_t vertex_count;   /**< Number of vertices. */
    const uint32_t *corners; /**< [triangle_count][3]: numbers of vertices; NULL for none. */
    uint32_t triangle_count; /**< Number of triangles; they may be degenerate. */
    const float *spheres;    /**< [sphere_count][4]: centre x, y, z, and a radius above 0; NULL for none. */
    uint32_t sphere_count;   /**< Number of spheres. */
    uint32_t reserved;       /**< 0. */
} raytally_objects;

/** No objects. */
#define RAYTALLY_OBJECTS                                                                                     \
    { sizeof(raytally_objects), NULL, 0, NULL, 0, NULL, 0, 0 }

/** Makes a scene of `objects`, grey and matte, with a camera that sees all of them and a light above it.
 * Triangle i is object i; sphere k is object triangle_count + k. */
RAYTALLY_API raytally_status raytally_scene_from_objects(const raytally_objects *objects,
                                                         raytally_scene **out, raytally_error *error);

/** Frees a scene. Free its accelerators first. */
RAYTALLY_API void raytally_scene_free(raytally_scene *scene);

/** The number of objects; they are numbered 0, 1, ... */
RAYTALLY_API uint32_t raytally_scene_object_count(const raytally_scene *scene);

/** The smallest box around all objects: x, y, z of its two corners. Without objects, `low` is INFINITY and
 * `high` -INFINITY. */
RAYTALLY_API void raytally_scene_bounds(const raytally_scene *scene, float low[3], float high[3]);

/** Size of the longest warning, with its terminating 0. */
#define RAYTALLY_WARNING_CHARS 1100

/** Writes to `out` what the reader of the scene's files left out or guessed: warning number `i`, from 0, with
 * its place, and how many more there are of its kind. False, and an empty string, after the last. */
RAYTALLY_API bool raytally_scene_warning(const raytally_scene *scene, uint32_t i,
                                         char out[RAYTALLY_WARNING_CHARS]);

/** A pinhole camera. */
typedef struct raytally_camera {
    float from[3]; /**< Position of the eye. */
    float at[3];   /**< The point it looks at; not `from`. */
    float up[3];   /**< The up direction of the image; not along the line of sight. */
    float fov;     /**< The full vertical angle of view in degrees, above 0 and below 180. */
} raytally_camera;

/** Sets the camera. Size and sampling of the image stay. RAYTALLY_BAD_INPUT if an accelerator is built over
 * the scene. */
RAYTALLY_API raytally_status raytally_scene_set_camera(raytally_scene *scene, const raytally_camera *camera,
                                                       raytally_error *error);

/** Sets the sampling of the image: `width` x `height` pixels, each 1..32768, or 0 for the value of the scene,
 * with `samples` x `samples` rays per pixel, 1..64. RAYTALLY_BAD_INPUT if an accelerator is built over the
 * scene. */
RAYTALLY_API raytally_status raytally_scene_set_sampling(raytally_scene *scene, uint32_t width,
                                                         uint32_t height, uint32_t samples,
                                                         raytally_error *error);

/** The size of the camera's image in pixels. */
RAYTALLY_API void raytally_scene_size(const raytally_scene *scene, uint32_t *width, uint32_t *height);

/** @}
 * @name Accelerators
 * @{ */

/** A structure over a scene that finds what rays hit. */
typedef struct raytally_accelerator raytally_accelerator;

/** The number of available accelerators. */
RAYTALLY_API size_t raytally_accelerator_count(void);

/** The name of accelerator `i`, below raytally_accelerator_count(), in the order of `raytally accels`. */
RAYTALLY_API const char *raytally_accelerator_name(size_t i);

/** Size of the longest spec, with its terminating 0. */
#define RAYTALLY_SPEC_CHARS 512

/** Checks `spec` and writes it to `out` with all effective parameters: "grid" becomes
 * "grid:rule=cubic,density=4,...". */
RAYTALLY_API raytally_status raytally_spec_format(const char *spec, char out[RAYTALLY_SPEC_CHARS],
                                                  raytally_error *error);

/** Loads the accelerators of the plugin at `path` (raytally/accel.h), unless it is loaded already; they can
 * then be used like the others. No other thread may call raytally at the same time. Accelerators of a plugin
 * run in a process of their own, a fork of the program, so load and build them before the program starts many
 * threads. RAYTALLY_BAD_INPUT, and nothing is loaded, if the file is not a plugin, is of another version, or
 * fails while it loads. */
RAYTALLY_API raytally_status raytally_plugin_load(const char *path, raytally_error *error);

/** Builds the accelerator that `spec` describes: `NAME[:KEY=VALUE[,KEY=VALUE]...]`, with overlays in front as
 * in `OVERLAY+NAME`. `raytally accels` lists all accelerators and their parameters. */
RAYTALLY_API raytally_status raytally_accelerator_build(const raytally_scene *scene, const char *spec,
                                                        int threads, raytally_accelerator **out,
                                                        raytally_error *error);

/** Frees an accelerator. Free its tracers first. */
RAYTALLY_API void raytally_accelerator_free(raytally_accelerator *accelerator);

/** Its spec, with all effective parameters. */
RAYTALLY_API const char *raytally_accelerator_spec(const raytally_accelerator *accelerator);

/** Whether its answers are those of `brute`, bit for bit; if not, verdicts judge them. */
RAYTALLY_API bool raytally_accelerator_exact(const raytally_accelerator *accelerator);

/** Call this after tracing, when no tracer is in use: RAYTALLY_OK, or why the answers are invalid.
 * RAYTALLY_BROKEN if the accelerator of a plugin has failed; all rays miss from then on. Functions that trace
 * rays themselves also check. */
RAYTALLY_API raytally_status raytally_accelerator_check(const raytally_accelerator *accelerator,
                                                        raytally_error *error);

/** Statistics of a structure, as indices of raytally_statistics.at. */
enum raytally_statistic {
    RAYTALLY_INTERIOR,         /**< Inner nodes. */
    RAYTALLY_LEAVES,           /**< Leaves, or voxels. */
    RAYTALLY_EMPTY_LEAVES,     /**< Leaves without an object. */
    RAYTALLY_REFERENCES,       /**< Entries in all lists of objects. */
    RAYTALLY_DEPTH,            /**< Of the deepest leaf, the root being 0. */
    RAYTALLY_BYTES,            /**< Of the structure, without the scene. */
    RAYTALLY_PREDICTED_COST,   /**< Expected cost of a random line in object tests; NaN where unknown. */
    RAYTALLY_PREDICTED_TESTS,  /**< Expected object tests of a random line; NaN where unknown. */
    RAYTALLY_PREDICTED_STEPS,  /**< Expected steps of a random line; NaN where unknown. */
    RAYTALLY_STATISTICS_KNOWN, /**< The number of statistics. */
    RAYTALLY_STATISTICS = 32   /**< The size of arrays, so that new ones do not change the layout. */
};

/** One value for each statistic, 0 if it does not apply; values from RAYTALLY_STATISTICS_KNOWN on are 0. */
typedef struct raytally_statistics {
    double at[RAYTALLY_STATISTICS]; /**< By ::raytally_statistic; whole numbers up to 2^53 are exact. */
} raytally_statistics;

/** Describes all layers together: sums, the largest depth, and the predictions of the lowest layer. */
RAYTALLY_API void raytally_accelerator_describe(const raytally_accelerator *accelerator,
                                                raytally_statistics *out);

/** @}
 * @name Tracing
 * @{ */

/** The state with which one thread traces rays. */
typedef struct raytally_tracer raytally_tracer;

/** Whether `ray` is valid: see raytally_ray. Tracers expect valid rays and do not check them. */
RAYTALLY_API bool raytally_ray_is_valid(const raytally_ray *ray);

/** Makes a tracer, which allocates everything that tracing needs: tracing itself cannot fail (but see
 * raytally_accelerator_check). */
RAYTALLY_API raytally_status raytally_tracer_new(const raytally_accelerator *accelerator,
                                                 raytally_tracer **out, raytally_error *error);

/** Frees a tracer. */
RAYTALLY_API void raytally_tracer_free(raytally_tracer *tracer);

/** Resets state that earlier rays have left (such as the last occluders of a shadow cache), so that counts of
 * later rays do not depend on it. Answers never do. */
RAYTALLY_API void raytally_tracer_begin(raytally_tracer *tracer);

/** Writes the nearest hits of rays[0..count), which are valid, to hits[0..count). `counters` is NULL or
 * [RAYTALLY_MAX_RAY_KINDS]; the cost of each ray is added to the counters of its kind, which is slower. */
RAYTALLY_API void raytally_nearest(raytally_tracer *tracer, const raytally_ray *rays, size_t count,
                                   raytally_hit *hits, raytally_counters *counters);

/** Writes whether anything lies on each of rays[0..count), which are valid, within [tmin, tmax] to
 * blocked[0..count). `counters` as for raytally_nearest. */
RAYTALLY_API void raytally_occluded(raytally_tracer *tracer, const raytally_ray *rays, size_t count,
                                    bool *blocked, raytally_counters *counters);

/** The name of a counter, "object_tests"; NULL if there is none with that number. */
RAYTALLY_API const char *raytally_counter_name(enum raytally_counter counter);

/** The name of a kind of rays, "primary"; NULL if there is none with that number. */
RAYTALLY_API const char *raytally_ray_kind_name(enum raytally_ray_kind kind);

/** @}
 * @name Rays
 * Rays of one kind, to be traced by every accelerator alike.
 * @{ */

/** An array of valid rays of one kind. */
typedef struct raytally_rays raytally_rays;

/** How rays are recorded. Initialise with RAYTALLY_RECORD_DEFAULTS. */
typedef struct raytally_record_options {
    size_t size;    /**< sizeof(raytally_record_options). */
    uint32_t depth; /**< Levels of the ray tree, 1..64, the primary ray being the first. */
    int threads;    /**< See "Threads" above. */
    uint64_t seed;  /**< Of diffuse and random rays. */
    uint64_t limit; /**< Most rays, 1..10^8; a larger set is thinned to evenly spread runs of 256. */
} raytally_record_options;

/** The options of `raytally bench`. */
#define RAYTALLY_RECORD_DEFAULTS                                                                             \
    { sizeof(raytally_record_options), 5, 0, 1, 100000 }

/** Records the rays of one kind from a frame of the accelerator's scene, in the order of tracing: tile by
 * tile, not row by row (raytally_ray.source tells their samples); or random rays, chords of the scene's
 * bounding sphere, as many as the limit. The accelerator must be exact. If the scene produces no rays of the
 * kind, the array is empty. `how` may be NULL: RAYTALLY_RECORD_DEFAULTS. The rays are the same on every
 * machine, and those of `raytally bench`. */
RAYTALLY_API raytally_status raytally_rays_record(const raytally_accelerator *accelerator,
                                                  enum raytally_ray_kind kind,
                                                  const raytally_record_options *how, raytally_rays **out,
                                                  raytally_error *error);

/** Copies and checks rays of the caller; all copies have the kind `kind`. */
RAYTALLY_API raytally_status raytally_rays_copy(enum raytally_ray_kind kind, const raytally_ray *rays,
                                                size_t count, raytally_rays **out, raytally_error *error);

/** Frees rays. */
RAYTALLY_API void raytally_rays_free(raytally_rays *rays);

/** The number of rays. */
RAYTALLY_API size_t raytally_rays_count(const raytally_rays *rays);

/** The rays, valid as long as `rays`. */
RAYTALLY_API const raytally_ray *raytally_rays_data(const raytally_rays *rays);

/** A hash of the rays: equal rays have equal fingerprints on every machine. */
RAYTALLY_API uint64_t raytally_rays_fingerprint(const raytally_rays *rays);

/** @}
 * @name Verifying
 * @{ */

/** The rays to verify with. Initialise with RAYTALLY_VERIFY_DEFAULTS. */
typedef struct raytally_verify_options {
    size_t size;                /**< sizeof(raytally_verify_options). */
    uint64_t rays;              /**< Number of rays, 1..20,000,000. Each is tested against every object. */
    uint64_t seed;              /**< Of the rays. */
    int threads;                /**< See "Threads" above. */
    const raytally_rays *given; /**< These rays instead, or NULL. */
} raytally_verify_options;

/** 10,000 rays of `raytally verify`: from the camera, chords, and difficult ones that graze, start and end on
 * surfaces, or run along axes and edges. */
#define RAYTALLY_VERIFY_DEFAULTS                                                                             \
    { sizeof(raytally_verify_options), 10000, 1, 0, NULL }

/** The result, in rays. The verdicts sum up to `rays`. */
typedef struct raytally_verify_result {
    uint64_t rays;     /**< Each traced for the nearest and for any hit, by the timed and counted kernels. */
    uint64_t equal;    /**< The answer of `brute`; for an exact accelerator, bit for bit. */
    uint64_t tie;      /**< Another object at the same place; 0 for an exact accelerator. */
    uint64_t marginal; /**< Explained by rounding; 0 for an exact accelerator. */
    uint64_t wrong;    /**< Anything else. */
    uint64_t occluded_wrong; /**< Wrong any-hit answers; these rays also have a verdict. */
    uint64_t certain;     /**< Rays that every careful float32 implementation answers alike, of an accelerator
                               that is not exact; since version 1.1. */
    uint64_t must_hit;    /**< Rays that must hit something, maybe one of several objects. */
    uint64_t certain_of;  /**< The rays examined for that: all, or a sample; 0 for an exact accelerator. */
    uint64_t reserved[7]; /**< 0. */
} raytally_verify_result;

/** Builds the accelerator that `spec` describes over `scene`, validates its structure, and compares its
 * answers with those of `brute`, which tests every object. It uses the rays of `raytally verify` with that
 * number and seed, however the image is sampled. RAYTALLY_MISMATCH if an answer is wrong, if too few rays
 * and hits are certain to judge an accelerator that is not exact, or if the
 * structure is broken: *error then describes the first wrong ray, its expected answer and the actual one, and
 * *out is filled. `how` may be NULL: RAYTALLY_VERIFY_DEFAULTS. */
RAYTALLY_API raytally_status raytally_verify(const raytally_scene *scene, const char *spec,
                                             const raytally_verify_options *how, raytally_verify_result *out,
                                             raytally_error *error);

/** @}
 * @name Measuring
 * Counting and timing are separate passes over the same rays. Shadow and occlusion rays are any-hit queries;
 * all others find the nearest hit.
 * @{ */

/** Counts what `rays` cost, the same at any number of threads and on every machine. RAYTALLY_MISMATCH if the
 * counted and the timed kernel of an exact accelerator disagree. Since version 1.1 RAYTALLY_NOT_AVAILABLE for
 * accelerators without such counts: `embree`, plugins with ::RAYTALLY_NO_COUNTS. */
RAYTALLY_API raytally_status raytally_count(raytally_accelerator *accelerator, const raytally_rays *rays,
                                            int threads, raytally_counters *out, raytally_error *error);

/** Counts what each of `rays` costs, traced by itself: counts[i * counters + c] gets ::raytally_counter `c`
 * of ray `i`, for c < counters; 0 for a counter that this library does not know. Their sums are those of
 * raytally_count, as are its errors. Since version 1.1. */
RAYTALLY_API raytally_status raytally_count_each(const raytally_accelerator *accelerator,
                                                 const raytally_rays *rays, int threads, uint64_t *counts,
                                                 uint32_t counters, raytally_error *error);

/** The median of repeated measurements, with a confidence interval by order statistics. */
typedef struct raytally_estimate {
    double median;      /**< The middle of the measurements. */
    double low;         /**< Lower end of the interval. */
    double high;        /**< Upper end of the interval. */
    double least;       /**< The smallest measurement. */
    double coverage;    /**< Probability that the interval holds the median; at least 0.95 for 6 or more. */
    double reserved[3]; /**< 0. */
} raytally_estimate;

/** The most measurements of one thing. */
#define RAYTALLY_MAX_ROUNDS 1000

/** Estimates the median of values[0..count), 1 <= count <= RAYTALLY_MAX_ROUNDS. */
RAYTALLY_API raytally_status raytally_estimate_median(const double *values, uint32_t count,
                                                      raytally_estimate *out, raytally_error *error);

/** Estimates the ratio over[i] / under[i] of paired measurements; pairing cancels drift of the machine.
 * `count` as above. NaN if an under[i] is 0. */
RAYTALLY_API raytally_status raytally_estimate_ratio(const double *over, const double *under, uint32_t count,
                                                     raytally_estimate *out, raytally_error *error);

/** How accelerators are timed. Initialise with RAYTALLY_TIME_DEFAULTS. */
typedef struct raytally_time_options {
    size_t size;     /**< sizeof(raytally_time_options). */
    uint32_t rounds; /**< 1..RAYTALLY_MAX_ROUNDS, after a warm-up; at least 6 for 95 % intervals. */
    double least;    /**< Least seconds of a round of one accelerator; the rays are repeated until then. */
    int threads;     /**< See "Threads" above. 1: by the thread's processor time; more: by the wall clock. */
    uint64_t seed;   /**< Of the order within rounds. */
} raytally_time_options;

/** The options of `raytally bench`. */
#define RAYTALLY_TIME_DEFAULTS                                                                               \
    { sizeof(raytally_time_options), 10, 0.02, 1, 1 }

/** The time of an accelerator. */
typedef struct raytally_time {
    raytally_estimate seconds; /**< Seconds per ray. */
    raytally_estimate ratio;   /**< Its throughput over that of the first accelerator, paired by rounds. */
    double reserved[8];        /**< 0. */
} raytally_time;

/** Times accelerators[0..count) on the same rays, at least one, in interleaved rounds: each round runs all
 * accelerators once, in a new random order. Writes times[0..count); ratios refer to accelerators[0].
 * RAYTALLY_BAD_INPUT if their scenes differ (since version 1.1). `how` may be NULL: RAYTALLY_TIME_DEFAULTS.
 */
RAYTALLY_API raytally_status raytally_time_all(raytally_accelerator *const *accelerators, size_t count,
                                               const raytally_rays *rays, const raytally_time_options *how,
                                               raytally_time *times, raytally_error *error);

/** @}
 * @name Pictures
 * @{ */

/** Renders the image of the scene's camera with the standard illumination model, `depth` levels deep (1..64;
 * 0: 5, the default of the program). It is written to the PNG file `png`, whole or not at all, and to `rgb`,
 * [height][width][3] linear values from the upper left. Either may be NULL. */
RAYTALLY_API raytally_status raytally_render(const raytally_accelerator *accelerator, uint32_t depth,
                                             int threads, const char *png, float *rgb, raytally_error *error);

/** @} */

#ifdef __cplusplus
}
#endif

#endif
