/* SPDX-License-Identifier: Apache-2.0 */
/* Embree's device and scene: building, describing and validating.
 *
 * The device is opened for one instruction set. It records errors instead of printing them, and counts the
 * bytes that it allocates. It ignores configuration files in the home or the program's folder, so the spec
 * alone determines its behaviour. */
#include "accel/embree/embree.h"

#include <stdatomic.h>
#include <stdio.h>

/* The choices of `isa`, in order, "default" first. */
#define ISAS "default|sse2|sse4.2|avx|avx2|avx512"

#define PARAMS(X)                                                                                            \
    X(PARAM_MODE, "mode", RT_CHOICE("native", "native|user"),                                                \
      "Embree's own triangles and spheres, or our hit functions in its hierarchy",                           \
      "native is the competitor")                                                                            \
    X(PARAM_QUALITY, "quality", RT_CHOICE("medium", "low|medium|high"),                                      \
      "build: Morton codes, binned SAH, SAH with spatial splits", "Embree's default")                        \
    X(PARAM_ISA, "isa", RT_CHOICE("default", ISAS),                                                          \
      "instruction set; default: the widest that the processor has", "Embree's default")                     \
    X(PARAM_ROBUST, "robust", RT_FLAG("off"),                                                                \
      "no ray passes between triangles that share an edge; user mode is exact either way",                   \
      "Embree's default")                                                                                    \
    X(PARAM_QUERY, "query", RT_CHOICE("1", "1|8|16|stream"),                                                 \
      "rays per call: one, a packet of 8 or 16, a stream (not in Embree 4)", "the most general one")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* ---- the device ---- */

enum { ISA_DEFAULT, ISA_SSE2, ISA_SSE42, ISA_AVX, ISA_AVX2, ISA_AVX512, ISA_COUNT };

static const char *const isa_names[ISA_COUNT] = {"default", "sse2", "sse4.2", "avx", "avx2", "avx512"};

/* Only the default is available on other processors than x86. */
static bool processor_has(uint32_t isa) {
    switch (isa) {
    case ISA_DEFAULT: return true;
#if defined(__x86_64__)
    case ISA_SSE2: return __builtin_cpu_supports("sse2");
    case ISA_SSE42: return __builtin_cpu_supports("sse4.2");
    case ISA_AVX: return __builtin_cpu_supports("avx");
    case ISA_AVX2: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512vl");
#endif
    default: return false;
    }
}

static RtStatus available(const RtValue *values, RtError *error) {
    const uint32_t isa = values[PARAM_ISA].choice;
    if (values[PARAM_QUERY].choice == RT_EMBREE_STREAM && !RT_EMBREE_STREAMS)
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "accelerator embree: Embree 4 has no streams; choose query=1, 8 or 16");
    if (processor_has(isa)) return RT_OK;
    return rt_fail(error, RT_NOT_AVAILABLE,
                   "accelerator embree: this processor has no %s; choose a smaller isa, or isa=default",
                   isa_names[isa]);
}

static void note_error(void *device, enum RTCError code, const char *message) {
    RtEmbreeDevice *d = device;
    int none = RTC_ERROR_NONE;
    if (!atomic_compare_exchange_strong(&d->code, &none, (int)code)) return;
    snprintf(d->message, sizeof d->message, "%s", message ? message : "no message");
}

static bool note_memory(void *device, ssize_t bytes, bool done) {
    (void)done;
    RtEmbreeDevice *d = device;
    atomic_fetch_add(&d->bytes, bytes);
    return true;
}

static RtStatus fail(int code, const char *message, RtError *error) {
    RtStatus status = code == RTC_ERROR_OUT_OF_MEMORY     ? RT_NO_MEMORY
                      : code == RTC_ERROR_UNSUPPORTED_CPU ? RT_NOT_AVAILABLE
                                                          : RT_MISMATCH;
    return rt_fail(error, status, "Embree reports error %d: %s", code, message);
}

/* Builds on `threads` threads (0 = all processors). */
static RtStatus open_device(uint32_t isa, int threads, RtEmbreeDevice **out, RtError *error) {
    char config[64];
    RtEmbreeDevice *device = rt_alloc(1, sizeof *device);
    if (!device) return rt_fail_memory(error, "Embree's device", sizeof *device);
    int length = snprintf(config, sizeof config, "ignore_config_files=1,threads=%d", threads);
    if (isa != ISA_DEFAULT)
        snprintf(config + length, sizeof config - (size_t)length, ",isa=%s", isa_names[isa]);
    *device = (RtEmbreeDevice){.device = rtcNewDevice(config), .isa = isa, .users = 1};
    if (!device->device) {
        rt_free(device);
        return fail((int)rtcGetDeviceError(NULL), "no device can be opened", error);
    }
    *out = device;
    rtcSetDeviceErrorFunction(device->device, note_error, device);
    rtcSetDeviceMemoryMonitorFunction(device->device, note_memory, device);
    return RT_OK;
}

static void close_device(RtEmbreeDevice *device) {
    if (!device || --device->users > 0) return;
    rtcReleaseDevice(device->device);
    rt_free(device);
}

/* The accelerator of the scene's first part, if it is built and uses Embree. */
static const RtEmbree *first_part(const RtAccel *accel, const RtBuild *what) {
    const RtAccel *part = what->parts ? what->parts[0] : NULL;
    return part && part->ops == accel->ops ? (const RtEmbree *)part : NULL;
}

/* The version at run time, and the instruction set of isa=default on this machine. */
static bool library(char *out, size_t size) {
    if (size > 0) out[0] = '\0';
    RtEmbreeDevice *device;
    if (open_device(ISA_DEFAULT, 0, &device, NULL) != RT_OK) return false;
    long version = (long)rtcGetDeviceProperty(device->device, RTC_DEVICE_PROPERTY_VERSION);
    uint32_t isa = ISA_COUNT - 1;
    while (isa > ISA_DEFAULT && !processor_has(isa)) isa--;
    snprintf(out, size, "%ld.%ld.%ld %s", version / 10000, version / 100 % 100, version % 100,
             isa_names[isa]);
    close_device(device);
    return true;
}

static RtStatus check(const RtAccel *accel, RtError *error) {
    const RtEmbreeDevice *device = ((const RtEmbree *)accel)->device;
    int code = atomic_load(&device->code);
    return code == RTC_ERROR_NONE ? RT_OK : fail(code, device->message, error);
}

/* ---- build ---- */

/* Embree asks for the box of each primitive: enlarged. */
static void bounds_of(const struct RTCBoundsFunctionArguments *arguments) {
    const RtEmbreeSlot *slot = arguments->geometryUserPtr;
    const RtBox *box = &slot->self->base.scene->geometry.boxes[slot->ids[arguments->primID]];
    double growth = (double)slot->self->growth;
    *arguments->bounds_o = (struct RTCBounds){
        .lower_x = rt_float_below((double)box->lo.x - growth),
        .lower_y = rt_float_below((double)box->lo.y - growth),
        .lower_z = rt_float_below((double)box->lo.z - growth),
        .upper_x = rt_float_above((double)box->hi.x + growth),
        .upper_y = rt_float_above((double)box->hi.y + growth),
        .upper_z = rt_float_above((double)box->hi.z + growth),
    };
}

/* Sets what follows from the reach: at least four times the size of the scene, or of a part 256 times, since
 * rays come from all over the scene, and twice the distance of the camera. */
static void set_reach(RtEmbree *self) {
    const RtScene *scene = self->base.scene;
    const RtBox *box = &scene->geometry.box;
    double size = fmax(rt_box_longest_side(*box), 0), magnitude = rt_box_largest_coordinate(*box);
    double camera = (double)rt_thickness(scene->camera.from, box) * 0x1p20;
    bool is_part = self->parts && scene->part_count == 0;
    double reach = fmax((is_part ? 256 : 4) * size, 2 * camera);
    self->max_thickness = rt_float_below(reach * 0x1p-20);
    self->growth = rt_float_above(reach * 0x1p-19 + magnitude * 0x1p-21 + 0x1p-100);
}

static void attach(RtEmbree *self, RTCGeometry geometry, RtShape shape, const uint32_t *ids, uint32_t count) {
    RtEmbreeSlot slot = {.self = self, .ids = ids, .first = ids[0], .consecutive = true};
    for (uint32_t i = 0; i < count; i++) slot.consecutive &= ids[i] == slot.first + i;
    self->slots[shape] = slot;
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(self->scene, geometry, shape);
    rtcReleaseGeometry(geometry);
}

static void attach_user(RtEmbree *self, RtShape shape, const uint32_t *ids, uint32_t count) {
    RTCGeometry geometry = rtcNewGeometry(self->device->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, count);
    rtcSetGeometryUserData(geometry, &self->slots[shape]);
    rtcSetGeometryBoundsFunction(geometry, bounds_of, NULL);
    rtcSetGeometryIntersectFunction(geometry, rt_embree_intersect);
    rtcSetGeometryOccludedFunction(geometry, rt_embree_occluded);
    attach(self, geometry, shape, ids, count);
}

/* Embree uses the scene's vertices. It reads 16 bytes of each, 4 beyond the end of the last one; a block of
 * rt_alloc is padded enough. */
static void attach_triangles(RtEmbree *self, enum RTCBuildQuality quality) {
    const RtGeometry *g = &self->base.scene->geometry;
    size_t count = (size_t)g->triangle_count * 3;
    self->indices = rt_arena_alloc(&self->base.memory, count, sizeof(uint32_t));
    if (!self->indices) return;
    for (size_t i = 0; i < count; i++) self->indices[i] = (uint32_t)i;
    RTCGeometry geometry = rtcNewGeometry(self->device->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, g->triangles, 0,
                               sizeof(RtVec3), count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, self->indices, 0,
                               3 * sizeof(uint32_t), g->triangle_count);
    attach(self, geometry, RT_SHAPE_TRIANGLE, g->triangle_ids, g->triangle_count);
}

_Static_assert(sizeof(RtSphere) == 4 * sizeof(float), "centre and radius, as Embree wants them");

static void attach_spheres(RtEmbree *self, enum RTCBuildQuality quality) {
    const RtGeometry *g = &self->base.scene->geometry;
    RTCGeometry geometry = rtcNewGeometry(self->device->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, g->spheres, 0,
                               sizeof(RtSphere), g->sphere_count);
    attach(self, geometry, RT_SHAPE_SPHERE, g->sphere_ids, g->sphere_count);
}

static void attach_instances(RtEmbree *self) {
    const RtGeometry *g = &self->base.scene->geometry;
    for (uint32_t i = 0; i < g->instance_count; i++) {
        const RtInstance *instance = &g->instances[i];
        float to_world[12];
        for (int k = 0; k < 12; k++) to_world[k] = (float)instance->to_world.m[k / 4][k % 4];
        RTCGeometry geometry = rtcNewGeometry(self->device->device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, ((const RtEmbree *)self->parts[instance->part])->scene);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, to_world);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(self->scene, geometry, RT_SHAPE_INSTANCE + i);
        rtcReleaseGeometry(geometry);
    }
}

static void attach_all(RtEmbree *self, enum RTCBuildQuality quality, bool own_instances) {
    const RtGeometry *g = &self->base.scene->geometry;
    bool own[RT_SHAPE_COUNT] = {false}; /* as Embree's own geometry */
    if (!self->user) {
        own[RT_SHAPE_TRIANGLE] = own[RT_SHAPE_SPHERE] = true;
        if (g->triangle_count > 0) attach_triangles(self, quality);
        if (g->sphere_count > 0) attach_spheres(self, quality);
        own[RT_SHAPE_INSTANCE] = own_instances;
        if (own_instances) attach_instances(self);
    }
#define ATTACH(CONSTANT, name, Type)                                                                         \
    if (!own[RT_SHAPE_##CONSTANT] && g->name##_count > 0) {                                                  \
        attach_user(self, RT_SHAPE_##CONSTANT, g->name##_ids, g->name##_count);                              \
    }
    RT_SHAPES(ATTACH)
#undef ATTACH
    self->slots[RT_SHAPE_INSTANCE].first = 0; /* the primitive id of a hit is that of the object */
}

/* Directions have components up to 2^16 (RT_EMBREE_LONG). In a wider scene their products with two edges may
 * overflow, t may become NaN, and a build of Embree with assertions, such as Debian's, ends the process. */
#define MOST_NATIVE_WIDTH 0x1p54f

static RtStatus check_width(const RtBox *box, double stretch, RtError *error) {
    const double most = (double)MOST_NATIVE_WIDTH / sqrt(fmax(stretch, 1));
    float width = 0;
    for (int a = 0; a < 3; a++) width = rt_maxf(width, box->hi.at[a] - box->lo.at[a]);
    if ((double)width <= most) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "embree: mode=native overflows float32 in a scene %g wide: %g would fit, or mode=user",
                   (double)width, most);
}

/* Embree's own instances are of one level, and stretch the directions of rays. */
static RtStatus check_instances(const RtGeometry *g, RtError *error) {
    if (g->nesting > 1) return rt_fail(error, RT_BAD_INPUT, "embree: instances in instances need mode=user");
    for (uint32_t i = 0; i < g->instance_count; i++) {
        const RtInstance *instance = &g->instances[i];
        double stretch = 0;
        for (int k = 0; k < 9; k++) stretch += fabs(instance->columns[k / 3][k % 3]);
        RT_TRY(check_width(&instance->geometry->box, stretch, error));
    }
    return RT_OK;
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    static const enum RTCBuildQuality qualities[] = {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM,
                                                     RTC_BUILD_QUALITY_HIGH};
    const RtValue *values = what->values;
    const uint32_t isa = values[PARAM_ISA].choice;
    enum RTCBuildQuality quality = qualities[values[PARAM_QUALITY].choice];
    RtEmbree *self = (RtEmbree *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    self->user = values[PARAM_MODE].choice == 1;
    self->query = (RtEmbreeQueryKind)values[PARAM_QUERY].choice;
    accel->exact = self->user;
    /* Without the flag its box test is one fused multiply-add of plane, 1 / dir and org / dir. */
    accel->absolute = !self->user && !values[PARAM_ROBUST].flag;
    accel->counts = false;
    rt_isa_use(accel, rt_embree_kernels);
    const RtEmbree *part = first_part(accel, what);
    const bool shares = part && part->device->isa == isa,
               own_instances = shares && !self->user && !part->user;
    if (!self->user) RT_TRY(check_width(&g->box, 1, error));
    if (own_instances) RT_TRY(check_instances(g, error));
    if (shares)
        (self->device = part->device)->users++;
    else
        RT_TRY(open_device(isa, what->threads, &self->device, error));
    const int64_t before = atomic_load(&self->device->bytes);
    self->parts = what->parts;
    set_reach(self);
    self->scene = rtcNewScene(self->device->device);
    rtcSetSceneFlags(self->scene, values[PARAM_ROBUST].flag ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(self->scene, quality);
    attach_all(self, quality, own_instances);
    RT_TRY(rt_arena_check(&accel->memory, "Embree's list of vertices", error));
    rtcCommitScene(self->scene);
    self->bytes = atomic_load(&self->device->bytes) - before;
    return check(accel, error);
}

static void destroy(RtAccel *accel) {
    RtEmbree *self = (RtEmbree *)accel;
    if (self->scene) rtcReleaseScene(self->scene);
    close_device(self->device);
}

/* ---- describe, validate ---- */

/* Bytes: what Embree has allocated, and our list of indices, which it needs; not the vertices, which belong
 * to the scene. */
static void describe(const RtAccel *accel, RtDescription *out) {
    const RtEmbree *self = (const RtEmbree *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    uint64_t indices = self->indices ? (uint64_t)g->triangle_count * 3 * sizeof(uint32_t) : 0;
    *out = (RtDescription){
        .references = g->object_count, .bytes = (uint64_t)self->bytes + indices, RT_NO_PREDICTION};
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtEmbree *self = (const RtEmbree *)accel;
    RT_TRY(check(accel, error));
    if (!self->user || accel->scene->geometry.object_count == 0) return RT_OK;
    struct RTCBounds bounds;
    rtcGetSceneBounds(self->scene, &bounds);
    RtBox all = {{bounds.lower_x, bounds.lower_y, bounds.lower_z},
                 {bounds.upper_x, bounds.upper_y, bounds.upper_z}};
    if (rt_box_contains(all, accel->scene->geometry.box)) return RT_OK;
    return rt_fail(error, RT_MISMATCH, "Embree's bounds do not contain the box of the scene");
}

/* The fastest setting depends on the scene and on the rays: packets for coherent rays, AVX2 on some machines
 * that have AVX-512. `robust` costs speed, so it is off. */
static const RtBestOf bests[] = {
    {"best", "query=1|8|16|stream,quality=medium|high,isa=avx2|avx512",
     "Embree's fastest setting for each scene and ray kind"},
    {"one", "query=1,quality=medium|high,isa=avx2|avx512", "its fastest setting for single rays"},
};

const RtAccelOps rt_embree_ops = {
    .name = "embree",
    .summary = "Intel's library: the competitor (mode=native) and a reference (mode=user)",
    .paper = "Wald, Woop, Benthin, Johnson & Ernst 2014, Embree: A Kernel Framework for Efficient CPU Ray "
             "Tracing, ACM TOG 33(4)",
    RT_PARAMS_OF(params),
    .bests = bests,
    .best_count = sizeof bests / sizeof bests[0],
    .available = available,
    .bytes = sizeof(RtEmbree),
    .build = build,
    .destroy = destroy,
    .describe = describe,
    .validate = validate,
    .library = library,
    .check = check,
};
