/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins on the command line: --plugin FILE, and $RAYTALLY_PLUGINS. */
#ifndef RT_CLI_PLUGINS_H
#define RT_CLI_PLUGINS_H

#include "experiment/experiment.h"

#include <argp.h>

/* The child parser of commands that take accelerators. */
extern const struct argp rt_plugin_argp;

/* Loads the plugins that the environment and these arguments name, before the arguments are parsed, since
 * they may name accelerators of plugins. */
RtStatus rt_cli_load_plugins(int argc, char *const *argv, RtError *error);

/* Appends " --plugin 'FILE'" for each given plugin to out[0..size), for commands shown to the user. */
void rt_cli_plugin_arguments(char *out, size_t size);

/* Says on stderr which accelerators of the experiment come from other plugins than in the manifest of
 * `directory`, or from none. */
void rt_cli_tell_plugins(const char *directory, const RtExperiment *experiment);

#endif
