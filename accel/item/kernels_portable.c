/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS  rt_item_portable
#define RT_PAINTING rt_item_painting_portable
#include "accel/item/kernels.h"
