/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes are drawn in the homogeneous coordinates of the view: (x, y, w) with w the distance along the axis
 * and the image -w <= x, y <= w, in which the near plane and the four sides of the view are planes to clip
 * with alike. */
#include "render/structure.h"

#include "render/draw.h"

typedef struct Drawing {
    RtImage *image;
    RtView view;
    double near;
    double deepest;
} Drawing;

static RtVec3d project(const RtView *view, RtVec3d point) {
    RtVec3d p = rt_subd(point, view->eye);
    return rt_vec3d(rt_dotd(p, view->right) / rt_dotd(view->right, view->right),
                    rt_dotd(p, view->down) / rt_dotd(view->down, view->down), rt_dotd(p, view->forward));
}

/* Distance of `p` to side `plane` of the visible space, negative outside. */
static double inside(const Drawing *drawing, RtVec3d p, int plane) {
    switch (plane) {
    case 0: return p.z - drawing->near;
    case 1: return p.z - p.x;
    case 2: return p.z + p.x;
    case 3: return p.z - p.y;
    default: return p.z + p.y;
    }
}

/* Cuts the segment to what is visible; false if nothing is. */
static bool clip(const Drawing *drawing, RtVec3d *a, RtVec3d *b) {
    for (int plane = 0; plane < 5; plane++) {
        double at_a = inside(drawing, *a, plane), at_b = inside(drawing, *b, plane);
        if (at_a < 0 && at_b < 0) return false;
        if (at_a >= 0 && at_b >= 0) continue;
        RtVec3d cut = rt_add_scaledd(*a, rt_subd(*b, *a), at_a / (at_a - at_b));
        *(at_a < 0 ? a : b) = cut;
    }
    return a->z > 0 && b->z > 0;
}

static void draw_edge(const Drawing *drawing, RtVec3d a, RtVec3d b, RtColor color, double opacity) {
    if (!clip(drawing, &a, &b)) return;
    double width = drawing->image->width, height = drawing->image->height;
    rt_draw_line(drawing->image, (a.x / a.z + 1) / 2 * width, (a.y / a.z + 1) / 2 * height,
                 (b.x / b.z + 1) / 2 * width, (b.y / b.z + 1) / 2 * height, color, opacity);
}

static void draw_box(void *context, const RtBox *box, uint32_t depth) {
    const Drawing *drawing = context;
    if (rt_box_is_empty(*box)) return;
    double deep = drawing->deepest > 0 ? fmin(depth / drawing->deepest, 1) : 0;
    RtColor color = rt_color_scale(1 - 0.7 * deep);
    double opacity = fmax(0.2, 1 / (1 + 0.15 * depth));
    RtVec3d corners[8]; /* bit a of the index: lo or hi along axis a */
    for (int i = 0; i < 8; i++) {
        RtVec3d corner;
        for (int a = 0; a < 3; a++) corner.at[a] = (double)(i >> a & 1 ? box->hi : box->lo).at[a];
        corners[i] = project(&drawing->view, corner);
    }
    for (int i = 0; i < 8; i++) {
        for (int a = 0; a < 3; a++) {
            if (i >> a & 1) continue;
            draw_edge(drawing, corners[i], corners[i | 1 << a], color, opacity);
        }
    }
}

RtStatus rt_structure_available(const RtAccelOps *ops, RtError *error) {
    if (ops->each_box) return RT_OK;
    return rt_fail(error, RT_NOT_AVAILABLE, "accelerator %s has no boxes to draw: choose another", ops->name);
}

RtStatus rt_draw_structure(RtImage *image, const RtAccel *accel, RtError *error) {
    accel = rt_accel_base(accel);
    RT_TRY(rt_structure_available(accel->ops, error));
    RtDescription description;
    accel->ops->describe(accel, &description);
    const RtCamera *camera = &accel->scene->camera;
    Drawing drawing = {.image = image, .deepest = (double)description.depth};
    RtSampling sampling;
    RT_TRY(rt_sampling_init(&sampling, image->width, image->height, 1, false, error));
    RT_TRY(rt_view_init(&drawing.view, camera, sampling, error));
    double distance = rt_lengthd(rt_subd(rt_widen(camera->at), drawing.view.eye));
    drawing.near = fmax(drawing.view.near, 1e-3 * distance);
    for (size_t i = 0; i < (size_t)image->width * image->height * 3; i++) image->rgb[i] /= 3;
    accel->ops->each_box(accel, (RtBoxViewer){draw_box, &drawing});
    return RT_OK;
}
