/* SPDX-License-Identifier: Apache-2.0 */
/* The command line of a command: one table of its options says what --help prints and where each value goes.
 *
 * The values go to a struct that the command's file calls Options. */
#ifndef RT_CLI_OPTIONS_H
#define RT_CLI_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct RtPixel {
    uint32_t x, y;
    bool given;
} RtPixel;

/* Reads `text`; ends the process by argp_error if it is wrong. */
typedef void RtTakeOption(void *options, const char *text, struct argp_state *state);

/* Where the value of an option goes, and what it may be. */
typedef struct RtOptionValue {
    enum {
        RT_OPTION_FLAG,    /* bool: true */
        RT_OPTION_TEXT,    /* const char *: as given */
        RT_OPTION_LIST,    /* const char *[high], one value after the other; their number is at `count` */
        RT_OPTION_INTEGER, /* an integer type of `size` bytes: low..high */
        RT_OPTION_SECONDS, /* double: a whole number, low..high */
        RT_OPTION_PERCENT, /* double: "1%" is 0.01 */
        RT_OPTION_SET,     /* int, or an enum: `low` */
        RT_OPTION_BYTES,   /* uint64_t: "512M" is 512 * 10^6; at least 1 */
        RT_OPTION_SIZE,    /* uint32_t[2]: WIDTHxHEIGHT */
        RT_OPTION_PIXEL,   /* RtPixel: X,Y */
        RT_OPTION_PATH,    /* const char *: a file name that ends in one of `endings` */
        RT_OPTION_TAKE,    /* as `take` reads it */
        RT_OPTION_GONE     /* none: an option of an earlier version; `instead` says what to do */
    } form;
    size_t offset, size; /* of the field */
    size_t count;        /* offset of the number of values of a list */
    int64_t low, high;
    RtTakeOption *take;
    const char *endings, *instead;
    size_t mark; /* of a const char * that gets the option's name; 0: none does */
    int flags;   /* argp's */
} RtOptionValue;

/* Parts of RT_MARKING. */
#define RT_AT(field)         .offset = offsetof(Options, field)
#define RT_SETS_FLAG(field)  .form = RT_OPTION_FLAG, RT_AT(field)
#define RT_SETS_PIXEL(field) .form = RT_OPTION_PIXEL, RT_AT(field)
#define RT_SETS_INTEGER(field, from, to)                                                                     \
    .form = RT_OPTION_INTEGER, RT_AT(field), .size = sizeof((Options *)0)->field, .low = (from), .high = (to)
#define RT_CALLS(function) .form = RT_OPTION_TAKE, .take = (function)

#define RT_VALUE(...)                                                                                        \
    { __VA_ARGS__ }
/* A value whose option leaves its name in `field`. */
#define RT_MARKING(field, ...) RT_VALUE(.mark = offsetof(Options, field), __VA_ARGS__)

#define RT_TO_FLAG(field)        RT_VALUE(RT_SETS_FLAG(field))
#define RT_TO_HIDDEN_FLAG(field) RT_VALUE(RT_SETS_FLAG(field), .flags = OPTION_HIDDEN)
#define RT_TO_TEXT(field)        RT_VALUE(.form = RT_OPTION_TEXT, RT_AT(field))
#define RT_TO_LIST(array, number)                                                                            \
    RT_VALUE(.form = RT_OPTION_LIST, RT_AT(array), .count = offsetof(Options, number),                       \
             .high = sizeof((Options *)0)->array / sizeof(char *))
#define RT_TO_INTEGER(field, from, to) RT_VALUE(RT_SETS_INTEGER(field, from, to))
#define RT_TO_SECONDS(field, from, to)                                                                       \
    RT_VALUE(.form = RT_OPTION_SECONDS, RT_AT(field), .low = (from), .high = (to))
#define RT_TO_PERCENT(field)    RT_VALUE(.form = RT_OPTION_PERCENT, RT_AT(field))
#define RT_TO_BYTES(field)      RT_VALUE(.form = RT_OPTION_BYTES, RT_AT(field))
#define RT_TO_SET(field, value) RT_VALUE(.form = RT_OPTION_SET, RT_AT(field), .low = (value))
#define RT_TO_SIZE(field)       RT_VALUE(.form = RT_OPTION_SIZE, RT_AT(field))
#define RT_TO_PIXEL(field)      RT_VALUE(RT_SETS_PIXEL(field))
#define RT_TO_PATH(field, ends) RT_VALUE(.form = RT_OPTION_PATH, RT_AT(field), .endings = (ends))
#define RT_TO_TAKE(function)    RT_VALUE(RT_CALLS(function))
/* `text` may be NULL. */
#define RT_TO_TAKE_OPTIONAL(function) RT_VALUE(RT_CALLS(function), .flags = OPTION_ARG_OPTIONAL)

/* An option that is no longer there. */
#define RT_GONE(name, use)                                                                                   \
    { name, 0, NULL, RT_VALUE(.form = RT_OPTION_GONE, .instead = (use), .flags = OPTION_HIDDEN), NULL }

typedef struct RtOption {
    const char *name;    /* NULL: `help` is the title of the options that follow */
    int letter;          /* of the short option, or 0 */
    const char *operand; /* what --help calls the value; NULL: it takes none */
    RtOptionValue value;
    const char *help;
} RtOption;

/* The arguments that are no options. */
typedef struct RtArgument {
    const char *name;    /* SCENE */
    const char *missing; /* what is said if there is none; NULL: there may be none */
    RtOptionValue value; /* of each; if it is a text, there is one at most */
} RtArgument;

#define RT_ARGUMENT(name, field, missing)                                                                    \
    { name, missing, RT_TO_TEXT(field) }
/* Members of the RtSyntax of a command that takes one SCENE. */
#define RT_ONE_SCENE                                                                                         \
    .arguments = "SCENE",                                                                                    \
    .argument =                                                                                              \
        RT_ARGUMENT("SCENE", scene, "a SCENE is missing: a file, or a built-in as `raytally scenes` lists")

typedef struct RtSyntax {
    const RtOption *options;      /* the last has no name and no help; NULL: none */
    const RtOption *shared;       /* options of several commands, or NULL */
    size_t shared_at;             /* offset of their own Options */
    int shared_group;             /* argp's, in --help */
    bool plugins;                 /* it takes --plugin */
    const char *arguments, *help; /* args_doc and doc of argp */
    RtArgument argument;
    void (*finish)(void *options, struct argp_state *state); /* checks all values together; or NULL */
} RtSyntax;

/* Fills `options`, a command's Options. Ends the process if the arguments are wrong, or ask for help. */
void rt_cli_parse(const RtSyntax *syntax, int argc, char **argv, void *options);

#endif
