/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by yaml_read.c, yaml_solids.c and yaml_write.c. The functions that add objects to the scene check
 * the values; rt_yaml_place adds the position to their messages. */
#ifndef RT_SCENE_YAML_READER_H
#define RT_SCENE_YAML_READER_H

#include "core/base/file.h"
#include "core/scene/formula.h"
#include "core/scene/scene.h"
#include "core/text/yaml.h"

typedef struct RtYamlNamed {
    const char *name;
    const RtYamlNode *node; /* the entry of the list */
    uint32_t index;         /* its position in the list */
} RtYamlNamed;

/* The entries of a list, sorted by name. */
typedef struct RtYamlNames {
    RtYamlNamed *all; /* owned, [count] */
    uint32_t count;
} RtYamlNames;

typedef struct RtYamlReader {
    RtYaml yaml;
    RtSceneOpener *open_named;
    RtScene *scene;
    RtYamlNames materials; /* entry i is material i of the scene */
    uint32_t standard;     /* index of the default material; UINT32_MAX until it is needed */
    RtCsgBuilder builder;  /* holds the solids */
    RtYamlNames solids;    /* entry i is terms[i] */
    RtCsgTerm *terms;
    uint32_t solids_known; /* solids read so far: formulas see only earlier ones */
    RtError *error;
} RtYamlReader;

/* X(name): the coefficients of a material, keys of the file and fields of RtMaterial alike. */
#define RT_YAML_COEFFICIENTS(X)                                                                              \
    X(ambient) X(diffuse) X(specular) X(shine) X(reflection) X(transmission) X(ior)

/* For a list X(name) of alternatives: their keys (rt_yaml_keys). */
#define RT_YAML_ONE_OF(name) #name "| "

/* yaml_reader.c */

/* Checks the entries of `list` (NULL: none) against `keys`, and fills `names` with their names, of at most
 * `most` characters. Rejects duplicates; `what` describes the entries in messages. */
RtStatus rt_yaml_read_names(RtYamlReader *r, const RtYamlNode *list, const char *keys, size_t most,
                            const char *what, RtYamlNames *names);
const RtYamlNamed *rt_yaml_find_name(const RtYamlNames *names, const char *name);

/* The `material` of an object; without one, the default material, created on first use. */
RtStatus rt_yaml_find_material(RtYamlReader *r, const RtYamlNode *object, uint32_t *index);

/* The `transform` of an object. *given is `transform`, or NULL if there are no steps. */
RtStatus rt_yaml_read_transform(RtYamlReader *r, const RtYamlNode *object, RtTransform *transform,
                                const RtTransform **given);

/* A cone, or a cylinder: keys and values. */
RtStatus rt_yaml_read_cone(const RtYaml *yaml, const RtYamlNode *node, bool cylinder, RtCone *cone);

/* Adds the triangles of the file at the `path` of an object to `scene`, moved by its `transform`. */
RtStatus rt_yaml_append_mesh(RtYamlReader *r, const RtYamlNode *object, uint32_t material, RtScene *scene);

/* yaml_solids.c */

/* Reads the list of solids (NULL: none) into the builder. */
RtStatus rt_yaml_add_solids(RtYamlReader *r, const RtYamlNode *list);

/* Adds a CSG tree as one object. */
RtStatus rt_yaml_add_csg(RtYamlReader *r, const RtYamlNode *csg);

#endif
