/* SPDX-License-Identifier: Apache-2.0 */
/* raytally completion: a bash function that prints names from the tables of commands, options, accelerators
 * and scenes, followed by cli/completion.bash, which calls it. */
#include "accel/accel.h"
#include "accel/columns.h"
#include "cli/cli.h"
#include "completion_bash.h"
#include "core/base/ray.h"
#include "scenes/builtin.h"

#include <stdio.h>
#include <string.h>

/* Begin and end the list TABLE:ENTRY of names. */
static void begin(const char *table, const char *entry) {
    printf("    %s%s%s) echo '", table, *entry ? ":" : "", entry);
}

static void end(void) {
    puts("' ;;");
}

/* ---- options ---- */

/* --NAME=VALUE and -cVALUE, with the table's VALUE up to a blank; without VALUE if it is optional. */
static void print_options(const struct argp *argp) {
    for (const struct argp_option *o = argp->options; o && (o->name || o->doc); o++) {
        if (!o->name || o->flags & (OPTION_HIDDEN | OPTION_DOC)) continue;
        const char *value = o->arg && !(o->flags & OPTION_ARG_OPTIONAL) ? o->arg : "";
        int length = (int)strcspn(value, " ");
        printf(" --%s%s%.*s", o->name, length ? "=" : "", length, value);
        if (o->key > ' ' && o->key < 127) printf(" -%c%.*s", o->key, length, value);
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        print_options(child->argp);
}

static void print_commands(const RtCommand *commands, int count) {
    begin("commands", "");
    for (int i = 0; i < count; i++) printf(" %s", commands[i].name);
    end();
    for (int i = 0; i < count; i++) {
        const RtCommand *command = &commands[i];
        begin("options", command->name);
        fputs("--help --usage", stdout);
        print_options(rt_cli_argp(command->syntax));
        end();
        begin("argument", command->name);
        fputs(command->arguments, stdout);
        end();
    }
}

/* ---- accelerators and scenes ---- */

static bool is_word(const RtParam *param) {
    return param->type == RT_PARAM_CHOICE || param->type == RT_PARAM_FLAG;
}

/* KEY= for each parameter, and the values of parameters that are words. */
static void print_params(const char *table, const char *name, const RtParam *params, size_t count) {
    char value[RT_MAX_SPEC_CHARS], entry[2 * RT_MAX_NAME];
    begin(table, name);
    for (size_t i = 0; i < count; i++) printf(" %s=", params[i].name);
    end();
    for (size_t i = 0; i < count; i++) {
        if (!is_word(&params[i])) continue;
        snprintf(entry, sizeof entry, "%s:%s", name, params[i].name);
        begin(table, entry);
        rt_param_range(&params[i], value, sizeof value);
        for (char *words = value, *word; (word = strsep(&words, "|"));) printf(" %s", word);
        end();
    }
}

static void print_accelerators(void) {
    begin("accels", "");
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        printf(" %s%s", ops->name, ops->kinds ? "+" : "");
    }
    end();
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        print_params("accels", ops->name, ops->params, ops->param_count);
    }
}

static void print_scenes(void) {
    begin("scenes", "");
    for (size_t i = 0; i < rt_builtin_count(); i++) printf(" %s", rt_builtin_at(i)->name);
    end();
    for (size_t i = 0; i < rt_builtin_count(); i++) {
        const RtBuiltin *builtin = rt_builtin_at(i);
        print_params("scenes", builtin->name, builtin->params, builtin->param_count);
    }
}

/* ---- the command ---- */

static void print_words(void) {
    begin("kinds", "");
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) printf(" %s", rt_ray_kind_name((RtRayKind)kind));
    end();
    begin("counters", "");
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) printf(" %s", rt_tally_columns[i].name);
    end();
}

static void take_shell(void *options, const char *text, struct argp_state *state) {
    (void)options;
    if (strcmp(text, "bash") != 0) argp_error(state, "there is no completion for '%s', only for bash", text);
}

const RtSyntax rt_completion_syntax = {
    .arguments = "bash",
    .argument = {.name = "SHELL", .missing = "a SHELL is missing: bash", .take = take_shell},
    .help = "Print a script that completes commands, options, accelerators and scenes with their parameters "
            "in bash.\v"
            "In this shell: source <(raytally completion bash)\n"
            "In all later shells: raytally completion bash > "
            "~/.local/share/bash-completion/completions/raytally"};

void rt_completion_print(const RtCommand *commands, int count) {
    puts("# Made by `raytally completion bash`.\n_raytally_names() {\n    case $1 in");
    print_commands(commands, count);
    print_accelerators();
    print_scenes();
    print_words();
    puts("    esac\n}");
    for (const char *const *line = completion_bash; *line; line++) fputs(*line, stdout);
}
