/* SPDX-License-Identifier: Apache-2.0 */
/* What a verification found, for reading: its rows as verify.csv, and what they add up to as verify.md. Both
 * follow from the rows alone, so they are the same bytes however the rows came about. */
#ifndef RT_VERIFY_VERIFY_TABLE_H
#define RT_VERIFY_VERIFY_TABLE_H

#include "core/base/param.h"
#include "core/text/table.h"
#include "exact/referee.h"
#include "verify/verdict.h"

/* Columns over a row: of verify.csv, of verify --json, and of the terminal. */
enum { RT_VERIFY_GROUPS = 3, RT_VERIFY_TEXT_GROUPS = 2 };
extern const RtColumnGroup rt_verify_csv[RT_VERIFY_GROUPS], rt_verify_json[RT_VERIFY_GROUPS];
extern const RtColumnGroup rt_verify_text[RT_VERIFY_TEXT_GROUPS];

/* What rows of one accelerator, whatever its parameters, add up to; or those of one scene. A pair is a ray
 * and an accelerator of certain parameters that was asked it, in all four ways. */
typedef struct RtVerifySum {
    char name[RT_MAX_SPEC_CHARS]; /* "item+bvh", without parameters; or the scene */
    bool exact;                   /* asked for the bits of brute, not for verdicts: true of scenes */
    uint32_t rows, failed;
    uint64_t pairs;
    uint64_t verdicts[RT_VERDICT_COUNT]; /* of nearest: they sum to pairs */
    uint64_t occluded_wrong;             /* pairs whose answer to occluded is wrong */
    uint64_t sides[RT_SIDE_COUNT];       /* as in RtEquivalence */
} RtVerifySum;

typedef enum RtVerifyGroup { RT_BY_ACCEL, RT_BY_SCENE } RtVerifyGroup;

/* Sums up an array of rows: (*sums)[0..count), in the order of their first rows. The caller frees them by
 * rt_free, after an error too. */
RtStatus rt_verify_sums(const json_t *rows, RtVerifyGroup group, RtVerifySum **sums, uint32_t *count,
                        RtError *error);

/* The sum of sums. */
RtVerifySum rt_verify_total(const RtVerifySum *sums, uint32_t count);

/* Has a row a wrong answer, or a "problem": a structure that is not valid, or too many marginal answers? */
bool rt_verify_row_fails(const json_t *row);

/* Writes `folder`/verify.csv and verify.md. */
RtStatus rt_verify_write(json_t *rows, const char *folder, RtError *error);

#endif
