/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/camera.h"

#include "core/base/elementary.h"

#include <stdio.h>

bool rt_image_size_parse(const char *text, uint32_t *width, uint32_t *height) {
    unsigned w = 0, h = 0;
    int length = 0;
    if (sscanf(text, "%5ux%5u%n", &w, &h, &length) != 2 || text[length]) return false;
    if (w < 1 || h < 1 || w > RT_MAX_IMAGE_SIDE || h > RT_MAX_IMAGE_SIDE) return false;
    *width = w;
    *height = h;
    return true;
}

RtStatus rt_sampling_init(RtSampling *sampling, uint32_t width, uint32_t height, uint32_t samples,
                          bool corners, RtError *error) {
    if (width < 1 || height < 1 || width > RT_MAX_IMAGE_SIDE || height > RT_MAX_IMAGE_SIDE)
        return rt_fail(error, RT_BAD_INPUT, "an image of %u x %u pixels: expected 1..%d on each side", width,
                       height, RT_MAX_IMAGE_SIDE);
    if (samples < 1 || samples > 64)
        return rt_fail(error, RT_BAD_INPUT, "%u samples along the side of a pixel: expected 1..64", samples);
    if (corners && samples > 1)
        return rt_fail(error, RT_BAD_INPUT,
                       "pixel corners have one sample each: omit the number of samples or the corners");
    *sampling = (RtSampling){.width = width,
                             .height = height,
                             .samples = samples,
                             .corners = corners,
                             .columns = corners ? width + 1 : width * samples,
                             .rows = corners ? height + 1 : height * samples};
    return RT_OK;
}

RtStatus rt_view_init(RtView *view, const RtCamera *camera, RtSampling sampling, RtError *error) {
    if (!(camera->fov > 0 && camera->fov < 180))
        return rt_fail(error, RT_BAD_INPUT,
                       "the camera's fov is %g degrees: expected a value above 0 and below 180",
                       (double)camera->fov);
    if (!(camera->near >= 0))
        return rt_fail(error, RT_BAD_INPUT, "the camera's near plane is at %g: expected at least 0",
                       (double)camera->near);
    RtVec3d axis = rt_subd(rt_widen(camera->at), rt_widen(camera->from));
    if (rt_lengthd(axis) == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "the camera has no direction: `from` and `at` are the same point");
    RtVec3d forward = rt_normalized(axis);
    RtVec3d right = rt_crossd(forward, rt_normalized(rt_widen(camera->up)));
    if (!(rt_lengthd(right) > 1e-6))
        return rt_fail(error, RT_BAD_INPUT,
                       "the camera's `up` is zero or along its line of sight: choose another");
    right = rt_normalized(right);
    RtVec3d down = rt_crossd(forward, right);
    RtTurn half = rt_turn((double)camera->fov / 2);
    double half_height = (double)(float)(half.sine / half.cosine);
    double half_width = half_height * sampling.width / sampling.height;
    *view = (RtView){.sampling = sampling,
                     .eye = rt_widen(camera->from),
                     .forward = forward,
                     .right = rt_scaled(right, half_width),
                     .down = rt_scaled(down, half_height),
                     .near = (double)camera->near};
    return RT_OK;
}

double rt_sample_position(uint32_t i, uint32_t n, bool corners) {
    return corners ? 2.0 * i / (n - 1) - 1 : (2.0 * i + 1) / n - 1;
}

RtRay rt_view_ray(const RtView *view, uint32_t column, uint32_t row) {
    const RtSampling *s = &view->sampling;
    RtVec3d dir =
        rt_add_scaledd(view->forward, view->right, rt_sample_position(column, s->columns, s->corners));
    dir = rt_add_scaledd(dir, view->down, rt_sample_position(row, s->rows, s->corners));
    return (RtRay){.org = rt_narrow(view->eye),
                   .tmin = (float)view->near,
                   .dir = rt_narrow(dir),
                   .tmax = INFINITY,
                   .kind = RT_RAY_PRIMARY,
                   .source = row * s->columns + column};
}
