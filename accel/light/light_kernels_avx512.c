/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_light_avx512
#define RT_RASTER  rt_light_raster_avx512
#include "accel/light/light_kernels.h"
