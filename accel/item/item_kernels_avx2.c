/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_item_avx2
#define RT_RASTER  rt_item_raster_avx2
#include "accel/item/item_kernels.h"
