/* SPDX-License-Identifier: Apache-2.0 */
/* raytally completion SHELL prints a script, cli/completion.SHELL. The script runs `raytally completion
 * --words WORD...` with the words after the program's name, up to the cursor. That prints what may replace
 * the last word, one per line, from the tables of commands, options, accelerators and scenes. A last line
 * FILES means that it may also be a file. */
#include "accel/accel.h"
#include "accel/columns.h"
#include "cli/cli.h"
#include "completion_bash.h"
#include "completion_fish.h"
#include "completion_zsh.h"
#include "core/base/ray.h"
#include "scenes/builtin.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define SHELLS "bash|zsh|fish"

/* The word at the cursor. */
typedef struct Word {
    const char *text;
    size_t kept; /* characters before the part that is completed: in "grid:den", those up to the colon */
} Word;

/* Prints the word with `name` and `after`, if `name` completes it. */
static void offer(Word word, const char *name, const char *after) {
    const char *typed = word.text + word.kept;
    if (strncmp(name, typed, strlen(typed)) != 0) return;
    printf("%.*s%s%s\n", (int)word.kept, word.text, name, after);
}

/* The same word, completed after the last of the characters `marks`. */
static Word part_after(Word word, const char *marks) {
    for (size_t i = word.kept; word.text[i]; i++) {
        if (strchr(marks, word.text[i])) word.kept = i + 1;
    }
    return word;
}

/* Each of "on|off"; a blank ends the list. */
static void offer_choices(Word word, const char *list) {
    char name[RT_MAX_NAME];
    for (size_t length; *list && *list != ' '; list += length + (list[length] == '|')) {
        length = strcspn(list, "| ");
        snprintf(name, sizeof name, "%.*s", (int)length, list);
        offer(word, name, "");
    }
}

/* ---- accelerators and scenes ---- */

/* What continues NAME:KEY=VALUE,KEY=VALUE. */
static void offer_params(Word word, const RtParam *params, size_t count) {
    word = part_after(word, ":,");
    const char *key = word.text + word.kept;
    const size_t length = strcspn(key, "=");
    for (size_t i = 0; i < count; i++) {
        const RtParam *param = &params[i];
        char range[RT_MAX_SPEC_CHARS];
        if (!key[length]) offer(word, param->name, "=");
        if (!key[length] || strlen(param->name) != length || strncmp(param->name, key, length) != 0) continue;
        if (param->type != RT_PARAM_CHOICE && param->type != RT_PARAM_FLAG) continue;
        rt_param_range(param, range, sizeof range);
        offer_choices(part_after(word, "="), range);
    }
}

static bool has_name(const char *spec, const char *name) {
    const size_t length = strlen(name);
    return strncmp(spec, name, length) == 0 && spec[length] == ':';
}

/* `joint` follows an overlay. */
static void offer_accelerators(Word word, const char *joint) {
    word = part_after(word, "+");
    const char *layer = word.text + word.kept;
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        if (!strchr(layer, ':')) offer(word, ops->name, ops->kinds ? joint : "");
        if (has_name(layer, ops->name)) offer_params(word, ops->params, ops->param_count);
    }
}

static void offer_scenes(Word word) {
    const char *spec = word.text + word.kept;
    for (size_t i = 0; i < rt_builtin_count(); i++) {
        const RtBuiltin *builtin = rt_builtin_at(i);
        if (!strchr(spec, ':')) offer(word, builtin->name, "");
        if (has_name(spec, builtin->name)) offer_params(word, builtin->params, builtin->param_count);
    }
}

/* ---- values ---- */

static bool begins(const char *text, const char *with) {
    return strncmp(text, with, strlen(with)) == 0;
}

/* `what` is the name of a value in the table of options, or of an argument in the list of commands. */
static void offer_values(const RtCommand *command, const char *what, Word word) {
    static const char *const files[] = {"FILE", "DIR", "FOLDER", "PROGRAM", "EXPERIMENT"};
    const bool is_scene = strstr(what, "SCENE") || begins(what, "IN OUT") || begins(what, "BEFORE");
    bool is_file = is_scene;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) is_file |= begins(what, files[i]);
    if (begins(what, "SPEC")) {
        offer_accelerators(word, "+");
        offer(word, "all", "");
    } else if (begins(what, "[NAME]")) {
        if (strcmp(command->name, "accels") == 0) offer_accelerators(word, "");
        if (strcmp(command->name, "scenes") == 0) offer_scenes(word);
    } else if (begins(what, "KIND")) {
        for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++)
            offer(part_after(word, ","), rt_ray_kind_name((RtRayKind)kind), "");
    } else if (begins(what, "COUNTER")) {
        for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) offer(word, rt_tally_columns[i].name, "");
    } else if (begins(what, "SHELL")) {
        offer_choices(word, SHELLS);
    } else if (islower((unsigned char)*what) && strchr(what, '|')) {
        offer_choices(word, what);
    }
    if (is_scene) offer_scenes(word);
    if (is_file) puts("FILES");
}

/* ---- options ---- */

static void offer_options(const struct argp *argp, Word word) {
    char name[RT_MAX_NAME];
    for (const struct argp_option *o = argp->options; o && (o->name || o->doc); o++) {
        if (!o->name || o->flags & (OPTION_HIDDEN | OPTION_DOC)) continue;
        snprintf(name, sizeof name, "--%s", o->name);
        offer(word, name, "");
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        offer_options(child->argp, word);
}

/* What follows an option, --NAME or -N, of `length` characters: the name of its value. NULL: no value, or one
 * that may be left out. */
static const char *value_of(const struct argp *argp, const char *option, size_t length) {
    for (const struct argp_option *o = argp->options; o && (o->name || o->doc); o++) {
        if (!o->name) continue;
        const bool letter = length == 2 && *option == '-' && option[1] == o->key;
        const bool word = begins(option, "--") && strlen(o->name) == length - 2 &&
                          strncmp(option + 2, o->name, length - 2) == 0;
        if (letter || word) return o->flags & OPTION_ARG_OPTIONAL ? NULL : o->arg;
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++) {
        const char *found = value_of(child->argp, option, length);
        if (found) return found;
    }
    return NULL;
}

/* ---- the command ---- */

static void offer_commands(const RtCommand *commands, int count, Word word) {
    for (int i = 0; i < count; i++) offer(word, commands[i].name, "");
    offer(word, "help", "");
    offer(word, "--help", "");
    offer(word, "--version", "");
}

static void offer_for_command(const RtCommand *command, const char *before, Word word) {
    const struct argp *argp = rt_cli_argp(command->syntax);
    const size_t option = strcspn(word.text, "=");
    const bool joined = begins(word.text, "--") && word.text[option]; /* --OPTION=VALUE */
    const char *what = joined ? value_of(argp, word.text, option) : value_of(argp, before, strlen(before));
    if (joined) word.kept = option + 1;
    if (what) {
        offer_values(command, what, word);
    } else if (!joined && *word.text == '-') {
        offer_options(argp, word);
        offer(word, "--help", "");
        offer(word, "--usage", "");
    } else if (!joined) {
        offer_values(command, command->arguments, word);
    }
}

static void offer_words(const RtCommand *commands, int count, int word_count, char *const *words) {
    const Word word = {word_count > 0 ? words[word_count - 1] : "", 0};
    if (word_count < 2 || strcmp(words[0], "help") == 0) {
        offer_commands(commands, count, word);
        return;
    }
    for (int i = 0; i < count; i++) {
        if (strcmp(commands[i].name, words[0]) == 0)
            offer_for_command(&commands[i], word_count > 2 ? words[word_count - 2] : "", word);
    }
}

static void take_shell(void *options, const char *text, struct argp_state *state) {
    const char *const **script = options;
    *script = strcmp(text, "bash") == 0   ? completion_bash
              : strcmp(text, "zsh") == 0  ? completion_zsh
              : strcmp(text, "fish") == 0 ? completion_fish
                                          : NULL;
    if (!*script) argp_error(state, "there is no completion for '%s', only for bash, zsh and fish", text);
}

const RtSyntax rt_completion_syntax = {
    .arguments = SHELLS,
    .argument = {.name = "SHELL",
                 .missing = "a SHELL is missing: bash, zsh or fish",
                 .value = RT_TO_TAKE(take_shell)},
    .help = "Print a script that completes commands, options, accelerators and scenes with their parameters. "
            "It runs raytally at each completion, so it stays valid for other versions.\v"
            "In this shell:\n"
            "  bash   source <(raytally completion bash)\n"
            "  zsh    source <(raytally completion zsh), after compinit\n"
            "  fish   raytally completion fish | source\n"
            "In all later shells, write the script to\n"
            "  bash   ~/.local/share/bash-completion/completions/raytally\n"
            "  zsh    _raytally, in a folder of $fpath\n"
            "  fish   ~/.config/fish/completions/raytally.fish"};

void rt_completion(const RtCommand *commands, int count, int argc, char **argv) {
    const char *const *script = NULL;
    if (argc > 1 && strcmp(argv[1], "--words") == 0) {
        offer_words(commands, count, argc - 2, argv + 2);
        return;
    }
    rt_cli_parse(&rt_completion_syntax, argc, argv, &script);
    for (; *script; script++) fputs(*script, stdout);
}
