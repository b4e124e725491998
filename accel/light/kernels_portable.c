/* SPDX-License-Identifier: Apache-2.0 */
#define RT_KERNELS  rt_light_portable
#define RT_PAINTING rt_light_painting_portable
#include "accel/light/kernels.h"
