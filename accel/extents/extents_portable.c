/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_extents_portable
#include "accel/extents/extents_kernels.h"
