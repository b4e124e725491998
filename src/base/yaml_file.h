/* A YAML file read by a libcyaml schema, with every complaint as FILE:LINE:COLUMN.
 *
 * libcyaml fills C structures by a schema, but lets pass what it takes for good ("1m" as 1, 1e39 as infinity,
 * a second document), and knows no lines once it is done. So the events of libyaml are held against the same
 * schema first, and may be walked again to find the line of any value by its path,
 * "objects[3].sphere.radius".
 *
 * Schemas may use mappings, sequences, fixed sequences, floats, unsigned integers and strings; their depth is
 * at most RT_YAML_MAX_DEPTH, and a mapping has at most RT_YAML_MAX_KEYS keys. */
#ifndef RT_BASE_YAML_FILE_H
#define RT_BASE_YAML_FILE_H

#include "base/status.h"

#include <cyaml/cyaml.h>

#define RT_YAML_MAX_DEPTH 16
#define RT_YAML_MAX_KEYS  32
#define RT_YAML_MAX_BYTES ((size_t)1 << 30) /* of one file */

typedef struct RtYamlFile {
    const char *path; /* borrowed */
    char *text;       /* owned, [length] */
    size_t length;
    const cyaml_schema_value_t *schema; /* borrowed */
    void *data;                         /* owned: what the schema describes */
} RtYamlFile;

/* Reads the file at `path` and fills file->data by `schema`, a mapping with CYAML_FLAG_POINTER whose address
 * stays valid. Refuses what is missing, not a regular file, empty, larger than RT_YAML_MAX_BYTES, not YAML,
 * more than one document, aliases (*name), keys that the schema does not know or that come twice, missing
 * keys, too short or too long lists and texts, and numbers that are not finite or not numbers to the end. On
 * failure nothing is owned. */
RtStatus rt_yaml_file_open(RtYamlFile *file, const char *path, const cyaml_schema_value_t *schema,
                           RtError *error);

/* The same of a text of rt_alloc that was read already, with a 0 behind its last byte; it is owned from here
 * on, and freed on failure. `path` names it in messages. */
RtStatus rt_yaml_file_take(RtYamlFile *file, const char *path, char *text, size_t length,
                           const cyaml_schema_value_t *schema, RtError *error);

/* Puts the place of the value at `where` (a path as above, "" for the whole) before the message of `error`,
 * and gives `status` back. Of a path the file does not have, the longest beginning it has counts. Errors that
 * are not about the input (RT_NO_MEMORY) are left as they are, and RT_OK is. `error` may be NULL. */
RtStatus rt_yaml_file_place(const RtYamlFile *file, RtStatus status, const char *where, RtError *error);

/* Frees text and data. */
void rt_yaml_file_close(RtYamlFile *file);

#endif
