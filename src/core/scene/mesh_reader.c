/* SPDX-License-Identifier: Apache-2.0 */
/* Polygons are split into a fan around their first corner if it sees all others, else by cutting off ears
 * (Meisters 1975): corners whose triangle is inside the polygon. What is left of a polygon that crosses
 * itself becomes a fan, with a warning. */
#include "core/scene/mesh.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

RtStatus rt_mesh_fail_short(const RtMeshReader *r, uint64_t count, uint64_t declared, const char *things) {
    return rt_mesh_fail(r, "the file ends after %" PRIu64 " of the %" PRIu64 " %s that its header declares",
                        count, declared, things);
}

/* ---- vertices ---- */

RtStatus rt_mesh_add_vertex(RtMeshReader *r, RtVec3d place) {
    const RtVec3 vertex = rt_narrow(rt_transform_pointd(&r->transform, place));
    if (!rt_finite(vertex))
        RT_TRY(rt_mesh_warn(r,
                            "vertex %u (counted from 0) is not finite, or beyond float32: no face may use it",
                            r->vertex_count));
    return rt_append(&r->vertices, &r->vertex_count, &r->vertex_capacity, &vertex, sizeof vertex,
                     r->text.error);
}

RtStatus rt_mesh_add_normal(RtMeshReader *r, RtVec3 normal) {
    if (!rt_finite(normal)) RT_TRY(rt_mesh_warn(r, "a normal is not finite: its triangles go without"));
    normal = rt_transform_normal(&r->transform, normal);
    return rt_append(&r->normals, &r->normal_count, &r->normal_capacity, &normal, sizeof normal,
                     r->text.error);
}

RtStatus rt_mesh_add_uv(RtMeshReader *r, RtUv uv) {
    if (!r->textured) return RT_OK;
    if (!isfinite(uv.u) || !isfinite(uv.v))
        RT_TRY(rt_mesh_warn(r, "texture coordinates are not finite: their triangles go without"));
    return rt_append(&r->uvs, &r->uv_count, &r->uv_capacity, &uv, sizeof uv, r->text.error);
}

RtStatus rt_mesh_add_corner(RtMeshReader *r, RtMeshCorner corner) {
    if (!rt_finite(r->vertices[corner.vertex]))
        return rt_mesh_fail(
            r, "face %u uses vertex %u, which is not finite, or beyond float32 (both counted from 0)",
            r->face_count, corner.vertex);
    return rt_append(&r->corners, &r->corner_count, &r->corner_capacity, &corner, sizeof corner,
                     r->text.error);
}

RtStatus rt_mesh_add_index(RtMeshReader *r, double index) {
    if (!(index >= 0 && index < r->vertex_count && index == floor(index)))
        return rt_mesh_fail(r, "face %u names vertex %.15g, but there are %u vertices (all counted from 0)",
                            r->face_count, index, r->vertex_count);
    const uint32_t vertex = (uint32_t)index;
    const RtMeshCorner corner = {vertex, r->normal_count ? vertex : RT_MESH_NONE,
                                 r->uv_count ? vertex : RT_MESH_NONE};
    return rt_mesh_add_corner(r, corner);
}

/* ---- polygons ---- */

static RtStatus add_triangle(RtMeshReader *r, const RtMeshCorner corners[3]) {
    RtVec3 vertices[3], normals[3];
    const bool mirror = rt_transform_mirrors(&r->transform);
    bool has_normals = true;
    RtUv uv[3];
    for (int i = 0; i < 3; i++) {
        const RtMeshCorner corner = corners[mirror ? 2 - i : i];
        vertices[i] = r->vertices[corner.vertex];
        uv[i] = corner.uv < r->uv_count ? r->uvs[corner.uv] : (RtUv){NAN, NAN};
        has_normals = has_normals && corner.normal != RT_MESH_NONE;
        if (!has_normals) continue;
        normals[i] = r->normals[corner.normal];
        has_normals = rt_finite(normals[i]) && rt_lengthd(rt_widen(normals[i])) > 0;
    }
    const RtStatus status =
        rt_scene_add_triangle(r->scene, r->material, vertices, has_normals ? normals : NULL, r->text.error);
    if (status == RT_OK && r->textured) return rt_scene_set_triangle_texture(r->scene, uv, r->text.error);
    if (status == RT_OK) return RT_OK;
    char face[48];
    snprintf(face, sizeof face, "face %u (counted from 0): ", r->face_count);
    return rt_scan_place(&r->text, status, r->text.last, face);
}

static RtVec3d vertex_of(const RtMeshReader *r, uint32_t corner) {
    return rt_widen(r->vertices[r->corners[corner].vertex]);
}

/* Twice the area of a triangle of three corners, as a vector. */
static RtVec3d twice_area(const RtMeshReader *r, uint32_t a, uint32_t b, uint32_t c) {
    return rt_area_vector(vertex_of(r, a), vertex_of(r, b), vertex_of(r, c));
}

/* Whether no triangle of the fan around the first corner has the wrong orientation; all have no area if the
 * whole has none. */
static bool first_sees_all(const RtMeshReader *r, RtVec3d whole) {
    const bool flat = rt_dotd(whole, whole) == 0;
    for (uint32_t i = 1; i + 1 < r->corner_count; i++) {
        const RtVec3d area = twice_area(r, 0, i, i + 1);
        if (flat ? rt_dotd(area, area) > 0 : rt_dotd(whole, area) < 0) return false;
    }
    return true;
}

/* ---- concave polygons ----
 *
 * Ears are looked for in the projection along the largest axis of the polygon's area, whose coordinates are
 * exact. Only a corner that is not convex can lie in an ear; those are in a grid, so that an ear is compared
 * with the few near it. A corner waits in a queue while its neighbours have changed since it was tried. */

#define NONE UINT32_MAX
#define FLAT 1e-6 /* of the polygon's area: a triangle that may be cut off though it is no ear */

typedef struct Corner {
    double x, y;
    uint32_t before, after; /* the polygon that is left, a ring */
    uint32_t next;          /* in the same voxel; NONE */
    bool waits, held;       /* in the queue; in a voxel */
} Corner;

typedef struct Cutter {
    Corner *corners;  /* [count] */
    uint32_t *voxels; /* [side * side] the first corner of each */
    uint32_t *queue;  /* [count], a ring */
    uint32_t count, left, side, first, waiting;
    uint32_t held;           /* corners in voxels */
    uint32_t kept;           /* a corner of what is left */
    double low[2], scale[2]; /* of the grid */
    double area;             /* twice that of the whole */
    uint64_t compared, most;
} Cutter;

static double turn(const Corner *a, const Corner *b, const Corner *c) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* The turn at a corner of the polygon that is left. */
static double turn_at(const Cutter *cutter, uint32_t i) {
    const Corner *at = &cutter->corners[i];
    return turn(&cutter->corners[at->before], at, &cutter->corners[at->after]);
}

static void wait_for(Cutter *cutter, uint32_t i) {
    if (cutter->corners[i].waits) return;
    cutter->corners[i].waits = true;
    const uint32_t end = cutter->first + cutter->waiting++;
    cutter->queue[end < cutter->count ? end : end - cutter->count] = i;
}

static uint32_t voxel_of(const Cutter *cutter, int axis, double value) {
    const double at = (value - cutter->low[axis]) * cutter->scale[axis];
    return at >= cutter->side ? cutter->side - 1 : at > 0 ? (uint32_t)at : 0;
}

/* Puts a corner into its voxel, if it is not convex. */
static void hold(Cutter *cutter, uint32_t i) {
    Corner *at = &cutter->corners[i];
    if (at->held || at->before == NONE || turn_at(cutter, i) > 0) return;
    uint32_t *voxel = &cutter->voxels[voxel_of(cutter, 1, at->y) * cutter->side + voxel_of(cutter, 0, at->x)];
    at->next = *voxel;
    at->held = true;
    *voxel = i;
    cutter->held++;
}

static bool at_same_place(const Corner *a, const Corner *b) {
    return a->x == b->x && a->y == b->y;
}

/* Whether an edge of a corner at the place of `a` leads into the triangle. */
static bool leads_in(const Cutter *cutter, const Corner *at, const Corner *a, const Corner *b,
                     const Corner *c) {
    const Corner *before = &cutter->corners[at->before], *after = &cutter->corners[at->after];
    return (turn(a, b, before) > 0 && turn(a, before, c) > 0) ||
           (turn(a, b, after) > 0 && turn(a, after, c) > 0);
}

/* Whether a corner that is not convex lies in the triangle or on its edge. Polygons with holes visit a point
 * twice: at the triangle's own points it counts if the polygon goes on inside. */
static bool blocks(const Cutter *cutter, const Corner *p, const Corner *a, const Corner *b, const Corner *c) {
    if (p == a || p == b || p == c) return false;
    if (at_same_place(p, a)) return leads_in(cutter, p, a, b, c);
    if (at_same_place(p, b)) return leads_in(cutter, p, b, c, a);
    if (at_same_place(p, c)) return leads_in(cutter, p, c, a, b);
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

/* Whether no corner is in the way of an ear. */
static bool is_free(Cutter *cutter, const Corner *a, const Corner *b, const Corner *c) {
    const uint32_t x0 = voxel_of(cutter, 0, fmin(a->x, fmin(b->x, c->x))),
                   x1 = voxel_of(cutter, 0, fmax(a->x, fmax(b->x, c->x))),
                   y0 = voxel_of(cutter, 1, fmin(a->y, fmin(b->y, c->y))),
                   y1 = voxel_of(cutter, 1, fmax(a->y, fmax(b->y, c->y)));
    for (uint32_t y = y0; y <= y1 && cutter->held > 0; y++) {
        for (uint32_t x = x0; x <= x1; x++) {
            uint32_t *link = &cutter->voxels[y * cutter->side + x];
            while (*link != NONE) {
                const Corner *p = &cutter->corners[*link];
                cutter->compared++;
                if (p->before == NONE || turn_at(cutter, *link) > 0) { /* cut off, or convex by now */
                    cutter->corners[*link].held = false;
                    *link = p->next;
                    cutter->held--;
                    continue;
                }
                if (blocks(cutter, p, a, b, c)) return false;
                link = &cutter->corners[*link].next;
            }
            cutter->compared++;
        }
    }
    return true;
}

/* Whether the triangle of a corner and its neighbours is an ear. */
static bool is_ear(Cutter *cutter, uint32_t i) {
    const Corner *at = &cutter->corners[i];
    return turn_at(cutter, i) > 0 &&
           is_free(cutter, &cutter->corners[at->before], at, &cutter->corners[at->after]);
}

/* Whether two of the three are at the same place. */
static bool is_spike(const Cutter *cutter, uint32_t i) {
    const Corner *at = &cutter->corners[i], *before = &cutter->corners[at->before],
                 *after = &cutter->corners[at->after];
    return at_same_place(before, after) || at_same_place(before, at) || at_same_place(at, after);
}

static RtStatus cut(RtMeshReader *r, Cutter *cutter, uint32_t i) {
    Corner *at = &cutter->corners[i];
    const RtMeshCorner ear[3] = {r->corners[at->before], r->corners[i], r->corners[at->after]};
    cutter->corners[at->before].after = at->after;
    cutter->corners[at->after].before = at->before;
    wait_for(cutter, at->before);
    wait_for(cutter, at->after);
    cutter->kept = at->before;
    at->before = NONE;
    cutter->left--;
    return add_triangle(r, ear);
}

/* Cuts off a corner that is a spike, and those that become spikes beside it. They would stand in the way of
 * ears, or be taken for some. */
static RtStatus cut_spikes(RtMeshReader *r, Cutter *cutter, uint32_t i) {
    while (cutter->left > 3 && cutter->corners[i].before != NONE && is_spike(cutter, i)) {
        const uint32_t before = cutter->corners[i].before, after = cutter->corners[i].after;
        RT_TRY(cut(r, cutter, i));
        i = is_spike(cutter, before) ? before : after;
    }
    return RT_OK;
}

/* Cuts off the ears among the corners that wait, and those that become ears by it. */
static RtStatus cut_ears(RtMeshReader *r, Cutter *cutter) {
    while (cutter->waiting > 0 && cutter->left > 3) {
        const uint32_t i = cutter->queue[cutter->first];
        if (++cutter->first == cutter->count) cutter->first = 0;
        cutter->waiting--;
        cutter->compared++;
        cutter->corners[i].waits = false;
        if (cutter->compared > cutter->most) return RT_OK;
        if (cutter->corners[i].before == NONE || !is_ear(cutter, i)) continue;
        const uint32_t before = cutter->corners[i].before, after = cutter->corners[i].after,
                       left = cutter->left;
        RT_TRY(cut(r, cutter, i));
        RT_TRY(cut_spikes(r, cutter, before));
        RT_TRY(cut_spikes(r, cutter, after));
        if (cutter->left == left - 1) continue;
        hold(cutter, cutter->kept); /* without a spike it may be convex no more */
        hold(cutter, cutter->corners[cutter->kept].after);
    }
    return RT_OK;
}

/* Cuts off what has (almost) no area. */
static RtStatus cut_flat(RtMeshReader *r, Cutter *cutter) {
    for (uint32_t i = cutter->kept, tries = cutter->left; tries > 0 && cutter->left > 3; tries--) {
        const uint32_t next = cutter->corners[i].after;
        if (fabs(turn_at(cutter, i)) <= FLAT * cutter->area) RT_TRY(cut(r, cutter, i));
        i = next;
    }
    return RT_OK;
}

/* Cuts until three corners are left, or nothing can be cut: a cut frees ears that are not beside it, too. */
static RtStatus cut_all(RtMeshReader *r, Cutter *cutter) {
    for (uint32_t left = 0; cutter->left > 3 && cutter->left != left && cutter->compared <= cutter->most;) {
        left = cutter->left;
        for (uint32_t i = 0; i < cutter->count; i++)
            if (cutter->corners[i].before != NONE) wait_for(cutter, i);
        RT_TRY(cut_ears(r, cutter));
        if (cutter->left == left) RT_TRY(cut_flat(r, cutter));
    }
    return RT_OK;
}

/* Projects the corners. */
static void project(const RtMeshReader *r, RtVec3d whole, Cutter *cutter) {
    const RtVec3d size = rt_vec3d(fabs(whole.x), fabs(whole.y), fabs(whole.z));
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const bool swap = whole.at[axis] < 0;
    const int u = (axis + 1 + swap) % 3, v = (axis + 2 - swap) % 3;
    for (uint32_t i = 0; i < cutter->count; i++) {
        const RtVec3 at = r->vertices[r->corners[i].vertex];
        cutter->corners[i] = (Corner){.x = (double)at.at[u],
                                      .y = (double)at.at[v],
                                      .before = (i + cutter->count - 1) % cutter->count,
                                      .after = (i + 1) % cutter->count};
    }
    cutter->area = size.at[axis];
}

/* Puts the corners that are not convex into the grid, which spans them. */
static void fill_grid(Cutter *cutter) {
    double high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < cutter->count; i++) {
        const Corner *at = &cutter->corners[i];
        if (at->before == NONE || turn_at(cutter, i) > 0) continue;
        cutter->low[0] = fmin(cutter->low[0], at->x);
        cutter->low[1] = fmin(cutter->low[1], at->y);
        high[0] = fmax(high[0], at->x);
        high[1] = fmax(high[1], at->y);
    }
    for (int a = 0; a < 2; a++) {
        const double length = high[a] - cutter->low[a];
        cutter->scale[a] = length > 0 ? cutter->side / length : 0;
    }
    memset(cutter->voxels, 0xff, (size_t)cutter->side * cutter->side * sizeof *cutter->voxels);
    for (uint32_t i = 0; i < cutter->count; i++) hold(cutter, i);
}

static RtStatus warn_crossing(RtMeshReader *r) {
    return rt_mesh_warn(r,
                        "face %u (counted from 0) crosses itself: what has no ear became a fan of triangles",
                        r->face_count);
}

/* Divides a polygon into ears, and what has none into a fan. */
static RtStatus divide(RtMeshReader *r, RtVec3d whole) {
    RT_ARENA(memory);
    const uint32_t count = r->corner_count, side = (uint32_t)sqrt((double)count) + 1;
    Cutter cutter = {.corners = rt_arena_alloc_unset(&memory, count, sizeof(Corner)),
                     .voxels = rt_arena_alloc_unset(&memory, (size_t)side * side, sizeof(uint32_t)),
                     .queue = rt_arena_alloc_unset(&memory, count, sizeof(uint32_t)),
                     .count = count,
                     .left = count,
                     .side = side,
                     .low = {INFINITY, INFINITY},
                     .most = (uint64_t)count * 4000 + 1000000};
    RT_TRY(rt_arena_check(&memory, "dividing a polygon", r->text.error));
    project(r, whole, &cutter);
    for (uint32_t i = 0; i < count; i++) RT_TRY(cut_spikes(r, &cutter, i));
    fill_grid(&cutter);
    RT_TRY(cut_all(r, &cutter));
    const uint32_t first = cutter.kept;
    /* What is left of a polygon that does not cross itself is a triangle of its orientation. */
    if (cutter.compared > cutter.most)
        RT_TRY(rt_mesh_warn(
            r, "face %u (counted from 0), of %u corners, winds too much: what was left became a fan",
            r->face_count, r->corner_count));
    else if (cutter.left > 3 || turn_at(&cutter, first) < -FLAT * cutter.area)
        RT_TRY(warn_crossing(r));
    for (uint32_t i = cutter.corners[first].after; cutter.corners[i].after != first;
         i = cutter.corners[i].after) {
        const RtMeshCorner triangle[3] = {r->corners[first], r->corners[i],
                                          r->corners[cutter.corners[i].after]};
        RT_TRY(add_triangle(r, triangle));
    }
    return RT_OK;
}

static RtStatus add_fan_or_ears(RtMeshReader *r) {
    RtVec3d whole = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < r->corner_count; i++) whole = rt_addd(whole, twice_area(r, 0, i, i + 1));
    if (!first_sees_all(r, whole)) {
        if (rt_dotd(whole, whole) > 0) return divide(r, whole);
        RT_TRY(warn_crossing(r));
    }
    for (uint32_t i = 1; i + 1 < r->corner_count; i++) {
        const RtMeshCorner triangle[3] = {r->corners[0], r->corners[i], r->corners[i + 1]};
        RT_TRY(add_triangle(r, triangle));
    }
    return RT_OK;
}

RtStatus rt_mesh_add_polygon(RtMeshReader *r) {
    RtStatus status;
    if (r->corner_count == 3)
        status = add_triangle(r, r->corners);
    else if (r->corner_count > 3)
        status = add_fan_or_ears(r);
    else
        status = rt_mesh_warn(r, "face %u (counted from 0) has %u corners, and was left out", r->face_count,
                              r->corner_count);
    r->corner_count = 0;
    r->face_count++;
    if (r->given_back) r->given_back = rt_discard(r->given_back, r->text.at);
    return status;
}

/* ---- text formats ---- */

RtStatus rt_mesh_begin_text(RtMeshReader *r) {
    enum { CTRL_Z = 0x1A };
    RtScanner *text = &r->text;
    const char *end = text->end;
    while (text->end > text->at && (text->end[-1] == 0 || text->end[-1] == CTRL_Z)) text->end--;
    const char *zero = memchr(text->at, 0, (size_t)(text->end - text->at));
    if (zero) return rt_file_fail_zero(text->path, text->at, zero, text->error);
    if (text->end < end)
        RT_TRY(
            rt_mesh_warn(r, "the file ends with bytes of 0 or ^Z (%td): they are ignored", end - text->end));
    if (text->end - text->at >= 3 && memcmp(text->at, "\xEF\xBB\xBF", 3) == 0) text->at += 3;
    *(char *)text->end = 0;
    return RT_OK;
}

RtStatus rt_mesh_take(RtMeshReader *r, bool first, const char *wanted, RtWord *word) {
    *word = rt_scan_peek(&r->text);
    if (word->length == 0 || (r->text.fresh && !first))
        return rt_mesh_fail(r, "expected %s, found the end of the %s", wanted,
                            word->length ? "line" : "file");
    if (first && !r->text.fresh) return rt_scan_fail(&r->text, *word, "the end of the line");
    rt_scan_take(&r->text, *word);
    return RT_OK;
}

bool rt_mesh_more(RtMeshReader *r, RtWord *word) {
    *word = rt_scan_peek(&r->text);
    const bool more = word->length > 0 && !r->text.fresh;
    if (more) rt_scan_take(&r->text, *word);
    return more;
}

RtStatus rt_mesh_expect(RtMeshReader *r, const char *text) {
    const RtWord word = rt_scan_peek(&r->text);
    char wanted[64];
    snprintf(wanted, sizeof wanted, "'%s'", text);
    if (!rt_scan_is_like(word, text)) return rt_scan_fail(&r->text, word, wanted);
    rt_scan_take(&r->text, word);
    return RT_OK;
}

RtStatus rt_mesh_integer(const RtMeshReader *r, RtWord word, int64_t *out) {
    const char *end = rt_scan_integer(word.text, out);
    if (end > word.text && end == word.text + word.length) return RT_OK;
    return rt_scan_fail(&r->text, word, "an integer");
}

RtStatus rt_mesh_coordinate(const RtMeshReader *r, RtWord word, double *out) {
    float nearest;
    char *end;
    if (rt_scan_float(word, &nearest)) {
        *out = r->moves ? strtod(word.text, NULL) : (double)nearest;
        return RT_OK;
    }
    *out = NAN;
    if (!isfinite(strtof(word.text, &end)) && end == word.text + word.length) return RT_OK;
    return rt_scan_fail(&r->text, word, "a finite number that fits float32");
}

RtStatus rt_mesh_take_vertex(RtMeshReader *r, bool first, RtVec3d *out) {
    RtWord word;
    for (int a = 0; a < 3; a++) {
        RT_TRY(rt_mesh_take(r, first && a == 0, "the x y z of a vertex", &word));
        RT_TRY(rt_mesh_coordinate(r, word, &out->at[a]));
    }
    return RT_OK;
}

RtStatus rt_mesh_end(RtMeshReader *r) {
    const RtWord word = rt_scan_peek(&r->text);
    if (word.length > 0) return rt_scan_fail(&r->text, word, "the end of the file");
    if (r->text.fresh) return RT_OK;
    return rt_mesh_warn(r, "the last line has no line break: its end may be missing");
}

RtStatus rt_mesh_end_binary(RtMeshReader *r) {
    const ptrdiff_t more = r->text.end - r->text.at;
    if (more == 0) return RT_OK;
    if (more < RT_MESH_FEW_BYTES)
        return rt_mesh_warn(r, "the file has %td bytes more than its header declares: they are ignored",
                            more);
    return rt_mesh_fail(r, "the file has %td bytes more than its header declares", more);
}
