/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/light/light.h"

const RtLightKernels *rt_light_kernels(RtIsa isa) {
    return isa == RT_ISA_AVX512 ? &rt_light_avx512 : isa == RT_ISA_AVX2 ? &rt_light_avx2 : &rt_light_portable;
}
