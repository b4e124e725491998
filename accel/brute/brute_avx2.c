/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_brute_avx2
#include "accel/brute/brute_kernels.h"
