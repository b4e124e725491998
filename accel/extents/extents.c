/* extents: one extent per object and no hierarchy. Every ray is tested against every extent, and against the
 * object only where it meets the extent (Weghorst, Hooper & Greenberg 1984: the cost is b B + i I).
 *
 * Exact for every kind. Boxes are, by the theorem in base/ray.h. There is none for spheres, oriented boxes
 * and slabs, so a ray is turned away by two tests that cannot be wrong:
 *
 * 1. Its *line* misses the extent widened by a pad, in double. Let m be the distance along an axis from the
 *    origin to the farthest corner of the scene's box, e = 2^-24. Triangles have the coarsest hit function: a
 *    sheared coordinate is off by at most (1 + 4 + 2) e m (difference, shear and product, sum), its signs are
 *    exact from there on, so a line said to hit passes within sqrt(2) 7 e m < 16 e m = 2^-20 m of the
 *    triangle. The other shapes compute in double; the worst, a ray by the tip of a cone, is off by the root
 *    of an ulp, 2^-25 m. The pad is 2^-18 m. What remains of it, 3 * 2^-20 m, is more than all rounding here:
 *    2^-50 m for positions relative to the origin and 2^-50 c for absolute ones, where c is a coordinate of
 *    the scene; c <= |org| + m, so another 2^-48 |org| is added for scenes that are a point. A direction's
 *    rounding moves the point of the hit by 2^-51 m at most, and can be seen as part of that. Extents are
 *    built in double and inflated by 2^-46 c (build.c), slabs then rounded outward to float32.
 * 2. The object's own box, along the ray's largest axis alone, begins beyond the best t or ends before tmin.
 *    A hit's t is brought into its own box, so the theorem holds. Where the line enters the extent says
 *    nothing: the t of a triangle seen edge-on may lie anywhere in its box. */
#include "accel/extents/extents.h"

#include "accel/kernel.h"
#include "base/memory.h"

extern const RtAccelOps rt_extents_ops;

/* ---- building ---- */

static size_t bytes_each(const RtExtents *self) {
    switch (self->kind) {
    case RT_EXTENT_SPHERE: return sizeof(RtBall);
    case RT_EXTENT_OBB: return sizeof(RtOrientedBox);
    case RT_EXTENT_SLABS: return self->slabs_each * sizeof(RtSlab);
    case RT_EXTENT_BOX:
    case RT_EXTENT_KIND_COUNT: break;
    }
    return 0;
}

static void destroy(RtAccel *accel) {
    RtExtents *self = (RtExtents *)accel;
    rt_free(self->balls);
    rt_free(self->boxes);
    rt_free(self->slabs);
    rt_free(self);
}

enum { PARAM_KIND, PARAM_SLABS, PARAM_COUNT };

static const RtParam params[PARAM_COUNT] = {
    {.name = "kind",
     .type = RT_PARAM_CHOICE,
     .standard = "box",
     .choices = "box|sphere|obb|slabs",
     .meaning = "the extent of an object: axis-aligned box, sphere, oriented box, or k slabs",
     .source = "the cheapest test"},
    {.name = "slabs",
     .type = RT_PARAM_INT,
     .standard = "7",
     .lo = 3,
     .hi = RT_MAX_SLABS,
     .meaning = "plane sets of kind=slabs: 3 axes, 4 diagonals of a cube, 6 of its faces, in this order",
     .source = "Kay & Kajiya 1986",
     .tries = "3|5|7|13"},
};

static RtStatus build(const RtScene *scene, const RtValue *values, RtAccel **out, RtError *error) {
    RtExtents *self = rt_alloc(1, sizeof(RtExtents));
    if (!self) return rt_fail_memory(error, "extents", sizeof(RtExtents));
    *self = (RtExtents){
        .base = {.ops = &rt_extents_ops, .scene = scene, .exact = true, .counts = true},
        .kind = (RtExtentKind)values[PARAM_KIND].choice,
        .slabs_each = (uint32_t)values[PARAM_SLABS].i,
    };
    if (self->kind != RT_EXTENT_BOX) {
        uint32_t count = scene->geometry.object_count;
        size_t each = bytes_each(self);
        void *block = rt_alloc(count, each);
        if (!block) {
            destroy(&self->base);
            return rt_fail_memory(error, "the extents of the objects", count * each);
        }
        if (self->kind == RT_EXTENT_SPHERE) self->balls = block;
        if (self->kind == RT_EXTENT_OBB) self->boxes = block;
        if (self->kind == RT_EXTENT_SLABS) self->slabs = block;
        rt_extents_fill(self);
    }
    *out = &self->base;
    return RT_OK;
}

/* ---- tracing ---- */

/* A ray as the line it lies on, in double, with what the tests of one kind need. */
typedef struct Line {
    RtVec3d org, dir;
    double pad;
    double dir_squared;           /* spheres */
    double along[RT_MAX_SLABS];   /* slabs: org . normal, ... */
    double inverse[RT_MAX_SLABS]; /* ... 1 / (dir . normal), possibly infinite */
} Line;

static inline double pad_of(RtVec3d org, const RtBox *scene_box) {
    double away = 0, most = 0;
    for (int a = 0; a < 3; a++) {
        double lo = fabs((double)scene_box->lo.at[a] - org.at[a]);
        double hi = fabs((double)scene_box->hi.at[a] - org.at[a]);
        double at = fabs(org.at[a]);
        away = lo > away ? lo : away;
        away = hi > away ? hi : away;
        most = at > most ? at : most;
    }
    return 0x1p-18 * away + 0x1p-48 * most;
}

static inline Line make_line(const RtExtents *self, RtExtentKind kind, const RtPreparedRay *ray) {
    Line line;
    line.org = rt_widen(ray->org);
    line.dir = rt_widen(ray->dir);
    line.pad = pad_of(line.org, &self->base.scene->geometry.box);
    if (kind == RT_EXTENT_SPHERE) line.dir_squared = rt_dotd(line.dir, line.dir);
    for (uint32_t i = 0; kind == RT_EXTENT_SLABS && i < self->slabs_each; i++) {
        line.along[i] = rt_dotd(line.org, rt_slab_normals[i]);
        line.inverse[i] = 1 / rt_dotd(line.dir, rt_slab_normals[i]);
    }
    return line;
}

/* The distance of the line from the centre is |offset x dir| / |dir|. */
static inline bool line_meets_ball(const Line *line, const RtBall *ball) {
    RtVec3d across = rt_crossd(rt_subd(ball->center, line->org), line->dir);
    double radius = ball->radius + line->pad;
    return !(rt_dotd(across, across) > radius * radius * line->dir_squared);
}

/* Separating axes of a line and a box: the line's direction crossed with each axis of the box. */
static inline bool line_meets_oriented_box(const Line *line, const RtOrientedBox *box) {
    RtVec3d offset = rt_subd(line->org, box->center);
    double at[3], d[3], half[3];
    for (int a = 0; a < 3; a++) {
        at[a] = rt_dotd(offset, box->axes[a]);
        d[a] = rt_dotd(line->dir, box->axes[a]);
        half[a] = box->half[a] + line->pad;
    }
    for (int a = 0; a < 3; a++) {
        int b = a == 2 ? 0 : a + 1;
        if (fabs(at[a] * d[b] - at[b] * d[a]) > half[a] * fabs(d[b]) + half[b] * fabs(d[a])) return false;
    }
    return true;
}

/* Where the line runs along a plane set its crossings are infinite, or NaN, which is passed over. */
static inline bool line_meets_slabs(const Line *line, const RtSlab *slabs, uint32_t count) {
    double near = -INFINITY, far = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        double lo = ((double)slabs[i].lo - line->pad - line->along[i]) * line->inverse[i];
        double hi = ((double)slabs[i].hi + line->pad - line->along[i]) * line->inverse[i];
        double first = signbit(line->inverse[i]) ? hi : lo;
        double second = signbit(line->inverse[i]) ? lo : hi;
        near = first > near ? first : near;
        far = second < far ? second : far;
        if (near > far) return false;
    }
    return true;
}

/* Can a hit on an object with box `own` lie in [ray->tmin, limit]? Asks the ray's largest axis only. */
static inline bool box_in_reach(const RtBox *own, const RtPreparedRay *ray, float limit) {
    int k = ray->kz;
    float near = ray->negative[k] ? own->hi.at[k] : own->lo.at[k];
    float far = ray->negative[k] ? own->lo.at[k] : own->hi.at[k];
    bool beyond = (near - ray->org_near[k]) * ray->inv[k] > limit;
    bool before = (far - ray->org_far[k]) * ray->inv[k] < ray->tmin;
    return !beyond && !before;
}

/* The extent test. `kind` is a constant where this is inlined. */
RT_KERNEL bool extent_hit(const RtExtents *self, RtExtentKind kind, uint32_t id, const RtPreparedRay *ray,
                          const Line *line, float limit) {
    const RtBox *own = &self->base.scene->geometry.boxes[id];
    float enter;
    if (kind == RT_EXTENT_BOX) return rt_box_hit(own, ray, limit, &enter);
    if (!box_in_reach(own, ray, limit)) return false;
    if (kind == RT_EXTENT_SPHERE) return line_meets_ball(line, &self->balls[id]);
    if (kind == RT_EXTENT_OBB) return line_meets_oriented_box(line, &self->boxes[id]);
    return line_meets_slabs(line, self->slabs + (size_t)id * self->slabs_each, self->slabs_each);
}

RT_KERNEL void scan(const RtExtents *self, RtExtentKind kind, const RtPreparedRay *ray, bool any, RtHit *best,
                    RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    Line line = make_line(self, kind, ray);
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        RT_COUNT(tally, steps, 1);
        RT_COUNT(tally, extent_tests, 1);
        if (!extent_hit(self, kind, id, ray, &line, rt_limit(ray, best))) continue;
        if (rt_test_object(geometry, id, ray, any, best, tally)) return;
    }
}

RT_KERNEL void search(const RtExtents *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    switch (self->kind) {
    case RT_EXTENT_BOX: scan(self, RT_EXTENT_BOX, ray, any, best, tally); break;
    case RT_EXTENT_SPHERE: scan(self, RT_EXTENT_SPHERE, ray, any, best, tally); break;
    case RT_EXTENT_OBB: scan(self, RT_EXTENT_OBB, ray, any, best, tally); break;
    case RT_EXTENT_SLABS: scan(self, RT_EXTENT_SLABS, ray, any, best, tally); break;
    case RT_EXTENT_KIND_COUNT: break;
    }
}

RT_DEFINE_KERNELS(RtExtents, search)

/* ---- looking at it ---- */

/* Half the surface of an extent; NaN for slabs, whose polytope is not worth the trouble. */
static double half_area(const RtExtents *self, uint32_t id) {
    switch (self->kind) {
    case RT_EXTENT_BOX: return rt_box_half_area(self->base.scene->geometry.boxes[id]);
    case RT_EXTENT_SPHERE:
        return 2 * 3.14159265358979323846 * self->balls[id].radius * self->balls[id].radius;
    case RT_EXTENT_OBB: {
        const double *half = self->boxes[id].half;
        return 4 * (half[0] * (half[1] + half[2]) + half[1] * half[2]);
    }
    case RT_EXTENT_SLABS:
    case RT_EXTENT_KIND_COUNT: break;
    }
    return NAN;
}

/* A line that meets a convex body meets a convex part of it with a probability of the ratio of their
 * surfaces: the sum over all extents is the expected number of object tests (too many where an extent sticks
 * out). */
static void describe(const RtAccel *accel, RtDescription *out) {
    const RtExtents *self = (const RtExtents *)accel;
    uint32_t count = accel->scene->geometry.object_count;
    double sum = 0, whole = rt_box_half_area(accel->scene->geometry.box);
    for (uint32_t id = 0; id < count; id++) sum += half_area(self, id);
    *out = (RtDescription){.references = count,
                           .bytes = count * bytes_each(self),
                           .predicted_cost = count == 0  ? 0
                                             : whole > 0 ? sum / whole
                                                         : NAN};
}

static void each_box(const RtAccel *accel, void (*draw)(void *context, const RtBox *box, uint32_t depth),
                     void *context) {
    const RtGeometry *geometry = &accel->scene->geometry;
    for (uint32_t id = 0; id < geometry->object_count; id++) draw(context, &geometry->boxes[id], 0);
}

const RtAccelOps rt_extents_ops = {
    .name = "extents",
    .summary = "every object's extent, and the object only where it is hit: no hierarchy",
    .paper = "Weghorst, Hooper & Greenberg 1984, Improved Computational Methods for Ray Tracing, TOG 3(1)",
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build,
    .destroy = destroy,
    .nearest = nearest_timed,
    .occluded = occluded_timed,
    .nearest_counted = nearest_counted,
    .occluded_counted = occluded_counted,
    .describe = describe,
    .validate = rt_extents_validate,
    .each_box = each_box,
};
