/* SPDX-License-Identifier: Apache-2.0 */
#define RT_LIGHT_KERNELS rt_light_portable
#include "accel/light/kernels.h"
