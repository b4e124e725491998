/* SPDX-License-Identifier: Apache-2.0 */
/* A place with a small experiment, for tests of result directories. */
#ifndef RT_TESTS_SMALL_RUN_TESTING_H
#define RT_TESTS_SMALL_RUN_TESTING_H

#include "experiment_testing.h"

static const char small_experiment[] = "name: small\n"
                                       "question: Which is cheaper?\n"
                                       "prediction: The hierarchy.\n"
                                       "scenes:\n"
                                       "  - {scene: \"balls:size=1\", size: 12x12, depth: 2}\n"
                                       "  - {scene: \"random:n=50\", label: cloud, size: 8x8, depth: 2}\n"
                                       "  - {scene: \"balls:size=1\", label: again, size: 8x8, depth: 1}\n"
                                       "accelerators: [{accel: bvh}, {accel: grid}]\n"
                                       "rays: [primary, shadow]\n"
                                       "count_only: yes\n"
                                       "limit: 100\n"
                                       "quick: {limit: 50}\n";

static inline int make_small(void **state) {
    return make_place_with(state, small_experiment);
}

#endif
