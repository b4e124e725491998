#include "scene/yaml_schema.h"

#define OPTIONAL CYAML_FLAG_OPTIONAL
#define POINTER  CYAML_FLAG_POINTER

static const cyaml_schema_value_t number = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, float)};
static const cyaml_schema_value_t wide_number = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, double)};
static const cyaml_schema_value_t whole = {CYAML_VALUE_UINT(CYAML_FLAG_DEFAULT, uint32_t)};

/* A list of `n` entries, into a member of that size or behind a pointer. (The macro of libcyaml takes the
 * size of an entry from the member, which here is a vector.) */
#define LIST_VALUE(flags_, size, entry_, n)                                                                  \
    {                                                                                                        \
        .type = CYAML_SEQUENCE_FIXED, .flags = (enum cyaml_flag)(flags_), .data_size = size, .sequence = {   \
            .entry = &(entry_),                                                                              \
            .min = n,                                                                                        \
            .max = n                                                                                         \
        }                                                                                                    \
    }
#define LIST(Struct, member, flags_, size, entry_, n)                                                        \
    { .key = #member, .data_offset = offsetof(Struct, member), .value = LIST_VALUE(flags_, size, entry_, n) }

static const cyaml_schema_value_t point = LIST_VALUE(CYAML_FLAG_DEFAULT, sizeof(float), number, 3);

#define POINT(Struct, member)           LIST(Struct, member, CYAML_FLAG_DEFAULT, sizeof(float), number, 3)
#define OPTIONAL_POINT(Struct, member)  LIST(Struct, member, OPTIONAL | POINTER, sizeof(float), number, 3)
#define NUMBER(Struct, member)          CYAML_FIELD_FLOAT(#member, CYAML_FLAG_DEFAULT, Struct, member)
#define OPTIONAL_NUMBER(Struct, member) CYAML_FIELD_FLOAT_PTR(#member, OPTIONAL | POINTER, Struct, member)
#define TEXT(Struct, member)            CYAML_FIELD_STRING(#member, CYAML_FLAG_DEFAULT, Struct, member, 1)
#define MATERIAL(Struct)                CYAML_FIELD_STRING("material", OPTIONAL, Struct, material, 1)
#define LIST_OF(Struct, member, flags_, entry_, least)                                                       \
    CYAML_FIELD_SEQUENCE(#member, (flags_) | POINTER, Struct, member, &(entry_), least, CYAML_UNLIMITED)
#define MAPPING(Struct, member, fields) CYAML_FIELD_MAPPING_PTR(#member, OPTIONAL, Struct, member, fields)

/* ---- transforms ---- */

static const cyaml_schema_field_t rotate_fields[] = {POINT(RtYamlRotate, axis), NUMBER(RtYamlRotate, degrees),
                                                     CYAML_FIELD_END};

static const cyaml_schema_field_t step_fields[] = {
    OPTIONAL_NUMBER(RtYamlStep, scale), OPTIONAL_POINT(RtYamlStep, stretch),
    MAPPING(RtYamlStep, rotate, rotate_fields), OPTIONAL_POINT(RtYamlStep, translate), CYAML_FIELD_END};

static const cyaml_schema_value_t step = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, RtYamlStep, step_fields)};

/* ---- kinds of objects and solids: one table a kind, called KIND_fields ---- */

static const cyaml_schema_field_t sphere_fields[] = {
    POINT(RtYamlSphere, center), NUMBER(RtYamlSphere, radius), MATERIAL(RtYamlSphere), CYAML_FIELD_END};

static const cyaml_schema_field_t polygon_fields[] = {
    LIST_OF(RtYamlPolygon, vertices, CYAML_FLAG_DEFAULT, point, 3), MATERIAL(RtYamlPolygon), CYAML_FIELD_END};

static const cyaml_schema_field_t triangle_fields[] = {
    LIST(RtYamlTriangle, vertices, CYAML_FLAG_DEFAULT, sizeof(RtVec3), point, 3),
    LIST(RtYamlTriangle, normals, OPTIONAL | POINTER, sizeof(RtVec3), point, 3), MATERIAL(RtYamlTriangle),
    CYAML_FIELD_END};

static const cyaml_schema_field_t cone_fields[] = {POINT(RtYamlCone, base), NUMBER(RtYamlCone, base_radius),
                                                   POINT(RtYamlCone, apex), NUMBER(RtYamlCone, apex_radius),
                                                   MATERIAL(RtYamlCone),    CYAML_FIELD_END};

static const cyaml_schema_field_t cylinder_fields[] = {
    POINT(RtYamlCylinder, base), POINT(RtYamlCylinder, apex), NUMBER(RtYamlCylinder, radius),
    MATERIAL(RtYamlCylinder), CYAML_FIELD_END};

static const cyaml_schema_field_t mesh_fields[] = {TEXT(RtYamlMesh, path), MATERIAL(RtYamlMesh),
                                                   LIST_OF(RtYamlMesh, transform, OPTIONAL, step, 0),
                                                   CYAML_FIELD_END};

static const cyaml_schema_field_t ellipsoid_fields[] = {POINT(RtYamlEllipsoid, center),
                                                        POINT(RtYamlEllipsoid, radii),
                                                        MATERIAL(RtYamlEllipsoid), CYAML_FIELD_END};

static const cyaml_schema_field_t box_fields[] = {POINT(RtYamlBox, lo), POINT(RtYamlBox, hi),
                                                  MATERIAL(RtYamlBox), CYAML_FIELD_END};

static const cyaml_schema_field_t torus_fields[] = {
    POINT(RtYamlTorus, center), OPTIONAL_POINT(RtYamlTorus, axis),
    NUMBER(RtYamlTorus, major), NUMBER(RtYamlTorus, minor),
    MATERIAL(RtYamlTorus),      CYAML_FIELD_END};

static const cyaml_schema_field_t half_space_fields[] = {POINT(RtYamlHalfSpace, point),
                                                         POINT(RtYamlHalfSpace, normal),
                                                         MATERIAL(RtYamlHalfSpace), CYAML_FIELD_END};

static const cyaml_schema_value_t plane = LIST_VALUE(CYAML_FLAG_DEFAULT, sizeof(double), wide_number, 4);

static const cyaml_schema_field_t polyhedron_fields[] = {
    LIST_OF(RtYamlPolyhedron, vertices, OPTIONAL, point, 4),
    LIST_OF(RtYamlPolyhedron, planes, OPTIONAL, plane, 1), MATERIAL(RtYamlPolyhedron), CYAML_FIELD_END};

static const cyaml_schema_value_t facet = LIST_VALUE(CYAML_FLAG_DEFAULT, sizeof(float), number, 9);

static const cyaml_schema_field_t facets_fields[] = {
    LIST_OF(RtYamlFacets, triangles, CYAML_FLAG_DEFAULT, facet, 4), MATERIAL(RtYamlFacets), CYAML_FIELD_END};

static const cyaml_schema_field_t standard_fields[] = {
    TEXT(RtYamlStandard, kind), CYAML_FIELD_FLOAT_PTR("ratio", OPTIONAL | POINTER, RtYamlStandard, ratio),
    LIST(RtYamlStandard, place, CYAML_FLAG_DEFAULT, sizeof(double), wide_number, 12),
    MATERIAL(RtYamlStandard), CYAML_FIELD_END};

static const cyaml_schema_field_t csg_fields[] = {
    CYAML_FIELD_STRING_PTR("formula", POINTER, RtYamlCsg, formula, 1, CYAML_UNLIMITED), MATERIAL(RtYamlCsg),
    CYAML_FIELD_STRING_PTR("extents", OPTIONAL | POINTER, RtYamlCsg, extents, 0, CYAML_UNLIMITED),
    LIST_OF(RtYamlCsg, transform, OPTIONAL, step, 0), CYAML_FIELD_END};

static const cyaml_schema_field_t builtin_fields[] = {
    TEXT(RtYamlBuiltin, name), LIST_OF(RtYamlBuiltin, transform, OPTIONAL, step, 0), CYAML_FIELD_END};

static const cyaml_schema_field_t object_fields[] = {
#define FIELD(name, Type) MAPPING(RtYamlObject, name, name##_fields),
    RT_YAML_OBJECTS(FIELD)
#undef FIELD
        CYAML_FIELD_END};

static const cyaml_schema_value_t object = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, RtYamlObject, object_fields)};

static const cyaml_schema_field_t solid_fields[] = {
    CYAML_FIELD_STRING("name", CYAML_FLAG_DEFAULT, RtYamlSolid, name, 1),
    CYAML_FIELD_STRING_PTR("formula", OPTIONAL | POINTER, RtYamlSolid, formula, 1, CYAML_UNLIMITED),
#define FIELD(name, Type) MAPPING(RtYamlSolid, name, name##_fields),
    RT_YAML_SOLIDS(FIELD)
#undef FIELD
        LIST_OF(RtYamlSolid, transform, OPTIONAL, step, 0),
    CYAML_FIELD_END};

static const cyaml_schema_value_t solid = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, RtYamlSolid, solid_fields)};

/* ---- the rest of a scene ---- */

static const cyaml_schema_field_t camera_fields[] = {
    OPTIONAL_POINT(RtYamlCamera, from),
    OPTIONAL_POINT(RtYamlCamera, at),
    OPTIONAL_POINT(RtYamlCamera, up),
    OPTIONAL_NUMBER(RtYamlCamera, fov),
    OPTIONAL_NUMBER(RtYamlCamera, near),
    LIST(RtYamlCamera, size, OPTIONAL | POINTER, sizeof(uint32_t), whole, 2),
    CYAML_FIELD_END};

static const cyaml_schema_field_t light_fields[] = {POINT(RtYamlLight, position),
                                                    OPTIONAL_POINT(RtYamlLight, intensity), CYAML_FIELD_END};

static const cyaml_schema_value_t light = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, RtYamlLight, light_fields)};

static const cyaml_schema_field_t material_fields[] = {TEXT(RtYamlMaterial, name),
                                                       OPTIONAL_POINT(RtYamlMaterial, color),
#define FIELD(name) OPTIONAL_NUMBER(RtYamlMaterial, name),
                                                       RT_YAML_COEFFICIENTS(FIELD)
#undef FIELD
                                                           CYAML_FIELD_END};

static const cyaml_schema_value_t material = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, RtYamlMaterial, material_fields)};

static const cyaml_schema_field_t scene_fields[] = {
    MAPPING(RtYamlScene, camera, camera_fields),
    OPTIONAL_POINT(RtYamlScene, background),
    OPTIONAL_POINT(RtYamlScene, ambient),
    LIST_OF(RtYamlScene, lights, OPTIONAL, light, 0),
    LIST_OF(RtYamlScene, materials, OPTIONAL, material, 0),
    LIST_OF(RtYamlScene, solids, OPTIONAL, solid, 0),
    LIST_OF(RtYamlScene, objects, CYAML_FLAG_DEFAULT, object, 1),
    CYAML_FIELD_END};

const cyaml_schema_value_t rt_yaml_scene_schema = {CYAML_VALUE_MAPPING(POINTER, RtYamlScene, scene_fields)};
