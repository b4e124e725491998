/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_light_portable
#define RT_RASTER  rt_light_raster_portable
#include "accel/light/light_kernels.h"
