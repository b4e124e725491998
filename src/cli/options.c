/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/options.h"

#include "cli/cli.h"

#include <assert.h>
#include <stdio.h>

enum { MOST_OPTIONS = 32, FIRST_KEY = 256 };

/* The input of the parser. */
typedef struct Parse {
    const RtSyntax *syntax;
    char *options;
} Parse;

static void take_option(const RtOption *o, char *options, const char *text, struct argp_state *state) {
    const RtOptionValue *value = &o->value;
    char *at = options + value->offset, name[40];
    snprintf(name, sizeof name, "--%s", o->name);
    const bool whole = value->form == RT_OPTION_INTEGER || value->form == RT_OPTION_SECONDS;
    const int64_t number = whole ? rt_cli_integer(state, name, text, value->low, value->high) : value->low;
    switch (value->form) {
    case RT_OPTION_FLAG: *(bool *)at = true; return;
    case RT_OPTION_TEXT: *(const char **)at = text; return;
    case RT_OPTION_INTEGER:
        if (value->size == sizeof(uint32_t))
            *(uint32_t *)at = (uint32_t)number;
        else
            *(uint64_t *)at = (uint64_t)number;
        return;
    case RT_OPTION_SECONDS: *(double *)at = (double)number; return;
    case RT_OPTION_PERCENT: *(double *)at = rt_cli_percent(state, name, text); return;
    case RT_OPTION_SET: *(int *)at = (int)number; return;
    case RT_OPTION_SIZE: rt_cli_size(state, text, (uint32_t *)at, (uint32_t *)at + 1); return;
    case RT_OPTION_PATH: rt_cli_set_path(state, name, (const char **)at, text, value->endings); return;
    case RT_OPTION_TAKE: value->take(options, text, state); return;
    }
}

static void take_argument(const Parse *parse, const char *text, struct argp_state *state) {
    const RtArgument *argument = &parse->syntax->argument;
    const char **slot = (const char **)(parse->options + argument->offset);
    if (argument->take) {
        argument->take(parse->options, text, state);
        return;
    }
    if (*slot) argp_error(state, "one %s at a time; '%s' is a second one", argument->name, text);
    *slot = text;
}

static error_t parse_key(int key, char *text, struct argp_state *state) {
    const Parse *parse = state->input;
    const RtSyntax *syntax = parse->syntax;
    switch (key) {
    case ARGP_KEY_INIT:
        if (syntax->children) state->child_inputs[0] = parse->options + syntax->child;
        return 0;
    case ARGP_KEY_ARG:
        if (!syntax->argument.name) return ARGP_ERR_UNKNOWN;
        take_argument(parse, text, state);
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num == 0 && syntax->argument.missing)
            argp_error(state, "%s", syntax->argument.missing);
        if (syntax->finish) syntax->finish(parse->options, state);
        return 0;
    default: break;
    }
    for (int i = 0; syntax->options && syntax->options[i].name; i++) {
        const RtOption *o = &syntax->options[i];
        if (key != FIRST_KEY + i && key != o->letter) continue;
        take_option(o, parse->options, text, state);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

const struct argp *rt_cli_argp(const RtSyntax *syntax) {
    static struct argp_option options[MOST_OPTIONS + 1];
    static struct argp argp;
    int count = 0;
    for (const RtOption *o = syntax->options; o && o->name; o++) {
        assert(count < MOST_OPTIONS);
        options[count] = (struct argp_option){
            o->name, o->letter ? o->letter : FIRST_KEY + count, o->operand, o->value.flags, o->help, 0};
        count++;
    }
    options[count] = (struct argp_option){0};
    argp = (struct argp){.options = count > 0 ? options : NULL, /* glibc leaks an empty table */
                         .parser = parse_key,
                         .args_doc = syntax->arguments,
                         .doc = syntax->help,
                         .children = syntax->children};
    return &argp;
}

void rt_cli_parse(const RtSyntax *syntax, int argc, char **argv, void *options) {
    Parse parse = {syntax, options};
    argp_parse(rt_cli_argp(syntax), argc, argv, 0, 0, &parse);
}
