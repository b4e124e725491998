/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/scripts.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_BYTES = 1 << 24 };

/* ---- shipped scripts ---- */

RtStatus rt_scripts_folder(char folder[RT_MAX_PATH], RtError *error) {
    static const char *const places[] = {"share/raytally/experiments", "../share/raytally/experiments"};
    char program[RT_MAX_PATH] = "", beside[RT_MAX_PATH];
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    rt_path_folder(program, beside);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        RT_TRY(rt_path_join(beside, places[i], folder, error));
        if (rt_file_exists_in(folder, "style.gp")) return RT_OK;
    }
    return rt_fail(error, RT_NOT_AVAILABLE,
                   "the gnuplot scripts that raytally ships are neither in %s/%s nor in ../share of that "
                   "folder: install it again",
                   beside, places[0]);
}

bool rt_scripts_shipped(const char *name, char path[RT_MAX_PATH]) {
    static const char *const folders[] = {"", "lecture/", "papers/"};
    char folder[RT_MAX_PATH], place[RT_MAX_PATH];
    if (rt_scripts_folder(folder, NULL) != RT_OK) return false;
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        const int length = snprintf(place, sizeof place, "%s%s", folders[i], name);
        if (length < (int)sizeof place && rt_path_join(folder, place, path, NULL) == RT_OK &&
            rt_file_exists(path))
            return true;
    }
    return false;
}

/* ---- those of an experiment ---- */

static bool same_bytes(const char *path, const char *other_path) {
    char *text = NULL, *other = NULL;
    size_t size, other_size;
    const bool same = rt_file_read(path, MOST_BYTES, &text, &size, NULL) == RT_OK &&
                      rt_file_read(other_path, MOST_BYTES, &other, &other_size, NULL) == RT_OK &&
                      other_size == size && memcmp(other, text, size) == 0;
    rt_free(text);
    rt_free(other);
    return same;
}

/* Whether the script is to be copied: it is beside the experiment, at `path`, and is not the shipped one. */
static bool is_own(const RtExperiment *experiment, uint32_t i, char path[RT_MAX_PATH]) {
    char shipped[RT_MAX_PATH];
    if (rt_path_join(experiment->folder, experiment->plots[i], path, NULL) != RT_OK || !rt_file_exists(path))
        return false;
    return !rt_scripts_shipped(rt_plot_name(experiment, i), shipped) || !same_bytes(path, shipped);
}

static RtStatus copy_path(const RtExperiment *experiment, uint32_t i, const char *directory,
                          char path[RT_MAX_PATH], RtError *error) {
    char plots[RT_MAX_PATH];
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    return rt_path_join(plots, rt_plot_name(experiment, i), path, error);
}

RtStatus rt_scripts_find(const RtExperiment *experiment, RtError *error) {
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        char path[RT_MAX_PATH];
        FILE *script;
        if (rt_scripts_shipped(rt_plot_name(experiment, i), path)) continue;
        RT_TRY(rt_path_join(experiment->folder, experiment->plots[i], path, error));
        RT_TRY(rt_file_open(path, &script, error));
        fclose(script);
    }
    return RT_OK;
}

RtStatus rt_scripts_copy(const RtExperiment *experiment, const char *directory, bool keep, RtOutputs *copies,
                         RtError *error) {
    char from[RT_MAX_PATH], to[RT_MAX_PATH];
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        RT_TRY(copy_path(experiment, i, directory, to, error));
        if (is_own(experiment, i, from) && !(keep && rt_file_exists(to)))
            RT_TRY(rt_outputs_copy(copies, from, to, error));
    }
    return RT_OK;
}

void rt_scripts_path(const RtExperiment *experiment, uint32_t plot, const char *directory, RtScripts allowed,
                     char path[RT_MAX_PATH]) {
    char own[RT_MAX_PATH], copy[RT_MAX_PATH] = "";
    const bool shipped = rt_scripts_shipped(rt_plot_name(experiment, plot), path);
    const bool there = copy_path(experiment, plot, directory, copy, NULL) == RT_OK && rt_file_exists(copy);
    if (!shipped || (there && (allowed == RT_SCRIPTS_ALL ||
                               (allowed == RT_SCRIPTS_OWN && is_own(experiment, plot, own)))))
        snprintf(path, RT_MAX_PATH, "plots/%s", rt_plot_name(experiment, plot));
}

typedef struct Found {
    RtExperiment *experiment;
    RtStatus status;
    RtError *error;
} Found;

static void add_found(void *context, const char *path) {
    Found *found = context;
    RtExperiment *experiment = found->experiment;
    const char *name = strrchr(path, '/') + 1;
    char shipped[RT_MAX_PATH];
    bool known =
        strcmp(name, "names.gp") == 0 || strcmp(name, "sweep.gp") == 0 || rt_scripts_shipped(name, shipped);
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

/* After the first failure nothing more is refused. gnuplot would write through a link. */
static void refuse_link(void *context, const char *path) {
    RtError *error = context;
    struct stat info;
    if (error->status != RT_OK || lstat(path, &info) != 0 || !S_ISLNK(info.st_mode)) return;
    rt_fail(
        error, RT_BAD_INPUT,
        "%s is a symbolic link, and gnuplot would write to its target: remove it, or allow it with --trust",
        path);
}

static RtStatus refuse_links(const char *plots, RtError *error) {
    RtError why = {RT_OK, ""};
    refuse_link(&why, plots);
    errno = 0;
    if (why.status == RT_OK && rt_directory_each(plots, "", refuse_link, &why) == 0 && errno != ENOENT &&
        errno != ENOTDIR)
        rt_fail(&why, RT_IO, "%s cannot be read (%s), so it may hold symbolic links: allow that with --trust",
                plots, strerror(errno));
    return why.status == RT_OK ? RT_OK : rt_fail(error, why.status, "%s", why.message);
}

/* Of a script that is not shipped: whether it is beside an experiment of the user's, and unchanged. */
static RtStatus check_own(const RtExperiment *experiment, uint32_t i, const char *directory, bool keep,
                          RtScripts allowed, RtError *error) {
    char own[RT_MAX_PATH], copy[RT_MAX_PATH], shipped[RT_MAX_PATH];
    const bool beside = is_own(experiment, i, own), is_users = allowed == RT_SCRIPTS_OWN && beside;
    RT_TRY(copy_path(experiment, i, directory, copy, error));
    const bool copied = keep && rt_file_exists(copy);
    if (is_users ? !copied || same_bytes(own, copy)
                 : rt_scripts_shipped(rt_plot_name(experiment, i), shipped))
        return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: raytally does not ship this gnuplot script%s, and a script can run any command: read "
                   "it, then allow it with --trust",
                   copied ? copy : own, is_users ? ", nor is it the one beside the experiment" : "");
}

RtStatus rt_scripts_check(const RtExperiment *experiment, const char *directory, bool keep, RtScripts allowed,
                          RtError *error) {
    char plots[RT_MAX_PATH];
    if (allowed == RT_SCRIPTS_ALL) return RT_OK;
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    RT_TRY(refuse_links(plots, error));
    for (uint32_t i = 0; i < experiment->plot_count; i++)
        RT_TRY(check_own(experiment, i, directory, keep, allowed, error));
    return RT_OK;
}
