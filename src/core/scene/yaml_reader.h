/* SPDX-License-Identifier: Apache-2.0 */
/* What the files between YAML and scenes share, private to yaml_read.c, yaml_solids.c and yaml_write.c. What
 * is wrong with values themselves is found by the functions that add them to the scene; rt_yaml_place says
 * where. */
#ifndef RT_SCENE_YAML_READER_H
#define RT_SCENE_YAML_READER_H

#include "core/base/file.h"
#include "core/scene/formula.h"
#include "core/scene/scene.h"
#include "core/text/yaml.h"

typedef struct RtYamlNamed {
    const char *name;
    const RtYamlNode *node; /* the entry of the list */
    uint32_t index;         /* its place in the list */
} RtYamlNamed;

/* The entries of a list, sorted by name for finding. */
typedef struct RtYamlNames {
    RtYamlNamed *all; /* owned, [count] */
    uint32_t count;
} RtYamlNames;

typedef struct RtYamlReader {
    RtYaml yaml;
    RtSceneOpener *open_named;
    RtScene *scene;
    RtYamlNames materials; /* entry i is material i of the scene */
    uint32_t standard;     /* index of the default material; UINT32_MAX until an object wants it */
    RtCsgBuilder builder;  /* holds the solids */
    RtYamlNames solids;    /* entry i is terms[i] */
    RtCsgTerm *terms;
    uint32_t solids_known; /* of them, those that are read: a formula sees what stands before it */
    RtError *error;
} RtYamlReader;

/* X(name): the coefficients of a material, keys of the file and fields of RtMaterial alike. */
#define RT_YAML_COEFFICIENTS(X)                                                                              \
    X(ambient) X(diffuse) X(specular) X(shine) X(reflection) X(transmission) X(ior)

/* For a list X(name) of what an entry can be: their keys (rt_yaml_keys). */
#define RT_YAML_ONE_OF(name) #name "| "

/* yaml_reader.c */

/* Holds the entries of `list` (NULL: none) against `keys`, and fills `names` with theirs, of at most `most`
 * characters. Refuses two that are the same; `what` they are is for messages. */
RtStatus rt_yaml_read_names(RtYamlReader *r, const RtYamlNode *list, const char *keys, size_t most,
                            const char *what, RtYamlNames *names);
const RtYamlNamed *rt_yaml_find_name(const RtYamlNames *names, const char *name);

/* The `material` of an object; the default one, made when first wanted, where it gives none. */
RtStatus rt_yaml_find_material(RtYamlReader *r, const RtYamlNode *object, uint32_t *index);

/* The `transform` of an object. *given is `transform`, or NULL where there are no steps. */
RtStatus rt_yaml_read_transform(RtYamlReader *r, const RtYamlNode *object, RtTransform *transform,
                                const RtTransform **given);

/* A cone, or a cylinder: keys and values. */
RtStatus rt_yaml_read_cone(const RtYaml *yaml, const RtYamlNode *node, bool cylinder, RtCone *cone);

/* The file at the `path` of an object, moved by its `transform`, its triangles added to `scene`. */
RtStatus rt_yaml_append_mesh(RtYamlReader *r, const RtYamlNode *object, uint32_t material, RtScene *scene);

/* yaml_solids.c */

/* Reads the list of solids (NULL: none) into the builder. */
RtStatus rt_yaml_add_solids(RtYamlReader *r, const RtYamlNode *list);

/* One object: a tree of them. */
RtStatus rt_yaml_add_csg(RtYamlReader *r, const RtYamlNode *csg);

#endif
