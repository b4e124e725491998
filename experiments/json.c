#include "experiments/json.h"

#include "base/file.h"

#include <inttypes.h>
#include <time.h>

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

json_t *rt_json_tally(const RtTally *tally) {
    json_t *object = json_object();
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        json_object_set_new(object, rt_tally_name(i), json_integer((json_int_t)rt_tally_get(tally, i)));
    }
    return object;
}

json_t *rt_json_structure(const RtDescription *d) {
    json_t *object = json_pack("{s:I, s:I, s:I, s:I, s:I}", "interior", (json_int_t)d->interior, "leaves",
                               (json_int_t)d->leaves, "empty_leaves", (json_int_t)d->empty_leaves,
                               "references", (json_int_t)d->references, "depth", (json_int_t)d->depth);
#define SET_PREDICTION(name, meaning) json_object_set_new(object, #name, rt_json_number(d->name));
    RT_PREDICTIONS(SET_PREDICTION)
#undef SET_PREDICTION
    json_object_set_new(object, "build", rt_json_tally(&d->build));
    return object;
}

RtStatus rt_json_save(const char *path, json_t *document, RtError *error) {
    RtOutput output;
    if (!document) return rt_fail_memory(error, path, 0);
    RtStatus status = rt_output_open(&output, path, error);
    if (status == RT_OK) {
        bool whole = json_dumpf(document, output.file, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) == 0;
        fputc('\n', output.file);
        /* A failed write is the output's to report; without one it was memory that ran out. */
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
