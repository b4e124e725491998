/* SPDX-License-Identifier: Apache-2.0 */
#include "report/color.h"

const char *rt_candidate_color(uint32_t candidate) {
    /* The eight of Okabe & Ito (2008), told apart by colour-blind readers too, led by grey; then four
     * more. */
    static const char *const colors[] = {"#8c8c8c", "#e69f00", "#009e73", "#0072b2", "#56b4e9", "#d55e00",
                                         "#cc79a7", "#5b4a9f", "#a6761d", "#66a61e", "#b2182b", "#17becf"};
    return colors[candidate % (sizeof colors / sizeof colors[0])];
}
