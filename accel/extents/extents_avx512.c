/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_extents_avx512
#include "accel/extents/extents_kernels.h"
