/* SPDX-License-Identifier: Apache-2.0 */
/* The precision of our hit functions against exact arithmetic. Prints a table and checks that the rows of it
 * in docs/precision.md are the same. */
#include "random_testing.h"
#include "testing.h"

#include "core/base/file.h"
#include "exact/exact.h"
#include "exact/precision.h"

enum { RAYS = 2000, MOST_CASES = 10 };

static RtPrecision measured[RT_SUBJECT_COUNT][MOST_CASES];

static int measure(void **state) {
    (void)state;
    assert_int_equal(rt_precision_case_count(), MOST_CASES);
    for (int subject = 0; subject < RT_SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < MOST_CASES; i++)
            assert_ok(rt_precision_measure((RtSubject)subject, i, RAYS, &measured[subject][i], error));
    }
    return 0;
}

/* ---- the table ---- */

static void format_row(RtSubject subject, size_t i, char *out, size_t size) {
    const RtPrecision *p = &measured[subject][i];
    char most[32];
    snprintf(most, sizeof most, p->most < 1e9 ? "%.2f" : "%.3g", p->most);
    snprintf(out, size, "| %s | %s | %d | %.2f | %.2f | %s | %.2f | %d | %d | %d | %.3g |\n",
             rt_subject_name(subject), rt_precision_case_name(i), (int)p->hits, p->median, p->most99, most,
             p->off, (int)p->missed, (int)p->invented, (int)p->elsewhere, p->border);
}

RT_TEST(the_rows_in_the_docs_are_what_is_measured) {
    OWNED_MEMORY char *text = NULL;
    size_t size = 0, stale = 0;
    assert_ok(rt_file_read(RT_SOURCE_DIR "/docs/precision.md", 1 << 20, &text, &size, error));
    for (size_t i = 0; i < MOST_CASES; i++) {
        char row[256];
        snprintf(row, sizeof row, "| %s | %s |\n", rt_precision_case_name(i), rt_precision_case_meaning(i));
        if (!strstr(text, row)) stale++;
    }
    for (int subject = 0; subject < RT_SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < MOST_CASES; i++) {
            char row[256], start[64];
            format_row((RtSubject)subject, i, row, sizeof row);
            fputs(row, stdout);
            snprintf(start, sizeof start, "| %s | %s |", rt_subject_name((RtSubject)subject),
                     rt_precision_case_name(i));
            const char *shown = strstr(text, start);
            if (shown && strncmp(shown, row, strlen(row)) != 0) stale++;
        }
    }
    if (stale > 0)
        fail_msg("%zu rows of docs/precision.md are not those above, or its cases are others", stale);
}

/* ---- bounds ---- */

static bool is_case(size_t i, const char *name) {
    return strcmp(rt_precision_case_name(i), name) == 0;
}

/* Rays that may start on the object: what is a rounding of doubles is any number of ulps of a t near 0. */
static bool starts_near(size_t i) {
    return is_case(i, "lattice") || is_case(i, "leaving");
}

/* Half an ulp is what rounding to float32 takes. What is computed in double takes no more, even along
 * tangents and from afar, but for 2^-46 of the distance to the far side of the box, 2^-22 units. A tangent of
 * a lattice has a double root, which takes half of the digits. */
RT_TEST(t_is_rounded_once_but_for_triangles) {
    for (int subject = 0; subject < RT_SUBJECT_COUNT; subject++) {
        if (subject == RT_SUBJECT_TRIANGLE) continue;
        for (size_t i = 0; i < MOST_CASES; i++) {
            const RtPrecision *p = &measured[subject][i];
            assert_true(p->hits > RAYS / 5);
            const double bound = is_case(i, "lattice") ? 1 : 0x1p-22;
            if (p->excess <= bound && (p->most <= 0.501 || starts_near(i))) continue;
            fail_msg("%s, %s: t is off by %g ulp, and by 0.501 ulp and %g units",
                     rt_subject_name((RtSubject)subject), rt_precision_case_name(i), p->most, p->excess);
        }
    }
}

/* A triangle's vertices are moved by a rounded shear, half a unit along two axes and more: its surface is
 * uncertain by that, and seen edge on t is by any number of ulps. The others are off by half an ulp of t, at
 * most sqrt(3) units. */
RT_TEST(hits_are_on_the_surface_within_a_few_units) {
    for (int subject = 0; subject < RT_SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < MOST_CASES; i++) {
            double bound = subject == RT_SUBJECT_TRIANGLE ? 4 : 1.74;
            if (measured[subject][i].off <= bound) continue;
            fail_msg("%s, %s: a hit is %g units off the surface", rt_subject_name((RtSubject)subject),
                     rt_precision_case_name(i), measured[subject][i].off);
        }
    }
}

/* An edge is passed within 2 units, and so is the start of a ray. Aimed at exactly, by lattices, any border
 * may be missed; a line through the tip of a cone, or along its side, passes no border. A wall of a tree that
 * is thinner than an ulp of t, 2 units, is not there, and the edge of a sharp wedge is farther off than the
 * wedge is thick. */
RT_TEST(decisions_differ_from_exact_ones_at_borders_only) {
    for (int subject = 0; subject < RT_SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < MOST_CASES; i++) {
            const RtPrecision *p = &measured[subject][i];
            bool edges = subject == RT_SUBJECT_TRIANGLE || subject == RT_SUBJECT_MESH;
            bool aimed = (edges && is_case(i, "border")) || is_case(i, "lattice");
            bool tip = subject == RT_SUBJECT_CONE && is_case(i, "lattice");
            if ((tip || p->border <= (subject >= RT_SUBJECT_CSG ? 4 : 2)) &&
                (aimed || p->missed + p->invented + p->elsewhere < RAYS / 50)) {
                continue;
            }
            fail_msg("%s, %s: %d missed, %d invented, %d elsewhere, up to %g units from a border",
                     rt_subject_name((RtSubject)subject), rt_precision_case_name(i), (int)p->missed,
                     (int)p->invented, (int)p->elsewhere, p->border);
        }
    }
}

/* Powers of two change no digit, unless numbers are lost at the ends of float32. */
RT_TEST(scale_makes_no_difference) {
    for (int subject = 0; subject < RT_SUBJECT_COUNT; subject++) {
        const RtPrecision *ordinary = &measured[subject][0];
        for (size_t i = 1; i < MOST_CASES; i++) {
            if (!is_case(i, "tiny") && !is_case(i, "huge")) continue;
            assert_memory_equal(ordinary, &measured[subject][i], sizeof *ordinary);
        }
    }
}

/* ---- needles ---- */

/* How far org + t dir is from the plane of the triangle, which may be passed beside it. */
static double off_plane(const RtVec3 v[3], const RtRay *ray, float t) {
    RtExactVec a = rt_exact_vec(rt_widen(v[0]));
    RtExactVec b = rt_exact_vec_sub(rt_exact_vec(rt_widen(v[1])), a);
    RtExactVec c = rt_exact_vec_sub(rt_exact_vec(rt_widen(v[2])), a);
    RtExactVec normal = rt_exact_cross(b, c), dir = rt_exact_vec(rt_widen(ray->dir));
    RtExactVec from = rt_exact_vec_sub(rt_exact_vec(rt_widen(ray->org)), a);
    RtExactVec point = rt_exact_vec_add_scaled(from, dir, rt_exact_of((double)t));
    long double height = rt_exact_value(rt_exact_dot(normal, point));
    long double length = sqrtl(rt_exact_value(rt_exact_dot(normal, normal)));
    rt_exact_rewind(0);
    return (double)fabsl(height / length);
}

/* A needle is thinner than the difference of float32 products, so that weights from those would put t
 * anywhere between its ends; but nothing is uncertain about where its plane is. */
RT_TEST(t_of_a_needle_is_that_of_its_plane) {
    RtRandom random = rt_random(11, 0);
    int hits = 0;
    for (int i = 0; i < 20000; i++) {
        RtVec3 v[3];
        for (int k = 0; k < 2; k++) v[k] = rt_random_point(&random, 1);
        float thin = rt_random_between(&random, 0x1p-20f, 0x1p-14f), along = rt_random_unit(&random);
        RtVec3 aside = rt_scale(rt_random_point(&random, 1), thin);
        v[2] = i % 2 ? rt_add(v[1], aside) : rt_add(rt_scale(rt_add(v[0], v[1]), 0.5f), aside);
        RtVec3 target = rt_add(v[0], rt_scale(rt_sub(v[1], v[0]), along));
        RtRay ray = {.org = rt_scale(rt_random_point(&random, 1), 3), .tmin = 0, .tmax = INFINITY};
        ray.dir = rt_sub(target, ray.org);
        OWNED_OBJECT(g, triangle, v, NULL);
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, &g, &ray, NULL);
        float t;
        if (rt_object_hit(&g, 0, &prepared, &t, NULL)) {
            hits++;
            double off = off_plane(v, &ray, t);
            double most = 16 * 0x1p-4 * (double)rt_thickness(ray.org, &g.box);
            if (!(off <= most)) fail_msg("needle %d: t = %g is %g off its plane", i, (double)t, off);
        }
    }
    assert_true(hits > 1000);
}

RT_TESTS(precision, measure, NULL)
