/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of published figures share: an experiment that counts on balls:size=1, ten spheres and a
 * polygon, of which brute tests all 11 for each of the 64 primary rays, while the grid has 64 voxels; and a
 * table and reasons beside it. */
#ifndef RT_TESTS_PUBLISHED_TESTING_H
#define RT_TESTS_PUBLISHED_TESTING_H

#include "experiment_testing.h"

static const char experiment_text[] =
    "name: small\n"
    "question: b\n"
    "prediction: c\n"
    "scenes:\n"
    "  - {scene: \"balls:size=1\", label: balls, size: 8x8, depth: 1}\n"
    "  - {scene: \"random:n=20\", label: cloud, size: 4x4, depth: 1}\n"
    "accelerators:\n"
    "  - {accel: bvh}\n"
    "  - {accel: brute, label: all, scenes: [balls]}\n"
    "  - {accel: \"grid:resolution=4x4x4\", label: cells, scenes: [balls]}\n"
    "  - {accel: \"grid:resolution=2x2x2\", label: cells, scenes: [cloud]}\n"
    "published:\n"
    "  tables: [figures.csv]\n"
    "  reasons: reasons.csv\n"
    "  tolerance: {leaves: 1, object_tests: 3, primary: 1}\n"
    "rays: [primary]\n"
    "count_only: yes\n"
    "quick: {size: 4x4}\n";

static inline void write_figures(const Place *place, const char *rows) {
    char text[4096];
    snprintf(text, sizeof text,
             "# a comment\nscene,source,structure,parameters,accel,tests_per,leaves,object_tests,steps\n%s",
             rows);
    write_in(place, "figures.csv", text);
}

static inline void write_reasons(const Place *place, const char *rows) {
    char text[4096];
    snprintf(text, sizeof text, "scene,source,accel,column,reason\n%s", rows);
    write_in(place, "reasons.csv", text);
}

/* The experiment with `to` in the place of `from`. */
static inline void change_experiment(const Place *place, const char *from, const char *to) {
    write_changed(place, "small.yaml", experiment_text, from, to);
}

static inline int make_published(void **state) {
    if (make_place_with(state, experiment_text) != 0) return -1;
    write_reasons(*state, "");
    return 0;
}

#define RT_TEST_IN_PLACE(name) RT_TEST_WITH(name, make_published, remove_place)

#endif
