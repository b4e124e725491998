/* SPDX-License-Identifier: Apache-2.0 */
/* shells: a sea shell of 180 * 2^size + 1 spheres, nearly all of which overlap their neighbours.
 *
 * Standard Procedural Databases of E. Haines, after C. Pickover, "A Short Recipe for Seashell Synthesis",
 * IEEE CG&A 9(6), 1989; "tends to bring ray tracers to their knees". The spheres lie on a spiral of nine
 * turns on a cone; the radius of each is its distance from the axis: at the angle a, from -12 pi to 6 pi,
 * the radius is r = e^(0.15 a) and the centre (r sin a, r cos a, -2 r). These numbers were inferred from
 * the files of the database, smallest sphere first. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("5", 1, 20, "1|3"),
     "doublings of the number of spheres, 180 * 2^size + 1, over the same nine turns", "SPD: 5761 spheres"},
};

enum { ARCS = 180 }; /* of 18 degrees, each of 2^size spheres */

static uint64_t object_count(const RtValue *values) {
    return ((uint64_t)ARCS << values[0].i) + 1;
}

static void add_sphere(RtSceneBuilder *b, double degrees, double radius) {
    RtTurn turn = rt_turn(degrees);
    rt_build_sphere(b, rt_vec3d(radius * turn.sine, radius * turn.cosine, -2 * radius), radius);
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{-100, -100, 100}};
    rt_spd_lights(b, lights, 1);
    b->scene->camera.from = rt_vec3(-6, -60, 35);
    b->scene->camera.at = rt_vec3(0, 8, -15);
    b->scene->camera.near = 0.5f;
    rt_build_material(b, rt_nff_material("shell", rt_vec3(1, 0.8f, 0.4f), 0.8f, 0.2f, 45.2776f, 0, 1));

    const double arc_growth = 1.0482518687537468114; /* e^(0.015 pi) */
    const int64_t spheres = INT64_C(1) << values[0].i;
    double growth = arc_growth, radius = 0.0035004393966670334; /* e^(-1.8 pi) */
    for (int64_t halving = 0; halving < values[0].i; halving++) growth = sqrt(growth);
    for (int arc = 0; arc < ARCS; arc++) {
        double within = radius; /* multiplied within an arc only: rounding errors do not add up */
        for (int64_t i = 0; i < spheres; i++) {
            add_sphere(b, 18 * (arc + (double)i / (double)spheres), within);
            within *= growth;
        }
        radius *= arc_growth;
    }
    add_sphere(b, 0, radius);
}

const RtBuiltin rt_builtin_shells = {
    .name = "shells",
    .summary = "a sea shell of spheres that overlap, many of them tiny",
    .source = RT_SPD_LATER_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
