/* SPDX-License-Identifier: Apache-2.0 */
#define RT_ITEM_KERNELS rt_item_portable
#include "accel/item/kernels.h"
