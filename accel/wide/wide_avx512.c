/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_wide_avx512
#include "accel/wide/wide_kernels.h"
