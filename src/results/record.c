/* SPDX-License-Identifier: Apache-2.0 */
#include "results/record.h"

#include "core/text/json.h"
#include "measure/statistics.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <string.h>

/* ---- writing ---- */

static json_t *member_json(const RtMember *m, const void *from) {
    const void *at = (const char *)from + m->offset;
    const RtEstimate *e = at;
    switch (m->form) {
    case RT_MEMBER_FLAG: return json_boolean(*(const bool *)at);
    case RT_MEMBER_ADDED:
    case RT_MEMBER_U32: return json_integer(*(const uint32_t *)at);
    case RT_MEMBER_INT: return json_integer(*(const int *)at);
    case RT_MEMBER_ADDED_COUNT:
    case RT_MEMBER_COUNT: return json_integer(*(const int64_t *)at);
    case RT_MEMBER_HASH: return rt_json_hex(*(const uint64_t *)at);
    case RT_MEMBER_TEXT: return json_string(at);
    case RT_MEMBER_NUMBER: return rt_json_number(*(const double *)at);
    case RT_MEMBER_RATIO:
        if (isnan(e->median)) return json_null();
        __attribute__((fallthrough));
    case RT_MEMBER_ESTIMATE: return json_pack("[f, f, f, f]", e->median, e->low, e->high, e->least);
    case RT_MEMBER_OBJECT: return rt_record_json(m->object, from);
    }
    return NULL;
}

json_t *rt_record_json(const RtRecord *record, const void *from) {
    json_t *json = json_object();
    for (size_t i = 0; json && i < record->count; i++)
        json = rt_json_add(json, record->members[i].name, member_json(&record->members[i], from));
    return json;
}

/* ---- reading ---- */

void rt_record_reject(RtRecordReader *reader, const char *key, const char *wanted) {
    if (reader->status != RT_OK) return;
    reader->status = rt_fail_at(reader->error, reader->path, reader->line, 0,
                                "'%s' is not %s: the journal is damaged, or from another version of "
                                "raytally. Remove this line; --resume then measures its cells again",
                                key, wanted);
}

static uint64_t take_integer(RtRecordReader *reader, const RtMember *m, const json_t *value) {
    const uint64_t all = m->form == RT_MEMBER_U32   ? UINT32_MAX
                         : m->form == RT_MEMBER_INT ? INT_MAX
                                                    : INT64_MAX;
    const uint64_t most = m->most ? m->most : all;
    const json_int_t number = json_integer_value(value);
    if (json_is_integer(value) && number >= 0 && (uint64_t)number >= m->least && (uint64_t)number <= most)
        return (uint64_t)number;
    char wanted[96];
    snprintf(wanted, sizeof wanted, "a whole number from %" PRIu64 " to %" PRIu64, m->least, most);
    rt_record_reject(reader, m->name, wanted);
    return m->least;
}

double rt_record_seconds(RtRecordReader *reader, const json_t *value, const char *key) {
    const double number = json_number_value(value);
    if (json_is_number(value) && number >= 0) return number;
    rt_record_reject(reader, key, "a number, 0 or more");
    return 0;
}

const char *rt_record_text(RtRecordReader *reader, const json_t *json, const char *key) {
    const json_t *value = json_object_get(json, key);
    if (value && !json_is_string(value)) rt_record_reject(reader, key, "a text");
    return json_string_value(value);
}

static void take_member(RtRecordReader *reader, const RtMember *m, void *to, const json_t *json) {
    const json_t *value = json_object_get(json, m->name);
    void *at = (char *)to + m->offset;
    const char *text;
    bool good;
    switch (m->form) {
    case RT_MEMBER_FLAG:
        if (!json_is_boolean(value)) rt_record_reject(reader, m->name, "true or false");
        *(bool *)at = json_is_true(value);
        return;
    case RT_MEMBER_ADDED: *(uint32_t *)at = value ? (uint32_t)take_integer(reader, m, value) : 0; return;
    case RT_MEMBER_U32: *(uint32_t *)at = (uint32_t)take_integer(reader, m, value); return;
    case RT_MEMBER_INT: *(int *)at = (int)take_integer(reader, m, value); return;
    case RT_MEMBER_ADDED_COUNT: *(uint64_t *)at = value ? take_integer(reader, m, value) : 0; return;
    case RT_MEMBER_COUNT: *(uint64_t *)at = take_integer(reader, m, value); return;
    case RT_MEMBER_HASH:
        *(uint64_t *)at = rt_json_parse_hex(value, &good);
        if (!good) rt_record_reject(reader, m->name, "a hash of 16 hexadecimal digits");
        return;
    case RT_MEMBER_TEXT:
        text = rt_record_text(reader, json, m->name);
        snprintf(at, m->size, "%s", text ? text : "");
        return;
    case RT_MEMBER_NUMBER:
        if (value && !json_is_null(value) && !json_is_number(value))
            rt_record_reject(reader, m->name, "a number");
        *(double *)at = json_is_number(value) ? json_number_value(value) : (double)NAN;
        return;
    case RT_MEMBER_RATIO:
        *(RtEstimate *)at = rt_estimate_exactly((double)NAN);
        if (json_is_null(value)) return;
        __attribute__((fallthrough));
    case RT_MEMBER_ESTIMATE: {
        RtEstimate *e = at;
        double *const parts[] = {&e->median, &e->low, &e->high, &e->least};
        for (size_t i = 0; i < 4; i++)
            *parts[i] =
                rt_record_seconds(reader, json_is_array(value) ? json_array_get(value, i) : value, m->name);
        return;
    }
    case RT_MEMBER_OBJECT: rt_record_take(reader, m->object, to, value); return;
    }
}

void rt_record_take(RtRecordReader *reader, const RtRecord *record, void *to, const json_t *json) {
    for (size_t i = 0; i < record->count; i++) take_member(reader, &record->members[i], to, json);
}
