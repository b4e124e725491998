/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of brute: the same for every instruction set, and the same answers and counts as rt_test_all,
 * which is what they do many lanes at a time. */
#ifndef RT_ACCEL_BRUTE_BRUTE_H
#define RT_ACCEL_BRUTE_BRUTE_H

#include "accel/isa.h"

RT_DECLARE_KERNELS(brute);

#endif
