/* What a scene file holds, as libcyaml fills it in: the structures and their schema, private to yaml_read.c.
 * Keys that may be left out are pointers, NULL where they were; a material's name is "" then. */
#ifndef RT_SCENE_YAML_SCHEMA_H
#define RT_SCENE_YAML_SCHEMA_H

#include "base/file.h"
#include "base/yaml_file.h"
#include "scene/scene.h"

typedef struct RtYamlRotate {
    RtVec3 axis;
    float degrees;
} RtYamlRotate;

/* One step of a transform: exactly one of these. */
typedef struct RtYamlStep {
    float *scale;
    RtVec3 *stretch;
    RtYamlRotate *rotate;
    RtVec3 *translate;
} RtYamlStep;

typedef struct RtYamlSphere {
    RtVec3 center;
    float radius;
    char material[RT_MAX_NAME];
} RtYamlSphere;

typedef struct RtYamlPolygon {
    RtVec3 *vertices;
    uint32_t vertices_count;
    char material[RT_MAX_NAME];
} RtYamlPolygon;

typedef struct RtYamlTriangle {
    RtVec3 vertices[3];
    RtVec3 *normals; /* [3] */
    char material[RT_MAX_NAME];
} RtYamlTriangle;

typedef struct RtYamlCone {
    RtVec3 base, apex;
    float base_radius, apex_radius;
    char material[RT_MAX_NAME];
} RtYamlCone;

typedef struct RtYamlCylinder {
    RtVec3 base, apex;
    float radius;
    char material[RT_MAX_NAME];
} RtYamlCylinder;

typedef struct RtYamlMesh {
    char path[RT_MAX_PATH];
    char material[RT_MAX_NAME];
    RtYamlStep *transform;
    uint32_t transform_count;
} RtYamlMesh;

typedef struct RtYamlBuiltin {
    char name[RT_MAX_SCENE_NAME];
    RtYamlStep *transform;
    uint32_t transform_count;
} RtYamlBuiltin;

/* X(name, Type): what an entry of `objects` can be. */
#define RT_YAML_OBJECTS(X)                                                                                   \
    X(sphere, RtYamlSphere)                                                                                  \
    X(polygon, RtYamlPolygon)                                                                                \
    X(triangle, RtYamlTriangle)                                                                              \
    X(cone, RtYamlCone)                                                                                      \
    X(cylinder, RtYamlCylinder)                                                                              \
    X(mesh, RtYamlMesh)                                                                                      \
    X(builtin, RtYamlBuiltin)

typedef struct RtYamlObject {
#define RT_YAML_MEMBER(name, Type) Type *name;
    RT_YAML_OBJECTS(RT_YAML_MEMBER)
#undef RT_YAML_MEMBER
} RtYamlObject;

typedef struct RtYamlCamera {
    RtVec3 *from, *at, *up;
    float *fov, *hither;
    uint32_t *size; /* [2] */
} RtYamlCamera;

typedef struct RtYamlLight {
    RtVec3 position;
    RtVec3 *intensity;
} RtYamlLight;

/* X(name): the coefficients of a material, keys of the file and fields of RtMaterial alike. */
#define RT_YAML_COEFFICIENTS(X)                                                                              \
    X(ambient) X(diffuse) X(specular) X(shine) X(reflection) X(transmission) X(ior)

typedef struct RtYamlMaterial {
    char name[RT_MAX_NAME];
    RtVec3 *color;
#define RT_YAML_MEMBER(name) float *name;
    RT_YAML_COEFFICIENTS(RT_YAML_MEMBER)
#undef RT_YAML_MEMBER
} RtYamlMaterial;

typedef struct RtYamlScene {
    RtYamlCamera *camera;
    RtVec3 *background, *ambient;
    RtYamlLight *lights;
    uint32_t lights_count;
    RtYamlMaterial *materials;
    uint32_t materials_count;
    RtYamlObject *objects;
    uint32_t objects_count;
} RtYamlScene;

extern const cyaml_schema_value_t rt_yaml_scene_schema;

#endif
