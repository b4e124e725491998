/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/forms.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"

#include <assert.h>

RtForms rt_forms(RtScene *scene) {
    return (RtForms){.scene = scene, .place = rt_transform_identity()};
}

void rt_forms_clear(RtForms *forms) {
    rt_free(forms->points);
    *forms = rt_forms(NULL);
}

RtStatus rt_forms_make(RtScene *scene, RtFormsMaker *make, const RtValue *values, RtError *error) {
    RtForms forms = rt_forms(scene);
    RtStatus status = make(&forms, values, error);
    rt_forms_clear(&forms);
    return status;
}

uint64_t rt_forms_count(RtFormsMaker *make, const RtValue *values) {
    RtForms forms = rt_forms(NULL);
    make(&forms, values, NULL); /* cannot fail: nothing is made */
    return forms.count;
}

RtStatus rt_forms_materials(const RtForms *forms, const RtMaterial *materials, uint32_t count,
                            RtError *error) {
    for (uint32_t i = 0; forms->scene && i < count; i++) {
        uint32_t index;
        RT_TRY(rt_scene_add_material(forms->scene, &materials[i], &index, error));
    }
    return RT_OK;
}

void rt_forms_at(RtForms *forms, RtVec3d at, int quarters) {
    static const double cosine[4] = {1, 0, -1, 0};
    double c = cosine[quarters & 3], s = cosine[(quarters + 3) & 3];
    forms->place = (RtTransform){{{c, -s, 0, at.x}, {s, c, 0, at.y}, {0, 0, 1, at.z}}};
}

/* ---- curves ---- */

RtVec3d rt_on_circle(uint32_t i, uint32_t n) {
    RtTurn turn = rt_turn(360.0 * i / n);
    return rt_vec3d(turn.cosine, turn.sine, 0);
}

RtVec3d rt_curve_point(const RtVec3d *points, uint32_t count, uint32_t step, uint32_t steps) {
    uint64_t along = (uint64_t)step * (count - 1);
    uint32_t i = (uint32_t)(along / steps);
    if (i == count - 1) return points[i];
    double t = (double)(along - (uint64_t)i * steps) / steps;
    if (t == 0) return points[i];
    RtVec3d b = points[i], c = points[i + 1];
    RtVec3d a = i > 0 ? points[i - 1] : rt_subd(rt_scaled(b, 2), c);
    RtVec3d d = i + 2 < count ? points[i + 2] : rt_subd(rt_scaled(c, 2), b);
    double wa = t * (-1 + t * (2 - t)), wb = 2 + t * t * (-5 + 3 * t);
    double wc = t * (1 + t * (4 - 3 * t)), wd = t * t * (t - 1);
    RtVec3d sum = rt_addd(rt_scaled(a, wa), rt_scaled(b, wb));
    return rt_scaled(rt_addd(sum, rt_addd(rt_scaled(c, wc), rt_scaled(d, wd))), 0.5);
}

/* ---- flat forms and those that are one object ---- */

static RtVec3 placed(const RtForms *forms, RtVec3d p) {
    return rt_narrow(rt_transform_pointd(&forms->place, p));
}

RtStatus rt_forms_triangle(RtForms *forms, RtVec3d a, RtVec3d b, RtVec3d c, RtError *error) {
    forms->count++;
    if (!forms->scene) return RT_OK;
    const RtVec3 corners[3] = {placed(forms, a), placed(forms, b), placed(forms, c)};
    return rt_scene_add_triangle(forms->scene, forms->material, corners, NULL, error);
}

RtStatus rt_forms_quad(RtForms *forms, const RtVec3d corners[4], RtError *error) {
    if (forms->polygons) return rt_forms_polygon(forms, corners, 4, error);
    RT_TRY(rt_forms_triangle(forms, corners[0], corners[1], corners[2], error));
    return rt_forms_triangle(forms, corners[2], corners[3], corners[0], error);
}

enum { MAX_CORNERS = 64 };

RtStatus rt_forms_polygon(RtForms *forms, const RtVec3d *corners, uint32_t count, RtError *error) {
    assert(count >= 3 && count <= MAX_CORNERS);
    forms->count++;
    if (!forms->scene) return RT_OK;
    RtVec3 vertices[MAX_CORNERS];
    for (uint32_t i = 0; i < count; i++) vertices[i] = placed(forms, corners[i]);
    return rt_scene_add_polygon(forms->scene, forms->material, vertices, count, error);
}

RtStatus rt_forms_disc(RtForms *forms, RtVec3d center, double radius, uint32_t sides, RtError *error) {
    assert(sides >= 3 && sides <= MAX_CORNERS);
    RtVec3d corners[MAX_CORNERS];
    for (uint32_t i = 0; i < sides; i++) {
        corners[i] = rt_add_scaledd(center, rt_on_circle(i, sides), radius);
    }
    return rt_forms_polygon(forms, corners, sides, error);
}

RtStatus rt_forms_sphere(RtForms *forms, RtVec3d center, double radius, RtError *error) {
    forms->count++;
    if (!forms->scene) return RT_OK;
    double scale = rt_transform_uniform_scale(&forms->place);
    return rt_scene_add_sphere(forms->scene, forms->material, placed(forms, center), (float)(scale * radius),
                               error);
}

RtStatus rt_forms_cone(RtForms *forms, RtVec3d base, double base_radius, RtVec3d apex, double apex_radius,
                       RtError *error) {
    forms->count++;
    if (!forms->scene) return RT_OK;
    double scale = rt_transform_uniform_scale(&forms->place);
    return rt_scene_add_cone(forms->scene, forms->material, placed(forms, base), (float)(scale * base_radius),
                             placed(forms, apex), (float)(scale * apex_radius), error);
}

RtStatus rt_forms_box(RtForms *forms, RtVec3d lo, RtVec3d hi, unsigned sides, RtError *error) {
    /* Corner k is at hi along the axes whose bits are set in k. */
    static const unsigned char quads[6][4] = {{4, 6, 2, 0}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                              {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (unsigned side = 0; side < 6; side++) {
        if (!(sides >> side & 1)) continue;
        RtVec3d corners[4];
        for (int i = 0; i < 4; i++) {
            unsigned k = quads[side][i];
            corners[i] = rt_vec3d(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z);
        }
        RT_TRY(rt_forms_quad(forms, corners, error));
    }
    return RT_OK;
}

RtStatus rt_forms_tube(RtForms *forms, RtVec3d from, double from_radius, RtVec3d to, double to_radius,
                       uint32_t sides, RtError *error) {
    RtVec3d axis = rt_normalized(rt_subd(to, from));
    RtVec3d other = fabs(axis.z) < 0.7 ? rt_vec3d(0, 0, 1) : rt_vec3d(1, 0, 0);
    RtVec3d right = rt_normalized(rt_crossd(other, axis)), up = rt_crossd(axis, right);
    RtVec3d before[2] = {rt_add_scaledd(from, right, from_radius), rt_add_scaledd(to, right, to_radius)};
    for (uint32_t i = 1; i <= sides; i++) {
        RtVec3d turn = rt_on_circle(i, sides);
        RtVec3d out = rt_addd(rt_scaled(right, turn.x), rt_scaled(up, turn.y));
        const RtVec3d after[2] = {rt_add_scaledd(from, out, from_radius), rt_add_scaledd(to, out, to_radius)};
        RT_TRY(rt_forms_triangle(forms, before[0], after[0], after[1], error));
        if (to_radius > 0) RT_TRY(rt_forms_triangle(forms, after[1], before[1], before[0], error));
        before[0] = after[0], before[1] = after[1];
    }
    return RT_OK;
}

/* ---- sheets ---- */

uint64_t rt_sheet_count(const RtSheet *sheet) {
    uint64_t poles = (uint64_t)sheet->first_pole + sheet->last_pole;
    return sheet->columns * (2 * (uint64_t)sheet->rows - poles);
}

/* The points of a sheet, moved and rounded, and the normals at them; row by row. */
typedef struct Mesh {
    uint32_t width; /* points in a row */
    RtVec3 *points, *normals;
} Mesh;

/* The two triangles of a cell: `corners` numbers its points; the first is none along the first pole, the
 * second none along the last. */
static void cell_corners(const RtSheet *sheet, const Mesh *mesh, uint32_t column, uint32_t row,
                         uint32_t corners[4]) {
    uint32_t next = sheet->wrapped && column + 1 == sheet->columns ? 0 : column + 1;
    uint32_t below = row * mesh->width, above = below + mesh->width;
    corners[0] = below + column;
    corners[1] = below + next;
    corners[2] = above + next;
    corners[3] = above + column;
}

static const unsigned char halves[2][3] = {{0, 1, 2}, {2, 3, 0}};

static bool is_left_out(const RtSheet *sheet, uint32_t row, int half) {
    return half == 0 ? sheet->first_pole && row == 0 : sheet->last_pole && row + 1 == sheet->rows;
}

static void add_to(RtVec3 *sum, RtVec3 a) {
    *sum = rt_add(*sum, a);
}

/* To every point the sum of the normals of its triangles, by their area; a pole shares them all. */
static void sum_normals(const RtSheet *sheet, const Mesh *mesh) {
    for (uint32_t row = 0; row < sheet->rows; row++) {
        for (uint32_t column = 0; column < sheet->columns; column++) {
            uint32_t corners[4];
            cell_corners(sheet, mesh, column, row, corners);
            for (int half = 0; half < 2; half++) {
                const unsigned char *at = halves[half];
                RtVec3d a = rt_widen(mesh->points[corners[at[0]]]);
                RtVec3d ab = rt_subd(rt_widen(mesh->points[corners[at[1]]]), a);
                RtVec3d ac = rt_subd(rt_widen(mesh->points[corners[at[2]]]), a);
                RtVec3 normal = rt_narrow(rt_crossd(ab, ac));
                for (int i = 0; i < 3; i++) add_to(&mesh->normals[corners[at[i]]], normal);
            }
        }
    }
    for (int end = 0; end < 2; end++) {
        if (!(end ? sheet->last_pole : sheet->first_pole)) continue;
        RtVec3 *row = mesh->normals + (end ? sheet->rows * mesh->width : 0), sum = {0, 0, 0};
        for (uint32_t i = 0; i < mesh->width; i++) add_to(&sum, row[i]);
        for (uint32_t i = 0; i < mesh->width; i++) row[i] = sum;
    }
}

static RtStatus add_cells(const RtForms *forms, const RtSheet *sheet, const Mesh *mesh, RtError *error) {
    for (uint32_t row = 0; row < sheet->rows; row++) {
        for (uint32_t column = 0; column < sheet->columns; column++) {
            uint32_t corners[4];
            cell_corners(sheet, mesh, column, row, corners);
            for (int half = 0; half < 2; half++) {
                if (is_left_out(sheet, row, half)) continue;
                RtVec3 vertices[3], normals[3];
                for (int i = 0; i < 3; i++) {
                    uint32_t corner = corners[halves[half][i]];
                    vertices[i] = mesh->points[corner];
                    if (sheet->smooth) normals[i] = mesh->normals[corner];
                }
                RT_TRY(rt_scene_add_triangle(forms->scene, forms->material, vertices,
                                             sheet->smooth ? normals : NULL, error));
            }
        }
    }
    return RT_OK;
}

RtStatus rt_forms_sheet(RtForms *forms, const RtSheet *sheet, RtError *error) {
    forms->count += rt_sheet_count(sheet);
    if (!forms->scene) return RT_OK;
    Mesh mesh = {.width = sheet->columns + !sheet->wrapped};
    uint64_t points = (uint64_t)mesh.width * (sheet->rows + 1);
    RT_TRY(rt_reserve(&forms->points, &forms->room, 2 * points, sizeof(RtVec3), error));
    mesh.points = forms->points;
    mesh.normals = mesh.points + points;
    for (uint32_t row = 0; row <= sheet->rows; row++) {
        for (uint32_t column = 0; column < mesh.width; column++) {
            uint64_t i = (uint64_t)row * mesh.width + column;
            mesh.points[i] = placed(forms, sheet->point(sheet->of, column, row));
            mesh.normals[i] = rt_vec3(0, 0, 0);
        }
    }
    if (sheet->smooth) sum_normals(sheet, &mesh);
    return add_cells(forms, sheet, &mesh, error);
}

static RtVec3d lathe_point(const void *of, uint32_t column, uint32_t row) {
    const RtLathe *lathe = of;
    RtVec3d p = rt_scaled(rt_curve_point(lathe->profile, lathe->count, row, lathe->steps), lathe->scale);
    RtVec3d around = rt_add_scaledd(lathe->center, rt_on_circle(column, lathe->sides), p.x);
    return rt_vec3d(around.x, around.y, around.z + p.z);
}

RtStatus rt_forms_lathe(RtForms *forms, const RtLathe *lathe, RtError *error) {
    return rt_forms_sheet(forms,
                          &(RtSheet){.columns = lathe->sides,
                                     .rows = lathe->steps,
                                     .wrapped = true,
                                     .first_pole = lathe->profile[0].x == 0,
                                     .last_pole = lathe->profile[lathe->count - 1].x == 0,
                                     .smooth = true,
                                     .point = lathe_point,
                                     .of = lathe},
                          error);
}

static RtVec3d torus_point(const void *of, uint32_t column, uint32_t row) {
    const RtTorus *torus = of;
    RtVec3d around = rt_on_circle(column, torus->around), section = rt_on_circle(row, torus->sides), p;
    double out = torus->radius + torus->tube * section.x;
    p.at[(torus->axis + 1) % 3] = out * around.x;
    p.at[(torus->axis + 2) % 3] = out * around.y;
    p.at[torus->axis] = torus->tube * section.y;
    return rt_addd(torus->center, p);
}

RtStatus rt_forms_torus(RtForms *forms, const RtTorus *torus, RtError *error) {
    return rt_forms_sheet(forms,
                          &(RtSheet){.columns = torus->around,
                                     .rows = torus->sides,
                                     .wrapped = true,
                                     .smooth = true,
                                     .point = torus_point,
                                     .of = torus},
                          error);
}
