/* SPDX-License-Identifier: Apache-2.0 */
/* What a plugin's library says of itself: its tables, read where it may be loaded, and told where not.
 *
 * Nothing of a library ever runs in raytally's own process: what constructors do (the locale, rounding,
 * signal handlers, a crash) stays in others. One process tries it and packs its tables, as far as they are
 * numbers and text, into memory that both have; raytally unpacks them there, and believes them as little as
 * any other input. Each process that builds an accelerator opens the library for itself. */
#ifndef RT_ACCEL_PLUGIN_LIBRARY_H
#define RT_ACCEL_PLUGIN_LIBRARY_H

#include "accel/plugin.h"
#include "accel/plugin/host.h"

enum { RT_MOST_TABLES = sizeof(((RtPlugin *)0)->names) / sizeof(char *) };

/* The tables of a library, as tables of this version: what theirs lack is NULL. */
typedef struct RtTables {
    uint32_t count;
    raytally_accel_ops at[RT_MOST_TABLES];
} RtTables;

/* Loads the library here, for as long as the process lives, and asks it for its tables. RT_BAD_INPUT where it
 * is no plugin, or one of another version. */
RtStatus rt_library_open(const char *path, RtTables *tables, RtError *error);

/* Whether the tables are complete, fit themselves, and have names that are free. */
RtStatus rt_tables_check(const char *path, const RtTables *tables, RtError *error);

/* Where the next plugin is to be put down, empty; NULL, and RT_BAD_INPUT in *error, where there are too many.
 * It is one of those that were loaded once it joins them. */
RtPlugin *rt_plugin_next(RtError *error);
void rt_plugin_join(void);

/* Bytes of the file (XXH3). */
RtStatus rt_library_fingerprint(const char *path, uint64_t *fingerprint, RtError *error);

/* To out[0..room): so many bytes of it, or 0 where there are not enough. */
size_t rt_tables_pack(const RtTables *tables, char *out, size_t room);

/* From packed[0..room), which stays as long as the tables do, and of which every byte may be anything: false
 * where it is not what rt_tables_pack writes. In place of their functions the tables have none, but for
 * `each_box`, which is not to be called, where they had that. Free the parameters with rt_tables_clear. */
bool rt_tables_unpack(const char *packed, size_t room, RtTables *tables);
void rt_tables_clear(RtTables *tables);

#endif
