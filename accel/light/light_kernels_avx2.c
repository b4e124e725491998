/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_light_avx2
#define RT_RASTER  rt_light_raster_avx2
#include "accel/light/light_kernels.h"
