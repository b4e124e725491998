/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS  rt_item_avx2
#define RT_PAINTING rt_item_painting_avx2
#include "accel/item/kernels.h"
