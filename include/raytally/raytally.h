/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * raytally as a library: scenes, accelerators, tracers, recorded rays, verification, measuring and pictures.
 *
 * **Errors.** What can fail returns a raytally_status and, where that is not RAYTALLY_OK, says why in
 * *error, which may be NULL; on success *error is left alone. What such a function makes goes to *out, which
 * is NULL after a failure. Nothing is printed, and nothing ends the process. Pointers must not be NULL unless
 * their description says so.
 *
 * **Ownership.** What is made is the caller's, and given back by the `_free` of its type, which takes NULL,
 * too. What an object is made from must outlive it: a scene its accelerators, an accelerator its tracers.
 * Strings and arrays that are handed in are copied; those that are handed out belong to the object that was
 * asked.
 *
 * **Threads.** Different objects may be used by different threads at once. One object may be read by many
 * threads; functions that take it without `const` need it for themselves. A tracer belongs to one thread at a
 * time. A parameter `threads` is the number of threads to work on, 1..1024, or 0 for all processors; it
 * changes no answer, no count and no picture. The library keeps no threads running between calls. An
 * accelerator of a plugin may refuse, with RAYTALLY_BAD_INPUT, more threads and tracers at once than there
 * are processors and than it was built on.
 *
 * **Numbers** in specs, files and messages are read and written by the rules of the locale "C", whatever the
 * program has chosen by setlocale. Lengths are in the units of the scene, times in seconds. Answers are the
 * same bits everywhere in the floating-point environment that a C program starts in: rounding to nearest,
 * denormals kept. A thread that has set FTZ or DAZ, and a program that was linked with -ffast-math, which
 * sets them, resets them before it calls.
 *
 * **Versions.** Structs of options begin with their size, of an older header or a newer one: what is left out
 * has its default, and what is set that this library does not know is RAYTALLY_NOT_AVAILABLE. Structs of
 * results have room for more, which is 0: hand over all of it, RAYTALLY_MAX_RAY_KINDS counters, too. */
#ifndef RAYTALLY_RAYTALLY_H
#define RAYTALLY_RAYTALLY_H

#include "raytally/types.h"

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What the library exports. */
#define RAYTALLY_API __attribute__((visibility("default")))

/** @name Version and errors
 * @{ */

/** The binary interface that this header describes: programs built with one number run with every library of
 * that number. It is the number of the shared library, libraytally.so.N. */
#define RAYTALLY_ABI_VERSION 1

/** The RAYTALLY_ABI_VERSION that the library was built with. */
RAYTALLY_API int raytally_abi_version(void);

/** The version of the library, "MAJOR.MINOR.PATCH". */
RAYTALLY_API const char *raytally_version(void);

/** How a call ended. */
typedef enum raytally_status {
    RAYTALLY_OK = 0,        /**< As it should. */
    RAYTALLY_MISMATCH,      /**< A check failed: answers or counts differ, or a structure is broken. */
    RAYTALLY_BROKEN,        /**< An accelerator of a plugin crashed, hung or answered nonsense. */
    RAYTALLY_BAD_INPUT,     /**< A file, a spec or an argument is wrong. */
    RAYTALLY_NOT_AVAILABLE, /**< Asked for something that this build or machine does not have. */
    RAYTALLY_NO_MEMORY,     /**< An allocation failed. */
    RAYTALLY_IO             /**< Reading or writing failed. */
} raytally_status;

/** Why a call failed. */
typedef struct raytally_error {
    raytally_status status; /**< What the call returned. */
    char message[1024];     /**< Where, what is wrong, and what would be right, in sentences. */
} raytally_error;

/** @}
 * @name Scenes
 * Objects, lights and a camera. A scene is read only but for its camera and sampling, which change as long as
 * no accelerator stands over it.
 * @{ */

/** A scene. */
typedef struct raytally_scene raytally_scene;

/** Opens a built-in scene by its spec ("balls:size=4"), or a file: YAML, NFF, or a mesh in one of the formats
 * that the program reads. What is in a file may be anything: all of it is checked. */
RAYTALLY_API raytally_status raytally_scene_open(const char *spec, raytally_scene **out,
                                                 raytally_error *error);

/** Objects of the caller's own: triangles over shared vertices, and spheres. Initialise with
 * RAYTALLY_OBJECTS. */
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

/** Makes a scene of `objects`, grey and matte, with a camera that sees all of it and a light above that.
 * Triangle i is object i, sphere k object triangle_count + k. */
RAYTALLY_API raytally_status raytally_scene_make(const raytally_objects *objects, raytally_scene **out,
                                                 raytally_error *error);

/** Frees a scene, over which no accelerator stands any more. */
RAYTALLY_API void raytally_scene_free(raytally_scene *scene);

/** The number of objects; they are numbered 0, 1, ... */
RAYTALLY_API uint32_t raytally_scene_object_count(const raytally_scene *scene);

/** The least box around all objects: x, y, z of its two ends. Of a scene without objects `low` is infinite
 * and `high` minus that. */
RAYTALLY_API void raytally_scene_bounds(const raytally_scene *scene, float low[3], float high[3]);

/** A pinhole camera. */
typedef struct raytally_camera {
    float from[3]; /**< Where the eye is. */
    float at[3];   /**< What it looks at; not `from`. */
    float up[3];   /**< What is up in the image; not along the line of sight. */
    float fov;     /**< The full vertical angle of view in degrees, above 0 and below 180. */
} raytally_camera;

/** Looks at the scene by another camera. Size and sampling of the image stay. RAYTALLY_BAD_INPUT where an
 * accelerator stands over the scene. */
RAYTALLY_API raytally_status raytally_scene_look(raytally_scene *scene, const raytally_camera *camera,
                                                 raytally_error *error);

/** Has the camera's image sampled anew: `width` x `height` pixels, each 1..32768, or 0 for what the scene
 * says, with `samples` x `samples` rays a pixel, 1..64. RAYTALLY_BAD_INPUT where an accelerator stands over
 * the scene. */
RAYTALLY_API raytally_status raytally_scene_sample(raytally_scene *scene, uint32_t width, uint32_t height,
                                                   uint32_t samples, raytally_error *error);

/** The size of the camera's image in pixels. */
RAYTALLY_API void raytally_scene_size(const raytally_scene *scene, uint32_t *width, uint32_t *height);

/** @}
 * @name Accelerators
 * @{ */

/** A structure over a scene, that answers what rays hit. */
typedef struct raytally_accelerator raytally_accelerator;

/** The number of accelerators that there are. */
RAYTALLY_API size_t raytally_accelerator_count(void);

/** The name of accelerator `i`, below raytally_accelerator_count(), in the order of `raytally accels`. */
RAYTALLY_API const char *raytally_accelerator_name(size_t i);

/** Room for the longest spec, its end included. */
#define RAYTALLY_SPEC_CHARS 512

/** Checks `spec` and writes it to `out` with every parameter that is in effect: "grid" becomes
 * "grid:rule=cubic,density=4,...". */
RAYTALLY_API raytally_status raytally_spec_format(const char *spec, char out[RAYTALLY_SPEC_CHARS],
                                                  raytally_error *error);

/** Loads the accelerators of the plugin at `path` (raytally/accel.h), which are then there like the others;
 * one that is loaded already is left as it is. Not while another thread calls anything of raytally. What is
 * built of them lives in a process of its own, a fork of the program: best before it has many threads.
 * RAYTALLY_BAD_INPUT, and nothing is loaded, where it is no plugin, of another version, or does not survive
 * being loaded. */
RAYTALLY_API raytally_status raytally_plugin_load(const char *path, raytally_error *error);

/** Builds the accelerator that `spec` describes, `NAME[:KEY=VALUE[,KEY=VALUE]...]`, overlays before it as in
 * `OVERLAY+NAME` (`raytally accels` lists all of them and their parameters). */
RAYTALLY_API raytally_status raytally_accelerator_build(const raytally_scene *scene, const char *spec,
                                                        int threads, raytally_accelerator **out,
                                                        raytally_error *error);

/** Frees an accelerator, of which no tracer is left. */
RAYTALLY_API void raytally_accelerator_free(raytally_accelerator *accelerator);

/** Its spec, with every parameter that is in effect. */
RAYTALLY_API const char *raytally_accelerator_spec(const raytally_accelerator *accelerator);

/** Whether its answers are those of `brute` bit for bit; if not, they are judged by verdicts. */
RAYTALLY_API bool raytally_accelerator_exact(const raytally_accelerator *accelerator);

/** To be asked after tracing, where no tracer traces: RAYTALLY_OK, or why what the accelerator answered is
 * not to be believed: RAYTALLY_BROKEN where it is a plugin's and has not survived its rays, which all miss
 * from then on. Functions that trace rays themselves ask it themselves. */
RAYTALLY_API raytally_status raytally_accelerator_check(const raytally_accelerator *accelerator,
                                                        raytally_error *error);

/** What a structure looks like, as places in raytally_structure.at. */
enum raytally_figure {
    RAYTALLY_INTERIOR,        /**< Inner nodes. */
    RAYTALLY_LEAVES,          /**< Leaves, or voxels. */
    RAYTALLY_EMPTY_LEAVES,    /**< Of them, those without an object. */
    RAYTALLY_REFERENCES,      /**< Entries in all lists of objects. */
    RAYTALLY_DEPTH,           /**< Of the deepest leaf, the root being 0. */
    RAYTALLY_BYTES,           /**< Of the structure, without the scene. */
    RAYTALLY_PREDICTED_COST,  /**< Expected cost of a random line in object tests; NaN where unknown. */
    RAYTALLY_PREDICTED_TESTS, /**< Expected object tests of a random line; NaN where unknown. */
    RAYTALLY_PREDICTED_STEPS, /**< Expected steps of a random line; NaN where unknown. */
    RAYTALLY_FIGURES_KNOWN,   /**< The number of figures there are. */
    RAYTALLY_FIGURES = 32     /**< The number there is room for, so that new ones change no layout. */
};

/** One value for each figure, 0 where it does not apply; those from RAYTALLY_FIGURES_KNOWN on are 0. */
typedef struct raytally_structure {
    double at[RAYTALLY_FIGURES]; /**< By ::raytally_figure; whole numbers up to 2^53 are exact. */
} raytally_structure;

/** Describes all layers together: sums, the largest depth, and what is predicted of the lowest. */
RAYTALLY_API void raytally_accelerator_describe(const raytally_accelerator *accelerator,
                                                raytally_structure *out);

/** @}
 * @name Tracing
 * @{ */

/** What one thread asks an accelerator through. */
typedef struct raytally_tracer raytally_tracer;

/** Whether `ray` is one: see raytally_ray. Tracers take rays that are, and do not look again. */
RAYTALLY_API bool raytally_ray_is_valid(const raytally_ray *ray);

/** Makes all that one thread's rays need: tracing allocates nothing and cannot fail (but see
 * raytally_accelerator_check). */
RAYTALLY_API raytally_status raytally_tracer_new(const raytally_accelerator *accelerator,
                                                 raytally_tracer **out, raytally_error *error);

/** Frees a tracer. */
RAYTALLY_API void raytally_tracer_free(raytally_tracer *tracer);

/** Forgets what the rays before have left behind (the last occluders of a shadow cache), so that the counts
 * of the rays that follow depend on these alone. Answers never depend on it. */
RAYTALLY_API void raytally_tracer_begin(raytally_tracer *tracer);

/** Finds the nearest hits of rays[0..count), which are valid, to hits[0..count). Where `counters` is not NULL
 * it is an array of RAYTALLY_MAX_RAY_KINDS, and what each ray costs is added to those of its kind; counting
 * is slower. */
RAYTALLY_API void raytally_nearest(raytally_tracer *tracer, const raytally_ray *rays, size_t count,
                                   raytally_hit *hits, raytally_counters *counters);

/** Finds whether anything lies on each of rays[0..count), which are valid, within [tmin, tmax], to
 * blocked[0..count). `counters` as for raytally_nearest. */
RAYTALLY_API void raytally_occluded(raytally_tracer *tracer, const raytally_ray *rays, size_t count,
                                    bool *blocked, raytally_counters *counters);

/** The name of a counter, "object_tests"; NULL where there is none of that number. */
RAYTALLY_API const char *raytally_counter_name(enum raytally_counter counter);

/** The name of a kind of rays, "primary"; NULL where there is none of that number. */
RAYTALLY_API const char *raytally_ray_kind_name(enum raytally_ray_kind kind);

/** @}
 * @name Rays
 * Rays of one kind, to be asked of every accelerator alike.
 * @{ */

/** An array of valid rays of one kind. */
typedef struct raytally_rays raytally_rays;

/** How rays are recorded. Initialise with RAYTALLY_RECORDING. */
typedef struct raytally_recording {
    size_t size;    /**< sizeof(raytally_recording). */
    uint32_t depth; /**< Levels of the ray tree, 1..64, the primary ray being the first. */
    int threads;    /**< See above. */
    uint64_t seed;  /**< Of diffuse and random rays. */
    uint64_t limit; /**< At most so many, 1..10^8: evenly spread runs of 256 neighbours of a larger set. */
} raytally_recording;

/** As `raytally bench` records them. */
#define RAYTALLY_RECORDING                                                                                   \
    { sizeof(raytally_recording), 5, 0, 1, 100000 }

/** Records the rays of one kind from a frame of the accelerator's scene, in the order in which it traces
 * them; of random rays, chords of the scene's bounding sphere, as many as the limit says. The accelerator,
 * an exact one, answers them on the way. A kind that the scene does not produce gives an empty array. `how`
 * may be NULL: RAYTALLY_RECORDING. The same rays on every machine, and those of `raytally bench`. */
RAYTALLY_API raytally_status raytally_rays_record(const raytally_accelerator *accelerator,
                                                  enum raytally_ray_kind kind, const raytally_recording *how,
                                                  raytally_rays **out, raytally_error *error);

/** Copies rays of the caller's own, each of which is checked and is of `kind` from then on. */
RAYTALLY_API raytally_status raytally_rays_copy(enum raytally_ray_kind kind, const raytally_ray *rays,
                                                size_t count, raytally_rays **out, raytally_error *error);

/** Frees rays. */
RAYTALLY_API void raytally_rays_free(raytally_rays *rays);

/** How many there are. */
RAYTALLY_API size_t raytally_rays_count(const raytally_rays *rays);

/** The array of them, valid as long as `rays`. */
RAYTALLY_API const raytally_ray *raytally_rays_data(const raytally_rays *rays);

/** A hash of them: equal rays, equal fingerprint, on every machine. */
RAYTALLY_API uint64_t raytally_rays_fingerprint(const raytally_rays *rays);

/** @}
 * @name Verifying
 * @{ */

/** What to verify by. Initialise with RAYTALLY_VERIFYING. */
typedef struct raytally_verifying {
    size_t size;                /**< sizeof(raytally_verifying). */
    uint64_t rays;              /**< How many, 1..20,000,000. Each is tested against every object. */
    uint64_t seed;              /**< Of the rays. */
    int threads;                /**< See above. */
    const raytally_rays *given; /**< These rays instead of all that, or NULL. */
} raytally_verifying;

/** As `raytally verify` does, by 10,000 rays: from the camera, chords, and those that are hard on
 * accelerators, as they graze, start and end on surfaces, run along axes and edges. */
#define RAYTALLY_VERIFYING                                                                                   \
    { sizeof(raytally_verifying), 10000, 1, 0, NULL }

/** What came of it, in rays. The verdicts sum up to `rays`. */
typedef struct raytally_verified {
    uint64_t rays;           /**< Each asked for the nearest and for any hit, when timed and when counted. */
    uint64_t equal;          /**< Answered as by `brute`: of an exact accelerator, bit for bit. */
    uint64_t tie;            /**< Another object at the same place; 0 of an exact accelerator. */
    uint64_t marginal;       /**< Explained by rounding; 0 of an exact accelerator. */
    uint64_t wrong;          /**< Anything else. */
    uint64_t occluded_wrong; /**< Whose answer to whether anything is hit is wrong; among all verdicts. */
    uint64_t reserved[10];   /**< 0. */
} raytally_verified;

/** Builds the accelerator that `spec` describes over `scene`, validates its structure, and compares its
 * answers with those of `brute`, which tests every object: by the rays of `raytally verify` for that number
 * and seed, however the image is sampled. Where one is wrong or the structure is broken: RAYTALLY_MISMATCH,
 * *error says which ray is the first, what was expected and what was answered, and *out is filled all the
 * same. `how` may be NULL: RAYTALLY_VERIFYING. */
RAYTALLY_API raytally_status raytally_verify(const raytally_scene *scene, const char *spec,
                                             const raytally_verifying *how, raytally_verified *out,
                                             raytally_error *error);

/** @}
 * @name Measuring
 * Counting and timing are separate passes over the same rays. Shadow and occlusion rays are asked for any
 * hit, all others for the nearest one.
 * @{ */

/** Counts what `rays` cost the accelerator: the same at any number of threads, and on every machine.
 * RAYTALLY_MISMATCH where an exact accelerator answers otherwise when it does not count. */
RAYTALLY_API raytally_status raytally_count(raytally_accelerator *accelerator, const raytally_rays *rays,
                                            int threads, raytally_counters *out, raytally_error *error);

/** A median of repeated measurements, and an interval that holds the true one, by order statistics. */
typedef struct raytally_estimate {
    double median;      /**< The middle of the measurements. */
    double low;         /**< Lower end of the interval. */
    double high;        /**< Upper end of the interval. */
    double least;       /**< The smallest measurement. */
    double coverage;    /**< Probability that the interval holds the median: at least 0.95 from 6 on. */
    double reserved[3]; /**< 0. */
} raytally_estimate;

/** The most measurements of one thing. */
#define RAYTALLY_MAX_ROUNDS 1000

/** Estimates the median of values[0..count), 1 <= count <= RAYTALLY_MAX_ROUNDS. */
RAYTALLY_API raytally_status raytally_estimate_median(const double *values, uint32_t count,
                                                      raytally_estimate *out, raytally_error *error);

/** Estimates the ratio over[i] / under[i] of measurements that were made in pairs, so that a drift of the
 * machine, which meets both, does not show. `count` as above. */
RAYTALLY_API raytally_status raytally_estimate_ratio(const double *over, const double *under, uint32_t count,
                                                     raytally_estimate *out, raytally_error *error);

/** How things are timed. Initialise with RAYTALLY_TIMING. */
typedef struct raytally_timing {
    size_t size;     /**< sizeof(raytally_timing). */
    uint32_t rounds; /**< 1..RAYTALLY_MAX_ROUNDS, after a warm-up; 6 at least for intervals of 95 %. */
    double least;    /**< Seconds that a round of one accelerator lasts at least, by repeating the rays. */
    int threads;     /**< See above. 1: by the thread's processor time; more: by the wall clock. */
    uint64_t seed;   /**< Of the order within rounds. */
} raytally_timing;

/** As `raytally bench` times. */
#define RAYTALLY_TIMING                                                                                      \
    { sizeof(raytally_timing), 10, 0.02, 1, 1 }

/** What an accelerator took. */
typedef struct raytally_time {
    raytally_estimate seconds; /**< Of a ray. */
    raytally_estimate ratio;   /**< Its throughput over that of the first accelerator, round by round. */
    double reserved[8];        /**< 0. */
} raytally_time;

/** Times accelerators[0..count) on the same rays, of which there is one at least, in interleaved rounds: each
 * round runs all of them once, in an order drawn anew. Ratios refer to accelerators[0]. To times[0..count).
 * `how` may be NULL: RAYTALLY_TIMING. */
RAYTALLY_API raytally_status raytally_time_all(raytally_accelerator *const *accelerators, size_t count,
                                               const raytally_rays *rays, const raytally_timing *how,
                                               raytally_time *times, raytally_error *error);

/** @}
 * @name Pictures
 * @{ */

/** Renders the image of the scene's camera through the accelerator under the standard illumination model,
 * `depth` levels deep (1..64; 0: 5, the default of the program): to the PNG file `png`, which is written
 * whole or not at all, and to `rgb`, [height][width][3] from the upper left, linear. Either may be NULL. */
RAYTALLY_API raytally_status raytally_render(const raytally_accelerator *accelerator, uint32_t depth,
                                             int threads, const char *png, float *rgb, raytally_error *error);

/** @} */

#ifdef __cplusplus
}
#endif

#endif
