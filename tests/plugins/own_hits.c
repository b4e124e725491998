/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators with hit functions of their own: Möller & Trumbore 1997 for triangles, and the point of the
 * ray nearest to the centre for spheres. Their answers are right but not bit for bit. Everything that `build`
 * is told of the geometry is checked, and a scene refused if it is wrong. */
#include <raytally/accel.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- build ---- */

static void destroy(void *self) {
    free(self);
}

/* Marks the objects of a list in `seen`. Returns whether they are new, in the scene and ascending. */
static int mark(const raytally_build_input *from, const uint32_t *objects, uint32_t count,
                unsigned char *seen) {
    for (uint32_t i = 0; i < count; i++) {
        if (objects[i] >= from->object_count || (i > 0 && objects[i] <= objects[i - 1]) || seen[objects[i]]++)
            return 0;
    }
    return 1;
}

/* Whether the box of a triangle is the one that is given. */
static int is_boxed(const raytally_box *box, const float *v) {
    for (int a = 0; a < 3; a++) {
        if (fminf(fminf(v[a], v[3 + a]), v[6 + a]) != box->lo[a] ||
            fmaxf(fmaxf(v[a], v[3 + a]), v[6 + a]) != box->hi[a])
            return 0;
    }
    return 1;
}

/* Whether the box that is given touches a sphere all around, nearly. */
static int is_wrapped(const raytally_box *box, const float *sphere) {
    for (int a = 0; a < 3; a++) {
        float slack = 1e-5f * (fabsf(sphere[a]) + sphere[3]);
        if (fabsf(sphere[a] - sphere[3] - box->lo[a]) > slack ||
            fabsf(sphere[a] + sphere[3] - box->hi[a]) > slack)
            return 0;
    }
    return 1;
}

static int geometry_is_right(const raytally_build_input *from, unsigned char *seen) {
    if (from->triangle_count + from->sphere_count + from->other_count != from->object_count ||
        !mark(from, from->triangle_objects, from->triangle_count, seen) ||
        !mark(from, from->sphere_objects, from->sphere_count, seen) ||
        !mark(from, from->other_objects, from->other_count, seen))
        return 0;
    for (uint32_t i = 0; i < from->triangle_count; i++) {
        if (!is_boxed(&from->boxes[from->triangle_objects[i]], from->triangles + (size_t)9 * i)) return 0;
    }
    for (uint32_t i = 0; i < from->sphere_count; i++) {
        if (!is_wrapped(&from->boxes[from->sphere_objects[i]], from->spheres + (size_t)4 * i)) return 0;
    }
    return 1;
}

/* The structure is a copy of the input, whose arrays outlive it. */
static int build(const raytally_build_input *from, void **self) {
    raytally_build_input *copy = malloc(sizeof *copy);
    unsigned char *seen = calloc(from->object_count + (size_t)1, 1);
    int right = copy && seen && geometry_is_right(from, seen);
    free(seen);
    if (right) {
        *copy = *from;
        *self = copy;
        return RAYTALLY_BUILD_OK;
    }
    free(copy);
    snprintf(from->message, from->message_room, "the geometry of the scene is not as the header says");
    return RAYTALLY_BUILD_REFUSED;
}

/* ---- hit functions ---- */

typedef struct Vector {
    double at[3];
} Vector;

static Vector from_to(const float a[3], const float b[3]) {
    return (Vector){{(double)b[0] - a[0], (double)b[1] - a[1], (double)b[2] - a[2]}};
}

static Vector widen(const float a[3]) {
    return (Vector){{a[0], a[1], a[2]}};
}

static double dot(Vector a, Vector b) {
    return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}

static Vector cross(Vector a, Vector b) {
    return (Vector){{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
                     a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}

/* The t of a hit, or NaN, which no comparison lets through. Seen edge on, t would be anywhere. */
static double triangle_hit(const float *v, const raytally_prepared *ray) {
    Vector e1 = from_to(v, v + 3), e2 = from_to(v, v + 6), s = from_to(v, ray->org), dir = widen(ray->dir);
    Vector p = cross(dir, e2), q = cross(s, e1);
    double determinant = dot(e1, p), u = dot(s, p) / determinant, w = dot(dir, q) / determinant;
    double size = sqrt(dot(s, s) * dot(dir, dir)) * sqrt(fmax(dot(e1, e1), dot(e2, e2)));
    if (!(fabs(determinant) > 0x1p-40 * size)) return (double)NAN;
    return u >= 0 && w >= 0 && u + w <= 1 ? dot(e2, q) / determinant : (double)NAN;
}

static double sphere_hit(const float *sphere, const raytally_prepared *ray) {
    Vector from = from_to(sphere, ray->org), dir = widen(ray->dir), across;
    double radius = sphere[3], dd = dot(dir, dir), closest = -dot(from, dir) / dd;
    for (int i = 0; i < 3; i++) across.at[i] = from.at[i] + closest * dir.at[i];
    double half = sqrt((radius * radius - dot(across, across)) / dd);
    return closest - half >= ray->tmin ? closest - half : closest + half;
}

/* Half a unit in the last place farther, so that many answers differ by a bit. */
static void keep(double where, uint32_t object, const raytally_prepared *ray, raytally_hit *best) {
    const float t = (float)(where * (1 + 0x1p-24));
    if (t >= ray->tmin && t <= ray->tmax && (t < best->t || (t == best->t && object < best->object)))
        *best = (raytally_hit){t, object};
}

RAYTALLY_INLINE void search(const raytally_build_input *scene, void *memory, const raytally_prepared *ray,
                            int any, raytally_hit *best, raytally_counters *counters) {
    (void)memory;
    RAYTALLY_COUNT(counters, RAYTALLY_OBJECT_TESTS, scene->triangle_count + scene->sphere_count);
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        keep(triangle_hit(scene->triangles + (size_t)9 * i, ray), scene->triangle_objects[i], ray, best);
    for (uint32_t i = 0; i < scene->sphere_count; i++)
        keep(sphere_hit(scene->spheres + (size_t)4 * i, ray), scene->sphere_objects[i], ray, best);
    raytally_object_hits(ray, scene->other_objects, scene->other_count, any, best, counters);
}
RAYTALLY_DEFINE_KERNELS(raytally_build_input, search)

/* Counts nothing, and names no occluder. */
static void unnamed_occluded(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                             size_t count, uint32_t *occluders, raytally_counters *counters) {
    if (counters) abort();
    search_occluded(self, memory, query, rays, count, occluders, NULL);
    for (size_t i = 0; i < count; i++) {
        if (occluders[i] != RAYTALLY_NO_OBJECT) occluders[i] = RAYTALLY_UNNAMED_OBJECT;
    }
}

/* ---- the tables ---- */

#define OWN(text, what, of_occlusion, more)                                                                  \
    {                                                                                                        \
        .abi = RAYTALLY_ACCEL_ABI, .size = sizeof(raytally_accel_ops), .name = (text), .summary = (what),    \
        .paper = "Möller & Trumbore 1997", .build = build, .destroy = destroy, .nearest = search_nearest,    \
        .occluded = (of_occlusion), .flags = RAYTALLY_OWN_HITS | (more)                                      \
    }

RAYTALLY_PLUGIN {
    static const raytally_accel_ops tables[] = {
        OWN("own-hits", "all objects, by its own hit functions", search_occluded, 0),
        OWN("own-unnamed", "the same, without counts and names of occluders", unnamed_occluded,
            RAYTALLY_NO_COUNTS)};
    return index < sizeof tables / sizeof tables[0] ? &tables[index] : NULL;
}
