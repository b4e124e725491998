/* SPDX-License-Identifier: Apache-2.0 */
/* The tables in a plugin's library.
 *
 * No code of a library ever runs in raytally's own process: effects of its constructors (the locale,
 * rounding, signal handlers, a crash) stay in other processes. One process tries the library and packs its
 * tables, that is their numbers and texts, into shared memory; raytally unpacks them and trusts them as
 * little as any other input. Each process that builds an accelerator opens the library for itself. */
#ifndef RT_ACCEL_PLUGIN_LIBRARY_H
#define RT_ACCEL_PLUGIN_LIBRARY_H

#include "accel/plugin.h"
#include "accel/plugin/host.h"

enum { RT_MOST_TABLES = sizeof(((RtPlugin *)0)->names) / sizeof(char *) };

/* The tables of a library, converted to this version: members that theirs lack are NULL. */
typedef struct RtTables {
    uint32_t count;
    raytally_accel_ops at[RT_MOST_TABLES];
} RtTables;

/* Loads the library into this process, for as long as that lives, and reads its tables. RT_BAD_INPUT if it is
 * not a plugin, or one of another version. */
RtStatus rt_library_open(const char *path, RtTables *tables, RtError *error);

/* Checks that the tables are complete and consistent, and that their names are free. */
RtStatus rt_tables_check(const char *path, const RtTables *tables, RtError *error);

/* Hash of the file's bytes (XXH3). */
RtStatus rt_library_fingerprint(const char *path, uint64_t *fingerprint, RtError *error);

/* To out[0..size). Returns the number of bytes written, or 0 if they do not fit. */
size_t rt_tables_pack(const RtTables *tables, char *out, size_t size);

/* From packed[0..size), which may hold anything and must stay as long as the tables. False if it was not
 * written by rt_tables_pack. The tables have no functions, except that `each_box` is not NULL where theirs
 * was not; it must not be called. Free the parameters with rt_tables_clear. */
bool rt_tables_unpack(char *packed, size_t size, RtTables *tables);
void rt_tables_clear(RtTables *tables);

#endif
