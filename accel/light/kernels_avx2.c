/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS  rt_light_avx2
#define RT_PAINTING rt_light_painting_avx2
#include "accel/light/kernels.h"
