/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS rt_item_portable
#define RT_RASTER  rt_item_raster_portable
#include "accel/item/item_kernels.h"
