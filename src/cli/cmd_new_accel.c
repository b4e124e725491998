/* SPDX-License-Identifier: Apache-2.0 */
/* raytally new-accel: a folder with a working plugin to edit. Its files are those of cli/new_accel, with the
 * given name instead of `my-accel`, and without the licence line: they belong to the user. */
#include "accel/accel.h"
#include "cli/cli.h"
#include "core/base/file.h"
#include "new_accel_c.h"
#include "new_accel_cmake.h"
#include "new_accel_readme.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct Options {
    const char *name, *out;
} Options;

static const RtOption options[] = {
    {"out", 'o', "DIR", RT_TO_TEXT(out), "The folder to make NAME in (the current folder)"}, {0}};

const RtSyntax rt_new_accel_syntax = {
    .options = options,
    .arguments = "NAME",
    .argument = RT_ARGUMENT("NAME", name, "a NAME for the accelerator is missing, as in my-grid"),
    .help = "Create a folder NAME with a new accelerator, as a working plugin to edit: code, build file, "
            "check, and README.\v"
            "For example:\n"
            "  raytally new-accel my-grid\n"
            "  raytally new-accel my-grid --out ~/plugins"};

/* ---- files ---- */

#define PLACEHOLDER "my-accel"

static void write_line(const char *line, const char *name, FILE *out) {
    for (const char *at; (at = strstr(line, PLACEHOLDER)); line = at + strlen(PLACEHOLDER)) {
        fwrite(line, 1, (size_t)(at - line), out);
        fputs(name, out);
    }
    fputs(line, out);
}

static RtStatus write_template(const char *const *lines, const char *folder, const char *title,
                               const char *name, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, folder, title, error));
    for (; *lines; lines++) {
        if (!strstr(*lines, "SPDX-License-Identifier")) write_line(*lines, name, output.file);
    }
    return rt_output_commit(&output, error);
}

static RtStatus write_folder(const char *folder, const char *name, RtError *error) {
    char code[RT_MAX_NAME + 8];
    if (mkdir(folder, 0777) != 0) {
        if (errno == EEXIST)
            return rt_fail(error, RT_BAD_INPUT, "%s already exists: choose another name or another --out",
                           folder);
        return rt_fail(error, RT_IO, "%s: creating the folder failed: %s", folder, strerror(errno));
    }
    snprintf(code, sizeof code, "%s.c", name);
    RtStatus status = write_template(new_accel_c, folder, code, name, error);
    if (status == RT_OK) status = write_template(new_accel_cmake, folder, "CMakeLists.txt", name, error);
    if (status == RT_OK) status = write_template(new_accel_readme, folder, "README.md", name, error);
    if (status == RT_OK) return RT_OK;
    rt_directory_remove_files(folder, "");
    rmdir(folder);
    return status;
}

/* ---- the command ---- */

RtStatus rt_command_new_accel(int argc, char **argv, RtError *error) {
    Options o = {.out = ""};
    rt_cli_parse(&rt_new_accel_syntax, argc, argv, &o);
    char folder[RT_MAX_PATH];
    RT_TRY(rt_accel_name_is_free(o.name, error));
    RT_TRY(rt_path_join(o.out, o.name, folder, error));
    if (*o.out) RT_TRY(rt_directory_create(o.out, error));
    RT_TRY(write_folder(folder, o.name, error));
    printf("%s: a working accelerator. Next steps:\n\n"
           "  cd %s\n"
           "  cmake -B build && cmake --build build\n"
           "  cmake --build build --target check\n"
           "  raytally bench balls:size=3 --plugin build/%s.so --accel %s --accel bvh\n\n"
           "%s.c shows where your structure goes; README.md explains the rest.\n",
           folder, folder, o.name, o.name, o.name);
    return RT_OK;
}
