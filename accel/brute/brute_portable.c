/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_brute_portable
#include "accel/brute/brute_kernels.h"
