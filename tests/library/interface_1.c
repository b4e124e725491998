/* SPDX-License-Identifier: Apache-2.0 */
/* A record of interface 1 (docs/interface.md) on 64-bit machines: it compiles only with headers that keep it.
 * Lines are added when the interface grows; the existing ones stay while its numbers do. Members that are
 * private or reserved are not recorded. */
#include <raytally/accel.h>
#include <raytally/raytally.h>

#define SAME_TYPE(thing, ...) __builtin_types_compatible_p(__typeof__(thing), __VA_ARGS__)

/* A constant; a number of entries, which may grow. */
#define VALUE(name, value) _Static_assert((name) == (value), #name " has another value")
#define COUNT(name, least) _Static_assert((name) >= (least), #name " is smaller")

/* A struct that keeps its size; one that may grow; a member: its offset and type. */
#define FIXED(Struct, bytes) _Static_assert(sizeof(Struct) == (bytes), #Struct " has another size")
#define GROWS(Struct, bytes) _Static_assert(sizeof(Struct) >= (bytes), #Struct " is smaller")
#define MEMBER(Struct, member, offset, ...)                                                                  \
    _Static_assert(offsetof(Struct, member) == (offset) && SAME_TYPE(((Struct *)0)->member, __VA_ARGS__),    \
                   #Struct "." #member " has moved or has another type")

#define FUNCTION(name, ...) _Static_assert(SAME_TYPE(name, __VA_ARGS__), #name " has another type")
#define CALLBACK(Type, ...) _Static_assert(SAME_TYPE((Type *)0, __VA_ARGS__), #Type " is another type")

/* ---- types.h ---- */

VALUE(RAYTALLY_NO_OBJECT, UINT32_MAX);

/* raytally_ray_kind */
VALUE(RAYTALLY_PRIMARY, 0);
VALUE(RAYTALLY_SHADOW, 1);
VALUE(RAYTALLY_REFLECTION, 2);
VALUE(RAYTALLY_TRANSMISSION, 3);
VALUE(RAYTALLY_DIFFUSE, 4);
VALUE(RAYTALLY_RANDOM, 5);
VALUE(RAYTALLY_OCCLUSION, 6);
COUNT(RAYTALLY_RAY_KINDS, 7);
VALUE(RAYTALLY_MAX_RAY_KINDS, 16);

FIXED(raytally_ray, 40);
MEMBER(raytally_ray, org, 0, float[3]);
MEMBER(raytally_ray, tmin, 12, float);
MEMBER(raytally_ray, dir, 16, float[3]);
MEMBER(raytally_ray, tmax, 28, float);
MEMBER(raytally_ray, kind, 32, uint32_t);
MEMBER(raytally_ray, source, 36, uint32_t);

FIXED(raytally_hit, 8);
MEMBER(raytally_hit, t, 0, float);
MEMBER(raytally_hit, object, 4, uint32_t);

/* raytally_counter */
VALUE(RAYTALLY_RAYS, 0);
VALUE(RAYTALLY_HITS, 1);
VALUE(RAYTALLY_OBJECT_TESTS, 2);
VALUE(RAYTALLY_OBJECT_HITS, 3);
VALUE(RAYTALLY_EXTENT_TESTS, 4);
VALUE(RAYTALLY_STEPS, 5);
VALUE(RAYTALLY_LEAF_STEPS, 6);
VALUE(RAYTALLY_EMPTY_STEPS, 7);
VALUE(RAYTALLY_CSG_TESTS, 8);
VALUE(RAYTALLY_REPEATS_AVOIDED, 9);
VALUE(RAYTALLY_PASSED_ON, 10);
COUNT(RAYTALLY_COUNTERS_KNOWN, 11);
VALUE(RAYTALLY_COUNTERS, 32);

FIXED(raytally_counters, 256);
MEMBER(raytally_counters, at, 0, uint64_t[RAYTALLY_COUNTERS]);

/* ---- box.h ---- */

FIXED(raytally_box, 24);
MEMBER(raytally_box, lo, 0, float[3]);
MEMBER(raytally_box, hi, 12, float[3]);

FIXED(raytally_prepared, 184);
MEMBER(raytally_prepared, tmin, 0, float);
MEMBER(raytally_prepared, tmax, 4, float);
MEMBER(raytally_prepared, org, 8, float[4]);
MEMBER(raytally_prepared, dir, 24, float[4]);
MEMBER(raytally_prepared, inv, 40, float[4]);
MEMBER(raytally_prepared, org_near, 56, float[4]);
MEMBER(raytally_prepared, org_far, 72, float[4]);
MEMBER(raytally_prepared, negative, 88, uint32_t[4]);
MEMBER(raytally_prepared, first, 104, uint32_t[4]);
MEMBER(raytally_prepared, last, 120, uint32_t[4]);
MEMBER(raytally_prepared, ray, 136, const raytally_ray *);
MEMBER(raytally_prepared, query, 144, struct raytally_query *);
MEMBER(raytally_prepared, crossings, 152, void *);
MEMBER(raytally_prepared, kx, 160, int32_t);
MEMBER(raytally_prepared, ky, 164, int32_t);
MEMBER(raytally_prepared, kz, 168, int32_t);
MEMBER(raytally_prepared, shear_x, 172, float);
MEMBER(raytally_prepared, shear_y, 176, float);

FUNCTION(raytally_box_side, float(const raytally_box *, uint32_t));
FUNCTION(raytally_box_hit, int(const raytally_box *, const raytally_prepared *, float, float *));
FUNCTION(raytally_tmax, float(const raytally_prepared *, const raytally_hit *));
FIXED(raytally_float4, 16);
FIXED(raytally_int4, 16);
FUNCTION(raytally_load4, raytally_float4(const void *));
FUNCTION(raytally_select4, raytally_float4(raytally_int4, raytally_float4, raytally_float4));
FUNCTION(raytally_min4, raytally_float4(raytally_float4, raytally_float4));
FUNCTION(raytally_max4, raytally_float4(raytally_float4, raytally_float4));
FUNCTION(raytally_abs4, raytally_float4(raytally_float4));
FUNCTION(raytally_rounded4, raytally_float4(raytally_float4));
FUNCTION(raytally_box_lo4, raytally_float4(const raytally_box *));
FUNCTION(raytally_box_hi4, raytally_float4(const raytally_box *));
FUNCTION(raytally_thickness4, float(raytally_float4, raytally_float4, raytally_float4));
FUNCTION(raytally_shift4, raytally_float4(float, raytally_float4, raytally_int4));
FUNCTION(raytally_thicken, void(raytally_float4, raytally_float4, const raytally_box *, float *, float *));
FUNCTION(raytally_prepare_in, void(raytally_prepared *, const raytally_ray *, const raytally_box *));

/* ---- hit.h ---- */

FUNCTION(raytally_rounded, double(double));
FUNCTION(raytally_root, double(double));
FUNCTION(raytally_bits4, uint32_t(raytally_int4));
FUNCTION(raytally_own_span4,
         void(raytally_float4, raytally_float4, const raytally_prepared *, float *, float *));
FUNCTION(raytally_admit4, int(raytally_float4, raytally_float4, const raytally_prepared *, float *));
FUNCTION(raytally_triangle_along, raytally_float4(const float *, size_t, size_t));
FUNCTION(raytally_triangle_vertex, raytally_float4(const float *, size_t));
FUNCTION(raytally_triangle_hit, int(const float *, size_t, size_t, const raytally_prepared *, float *));
FUNCTION(raytally_quadratic_roots, int(double, double, double, double, double *));
FUNCTION(raytally_dot, double(const double *, const double *));
FUNCTION(raytally_sphere_roots, int(const float *, const float *, const float *, double *));
FUNCTION(raytally_sphere_hit, int(const float *, const raytally_box *, const raytally_prepared *, float *));

/* ---- accel.h ---- */

VALUE(RAYTALLY_ACCEL_ABI, 1);
VALUE(RAYTALLY_MAX_PARAMS, 16);
VALUE(RAYTALLY_UNNAMED_OBJECT, UINT32_MAX - 1);

/* raytally_param_type */
VALUE(RAYTALLY_INT, 0);
VALUE(RAYTALLY_FLOAT, 1);
VALUE(RAYTALLY_CHOICE, 2);
VALUE(RAYTALLY_FLAG, 3);

FIXED(raytally_param, 72);
MEMBER(raytally_param, name, 0, const char *);
MEMBER(raytally_param, type, 8, uint32_t);
MEMBER(raytally_param, default_text, 16, const char *);
MEMBER(raytally_param, lo, 24, double);
MEMBER(raytally_param, hi, 32, double);
MEMBER(raytally_param, choices, 40, const char *);
MEMBER(raytally_param, test_values, 48, const char *);
MEMBER(raytally_param, meaning, 56, const char *);
MEMBER(raytally_param, source, 64, const char *);

FIXED(raytally_value, 8);
MEMBER(raytally_value, integer, 0, int64_t);
MEMBER(raytally_value, number, 0, double);
MEMBER(raytally_value, choice, 0, uint32_t);
MEMBER(raytally_value, flag, 0, uint32_t);

GROWS(raytally_host, 24);
MEMBER(raytally_host, abi, 0, uint32_t);
MEMBER(raytally_host, size, 4, uint32_t);
MEMBER(raytally_host, prepare, 8, void (*)(raytally_query *, const raytally_ray *, raytally_prepared *));
MEMBER(raytally_host, object_hits, 16,
       int (*)(const raytally_prepared *, const uint32_t *, uint32_t, int, raytally_hit *,
               raytally_counters *));
MEMBER(raytally_host, other_hit, 24, int (*)(const raytally_prepared *, uint32_t, float *));
MEMBER(raytally_host, nearest_below, 32,
       void (*)(raytally_query *, const raytally_ray *, size_t, raytally_hit *));
MEMBER(raytally_host, occluded_below, 40,
       void (*)(raytally_query *, const raytally_ray *, size_t, uint32_t *));
MEMBER(raytally_host, show, 48,
       void (*)(const raytally_prepared *, uint32_t, uint32_t, const raytally_box *));

GROWS(raytally_query, 8);
MEMBER(raytally_query, host, 0, const raytally_host *);
MEMBER(raytally_query, ray, 8, const raytally_ray *volatile);
MEMBER(raytally_query, crossings, 16, void *);
MEMBER(raytally_query, boxes, 24, const raytally_box *);
MEMBER(raytally_query, triangles, 32, const float *);
MEMBER(raytally_query, spheres, 40, const float *);
MEMBER(raytally_query, objects, 48, const uint32_t *);
MEMBER(raytally_query, object_count, 56, uint32_t);
MEMBER(raytally_query, box, 60, raytally_box);
VALUE(RAYTALLY_SHAPE_SPHERE, 0);
VALUE(RAYTALLY_SHAPE_TRIANGLE, 2);
VALUE(RAYTALLY_INDEX_BITS, 28);

/* raytally_build_result */
VALUE(RAYTALLY_BUILD_OK, 0);
VALUE(RAYTALLY_BUILD_REFUSED, 1);
VALUE(RAYTALLY_BUILD_NO_MEMORY, 2);

GROWS(raytally_build_input, 136);
MEMBER(raytally_build_input, size, 0, uint32_t);
MEMBER(raytally_build_input, object_count, 4, uint32_t);
MEMBER(raytally_build_input, boxes, 8, const raytally_box *);
MEMBER(raytally_build_input, box, 16, raytally_box);
MEMBER(raytally_build_input, values, 40, const raytally_value *);
MEMBER(raytally_build_input, threads, 48, int32_t);
MEMBER(raytally_build_input, byte_limit, 56, uint64_t);
MEMBER(raytally_build_input, message, 64, char *);
MEMBER(raytally_build_input, message_room, 72, size_t);
MEMBER(raytally_build_input, triangles, 80, const float *);
MEMBER(raytally_build_input, triangle_objects, 88, const uint32_t *);
MEMBER(raytally_build_input, spheres, 96, const float *);
MEMBER(raytally_build_input, sphere_objects, 104, const uint32_t *);
MEMBER(raytally_build_input, other_objects, 112, const uint32_t *);
MEMBER(raytally_build_input, triangle_count, 120, uint32_t);
MEMBER(raytally_build_input, sphere_count, 124, uint32_t);
MEMBER(raytally_build_input, other_count, 128, uint32_t);

FIXED(raytally_description, 128);
MEMBER(raytally_description, interior, 0, uint64_t);
MEMBER(raytally_description, leaves, 8, uint64_t);
MEMBER(raytally_description, empty_leaves, 16, uint64_t);
MEMBER(raytally_description, references, 24, uint64_t);
MEMBER(raytally_description, depth, 32, uint64_t);
MEMBER(raytally_description, bytes, 40, uint64_t);
MEMBER(raytally_description, predicted_cost, 48, double);
MEMBER(raytally_description, predicted_tests, 56, double);
MEMBER(raytally_description, predicted_steps, 64, double);

/* raytally_accel_flag */
VALUE(RAYTALLY_OWN_HITS, 1);
VALUE(RAYTALLY_NO_COUNTS, 2);
VALUE(RAYTALLY_OVERLAY, 4);
VALUE(RAYTALLY_ABSOLUTE_HITS, 8);

GROWS(raytally_accel_ops, 128);
MEMBER(raytally_accel_ops, abi, 0, uint32_t);
MEMBER(raytally_accel_ops, size, 4, uint32_t);
MEMBER(raytally_accel_ops, name, 8, const char *);
MEMBER(raytally_accel_ops, summary, 16, const char *);
MEMBER(raytally_accel_ops, paper, 24, const char *);
MEMBER(raytally_accel_ops, params, 32, const raytally_param *);
MEMBER(raytally_accel_ops, param_count, 40, uint32_t);
MEMBER(raytally_accel_ops, build, 48, int (*)(const raytally_build_input *, void **));
MEMBER(raytally_accel_ops, destroy, 56, void (*)(void *));
MEMBER(raytally_accel_ops, nearest, 64, raytally_nearest_kernel *);
MEMBER(raytally_accel_ops, occluded, 72, raytally_occluded_kernel *);
MEMBER(raytally_accel_ops, query_bytes, 80, size_t (*)(const void *));
MEMBER(raytally_accel_ops, begin, 88, void (*)(const void *, void *));
MEMBER(raytally_accel_ops, describe, 96, void (*)(const void *, raytally_description *));
MEMBER(raytally_accel_ops, validate, 104, int (*)(const void *, char *, size_t));
MEMBER(raytally_accel_ops, each_box, 112, void (*)(const void *, raytally_box_visitor *, void *));
MEMBER(raytally_accel_ops, flags, 120, uint64_t);

FUNCTION(raytally_object_hit, int(const raytally_prepared *, uint32_t, float *));
FUNCTION(raytally_prepare, void(raytally_query *, const raytally_ray *, raytally_prepared *));
FUNCTION(raytally_object_hits, int(const raytally_prepared *, const uint32_t *, uint32_t, int, raytally_hit *,
                                   raytally_counters *));
FUNCTION(raytally_show, void(const raytally_prepared *, uint32_t, uint32_t, const raytally_box *,
                             const raytally_counters *));
FUNCTION(raytally_nearest_below, void(raytally_query *, const raytally_ray *, size_t, raytally_hit *));
FUNCTION(raytally_occluded_below, void(raytally_query *, const raytally_ray *, size_t, uint32_t *));

CALLBACK(raytally_box_visitor, void (*)(void *, const raytally_box *, uint32_t, int));
CALLBACK(raytally_nearest_kernel, void (*)(const void *, void *, raytally_query *, const raytally_ray *,
                                           size_t, raytally_hit *, raytally_counters *));
CALLBACK(raytally_occluded_kernel, void (*)(const void *, void *, raytally_query *, const raytally_ray *,
                                            size_t, uint32_t *, raytally_counters *));
CALLBACK(raytally_plugin_function, const raytally_accel_ops *(*)(uint32_t));

/* ---- raytally.h ---- */

VALUE(RAYTALLY_ABI_VERSION, 1);
VALUE(RAYTALLY_SPEC_CHARS, 512);
VALUE(RAYTALLY_MAX_ROUNDS, 1000);

/* raytally_status */
VALUE(RAYTALLY_OK, 0);
VALUE(RAYTALLY_MISMATCH, 1);
VALUE(RAYTALLY_BROKEN, 2);
VALUE(RAYTALLY_BAD_INPUT, 3);
VALUE(RAYTALLY_NOT_AVAILABLE, 4);
VALUE(RAYTALLY_NO_MEMORY, 5);
VALUE(RAYTALLY_IO, 6);

FIXED(raytally_error, 1028);
MEMBER(raytally_error, status, 0, raytally_status);
MEMBER(raytally_error, message, 4, char[1024]);

GROWS(raytally_objects, 56);
MEMBER(raytally_objects, size, 0, size_t);
MEMBER(raytally_objects, vertices, 8, const float *);
MEMBER(raytally_objects, vertex_count, 16, uint32_t);
MEMBER(raytally_objects, corners, 24, const uint32_t *);
MEMBER(raytally_objects, triangle_count, 32, uint32_t);
MEMBER(raytally_objects, spheres, 40, const float *);
MEMBER(raytally_objects, sphere_count, 48, uint32_t);

FIXED(raytally_camera, 40);
MEMBER(raytally_camera, from, 0, float[3]);
MEMBER(raytally_camera, at, 12, float[3]);
MEMBER(raytally_camera, up, 24, float[3]);
MEMBER(raytally_camera, fov, 36, float);

/* raytally_statistic */
VALUE(RAYTALLY_INTERIOR, 0);
VALUE(RAYTALLY_LEAVES, 1);
VALUE(RAYTALLY_EMPTY_LEAVES, 2);
VALUE(RAYTALLY_REFERENCES, 3);
VALUE(RAYTALLY_DEPTH, 4);
VALUE(RAYTALLY_BYTES, 5);
VALUE(RAYTALLY_PREDICTED_COST, 6);
VALUE(RAYTALLY_PREDICTED_TESTS, 7);
VALUE(RAYTALLY_PREDICTED_STEPS, 8);
COUNT(RAYTALLY_STATISTICS_KNOWN, 9);
VALUE(RAYTALLY_STATISTICS, 32);

FIXED(raytally_statistics, 256);
MEMBER(raytally_statistics, at, 0, double[RAYTALLY_STATISTICS]);

GROWS(raytally_record_options, 32);
MEMBER(raytally_record_options, size, 0, size_t);
MEMBER(raytally_record_options, depth, 8, uint32_t);
MEMBER(raytally_record_options, threads, 12, int);
MEMBER(raytally_record_options, seed, 16, uint64_t);
MEMBER(raytally_record_options, limit, 24, uint64_t);

GROWS(raytally_verify_options, 40);
MEMBER(raytally_verify_options, size, 0, size_t);
MEMBER(raytally_verify_options, rays, 8, uint64_t);
MEMBER(raytally_verify_options, seed, 16, uint64_t);
MEMBER(raytally_verify_options, threads, 24, int);
MEMBER(raytally_verify_options, given, 32, const raytally_rays *);

FIXED(raytally_verify_result, 128);
MEMBER(raytally_verify_result, rays, 0, uint64_t);
MEMBER(raytally_verify_result, equal, 8, uint64_t);
MEMBER(raytally_verify_result, tie, 16, uint64_t);
MEMBER(raytally_verify_result, marginal, 24, uint64_t);
MEMBER(raytally_verify_result, wrong, 32, uint64_t);
MEMBER(raytally_verify_result, occluded_wrong, 40, uint64_t);
MEMBER(raytally_verify_result, certain, 48, uint64_t);
MEMBER(raytally_verify_result, must_hit, 56, uint64_t);
MEMBER(raytally_verify_result, certain_of, 64, uint64_t);

FIXED(raytally_estimate, 64);
MEMBER(raytally_estimate, median, 0, double);
MEMBER(raytally_estimate, low, 8, double);
MEMBER(raytally_estimate, high, 16, double);
MEMBER(raytally_estimate, least, 24, double);
MEMBER(raytally_estimate, coverage, 32, double);

GROWS(raytally_time_options, 40);
MEMBER(raytally_time_options, size, 0, size_t);
MEMBER(raytally_time_options, rounds, 8, uint32_t);
MEMBER(raytally_time_options, least, 16, double);
MEMBER(raytally_time_options, threads, 24, int);
MEMBER(raytally_time_options, seed, 32, uint64_t);

FIXED(raytally_time, 192);
MEMBER(raytally_time, seconds, 0, raytally_estimate);
MEMBER(raytally_time, ratio, 64, raytally_estimate);

FUNCTION(raytally_abi_version, int(void));
FUNCTION(raytally_version, const char *(void));
FUNCTION(raytally_scene_open, raytally_status(const char *, raytally_scene **, raytally_error *));
FUNCTION(raytally_scene_from_objects,
         raytally_status(const raytally_objects *, raytally_scene **, raytally_error *));
FUNCTION(raytally_scene_free, void(raytally_scene *));
FUNCTION(raytally_scene_object_count, uint32_t(const raytally_scene *));
FUNCTION(raytally_scene_bounds, void(const raytally_scene *, float *, float *));
FUNCTION(raytally_scene_set_camera,
         raytally_status(raytally_scene *, const raytally_camera *, raytally_error *));
FUNCTION(raytally_scene_set_sampling,
         raytally_status(raytally_scene *, uint32_t, uint32_t, uint32_t, raytally_error *));
FUNCTION(raytally_scene_size, void(const raytally_scene *, uint32_t *, uint32_t *));
FUNCTION(raytally_accelerator_count, size_t(void));
FUNCTION(raytally_accelerator_name, const char *(size_t));
FUNCTION(raytally_spec_format, raytally_status(const char *, char *, raytally_error *));
FUNCTION(raytally_plugin_load, raytally_status(const char *, raytally_error *));
FUNCTION(raytally_accelerator_build, raytally_status(const raytally_scene *, const char *, int,
                                                     raytally_accelerator **, raytally_error *));
FUNCTION(raytally_accelerator_free, void(raytally_accelerator *));
FUNCTION(raytally_accelerator_spec, const char *(const raytally_accelerator *));
FUNCTION(raytally_accelerator_exact, bool(const raytally_accelerator *));
FUNCTION(raytally_accelerator_check, raytally_status(const raytally_accelerator *, raytally_error *));
FUNCTION(raytally_accelerator_describe, void(const raytally_accelerator *, raytally_statistics *));
FUNCTION(raytally_ray_is_valid, bool(const raytally_ray *));
FUNCTION(raytally_tracer_new,
         raytally_status(const raytally_accelerator *, raytally_tracer **, raytally_error *));
FUNCTION(raytally_tracer_free, void(raytally_tracer *));
FUNCTION(raytally_tracer_begin, void(raytally_tracer *));
FUNCTION(raytally_nearest,
         void(raytally_tracer *, const raytally_ray *, size_t, raytally_hit *, raytally_counters *));
FUNCTION(raytally_occluded,
         void(raytally_tracer *, const raytally_ray *, size_t, bool *, raytally_counters *));
FUNCTION(raytally_counter_name, const char *(enum raytally_counter));
FUNCTION(raytally_ray_kind_name, const char *(enum raytally_ray_kind));
FUNCTION(raytally_rays_record,
         raytally_status(const raytally_accelerator *, enum raytally_ray_kind,
                         const raytally_record_options *, raytally_rays **, raytally_error *));
FUNCTION(raytally_rays_copy, raytally_status(enum raytally_ray_kind, const raytally_ray *, size_t,
                                             raytally_rays **, raytally_error *));
FUNCTION(raytally_rays_free, void(raytally_rays *));
FUNCTION(raytally_rays_count, size_t(const raytally_rays *));
FUNCTION(raytally_rays_data, const raytally_ray *(const raytally_rays *));
FUNCTION(raytally_rays_fingerprint, uint64_t(const raytally_rays *));
FUNCTION(raytally_verify,
         raytally_status(const raytally_scene *, const char *, const raytally_verify_options *,
                         raytally_verify_result *, raytally_error *));
FUNCTION(raytally_count, raytally_status(raytally_accelerator *, const raytally_rays *, int,
                                         raytally_counters *, raytally_error *));
FUNCTION(raytally_estimate_median,
         raytally_status(const double *, uint32_t, raytally_estimate *, raytally_error *));
FUNCTION(raytally_estimate_ratio,
         raytally_status(const double *, const double *, uint32_t, raytally_estimate *, raytally_error *));
FUNCTION(raytally_time_all,
         raytally_status(raytally_accelerator *const *, size_t, const raytally_rays *,
                         const raytally_time_options *, raytally_time *, raytally_error *));
FUNCTION(raytally_render, raytally_status(const raytally_accelerator *, uint32_t, int, const char *, float *,
                                          raytally_error *));
