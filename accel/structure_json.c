#include "accel/structure_json.h"

#include "base/json.h"

json_t *rt_json_structure(const RtDescription *d) {
    json_t *object = json_pack("{s:I, s:I, s:I, s:I, s:I}", "interior", (json_int_t)d->interior, "leaves",
                               (json_int_t)d->leaves, "empty_leaves", (json_int_t)d->empty_leaves,
                               "references", (json_int_t)d->references, "depth", (json_int_t)d->depth);
#define SET_PREDICTION(name, meaning) json_object_set_new(object, #name, rt_json_number(d->name));
    RT_PREDICTIONS(SET_PREDICTION)
#undef SET_PREDICTION
    return object;
}
