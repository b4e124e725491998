/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors: three float32 (RtVec3, for geometry and rays) or three doubles (RtVec3d, for arithmetic in hit
 * functions). Only + - * / sqrt, in the order written: with -ffp-contract=off every compiler returns the
 * same bits. */
#ifndef RT_BASE_VEC_H
#define RT_BASE_VEC_H

#include <math.h>
#include <stdbool.h>

/* By name or by axis: 0 = x, 1 = y, 2 = z. */
typedef union RtVec3 {
    struct {
        float x, y, z;
    };
    float at[3];
} RtVec3;

typedef union RtVec3d {
    struct {
        double x, y, z;
    };
    double at[3];
} RtVec3d;

static inline RtVec3 rt_vec3(float x, float y, float z) {
    return (RtVec3){x, y, z};
}

static inline RtVec3 rt_vec3_load(const float at[3]) {
    return (RtVec3){at[0], at[1], at[2]};
}

static inline RtVec3d rt_vec3d(double x, double y, double z) {
    return (RtVec3d){x, y, z};
}

/* float32 to double: exact. */
static inline RtVec3d rt_widen(RtVec3 a) {
    return (RtVec3d){(double)a.x, (double)a.y, (double)a.z};
}

/* double to float32: rounds to nearest. */
static inline RtVec3 rt_narrow(RtVec3d a) {
    return (RtVec3){(float)a.x, (float)a.y, (float)a.z};
}

static inline RtVec3 rt_add(RtVec3 a, RtVec3 b) {
    return (RtVec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline RtVec3 rt_sub(RtVec3 a, RtVec3 b) {
    return (RtVec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline RtVec3 rt_mul(RtVec3 a, RtVec3 b) {
    return (RtVec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline RtVec3 rt_scale(RtVec3 a, float s) {
    return (RtVec3){a.x * s, a.y * s, a.z * s};
}

static inline float rt_dot(RtVec3 a, RtVec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline RtVec3d rt_addd(RtVec3d a, RtVec3d b) {
    return (RtVec3d){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline RtVec3d rt_subd(RtVec3d a, RtVec3d b) {
    return (RtVec3d){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline RtVec3d rt_scaled(RtVec3d a, double s) {
    return (RtVec3d){a.x * s, a.y * s, a.z * s};
}

/* a + s * b */
static inline RtVec3d rt_add_scaledd(RtVec3d a, RtVec3d b, double s) {
    return (RtVec3d){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double rt_dotd(RtVec3d a, RtVec3d b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline RtVec3d rt_crossd(RtVec3d a, RtVec3d b) {
    return (RtVec3d){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* The normal of a triangle; its length is twice the area. */
static inline RtVec3d rt_area_vector(RtVec3d a, RtVec3d b, RtVec3d c) {
    return rt_crossd(rt_subd(b, a), rt_subd(c, a));
}

static inline double rt_lengthd(RtVec3d a) {
    return sqrt(rt_dotd(a, a));
}

/* a / |a|; the zero vector stays zero. */
static inline RtVec3d rt_normalized(RtVec3d a) {
    double length = rt_lengthd(a);
    return length > 0 ? rt_scaled(a, 1 / length) : a;
}

/* Clamps `value` to lo..hi; NaN stays NaN. */
static inline double rt_clampd(double value, double lo, double hi) {
    return value < lo ? lo : value > hi ? hi : value;
}

/* No infinity and no NaN in any component. */
static inline bool rt_finite(RtVec3 a) {
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/* The axis along which |a| is largest; the lower axis wins a tie. */
static inline int rt_major_axis(RtVec3 a) {
    /* Branch-free: the outcome is unpredictable. */
    float x = fabsf(a.x), y = fabsf(a.y), z = fabsf(a.z);
    int is_z = (z > x) & (z > y);
    return 2 * is_z | ((y > x) & !is_z);
}

/* 1, 2, 0 for 0, 1, 2, without a branch. */
static inline int rt_next_axis(int axis) {
    return 9 >> 2 * axis & 3;
}

#endif
