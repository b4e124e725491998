/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of a verification: its rows as verify.csv, their sums as verify.md. Both depend on the rows
 * alone, so they are the same bytes however the rows were produced. */
#ifndef RT_VERIFY_VERIFY_TABLE_H
#define RT_VERIFY_VERIFY_TABLE_H

#include "core/base/param.h"
#include "core/text/table.h"
#include "exact/referee.h"
#include "verify/verdict.h"

/* Columns over a row: for verify.csv, verify --json, and the terminal. */
enum { RT_VERIFY_CSV_GROUPS = 5, RT_VERIFY_JSON_GROUPS = 5, RT_VERIFY_TEXT_GROUPS = 2 };
extern const RtColumnGroup rt_verify_csv[RT_VERIFY_CSV_GROUPS];
extern const RtColumnGroup rt_verify_json[RT_VERIFY_JSON_GROUPS];
extern const RtColumnGroup rt_verify_text[RT_VERIFY_TEXT_GROUPS];

/* The sum of the rows of one accelerator with any parameters, or of one scene. A pair is a ray and an
 * accelerator with certain parameters, queried in all four modes. */
typedef struct RtVerifySum {
    char name[RT_MAX_SPEC_CHARS];   /* "item+bvh", without parameters; or the scene */
    bool exact;                     /* must match brute bit for bit; true for scenes */
    uint32_t rows, failed, refused; /* the last by accelerators, which is no failure */
    uint32_t undecided;             /* failed for want of certain rays (equivalence.h) */
    uint64_t pairs;
    uint64_t judged;                        /* pairs compared by verdicts; the others bit for bit */
    uint64_t itself;                        /* pairs of brute with itself */
    uint64_t recorded;                      /* pairs with hits of a file, which do not answer `occluded` */
    uint64_t certain, must_hit, certain_of; /* rays of judged rows: certain among those examined */
    uint64_t verdicts[RT_VERDICT_COUNT];    /* of nearest; sum to `pairs` */
    uint64_t occluded_wrong;                /* pairs with a wrong answer to occluded */
    uint64_t sides[RT_SIDE_COUNT], missed;  /* as in RtEquivalence */
    double largest_off;
    uint64_t faults[RT_FAULT_COUNT];
} RtVerifySum;

/* Sums rows by accelerator, or `by_scene`, to (*sums)[0..count), in the order of their first rows. Free with
 * rt_free, also after an error. */
RtStatus rt_verify_sums(const json_t *rows, bool by_scene, RtVerifySum **sums, uint32_t *count,
                        RtError *error);

/* The sum of all rows; exact if every accelerator is. */
RtVerifySum rt_verify_total(const json_t *rows);

/* True if a row has a wrong answer or a "problem": an invalid structure, or too few certain rays. */
bool rt_verify_row_fails(const json_t *row);

/* Writes `folder`/verify.csv and verify.md. */
RtStatus rt_verify_write(json_t *rows, const char *folder, RtError *error);

#endif
