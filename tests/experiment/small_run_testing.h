/* SPDX-License-Identifier: Apache-2.0 */
/* A place with a small experiment, for tests of result directories. */
#ifndef RT_TESTS_SMALL_RUN_TESTING_H
#define RT_TESTS_SMALL_RUN_TESTING_H

#include "experiment_testing.h"

static const char small_experiment[] =
    "name: small\nquestion: Which is cheaper?\nprediction: The hierarchy.\n"
    "scenes:\n"
    "  - {scene: \"balls:size=1\", size: 12x12, depth: 2}\n"
    "  - {scene: \"random:n=50\", label: cloud, size: 8x8, depth: 2}\n"
    "  - {scene: \"balls:size=1\", label: again, size: 8x8, depth: 1}\n"
    "accelerators: [{accel: bvh}, {accel: grid}]\nrays: [primary, shadow]\ncount_only: yes\nlimit: 100\n"
    "quick: {limit: 50}\n";

PLACES_WITH(small_experiment)

#endif
