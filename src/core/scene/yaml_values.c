/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/yaml_values.h"

#include <stdlib.h>
#include <string.h>

/* ---- transforms ---- */

static RtStatus add_rotation(const RtYaml *y, const RtYamlNode *n, RtTransform *transform) {
    RtVec3 axis = {0};
    float degrees = 0;
    RT_TRY(rt_yaml_keys(y, n, "axis degrees"));
    RT_TRY(rt_yaml_point(y, n, "axis", &axis));
    RT_TRY(rt_yaml_float(y, n, "degrees", &degrees));
    RtStatus status = rt_transform_rotate(transform, axis, (double)degrees, y->error);
    return rt_yaml_place(y, status, n, NULL);
}

static RtStatus add_step(const RtYaml *y, const RtYamlNode *step, bool wide, RtTransform *transform) {
    float scale = 1;
    double exact[3] = {0};
    RtVec3 stretch, move = {0};
    RT_TRY(rt_yaml_keys(y, step, "scale| stretch| rotate| translate|"));
    const RtYamlNode *rotate = rt_yaml_get(y, step, "rotate");
    if (rotate) return add_rotation(y, rotate, transform);
    RT_TRY(rt_yaml_float(y, step, "scale", &scale));
    stretch = rt_vec3(scale, scale, scale);
    RT_TRY(rt_yaml_point(y, step, "stretch", &stretch));
    RT_TRY(rt_yaml_point(y, step, "translate", &move));
    RtStatus status = rt_yaml_get(y, step, "translate") ? rt_transform_translate(transform, move, y->error)
                                                        : rt_transform_scale(transform, stretch, y->error);
    if (wide) RT_TRY(rt_yaml_doubles(y, step, "translate", 3, exact));
    for (int a = 0; a < 3 && wide; a++) transform->m[a][3] += exact[a] - (double)move.at[a];
    return rt_yaml_place(y, status, step, NULL);
}

RtStatus rt_yaml_transform(const RtYaml *y, const RtYamlNode *object, RtVec3d offset, bool wide,
                           RtTransform *transform, const RtTransform **given) {
    const RtYamlNode *steps = rt_yaml_get(y, object, "transform");
    *transform = rt_transform_identity();
    RT_TRY(rt_yaml_list(y, steps, NULL, 0, UINT32_MAX, "steps"));
    for (const RtYamlNode *n = rt_yaml_first(steps); n != rt_yaml_end(steps); n += n->size)
        RT_TRY(add_step(y, n, wide, transform));
    for (int a = 0; a < 3; a++) transform->m[a][3] -= offset.at[a];
    *given = rt_yaml_count(steps) || rt_dotd(offset, offset) > 0 ? transform : NULL;
    return RT_OK;
}

/* ---- shapes ---- */

RtStatus rt_yaml_sphere(const RtYaml *y, const RtYamlNode *n, RtVec3 *center, float *radius) {
    *center = rt_vec3(0, 0, 0);
    *radius = 0;
    RT_TRY(rt_yaml_keys(y, n, "center radius material?"));
    RT_TRY(rt_yaml_position(y, n, "center", center));
    return rt_yaml_float(y, n, "radius", radius);
}

RtStatus rt_yaml_cone(const RtYaml *y, const RtYamlNode *n, RtCone *cone) {
    const bool cylinder = strcmp(rt_yaml_key_of(y, n), "cylinder") == 0;
    *cone = (RtCone){0};
    RT_TRY(rt_yaml_keys(
        y, n, cylinder ? "base apex radius material?" : "base base_radius apex apex_radius material?"));
    RT_TRY(rt_yaml_position(y, n, "base", &cone->base));
    RT_TRY(rt_yaml_position(y, n, "apex", &cone->apex));
    RT_TRY(rt_yaml_float(y, n, cylinder ? "radius" : "base_radius", &cone->base_radius));
    return rt_yaml_float(y, n, cylinder ? "radius" : "apex_radius", &cone->apex_radius);
}

RtStatus rt_yaml_points(const RtYaml *y, const RtYamlNode *list, bool normals, RtVec3 points[3]) {
    RT_TRY(rt_yaml_list(y, list, NULL, 3, 3, "lists of numbers, as in [1, 2, 3]"));
    for (const RtYamlNode *p = rt_yaml_first(list); p != rt_yaml_end(list); p += p->size)
        RT_TRY((normals ? rt_yaml_point : rt_yaml_position)(y, p, NULL, points++));
    return RT_OK;
}

RtStatus rt_yaml_corners(const RtYaml *y, const RtYamlNode *list, RtUv at[3]) {
    RT_TRY(rt_yaml_list(y, list, NULL, 3, 3, "pairs of numbers, as in [0, 1]"));
    for (const RtYamlNode *p = rt_yaml_first(list); p != rt_yaml_end(list); p += p->size, at++) {
        RT_TRY(rt_yaml_list(y, p, NULL, 2, 2, "numbers, as in [0, 1]"));
        RT_TRY(rt_yaml_float(y, p + 1, NULL, &at->u));
        RT_TRY(rt_yaml_float(y, p + 2, NULL, &at->v));
    }
    return RT_OK;
}

RtVec3d rt_yaml_first_point(const RtYaml *y, const RtYamlNode *solid) {
    static const char *const keys[] = {"center", "lo", "point", "base", "vertices", "triangles"};
    RtVec3d point = {{0, 0, 0}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        const RtYamlNode *n = rt_yaml_get(y, solid, keys[i]);
        while (n && n->kind == RT_YAML_LIST && n->count > 0) n++;
        for (int a = 0; n && a < 3 && n + a < y->nodes + y->node_count && n[a].kind == RT_YAML_SCALAR; a++)
            point.at[a] = strtod(rt_yaml_text_of(y, n + a), NULL);
    }
    return point;
}

/* ---- camera, light ---- */

static bool is_far(RtVec3 p) {
    return rt_maxf(fabsf(p.x), rt_maxf(fabsf(p.y), fabsf(p.z))) > RT_MAX_COORDINATE;
}

/* Checks the camera as rendering does. If it will be placed later, its line of sight is assumed
 * perpendicular to `up`. */
static RtStatus check_camera(const RtCamera *camera, bool placed, const char **key, RtError *error) {
    *key = "size";
    RtSampling sampling;
    RT_TRY(rt_sampling_init(&sampling, camera->width, camera->height, 1, false, error));
    *key = is_far(camera->from) ? "from" : "at";
    if (is_far(camera->from) || is_far(camera->at))
        return rt_fail(error, RT_BAD_INPUT, "the camera is farther than %g from the origin: move it nearer",
                       (double)RT_MAX_COORDINATE);
    RtCamera tried = *camera;
    if (!placed) tried.at.at[(rt_major_axis(camera->up) + 1) % 3] = 1;
    RtVec3 gap = rt_sub(tried.at, tried.from);
    *key = !(camera->fov > 0 && camera->fov < 180) ? "fov"
           : !(camera->near >= 0)                  ? "near"
           : rt_dot(gap, gap) > 0                  ? "up"
                                                   : "at";
    RtView view;
    return rt_view_init(&view, &tried, sampling, error);
}

RtStatus rt_yaml_camera(const RtYaml *y, const RtYamlNode *n, RtCamera *camera) {
    RT_TRY(rt_yaml_keys(y, n, "from? at? up? fov? near? size?"));
    bool placed = rt_yaml_get(y, n, "from");
    if (placed != !!rt_yaml_get(y, n, "at"))
        return rt_yaml_fail(y, n,
                            "`from` and `at` belong together: give both, or neither for a camera that sees "
                            "the whole scene");
    RT_TRY(rt_yaml_position(y, n, "from", &camera->from));
    RT_TRY(rt_yaml_position(y, n, "at", &camera->at));
    RT_TRY(rt_yaml_point(y, n, "up", &camera->up));
    RT_TRY(rt_yaml_float(y, n, "fov", &camera->fov));
    RT_TRY(rt_yaml_float(y, n, "near", &camera->near));
    RT_TRY(rt_yaml_list(y, n, "size", 2, 2, "numbers, as in [640, 480]"));
    const RtYamlNode *size = rt_yaml_get(y, n, "size");
    uint32_t *side = &camera->width;
    for (const RtYamlNode *s = rt_yaml_first(size); s != rt_yaml_end(size); s += s->size) {
        RT_TRY(rt_yaml_u32(y, s, NULL, 1, RT_MAX_IMAGE_SIDE, side));
        side = &camera->height;
    }
    const char *key;
    RtStatus status = check_camera(camera, placed, &key, y->error);
    return rt_yaml_place(y, status, n, key);
}

RtStatus rt_yaml_color(const RtYaml *y, const RtYamlNode *node, const char *key, RtVec3 *color) {
    RT_TRY(rt_yaml_point(y, node, key, color));
    if (color->x >= 0 && color->y >= 0 && color->z >= 0) return RT_OK;
    RtStatus status = rt_fail(y->error, RT_BAD_INPUT, "a colour must not be negative: [red, green, blue]");
    return rt_yaml_place(y, status, node, key);
}

RtStatus rt_yaml_lights(const RtYaml *y, const RtYamlNode *list, RtScene *scene) {
    RT_TRY(rt_yaml_list(y, list, NULL, 0, UINT32_MAX, "lights"));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RtVec3 position = {0}, intensity = rt_vec3(1, 1, 1);
        RT_TRY(rt_yaml_keys(y, n, "position intensity?"));
        RT_TRY(rt_yaml_position(y, n, "position", &position));
        RT_TRY(rt_yaml_point(y, n, "intensity", &intensity));
        RT_TRY(rt_yaml_place(y, rt_scene_add_light(scene, position, intensity, y->error), n, NULL));
    }
    return RT_OK;
}
