/* Making the extents of `extents`, and checking that they hold their objects. Both ask the shapes alone: a
 * ball, a frame, and the support function, the farthest that an object reaches in a direction. All in double,
 * then inflated by more than that arithmetic can be wrong by. */
#include "accel/extents/extents.h"

#define THIRD 0.57735026918962576451
#define HALF  0.70710678118654752440
const RtVec3d rt_slab_normals[RT_MAX_SLABS] = {
    {1, 0, 0},
    {0, 1, 0},
    {0, 0, 1},
    {THIRD, THIRD, THIRD},
    {-THIRD, THIRD, THIRD},
    {THIRD, -THIRD, THIRD},
    {THIRD, THIRD, -THIRD},
    {HALF, HALF, 0},
    {HALF, -HALF, 0},
    {HALF, 0, HALF},
    {HALF, 0, -HALF},
    {0, HALF, HALF},
    {0, HALF, -HALF},
};

static const char *const kind_names[RT_EXTENT_KIND_COUNT] = {"box", "sphere", "oriented box", "set of slabs"};

/* ---- making ---- */

/* What rounding in double may cost an extent of an object in `box`: 2^-46 of its largest coordinate. */
static double inflation(const RtBox *box) {
    float most = 0;
    for (int a = 0; a < 3; a++) {
        most = rt_maxf(fabsf(box->lo.at[a]), most);
        most = rt_maxf(fabsf(box->hi.at[a]), most);
    }
    return 0x1p-46 * (double)most;
}

static RtVec3d opposite(RtVec3d a) {
    return rt_subd(rt_vec3d(0, 0, 0), a);
}

static RtBall make_ball(const RtGeometry *geometry, uint32_t id) {
    RtBall ball = rt_object_ball(geometry, id);
    ball.radius += inflation(&geometry->boxes[id]);
    return ball;
}

static RtOrientedBox make_oriented_box(const RtGeometry *geometry, uint32_t id) {
    RtOrientedBox box = {.center = {0, 0, 0}};
    rt_object_frame(geometry, id, box.axes);
    for (int a = 0; a < 3; a++) {
        double hi = rt_object_support(geometry, id, box.axes[a]);
        double lo = -rt_object_support(geometry, id, opposite(box.axes[a]));
        box.center = rt_add_scaledd(box.center, box.axes[a], 0.5 * (lo + hi));
        box.half[a] = 0.5 * (hi - lo) + inflation(&geometry->boxes[id]);
    }
    return box;
}

static RtSlab make_slab(const RtGeometry *geometry, uint32_t id, RtVec3d normal) {
    double more = inflation(&geometry->boxes[id]);
    double hi = rt_object_support(geometry, id, normal);
    double lo = -rt_object_support(geometry, id, opposite(normal));
    return (RtSlab){rt_float_below(lo - more), rt_float_above(hi + more)};
}

void rt_extents_fill(RtExtents *self) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        if (self->balls) self->balls[id] = make_ball(geometry, id);
        if (self->boxes) self->boxes[id] = make_oriented_box(geometry, id);
        if (!self->slabs) continue;
        RtSlab *slabs = self->slabs + (size_t)id * self->slabs_each;
        for (uint32_t i = 0; i < self->slabs_each; i++)
            slabs[i] = make_slab(geometry, id, rt_slab_normals[i]);
    }
}

/* ---- checking ---- */

/* How far the extent of object `id` reaches along `direction`, which is the normal of one of its faces: of a
 * box, any axis; of a sphere, any unit vector. */
static double extent_support(const RtExtents *self, uint32_t id, RtVec3d direction) {
    const RtBox *own = &self->base.scene->geometry.boxes[id];
    if (self->kind == RT_EXTENT_BOX) {
        double sum = 0;
        for (int a = 0; a < 3; a++) {
            sum += direction.at[a] * (double)(direction.at[a] < 0 ? own->lo.at[a] : own->hi.at[a]);
        }
        return sum;
    }
    if (self->kind == RT_EXTENT_SPHERE) {
        return rt_dotd(self->balls[id].center, direction) + self->balls[id].radius;
    }
    const RtOrientedBox *box = &self->boxes[id];
    double sum = rt_dotd(box->center, direction);
    for (int a = 0; a < 3; a++) sum += box->half[a] * fabs(rt_dotd(box->axes[a], direction));
    return sum;
}

static RtStatus too_small(const RtExtents *self, uint32_t id, RtVec3d direction, RtError *error) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    return rt_fail(error, RT_MISMATCH,
                   "extents: the %s of object %u (%s) does not contain it along (%g, %g, %g)",
                   kind_names[self->kind], id, rt_shape_name(rt_ref_shape(geometry->objects[id])),
                   direction.x, direction.y, direction.z);
}

/* Does the extent reach as far as its object? Up to the rounding of the two sums. */
static RtStatus check_reach(const RtExtents *self, uint32_t id, RtVec3d direction, RtError *error) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    double slack = 0.25 * inflation(&geometry->boxes[id]);
    const RtVec3d both[2] = {direction, opposite(direction)};
    for (int i = 0; i < 2; i++) {
        double reach = extent_support(self, id, both[i]) + slack;
        if (!(reach >= rt_object_support(geometry, id, both[i]))) return too_small(self, id, both[i], error);
    }
    return RT_OK;
}

static RtStatus check_slab(const RtExtents *self, uint32_t id, uint32_t i, RtError *error) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    const RtSlab *slab = &self->slabs[(size_t)id * self->slabs_each + i];
    RtVec3d up = rt_slab_normals[i], down = opposite(up);
    if (!((double)slab->hi >= rt_object_support(geometry, id, up))) return too_small(self, id, up, error);
    if (!(-(double)slab->lo >= rt_object_support(geometry, id, down)))
        return too_small(self, id, down, error);
    return RT_OK;
}

static RtStatus check_axes(const RtExtents *self, uint32_t id, RtError *error) {
    const RtVec3d *axes = self->boxes[id].axes;
    for (int a = 0; a < 3; a++) {
        int b = a == 2 ? 0 : a + 1;
        bool unit = fabs(rt_dotd(axes[a], axes[a]) - 1) <= 0x1p-48;
        if (unit && fabs(rt_dotd(axes[a], axes[b])) <= 0x1p-48) continue;
        return rt_fail(error, RT_MISMATCH,
                       "extents: the axes of the oriented box of object %u are not orthonormal", id);
    }
    return RT_OK;
}

static RtStatus check_extent(const RtExtents *self, uint32_t id, RtError *error) {
    if (self->kind == RT_EXTENT_OBB) RT_TRY(check_axes(self, id, error));
    uint32_t count = self->kind == RT_EXTENT_BOX     ? 3
                     : self->kind == RT_EXTENT_SLABS ? self->slabs_each
                                                     : RT_MAX_SLABS;
    for (uint32_t i = 0; i < count; i++) {
        if (self->kind == RT_EXTENT_SLABS)
            RT_TRY(check_slab(self, id, i, error));
        else
            RT_TRY(check_reach(self, id, rt_slab_normals[i], error));
    }
    for (int a = 0; a < 3 && self->kind == RT_EXTENT_OBB; a++) {
        RT_TRY(check_reach(self, id, self->boxes[id].axes[a], error));
    }
    return RT_OK;
}

RtStatus rt_extents_validate(const RtAccel *accel, RtError *error) {
    const RtExtents *self = (const RtExtents *)accel;
    for (uint32_t id = 0; id < accel->scene->geometry.object_count; id++)
        RT_TRY(check_extent(self, id, error));
    return RT_OK;
}
