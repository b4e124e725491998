/* SPDX-License-Identifier: Apache-2.0 */
/* A result directory in an index: what the pages of report/index.h say of it. */
#ifndef RT_REPORT_INDEX_ENTRY_H
#define RT_REPORT_INDEX_ENTRY_H

#include "experiment/experiment.h"

#include <stdio.h>

typedef enum RtIndexPart {
    RT_INDEX_HTML,     /* the card of a directory */
    RT_INDEX_MARKDOWN, /* the same in index.md */
    RT_INDEX_ROWS,     /* its rows in the table of sentences */
    RT_INDEX_LINES     /* the same in index.md */
} RtIndexPart;

enum { RT_INDEX_PARTS = 4, RT_MAX_ORIGIN = 256 };

/* A result directory. */
typedef struct RtIndexEntry {
    char name[RT_MAX_LABEL];   /* of the directory: one experiment may have several, of different systems */
    char section[RT_MAX_WORD]; /* or "" */
    char build[RT_MAX_ORIGIN], machine[RT_MAX_ORIGIN];
    char again[RT_MAX_ORIGIN];          /* the build that counted some scenes again, or "" */
    uint32_t number;                    /* the caller's */
    RtMemoryFile parts[RT_INDEX_PARTS]; /* closed once they are complete */
} RtIndexEntry;

/* Whether `directory` is one: of an experiment or a verification. */
bool rt_index_is_entry(const char *directory);

/* Fills *entry from `directory`, which the pages find at `place`; `experiment` is scratch. A directory that
 * cannot be read has the reason in its text. Clear it also after a failure, RT_NO_MEMORY. */
RtStatus rt_index_entry_read(RtIndexEntry *entry, const char *directory, const char *place,
                             RtExperiment *experiment, RtError *error);
void rt_index_entry_clear(RtIndexEntry *entry);

/* Writes plain text as Markdown, for a cell of a table or elsewhere; `code` stays. */
void rt_index_put_markdown(FILE *out, const char *text, bool cell);

#endif
