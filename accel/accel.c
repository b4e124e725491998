/* SPDX-License-Identifier: Apache-2.0 */
/* The struct that every accelerator begins with. */
#include "accel/accel.h"

#include "core/base/memory.h"

RtStatus rt_accel_new(const RtBuild *what, size_t bytes, RtAccel **out, RtError *error) {
    RtAccel *accel = rt_alloc(1, bytes);
    if (!accel) return rt_fail_memory(error, what->ops->name, bytes);
    *accel = (RtAccel){.ops = what->ops, .scene = what->scene, .exact = true, .counts = true};
    *out = accel;
    return RT_OK;
}

RtStatus rt_accel_built(RtAccel *accel, RtStatus status, RtAccel **out) {
    if (status == RT_OK)
        *out = accel;
    else
        accel->ops->destroy(accel);
    return status;
}
