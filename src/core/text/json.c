/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/json.h"

#include "core/base/file.h"
#include "core/base/versions.h"

#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static atomic_bool ran_out;

static void *allocate(size_t size) {
    void *block = malloc(size);
    if (!block && size > 0) atomic_store(&ran_out, true);
    return block;
}

void rt_json_watch_memory(void) {
    json_set_alloc_funcs(allocate, free);
}

RtStatus rt_json_check_memory(const char *what, RtError *error) {
    return atomic_load(&ran_out) ? rt_fail_memory(error, what, 0) : RT_OK;
}

json_t *rt_json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *rt_json_ratio_end(double value) {
    if (value > 1 && value < 1 + 1e-8) value = 1 + 1e-8;
    if (value < 1 && value > 1 - 1e-9) value = 1 - 1e-9;
    return rt_json_number(value);
}

json_t *rt_json_hex(uint64_t value) {
    return json_sprintf("%016" PRIx64, value);
}

json_t *rt_json_now(void) {
    char date[32];
    time_t now = time(NULL);
    struct tm utc;
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    return json_string(date);
}

const char *rt_json_text(const json_t *object, const char *key, const char *otherwise) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : otherwise;
}

RtStatus rt_json_check_format(const json_t *document, const char *path, RtError *error) {
    const json_t *member = json_object_get(document, "format");
    const int64_t format = json_integer_value(member);
    if (!member || (format >= 1 && format <= RT_FILE_FORMAT)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: " RT_FORMAT_UNKNOWN, path, format, RT_FILE_FORMAT);
}

RtStatus rt_json_save(const char *path, json_t *document, RtError *error) {
    RtOutput output;
    RtStatus status = document ? rt_json_check_memory(path, error) : rt_fail_memory(error, path, 0);
    if (status == RT_OK) status = rt_output_open(&output, path, error);
    if (status == RT_OK) {
        bool whole = json_dumpf(document, output.file, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) == 0;
        fputc('\n', output.file);
        /* A failed write is reported by the output; any other failure is short memory. */
        if (whole || ferror(output.file)) {
            status = rt_output_commit(&output, error);
        } else {
            rt_output_discard(&output);
            status = rt_fail_memory(error, path, 0);
        }
    }
    json_decref(document);
    return status;
}

json_t *rt_json_add(json_t *json, const char *key, json_t *value) {
    if (json_object_set_new(json, key, value) == 0) return json;
    json_decref(json);
    return NULL;
}

uint64_t rt_json_parse_hex(const json_t *value, bool *good) {
    const char *text = json_string_value(value);
    uint64_t number = 0;
    *good = text && strlen(text) == 16 && strspn(text, "0123456789abcdef") == 16 &&
            sscanf(text, "%16" SCNx64, &number) == 1;
    return *good ? number : 0;
}
