/* SPDX-License-Identifier: Apache-2.0 */
/* From nodes of a YAML file to what stands in a scene: points of shapes, transforms, camera and lights. What
 * a node leaves out keeps its value. Messages go to yaml->error, with the position. */
#ifndef RT_SCENE_YAML_VALUES_H
#define RT_SCENE_YAML_VALUES_H

#include "core/base/transform.h"
#include "core/scene/scene.h"
#include "core/text/yaml.h"

/* The key of a value, which comes before it. */
static inline const char *rt_yaml_key_of(const RtYaml *yaml, const RtYamlNode *value) {
    return rt_yaml_text_of(yaml, value - 1);
}

/* The `transform` of an object, less `offset`; `wide`: translations are doubles. *given is `transform`, or
 * NULL if it moves nothing. */
RtStatus rt_yaml_transform(const RtYaml *yaml, const RtYamlNode *object, RtVec3d offset, bool wide,
                           RtTransform *transform, const RtTransform **given);

RtStatus rt_yaml_sphere(const RtYaml *yaml, const RtYamlNode *node, RtVec3 *center, float *radius);
/* A cone, or a cylinder. */
RtStatus rt_yaml_cone(const RtYaml *yaml, const RtYamlNode *node, RtCone *cone);
/* Three positions, or normals. */
RtStatus rt_yaml_points(const RtYaml *yaml, const RtYamlNode *list, bool normals, RtVec3 points[3]);
/* Texture coordinates. */
RtStatus rt_yaml_corners(const RtYaml *yaml, const RtYamlNode *list, RtUv at[3]);
/* The first of the points that place a solid. */
RtVec3d rt_yaml_first_point(const RtYaml *yaml, const RtYamlNode *solid);

/* Rejects a camera that cannot render. */
RtStatus rt_yaml_camera(const RtYaml *yaml, const RtYamlNode *node, RtCamera *camera);
RtStatus rt_yaml_color(const RtYaml *yaml, const RtYamlNode *node, const char *key, RtVec3 *color);
RtStatus rt_yaml_lights(const RtYaml *yaml, const RtYamlNode *list, RtScene *scene);

#endif
