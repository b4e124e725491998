/* SPDX-License-Identifier: Apache-2.0 */
/* Records: structs as JSON objects. One list of members says how a struct is written and how it is read back.
 *
 *     static const RtMember members[] = {RT_MEMBER(RtThing, U32, "width", width)};
 *     static const RtRecord thing = RT_RECORD(members); */
#ifndef RT_RESULTS_RECORD_H
#define RT_RESULTS_RECORD_H

#include "core/base/status.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The C type of a member, and its JSON. */
typedef enum RtMemberForm {
    RT_MEMBER_FLAG,        /* bool: true or false */
    RT_MEMBER_U32,         /* uint32_t: an integer */
    RT_MEMBER_ADDED,       /* the same; 0: missing, as in journals of older versions */
    RT_MEMBER_ADDED_COUNT, /* uint64_t, likewise */
    RT_MEMBER_INT,         /* int: an integer, 0 or more */
    RT_MEMBER_COUNT,       /* uint64_t: an integer, up to INT64_MAX */
    RT_MEMBER_HASH,        /* uint64_t: 16 hexadecimal digits */
    RT_MEMBER_TEXT,        /* char[]: a string; missing: "" */
    RT_MEMBER_NUMBER,      /* double: a number; NAN: null, or missing */
    RT_MEMBER_ESTIMATE,    /* RtEstimate: [median, low, high, least], each 0 or more; or one number for all */
    RT_MEMBER_RATIO,       /* the same; NAN: null */
    RT_MEMBER_OBJECT       /* members of the same struct, as an object of their own */
} RtMemberForm;

typedef struct RtRecord RtRecord;
typedef struct RtMember {
    const char *name;
    RtMemberForm form;
    size_t offset, size;    /* in the struct */
    uint64_t least, most;   /* of an integer; most 0: all that its type holds */
    const RtRecord *object; /* of RT_MEMBER_OBJECT */
} RtMember;

struct RtRecord {
    const RtMember *members;
    size_t count;
};

#define RT_MEMBER_RANGE(Type, form, name, field, least, most)                                                \
    { name, RT_MEMBER_##form, offsetof(Type, field), sizeof((Type *)0)->field, least, most, NULL }
#define RT_MEMBER(Type, form, name, field) RT_MEMBER_RANGE(Type, form, name, field, 0, 0)
#define RT_MEMBER_OF(name, object)                                                                           \
    { name, RT_MEMBER_OBJECT, 0, 0, 0, 0, object }
#define RT_RECORD(members)                                                                                   \
    { members, sizeof(members) / sizeof *(members) }

/* The struct as a new object; NULL if memory is short. */
json_t *rt_record_json(const RtRecord *record, const void *from);

/* Reads a line of a journal. The first fault is reported; values read after it are within their ranges and
 * otherwise meaningless. */
typedef struct RtRecordReader {
    const char *path;
    size_t line; /* from 1 */
    RtStatus status;
    RtError *error;
} RtRecordReader;

/* Fills the members of the struct at `to`. */
void rt_record_take(RtRecordReader *reader, const RtRecord *record, void *to, const json_t *json);

/* Reports that `key` is not what was wanted. */
void rt_record_reject(RtRecordReader *reader, const char *key, const char *wanted);

/* Single values: a number, 0 or more; a text, NULL if it is missing. */
double rt_record_seconds(RtRecordReader *reader, const json_t *value, const char *key);
const char *rt_record_text(RtRecordReader *reader, const json_t *json, const char *key);

#endif
