/* SPDX-License-Identifier: Apache-2.0 */
/* The pinhole camera. One function makes every primary ray, so rays, item buffers and ray sets agree on them
 * bit for bit.
 *
 * Samples lie on a grid of `columns` x `rows` over the image plane, row by row from the upper left:
 *
 *   pixel centres:  columns = width * samples, sample i at (i + 1/2) / columns of the width;
 *   pixel corners:  columns = width + 1,       sample i at i / width of the width (as in SPD). */
#ifndef RT_SCENE_CAMERA_H
#define RT_SCENE_CAMERA_H

#include "core/base/ray.h"
#include "core/base/status.h"

typedef struct RtCamera {
    RtVec3 from, at, up;
    float fov;              /* full vertical angle, degrees, in (0, 180) */
    float near;             /* distance along the axis to the near plane, >= 0 */
    uint32_t width, height; /* pixels, the default image size */
} RtCamera;

#define RT_MAX_IMAGE_SIDE 32768

/* Parses "640x480": width and height in pixels, each 1..RT_MAX_IMAGE_SIDE. Returns false, changing
 * nothing, for anything else. */
bool rt_image_size_parse(const char *text, uint32_t *width, uint32_t *height);

/* How an image of width x height pixels is sampled. */
typedef struct RtSampling {
    uint32_t width, height;
    uint32_t samples; /* N: N x N samples a pixel; 1 with corners */
    bool corners;
    uint32_t columns, rows; /* of the sample grid */
} RtSampling;

/* Rejects sides outside 1..RT_MAX_IMAGE_SIDE, samples outside 1..64, and corners with samples > 1. */
RtStatus rt_sampling_init(RtSampling *sampling, uint32_t width, uint32_t height, uint32_t samples,
                          bool corners, RtError *error);

/* The camera's coordinate frame for one sampling, computed once. */
typedef struct RtView {
    RtSampling sampling;
    RtVec3d eye, forward; /* forward: to the centre of the image plane, at distance 1 */
    RtVec3d right, down;  /* half the width and half the height of the image plane at distance 1 */
    double near;
} RtView;

/* Rejects a camera with from = at, `up` along its axis, or a fov outside (0, 180). */
RtStatus rt_view_init(RtView *view, const RtCamera *camera, RtSampling sampling, RtError *error);

/* Position of sample `i` of `n` (a column or a row of the grid) across the image plane, in -1..1. */
double rt_sample_position(uint32_t i, uint32_t n, bool corners);

/* The primary ray of the sample in `column`, `row`: from the eye, not normalised (its component along the
 * axis is 1, so t is depth), tmin at the near plane, source = row * columns + column. Its direction is
 * (forward + right * column position) + down * row position, in double, rounded once. */
RtRay rt_view_ray(const RtView *view, uint32_t column, uint32_t row);

#endif
