/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators that are broken on purpose, each by one known pitfall, and their correct counterparts. They
 * are tiny and slow, and can be built over any scene: a flat list of boxes, a grid of 3 x 3 x 3 voxels
 * visited in the order of the ray, object lists for the octants around a light. */
#ifndef RT_TESTS_MUTANTS_H
#define RT_TESTS_MUTANTS_H

#include "accel/kernel.h"

#include <stdlib.h>
#include <string.h>

/* X(CONSTANT, name, what is wrong): */
#define MUTANTS(X)                                                                                           \
    X(UNPADDED_BOX, "unpadded-boxes", "boxes are tested by the bare ray, the thickness left out")            \
    X(EARLY_EXIT, "early-exit", "the grid stops at the first hit, though it lies beyond the voxel")          \
    X(PRUNED_TIE, "pruned-ties", "a box entered at the best t is skipped: >= instead of >")                  \
    X(DEPTH_BUFFER, "z-buffer-nearest", "the nearest by depth of 24 bits, not by t")                         \
    X(PARTIAL_OCCLUDER, "partial-occluder", "what lies behind an object is culled, though it leaks past it") \
    X(ABSOLUTE_EPSILON, "absolute-epsilon", "Moeller and Trumbore's determinant below 1e-6 is parallel")     \
    X(IGNORED_START, "ignored-start", "any hit from t = 0 on, not from tmin; judged by verdicts")

typedef enum MutantKind {
#define MUTANT_ENUM(CONSTANT, name, what) CONSTANT,
    MUTANTS(MUTANT_ENUM)
#undef MUTANT_ENUM
        MUTANT_COUNT
} MutantKind;

typedef struct Mutant {
    RtAccel base;
    MutantKind kind;
    bool broken; /* false: the control */
} Mutant;

/* ---- boxes ---- */

static bool box_is_skipped(const Mutant *m, const RtBox *box, const RtPreparedRay *ray, float limit) {
    MutantKind kind = m->kind;
    float enter;
    if (kind == UNPADDED_BOX && m->broken) {
        RtPreparedRay bare = *ray;
        memcpy(bare.org_near, ray->org, sizeof bare.org_near);
        memcpy(bare.org_far, ray->org, sizeof bare.org_far);
        return !rt_box_hit(box, &bare, limit, &enter);
    }
    if (!rt_box_hit(box, ray, limit, &enter)) return true;
    return kind == PRUNED_TIE && m->broken && enter >= limit;
}

/* From the last object to the first, so that of two at the same t the one tested later counts. */
static void search_boxes(const Mutant *m, const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    const RtGeometry *g = &m->base.scene->geometry;
    for (uint32_t id = g->object_count; id-- > 0;) {
        if (box_is_skipped(m, &g->boxes[id], ray, rt_limit(ray, best))) continue;
        if (rt_test_object(g, id, ray, any, best, tally)) return;
    }
}

/* ---- a grid ---- */

enum { SIDE = 3, VOXELS = SIDE * SIDE * SIDE };

typedef struct Entry {
    float enter;
    int voxel;
} Entry;

static int compare_entries(const void *a, const void *b) {
    const Entry *x = a, *y = b;
    return x->enter != y->enter ? (x->enter > y->enter) - (x->enter < y->enter) : x->voxel - y->voxel;
}

static RtBox voxel_box(const RtBox *around, int voxel) {
    const int place[3] = {voxel % SIDE, voxel / SIDE % SIDE, voxel / SIDE / SIDE};
    RtBox box = *around;
    for (int a = 0; a < 3; a++) {
        double lo = (double)around->lo.at[a], size = (double)around->hi.at[a] - lo;
        if (place[a] > 0) box.lo.at[a] = (float)(lo + size * place[a] / SIDE);
        if (place[a] < SIDE - 1) box.hi.at[a] = (float)(lo + size * (place[a] + 1) / SIDE);
    }
    return box;
}

static bool boxes_meet(const RtBox *a, const RtBox *b) {
    for (int i = 0; i < 3; i++) {
        if (a->lo.at[i] > b->hi.at[i] || b->lo.at[i] > a->hi.at[i]) return false;
    }
    return true;
}

static void search_grid(const Mutant *m, const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    const RtGeometry *g = &m->base.scene->geometry;
    Entry entries[VOXELS];
    size_t count = 0;
    if (g->object_count == 0) return;
    for (int v = 0; v < VOXELS; v++) {
        RtBox box = voxel_box(&g->box, v);
        if (rt_box_hit(&box, ray, ray->tmax, &entries[count].enter)) entries[count++].voxel = v;
    }
    qsort(entries, count, sizeof *entries, compare_entries);
    for (size_t i = 0; i < count && entries[i].enter <= rt_limit(ray, best); i++) {
        RtBox box = voxel_box(&g->box, entries[i].voxel);
        for (uint32_t id = 0; id < g->object_count; id++) {
            if (boxes_meet(&box, &g->boxes[id]) && rt_test_object(g, id, ray, any, best, tally)) return;
        }
        if (m->broken && best->object != RT_NO_OBJECT) return;
    }
}

/* ---- a z-buffer ---- */

static void search_depths(const Mutant *m, const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    const RtGeometry *g = &m->base.scene->geometry;
    double least = HUGE_VAL, unit = (double)rt_thickness(rt_vec3_load(ray->org), &g->box) * 0x1p20 * 0x1p-24;
    if (any || !m->broken) {
        rt_test_all(g, ray, any, best, tally);
        return;
    }
    for (uint32_t id = 0; id < g->object_count; id++) {
        float t;
        if (!rt_object_hit(g, id, ray, &t, tally)) continue;
        double depth = floor((double)t * fabs((double)ray->dir[ray->kz]) / unit);
        if (depth >= least) continue;
        least = depth;
        *best = (RtHit){t, id};
    }
}

/* ---- a light buffer ---- */

/* The octants around the light that a box, grown by a margin, has a part in. */
static unsigned octants_of(const RtBox *box, RtVec3 light) {
    unsigned octants = 0xff;
    for (int a = 0; a < 3; a++) {
        static const unsigned upper[3] = {0xaa, 0xcc, 0xf0};
        double lo = (double)box->lo.at[a] - (double)light.at[a],
               hi = (double)box->hi.at[a] - (double)light.at[a];
        double margin = 0x1p-16 * fmax(fabs((double)light.at[a]), fmax(fabs(lo), fabs(hi)));
        if (lo > margin) octants &= upper[a];
        if (hi < -margin) octants &= ~upper[a];
    }
    return octants;
}

/* Least and greatest distance of a box from a point. */
static void distances_of(const RtBox *box, RtVec3 p, double *least, double *greatest) {
    double near2 = 0, far2 = 0;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a] - (double)p.at[a], hi = (double)box->hi.at[a] - (double)p.at[a];
        double near = fmax(fmax(lo, -hi), 0), far = fmax(fabs(lo), fabs(hi));
        near2 += near * near;
        far2 += far * far;
    }
    *least = sqrt(near2);
    *greatest = sqrt(far2);
}

/* Does another object of one of these octants lie before `id` altogether? It covers none of them, ever. */
static bool lies_behind(const RtGeometry *g, uint32_t id, RtVec3 light, unsigned octants) {
    double least, greatest, front, back;
    distances_of(&g->boxes[id], light, &least, &greatest);
    for (uint32_t other = 0; other < g->object_count; other++) {
        if (other == id || !(octants_of(&g->boxes[other], light) & octants)) continue;
        distances_of(&g->boxes[other], light, &front, &back);
        if (back < least) return true;
    }
    return false;
}

static void search_light(const Mutant *m, const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    const RtScene *scene = m->base.scene;
    const RtRay *asked = (const RtRay *)ray->ray;
    bool known = any && asked->kind == RT_RAY_SHADOW && asked->source < scene->light_count && ray->tmax <= 1;
    RtVec3 light = known ? scene->lights[asked->source].position : rt_vec3(0, 0, 0);
    RtVec3 org = rt_vec3_load(ray->org), to = rt_sub(light, org);
    if (!known || memcmp(&to, ray->dir, sizeof to) != 0) {
        rt_test_all(&scene->geometry, ray, any, best, tally);
        return;
    }
    const RtBox origin = {org, org};
    unsigned cells = octants_of(&origin, light);
    for (uint32_t id = 0; id < scene->geometry.object_count; id++) {
        unsigned shared = octants_of(&scene->geometry.boxes[id], light) & cells;
        if (!shared || (m->broken && lies_behind(&scene->geometry, id, light, shared))) continue;
        if (rt_test_object(&scene->geometry, id, ray, any, best, tally)) return;
    }
}

/* ---- triangles ---- */

/* The divisor of Moeller & Trumbore 1997. */
static double determinant(const RtTriangle *triangle, const RtPreparedRay *ray) {
    RtVec3d a = rt_widen(triangle->v[0]);
    RtVec3d u = rt_subd(rt_widen(triangle->v[1]), a), v = rt_subd(rt_widen(triangle->v[2]), a);
    return rt_dotd(u, rt_crossd(rt_widen(rt_vec3_load(ray->dir)), v));
}

static void search_triangles(const Mutant *m, const RtPreparedRay *ray, bool any, RtHit *best,
                             RtTally *tally) {
    const RtGeometry *g = &m->base.scene->geometry;
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (m->broken && rt_ref_shape(g->objects[id]) == RT_SHAPE_TRIANGLE &&
            fabs(determinant(&g->triangles[rt_ref_index(g->objects[id])], ray)) < 1e-6) {
            continue;
        }
        if (rt_test_object(g, id, ray, any, best, tally)) return;
    }
}

/* ---- intervals ---- */

static void search_all(const Mutant *m, const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    RtPreparedRay whole = *ray;
    if (any && m->broken) whole.tmin = 0;
    rt_test_all(&m->base.scene->geometry, &whole, any, best, tally);
}

/* ---- the accelerator ---- */

static void search(const Mutant *m, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                   RtTally *tally) {
    (void)scratch;
    switch (m->kind) {
    case UNPADDED_BOX:
    case PRUNED_TIE: search_boxes(m, ray, any, best, tally); break;
    case EARLY_EXIT: search_grid(m, ray, any, best, tally); break;
    case DEPTH_BUFFER: search_depths(m, ray, any, best, tally); break;
    case PARTIAL_OCCLUDER: search_light(m, ray, any, best, tally); break;
    case ABSOLUTE_EPSILON: search_triangles(m, ray, any, best, tally); break;
    case IGNORED_START: search_all(m, ray, any, best, tally); break;
    case MUTANT_COUNT: break;
    }
}

RT_DEFINE_KERNELS(Mutant, search)

/* The accelerators "mutant:kind=early-exit", with "broken=off" the control. */
static const RtParam mutant_params[] = {
#define MUTANT_CHOICE(CONSTANT, name, what) "|" name
    {"kind", RT_CHOICE("unpadded-boxes", &MUTANTS(MUTANT_CHOICE)[1]), "the fault", ""},
#undef MUTANT_CHOICE
    {"broken", RT_FLAG("on"), "whether it has the fault", ""},
};

static RtStatus build_mutant(RtAccel *accel, const RtBuild *what, RtError *error) {
    (void)error;
    Mutant *mutant = (Mutant *)accel;
    mutant->kind = (MutantKind)what->values[0].choice;
    mutant->broken = what->values[1].flag;
    accel->exact = mutant->kind != IGNORED_START;
    return RT_OK;
}

static const RtAccelOps mutant_ops = {
    .name = "mutant",
    .bytes = sizeof(Mutant),
    RT_PARAMS_OF(mutant_params),
    .build = build_mutant,
    .kernels = &kernels,
};

#define UNPADDED "mutant:kind=unpadded-boxes"
#define PADDED   "mutant:kind=unpadded-boxes,broken=off"

#endif
