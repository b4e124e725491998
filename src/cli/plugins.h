/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins on the command line: --plugin FILE, and $RAYTALLY_PLUGINS. */
#ifndef RT_CLI_PLUGINS_H
#define RT_CLI_PLUGINS_H

#include "experiment/experiment.h"

#include <argp.h>

/* The child parser of commands that take accelerators. */
extern const struct argp rt_plugin_argp;

/* Loads what the environment and these arguments name, before the arguments are parsed: they may be about the
 * accelerators in it. The environment then names all of it, for programs that are started. */
RtStatus rt_cli_load_plugins(int argc, char *const *argv, RtError *error);

/* " --plugin 'FILE'" for each that was given, to out[0..room): for commands that a user is told to type. */
void rt_cli_plugin_arguments(char *out, size_t room);

/* Says on stderr which accelerators of the experiment are of other plugins than the manifest of `directory`
 * names, or of none. */
void rt_cli_tell_plugins(const char *directory, const RtExperiment *experiment);

#endif
