/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_wide_portable
#include "accel/wide/wide_kernels.h"
