/* What the files that turn YAML into a scene share, private to yaml_read.c and yaml_solids.c. What is wrong
 * with values themselves is found by the functions that add them to the scene; it gets its place here: each
 * adder leaves in reader->at the key under which it was when it failed. */
#ifndef RT_SCENE_YAML_READER_H
#define RT_SCENE_YAML_READER_H

#include "scene/yaml_schema.h"

#include <stdio.h>

/* A name and where its bearer stands. Sorted by name for finding. */
typedef struct RtYamlNamed {
    const char *name;
    uint32_t index;
} RtYamlNamed;

typedef struct RtYamlReader {
    const RtYamlFile *file;
    const RtYamlScene *yaml;
    RtSceneOpener *open_named;
    RtScene *scene;
    RtYamlNamed *materials; /* [yaml->materials_count], sorted by name */
    uint32_t standard;      /* index of the default material; UINT32_MAX until an object wants it */
    RtCsgBuilder builder;   /* holds the solids */
    RtCsgTerm *terms;       /* [yaml->solids_count] */
    RtYamlNamed *solids;    /* [yaml->solids_count], sorted by name; index into `terms` */
    uint32_t solids_known;  /* of them, those that are read: a formula sees what stands before it */
    char at[64];            /* ".radius", ".transform[2].scale": below the entry, for messages */
    RtError *error;
} RtYamlReader;

static inline void rt_yaml_at(RtYamlReader *r, const char *key) {
    snprintf(r->at, sizeof r->at, ".%s", key);
}

/* yaml_read.c */

/* Gives a failure the place of entry `i` of `list`, or of what is below it. */
RtStatus rt_yaml_place(const RtYamlReader *r, RtStatus status, const char *list, uint32_t i,
                       const char *below);

/* Sorts names[0..count), and refuses two that are the same: `what` and `list` are for the message. */
RtStatus rt_yaml_sort_names(const RtYamlReader *r, RtYamlNamed *names, uint32_t count, const char *what,
                            const char *list);
const RtYamlNamed *rt_yaml_find_name(const RtYamlNamed *names, uint32_t count, const char *name);

/* The material called `name`; "" is the default one, made when first wanted. */
RtStatus rt_yaml_find_material(RtYamlReader *r, const char *name, uint32_t *index);

RtStatus rt_yaml_make_transform(RtYamlReader *r, const RtYamlStep *steps, uint32_t count,
                                RtTransform *transform);

/* The path of a file that the scene names; a relative one starts in the folder of the scene file. */
RtStatus rt_yaml_path(const RtYamlReader *r, const char *name, char path[RT_MAX_PATH]);

/* yaml_solids.c */

/* Reads the list of solids into the builder. */
RtStatus rt_yaml_add_solids(RtYamlReader *r);

/* One object: a tree of them. */
RtStatus rt_yaml_add_csg(RtYamlReader *r, const RtYamlCsg *csg);

#endif
