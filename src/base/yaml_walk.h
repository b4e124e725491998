/* The walk of yaml_file.h over the events of a text: checks it against a schema, or finds a place in it. */
#ifndef RT_BASE_YAML_WALK_H
#define RT_BASE_YAML_WALK_H

#include "base/yaml_file.h"

/* Holds file->text against file->schema; the first fault goes to `error` with its place. */
RtStatus rt_yaml_check(const RtYamlFile *file, RtError *error);

/* Line and column, from 1, of the value at path `where` in a text that passed the check: of the value itself
 * where it is a scalar or in a list, of its key otherwise. */
void rt_yaml_locate(const RtYamlFile *file, const char *where, size_t *line, size_t *column);

#endif
