/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/scripts.h"

#include "core/base/memory.h"
#include "shipped_scripts.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

RtStatus rt_scripts_find(const RtExperiment *experiment, RtError *error) {
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        char path[RT_MAX_PATH];
        FILE *script;
        RT_TRY(rt_path_join(experiment->folder, experiment->plots[i], path, error));
        RT_TRY(rt_file_open(path, &script, error));
        fclose(script);
    }
    return RT_OK;
}

RtStatus rt_scripts_copy(const RtExperiment *experiment, const char *directory, bool keep, RtOutputs *copies,
                         RtError *error) {
    char from[RT_MAX_PATH], plots[RT_MAX_PATH], to[RT_MAX_PATH];
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        RT_TRY(rt_path_join(experiment->folder, experiment->plots[i], from, error));
        RT_TRY(rt_path_join(plots, rt_plot_name(experiment, i), to, error));
        if (!keep || !rt_file_exists(to)) RT_TRY(rt_outputs_copy(copies, from, to, error));
    }
    return RT_OK;
}

typedef struct Found {
    RtExperiment *experiment;
    RtStatus status;
    RtError *error;
} Found;

static void add_found(void *context, const char *path) {
    static const char *const written[] = {"names.gp", "style.gp", "sweep.gp", "histograms.gp"};
    Found *found = context;
    RtExperiment *experiment = found->experiment;
    const char *name = strrchr(path, '/') + 1;
    bool known = false;
    for (size_t i = 0; i < sizeof written / sizeof written[0]; i++) known |= strcmp(name, written[i]) == 0;
    for (uint32_t i = 0; i < experiment->plot_count; i++)
        known |= strcmp(name, rt_plot_name(experiment, i)) == 0;
    if (known || found->status != RT_OK) return;
    if (experiment->plot_count == RT_MAX_PLOTS || strlen(name) >= RT_MAX_LABEL)
        found->status = rt_fail(found->error, RT_BAD_INPUT,
                                "%s: there is room for %d scripts, with names of fewer than %d characters",
                                path, RT_MAX_PLOTS, RT_MAX_LABEL);
    else
        strcpy(experiment->plots[experiment->plot_count++], name);
}

RtStatus rt_scripts_add_found(RtExperiment *experiment, const char *directory, RtError *error) {
    char plots[RT_MAX_PATH];
    Found found = {experiment, RT_OK, error};
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    rt_directory_each(plots, ".gp", add_found, &found);
    return found.status;
}

/* ---- trusted scripts ---- */

enum { MOST_BYTES = 1 << 24 };

static bool is_text(const char *const *lines, const char *text) {
    for (; *lines; lines++) {
        size_t length = strlen(*lines);
        if (strncmp(text, *lines, length) != 0) return false;
        text += length;
    }
    return *text == '\0';
}

/* `text` has `size` bytes and ends with 0. */
static bool is_shipped(const char *text, size_t size) {
    if (strlen(text) != size) return false;
    for (int i = 0; shipped_scripts[i]; i++) {
        if (is_text(shipped_scripts[i], text)) return true;
    }
    return false;
}

static bool is_file(const char *path, const char *text, size_t size) {
    char *other;
    size_t other_size;
    if (rt_file_read(path, MOST_BYTES, &other, &other_size, NULL) != RT_OK) return false;
    bool same = other_size == size && memcmp(other, text, size) == 0;
    rt_free(other);
    return same;
}

/* `own` is the path of the user's own script of that name, or NULL. */
static RtStatus check_script(const char *path, const char *own, RtError *error) {
    char *text;
    size_t size;
    RT_TRY(rt_file_read(path, MOST_BYTES, &text, &size, error));
    bool known = is_shipped(text, size) || (own && is_file(own, text, size));
    rt_free(text);
    if (known) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: raytally does not ship this gnuplot script%s, and a script can run any command: read "
                   "it, then allow it with --trust",
                   path, own ? ", nor is it the one beside the experiment" : "");
}

typedef struct Links {
    RtStatus status;
    RtError *error;
} Links;

/* gnuplot would write through a link. */
static void refuse_link(void *context, const char *path) {
    Links *links = context;
    struct stat info;
    if (links->status != RT_OK || lstat(path, &info) != 0 || !S_ISLNK(info.st_mode)) return;
    links->status = rt_fail(
        links->error, RT_BAD_INPUT,
        "%s is a symbolic link, and gnuplot would write to its target: remove it, or allow it with --trust",
        path);
}

static RtStatus refuse_links(const char *plots, RtError *error) {
    Links links = {RT_OK, error};
    refuse_link(&links, plots);
    RT_TRY(links.status);
    errno = 0;
    if (rt_directory_each(plots, "", refuse_link, &links) == 0 && errno != ENOENT && errno != ENOTDIR)
        return rt_fail(error, RT_IO,
                       "%s cannot be read (%s), so it may hold symbolic links: allow that with --trust",
                       plots, strerror(errno));
    return links.status;
}

/* Checks a script that the experiment names. */
static RtStatus check_named(const RtExperiment *experiment, uint32_t i, const char *plots, bool keep,
                            RtScripts allowed, RtError *error) {
    char beside[RT_MAX_PATH], copy[RT_MAX_PATH];
    RT_TRY(rt_path_join(experiment->folder, experiment->plots[i], beside, error));
    RT_TRY(rt_path_join(plots, rt_plot_name(experiment, i), copy, error));
    return check_script(keep && rt_file_exists(copy) ? copy : beside,
                        allowed == RT_SCRIPTS_OWN ? beside : NULL, error);
}

RtStatus rt_scripts_check(const RtExperiment *experiment, const char *directory, bool keep, RtScripts allowed,
                          RtError *error) {
    char plots[RT_MAX_PATH], style[RT_MAX_PATH];
    bool style_named = false;
    if (allowed == RT_SCRIPTS_ALL) return RT_OK;
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    RT_TRY(rt_path_join(plots, "style.gp", style, error));
    RT_TRY(refuse_links(plots, error));
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        RT_TRY(check_named(experiment, i, plots, keep, allowed, error));
        style_named |= strcmp(rt_plot_name(experiment, i), "style.gp") == 0;
    }
    return style_named || !rt_file_exists(style) ? RT_OK : check_script(style, NULL, error);
}
