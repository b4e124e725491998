/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS  rt_item_avx512
#define RT_PAINTING rt_item_painting_avx512
#include "accel/item/kernels.h"
