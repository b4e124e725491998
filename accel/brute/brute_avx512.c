/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_brute_avx512
#include "accel/brute/brute_kernels.h"
