/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/build.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"

#include <assert.h>

/* While counting, a generator sets the camera of an unused scene. */
static RtSceneBuilder run(RtScene *scene, bool counting, RtSceneGenerator *generate, const RtValue *values,
                          RtError *error) {
    RtSceneBuilder b = {.scene = scene,
                        .whole = scene,
                        .counting = counting,
                        .transform = rt_transform_identity(),
                        .error = error};
    generate(&b, values);
    rt_free(b.points);
    return b;
}

RtStatus rt_build_scene(RtScene *scene, RtSceneGenerator *generate, const RtValue *values, RtError *error) {
    const RtSceneBuilder b = run(scene, false, generate, values, error);
    RT_TRY(b.status);
    RT_TRY(rt_scene_finish(scene, error));
    if (!b.flattened) return RT_OK;
    RtScene instanced = *scene;
    RtStatus status = rt_scene_flatten(&instanced, scene, error);
    rt_scene_clear(&instanced);
    return status;
}

uint64_t rt_build_count(RtSceneGenerator *generate, const RtValue *values) {
    RtScene unused = {0};
    return run(&unused, true, generate, values, NULL).count;
}

void rt_build_check(RtSceneBuilder *b, RtStatus status) {
    if (b->status == RT_OK) b->status = status;
}

/* True unless counting or after an error. */
static bool adds(const RtSceneBuilder *b) {
    return !b->counting && b->status == RT_OK;
}

void rt_build_material(RtSceneBuilder *b, RtMaterial material) {
    if (adds(b)) b->status = rt_scene_add_material(b->scene, &material, &b->material, b->error);
}

void rt_build_materials(RtSceneBuilder *b, const RtMaterial *materials, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) rt_build_material(b, materials[i]);
}

void rt_build_light(RtSceneBuilder *b, RtVec3d position, RtVec3 intensity) {
    if (adds(b)) b->status = rt_scene_add_light(b->scene, rt_narrow(position), intensity, b->error);
}

void rt_build_lights(RtSceneBuilder *b, const RtVec3d *positions, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) rt_build_light(b, positions[i], rt_nff_light_intensity(count));
}

void rt_build_studio(RtSceneBuilder *b, bool glass) {
    rt_build_material(b, rt_nff_material("clay", rt_vec3(0.9f, 0.5f, 0.3f), 0.9f, 0, 1, 0, 1));
    rt_build_material(b, rt_nff_material("slate", rt_vec3(0.3f, 0.4f, 0.6f), 0.9f, 0, 1, 0, 1));
    if (!glass) rt_build_material(b, rt_nff_material("moss", rt_vec3(0.4f, 0.6f, 0.3f), 0.9f, 0, 1, 0, 1));
    rt_build_material(b, rt_nff_material("steel", rt_vec3(0.8f, 0.8f, 0.8f), 0.4f, 0.5f, 50, 0, 1));
    if (glass)
        rt_build_material(b, rt_nff_material("glass", rt_vec3(0.9f, 1, 0.9f), 0.1f, 0.1f, 100, 0.8f, 1.3f));
    rt_build_light(b, rt_vec3d(4, 3, 6), rt_vec3(0.6f, 0.6f, 0.6f));
    rt_build_light(b, rt_vec3d(5, -6, 2), rt_vec3(0.4f, 0.4f, 0.4f));
}

void rt_build_origin(RtSceneBuilder *b, RtVec3d at, int quarters) {
    static const double cosine[4] = {1, 0, -1, 0};
    double c = cosine[quarters & 3], s = cosine[(quarters + 3) & 3];
    b->transformed = true;
    b->transform = (RtTransform){{{c, -s, 0, at.x}, {s, c, 0, at.y}, {0, 0, 1, at.z}}};
}

/* ---- parts ---- */

void rt_build_begin_part(RtSceneBuilder *b) {
    assert(b->scene == b->whole && b->part_count < RT_MAX_BUILT_PARTS);
    b->scene = &b->part;
    b->count_before = b->count;
}

void rt_build_end_part(RtSceneBuilder *b) {
    b->part_sizes[b->part_count++] = b->count - b->count_before;
    if (b->flattened) b->count = b->count_before;
    b->scene = b->whole;
    if (adds(b)) b->status = rt_scene_add_part(b->whole, &b->part, b->error);
    rt_scene_clear(&b->part); /* after a failure */
}

void rt_build_instance(RtSceneBuilder *b, uint32_t part, const RtTransform *to_world) {
    assert(part < b->part_count);
    b->count += b->flattened ? b->part_sizes[part] : 1;
    if (!adds(b)) return;
    b->status = rt_scene_add_instance(b->scene, b->whole, part, to_world, RT_OWN_MATERIALS, b->error);
}

/* ---- curves ---- */

RtVec3d rt_on_circle(uint32_t i, uint32_t n) {
    RtTurn turn = rt_turn(360.0 * i / n);
    return rt_vec3d(turn.cosine, turn.sine, 0);
}

/* Point `step` of `steps` on the Catmull-Rom spline (1974) through points[0..count), count >= 2. */
static RtVec3d curve_point(const RtVec3d *points, uint32_t count, uint32_t step, uint32_t steps) {
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

/* ---- single objects ---- */

static RtVec3 placed(const RtSceneBuilder *b, RtVec3d p) {
    return rt_narrow(b->transformed ? rt_transform_pointd(&b->transform, p) : p);
}

static double scale_of(const RtSceneBuilder *b) {
    return b->transformed ? rt_transform_uniform_scale(&b->transform) : 1;
}

void rt_build_sphere(RtSceneBuilder *b, RtVec3d center, double radius) {
    b->count++;
    if (!adds(b)) return;
    float r = (float)(scale_of(b) * radius);
    b->status = rt_scene_add_sphere(b->scene, b->material, placed(b, center), r, b->error);
}

void rt_build_cone(RtSceneBuilder *b, RtVec3d base, double base_radius, RtVec3d apex, double apex_radius) {
    b->count++;
    if (!adds(b)) return;
    float r0 = (float)(scale_of(b) * base_radius), r1 = (float)(scale_of(b) * apex_radius);
    b->status = rt_scene_add_cone(b->scene, b->material, placed(b, base), r0, placed(b, apex), r1, b->error);
}

void rt_build_triangle(RtSceneBuilder *b, RtVec3d v0, RtVec3d v1, RtVec3d v2) {
    b->count++;
    if (!adds(b)) return;
    const RtVec3 corners[3] = {placed(b, v0), placed(b, v1), placed(b, v2)};
    b->status = rt_scene_add_triangle(b->scene, b->material, corners, NULL, b->error);
}

enum { MAX_CORNERS = 144 };

void rt_build_polygon(RtSceneBuilder *b, const RtVec3d *corners, uint32_t count) {
    assert(count >= 3 && count <= MAX_CORNERS);
    b->count++;
    if (!adds(b)) return;
    RtVec3 vertices[MAX_CORNERS];
    for (uint32_t i = 0; i < count; i++) vertices[i] = placed(b, corners[i]);
    b->status = rt_scene_add_polygon(b->scene, b->material, vertices, count, b->error);
}

void rt_build_quad(RtSceneBuilder *b, const RtVec3d corners[4]) {
    if (b->polygons) {
        rt_build_polygon(b, corners, 4);
    } else {
        rt_build_triangle(b, corners[0], corners[1], corners[2]);
        rt_build_triangle(b, corners[2], corners[3], corners[0]);
    }
}

void rt_build_disc(RtSceneBuilder *b, RtVec3d center, double radius, uint32_t sides) {
    RtVec3d corners[MAX_CORNERS];
    for (uint32_t i = 0; i < sides; i++) corners[i] = rt_add_scaledd(center, rt_on_circle(i, sides), radius);
    rt_build_polygon(b, corners, sides);
}

void rt_build_box(RtSceneBuilder *b, RtVec3d lo, RtVec3d hi, unsigned sides) {
    /* Bit a of k: corner k is at hi along axis a. */
    static const unsigned char quads[6][4] = {{4, 6, 2, 0}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                              {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (unsigned side = 0; side < 6; side++) {
        if (!(sides >> side & 1)) continue;
        RtVec3d corners[4];
        for (int i = 0; i < 4; i++) {
            unsigned k = quads[side][i];
            corners[i] = rt_vec3d(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z);
        }
        rt_build_quad(b, corners);
    }
}

void rt_build_prism(RtSceneBuilder *b, RtVec3d from, double from_radius, RtVec3d to, double to_radius,
                    uint32_t sides) {
    RtVec3d axis = rt_normalized(rt_subd(to, from));
    RtVec3d other = fabs(axis.z) < 0.7 ? rt_vec3d(0, 0, 1) : rt_vec3d(1, 0, 0);
    RtVec3d right = rt_normalized(rt_crossd(other, axis)), up = rt_crossd(axis, right);
    RtVec3d before[2] = {rt_add_scaledd(from, right, from_radius), rt_add_scaledd(to, right, to_radius)};
    for (uint32_t i = 1; i <= sides; i++) {
        RtVec3d turn = rt_on_circle(i, sides);
        RtVec3d out = rt_addd(rt_scaled(right, turn.x), rt_scaled(up, turn.y));
        const RtVec3d after[2] = {rt_add_scaledd(from, out, from_radius), rt_add_scaledd(to, out, to_radius)};
        rt_build_triangle(b, before[0], after[0], after[1]);
        if (to_radius > 0) rt_build_triangle(b, after[1], before[1], before[0]);
        before[0] = after[0], before[1] = after[1];
    }
}

/* ---- grid meshes ---- */

/* The transformed points and the normals at them, row by row. */
typedef struct Mesh {
    uint32_t width; /* points in a row */
    RtVec3 *points, *normals;
} Mesh;

/* The indices of the points of a cell. */
static void cell_corners(const RtGridMesh *grid, const Mesh *mesh, uint32_t column, uint32_t row,
                         uint32_t corners[4]) {
    uint32_t next = grid->wrapped && column + 1 == grid->columns ? 0 : column + 1;
    uint32_t below = row * mesh->width, above = below + mesh->width;
    corners[0] = below + column;
    corners[1] = below + next;
    corners[2] = above + next;
    corners[3] = above + column;
}

/* The corners of the two triangles of a cell; the first is omitted along the first pole, the second along
 * the last. */
static const unsigned char halves[2][3] = {{0, 1, 2}, {2, 3, 0}};

/* Adds the area-weighted normals of its triangles to each point; the points of a pole share one sum. */
static void sum_normals(const RtGridMesh *grid, const Mesh *mesh) {
    for (uint32_t row = 0; row < grid->rows; row++) {
        for (uint32_t column = 0; column < grid->columns; column++) {
            uint32_t corners[4];
            cell_corners(grid, mesh, column, row, corners);
            for (int half = 0; half < 2; half++) {
                const unsigned char *at = halves[half];
                RtVec3d v[3];
                for (int i = 0; i < 3; i++) v[i] = rt_widen(mesh->points[corners[at[i]]]);
                RtVec3 normal = rt_narrow(rt_area_vector(v[0], v[1], v[2]));
                for (int i = 0; i < 3; i++)
                    mesh->normals[corners[at[i]]] = rt_add(mesh->normals[corners[at[i]]], normal);
            }
        }
    }
    for (int end = 0; end < 2; end++) {
        if (!(end ? grid->last_pole : grid->first_pole)) continue;
        RtVec3 *row = mesh->normals + (end ? grid->rows * mesh->width : 0), sum = {0, 0, 0};
        for (uint32_t i = 0; i < mesh->width; i++) sum = rt_add(sum, row[i]);
        for (uint32_t i = 0; i < mesh->width; i++) row[i] = sum;
    }
}

static void add_cells(RtSceneBuilder *b, const RtGridMesh *grid, const Mesh *mesh) {
    for (uint32_t row = 0; row < grid->rows; row++) {
        for (uint32_t column = 0; column < grid->columns; column++) {
            uint32_t corners[4];
            cell_corners(grid, mesh, column, row, corners);
            for (int half = 0; half < 2; half++) {
                if (half == 0 ? grid->first_pole && row == 0 : grid->last_pole && row + 1 == grid->rows)
                    continue;
                RtVec3 vertices[3], normals[3];
                for (int i = 0; i < 3; i++) {
                    uint32_t corner = corners[halves[half][i]];
                    vertices[i] = mesh->points[corner];
                    if (grid->smooth) normals[i] = mesh->normals[corner];
                }
                rt_build_check(b, rt_scene_add_triangle(b->scene, b->material, vertices,
                                                        grid->smooth ? normals : NULL, b->error));
                if (b->status != RT_OK) return;
            }
        }
    }
}

void rt_build_grid_mesh(RtSceneBuilder *b, const RtGridMesh *grid) {
    uint64_t poles = (uint64_t)grid->first_pole + grid->last_pole;
    b->count += grid->columns * (2 * (uint64_t)grid->rows - poles);
    if (!adds(b)) return;
    Mesh mesh = {.width = grid->columns + !grid->wrapped};
    uint64_t points = (uint64_t)mesh.width * (grid->rows + 1);
    b->status = rt_reserve(&b->points, &b->point_capacity, 2 * points, sizeof(RtVec3), b->error);
    if (b->status != RT_OK) return;
    mesh.points = b->points;
    mesh.normals = mesh.points + points;
    for (uint32_t row = 0; row <= grid->rows; row++) {
        for (uint32_t column = 0; column < mesh.width; column++) {
            uint64_t i = (uint64_t)row * mesh.width + column;
            mesh.points[i] = placed(b, grid->point(grid->of, column, row));
            mesh.normals[i] = rt_vec3(0, 0, 0);
        }
    }
    if (grid->smooth) sum_normals(grid, &mesh);
    add_cells(b, grid, &mesh);
}

static RtVec3d lathe_point(const void *of, uint32_t column, uint32_t row) {
    const RtLathe *lathe = of;
    RtVec3d p = curve_point(lathe->profile, lathe->count, row, lathe->steps);
    RtVec3d around = rt_add_scaledd(lathe->center, rt_on_circle(column, lathe->sides), p.x);
    return rt_vec3d(around.x, around.y, around.z + p.z);
}

void rt_build_lathe(RtSceneBuilder *b, const RtLathe *lathe) {
    rt_build_grid_mesh(b, &(RtGridMesh){.columns = lathe->sides,
                                        .rows = lathe->steps,
                                        .wrapped = true,
                                        .first_pole = lathe->profile[0].x == 0,
                                        .last_pole = lathe->profile[lathe->count - 1].x == 0,
                                        .smooth = true,
                                        .point = lathe_point,
                                        .of = lathe});
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

void rt_build_torus(RtSceneBuilder *b, const RtTorus *torus) {
    rt_build_grid_mesh(b, &(RtGridMesh){.columns = torus->around,
                                        .rows = torus->sides,
                                        .wrapped = true,
                                        .smooth = true,
                                        .point = torus_point,
                                        .of = torus});
}
