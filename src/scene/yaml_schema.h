/* What a scene file holds, as libcyaml fills it in: the structures and their schema, private to yaml_read.c.
 * Keys that may be left out are pointers, NULL where they were; a material's name is "" then. */
#ifndef RT_SCENE_YAML_SCHEMA_H
#define RT_SCENE_YAML_SCHEMA_H

#include "base/file.h"
#include "base/yaml_file.h"
#include "scene/formula.h"
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

/* ---- solids of CSG trees ---- */

typedef struct RtYamlEllipsoid {
    RtVec3 center, radii;
    char material[RT_MAX_NAME];
} RtYamlEllipsoid;

typedef struct RtYamlBox {
    RtVec3 lo, hi;
    char material[RT_MAX_NAME];
} RtYamlBox;

typedef struct RtYamlTorus {
    RtVec3 center;
    RtVec3 *axis;
    float major, minor;
    char material[RT_MAX_NAME];
} RtYamlTorus;

typedef struct RtYamlHalfSpace {
    RtVec3 point, normal;
    char material[RT_MAX_NAME];
} RtYamlHalfSpace;

/* Of points, one of the two. */
typedef struct RtYamlPolyhedron {
    RtVec3 *vertices;
    uint32_t vertices_count;
    double (*planes)[4];
    uint32_t planes_count;
    char material[RT_MAX_NAME];
} RtYamlPolyhedron;

/* As raytally writes solids: a standard one of solid.h, and where it is. */
typedef struct RtYamlStandard {
    char kind[16];
    double *ratio;
    double place[12]; /* rows of 4 */
    char material[RT_MAX_NAME];
} RtYamlStandard;

typedef struct RtYamlFacets {
    float (*triangles)[9];
    uint32_t triangles_count;
    char material[RT_MAX_NAME];
} RtYamlFacets;

/* X(name, Type): what an entry of `solids` can be, besides a formula. */
#define RT_YAML_SOLIDS(X)                                                                                    \
    X(sphere, RtYamlSphere)                                                                                  \
    X(ellipsoid, RtYamlEllipsoid)                                                                            \
    X(box, RtYamlBox)                                                                                        \
    X(cylinder, RtYamlCylinder)                                                                              \
    X(cone, RtYamlCone)                                                                                      \
    X(torus, RtYamlTorus)                                                                                    \
    X(half_space, RtYamlHalfSpace)                                                                           \
    X(polyhedron, RtYamlPolyhedron)                                                                          \
    X(mesh, RtYamlMesh)                                                                                      \
    X(facets, RtYamlFacets)                                                                                  \
    X(standard, RtYamlStandard)

typedef struct RtYamlSolid {
    char name[RT_FORMULA_MAX_NAME];
    char *formula;
#define RT_YAML_MEMBER(name, Type) Type *name;
    RT_YAML_SOLIDS(RT_YAML_MEMBER)
#undef RT_YAML_MEMBER
    RtYamlStep *transform;
    uint32_t transform_count;
} RtYamlSolid;

typedef struct RtYamlCsg {
    char *formula;
    char material[RT_MAX_NAME];
    char *extents; /* may be NULL */
    RtYamlStep *transform;
    uint32_t transform_count;
} RtYamlCsg;

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
    X(csg, RtYamlCsg)                                                                                        \
    X(mesh, RtYamlMesh)                                                                                      \
    X(builtin, RtYamlBuiltin)

typedef struct RtYamlObject {
#define RT_YAML_MEMBER(name, Type) Type *name;
    RT_YAML_OBJECTS(RT_YAML_MEMBER)
#undef RT_YAML_MEMBER
} RtYamlObject;

typedef struct RtYamlCamera {
    RtVec3 *from, *at, *up;
    float *fov, *near;
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
    RtYamlSolid *solids;
    uint32_t solids_count;
    RtYamlObject *objects;
    uint32_t objects_count;
} RtYamlScene;

extern const cyaml_schema_value_t rt_yaml_scene_schema;

#endif
