/* Experiments as YAML. The document is read by a schema into Document, whose texts are then understood one by
 * one: libcyaml knows the shape, rt_experiment_check the meaning, rt_yaml_file_place the line. */
#include "base/yaml_file.h"
#include "bench/experiment.h"
#include "render/frame.h"

#include <string.h>
#include <xxhash.h>

/* ---- the document ---- */

#define MAX_WORD 16

typedef struct Word {
    char text[RT_MAX_LABEL];
} Word;

typedef struct TrialEntry {
    char scene[RT_MAX_SCENE_NAME], label[RT_MAX_LABEL], size[MAX_WORD], corners[MAX_WORD], optional[MAX_WORD];
    char light_from_outside[MAX_WORD];
    uint32_t depth;
} TrialEntry;

typedef struct ContenderEntry {
    char accel[RT_MAX_SPEC_CHARS], label[RT_MAX_LABEL];
    uint64_t every;
    Word scenes[RT_MAX_TRIALS];
    uint32_t scenes_count;
} ContenderEntry;

/* By the names of RtColumn, in its order. */
typedef struct Tolerances {
#define MEMBER(name) double name;
    RT_PUBLISHED_COLUMNS(MEMBER)
#undef MEMBER
} Tolerances;

typedef struct PublishedEntry {
    Word tables[RT_MAX_PUBLISHED], ours[RT_MAX_CONTENDERS];
    uint32_t tables_count, ours_count;
    char reasons[RT_MAX_LABEL];
    Tolerances tolerance;
} PublishedEntry;

/* Settings that `quick` may override; 0 and "" stand for what is not given. */
typedef struct Scale {
    char size[MAX_WORD];
    uint64_t limit;
    uint32_t rounds, milliseconds, depth;
} Scale;

typedef struct Document {
    char name[RT_MAX_LABEL], question[RT_MAX_TEXT], prediction[RT_MAX_TEXT], baseline[RT_MAX_LABEL];
    TrialEntry scenes[RT_MAX_TRIALS];
    ContenderEntry accelerators[RT_MAX_CONTENDERS];
    Word rays[RT_RAY_KIND_COUNT], plots[RT_MAX_PLOTS];
    uint32_t scenes_count, accelerators_count, rays_count, plots_count;
    uint64_t limit, together, seed;
    uint32_t rounds, milliseconds;
    char count_only[MAX_WORD];
    PublishedEntry published;
    Scale quick;
} Document;

#define OPTIONAL CYAML_FLAG_OPTIONAL
#define REQUIRED CYAML_FLAG_DEFAULT

static const cyaml_schema_field_t trial_fields[] = {
    CYAML_FIELD_STRING("scene", REQUIRED, TrialEntry, scene, 1),
    CYAML_FIELD_STRING("label", OPTIONAL, TrialEntry, label, 1),
    CYAML_FIELD_STRING("size", OPTIONAL, TrialEntry, size, 1),
    CYAML_FIELD_STRING("corners", OPTIONAL, TrialEntry, corners, 1),
    CYAML_FIELD_STRING("light_from_outside", OPTIONAL, TrialEntry, light_from_outside, 1),
    CYAML_FIELD_UINT("depth", OPTIONAL, TrialEntry, depth),
    CYAML_FIELD_STRING("optional", OPTIONAL, TrialEntry, optional, 1),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t word_schema = {CYAML_VALUE_STRING(REQUIRED, Word, 1, RT_MAX_LABEL - 1)};

static const cyaml_schema_field_t contender_fields[] = {
    CYAML_FIELD_STRING("accel", REQUIRED, ContenderEntry, accel, 1),
    CYAML_FIELD_STRING("label", OPTIONAL, ContenderEntry, label, 1),
    CYAML_FIELD_UINT("every", OPTIONAL, ContenderEntry, every),
    CYAML_FIELD_SEQUENCE("scenes", OPTIONAL, ContenderEntry, scenes, &word_schema, 1, RT_MAX_TRIALS),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t tolerance_fields[] = {
#define FIELD(name) CYAML_FIELD_FLOAT(#name, OPTIONAL, Tolerances, name),
    RT_PUBLISHED_COLUMNS(FIELD)
#undef FIELD
        CYAML_FIELD_END,
};

static const cyaml_schema_field_t published_fields[] = {
    CYAML_FIELD_SEQUENCE("tables", REQUIRED, PublishedEntry, tables, &word_schema, 1, RT_MAX_PUBLISHED),
    CYAML_FIELD_STRING("reasons", OPTIONAL, PublishedEntry, reasons, 1),
    CYAML_FIELD_MAPPING("tolerance", OPTIONAL, PublishedEntry, tolerance, tolerance_fields),
    CYAML_FIELD_SEQUENCE("ours", OPTIONAL, PublishedEntry, ours, &word_schema, 1, RT_MAX_CONTENDERS),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t scale_fields[] = {
    CYAML_FIELD_STRING("size", OPTIONAL, Scale, size, 1),
    CYAML_FIELD_UINT("limit", OPTIONAL, Scale, limit),
    CYAML_FIELD_UINT("rounds", OPTIONAL, Scale, rounds),
    CYAML_FIELD_UINT("milliseconds", OPTIONAL, Scale, milliseconds),
    CYAML_FIELD_UINT("depth", OPTIONAL, Scale, depth),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t trial_schema = {CYAML_VALUE_MAPPING(REQUIRED, TrialEntry, trial_fields)};
static const cyaml_schema_value_t contender_schema = {
    CYAML_VALUE_MAPPING(REQUIRED, ContenderEntry, contender_fields)};

static const cyaml_schema_field_t document_fields[] = {
    CYAML_FIELD_STRING("name", REQUIRED, Document, name, 1),
    CYAML_FIELD_STRING("question", REQUIRED, Document, question, 1),
    CYAML_FIELD_STRING("prediction", REQUIRED, Document, prediction, 1),
    CYAML_FIELD_SEQUENCE("scenes", REQUIRED, Document, scenes, &trial_schema, 1, RT_MAX_TRIALS),
    CYAML_FIELD_SEQUENCE("accelerators", REQUIRED, Document, accelerators, &contender_schema, 1,
                         RT_MAX_CONTENDERS),
    CYAML_FIELD_STRING("baseline", OPTIONAL, Document, baseline, 1),
    CYAML_FIELD_SEQUENCE("rays", OPTIONAL, Document, rays, &word_schema, 1, RT_RAY_KIND_COUNT),
    CYAML_FIELD_UINT("limit", OPTIONAL, Document, limit),
    CYAML_FIELD_UINT("together", OPTIONAL, Document, together),
    CYAML_FIELD_UINT("rounds", OPTIONAL, Document, rounds),
    CYAML_FIELD_UINT("milliseconds", OPTIONAL, Document, milliseconds),
    CYAML_FIELD_UINT("seed", OPTIONAL, Document, seed),
    CYAML_FIELD_STRING("count_only", OPTIONAL, Document, count_only, 1),
    CYAML_FIELD_MAPPING("published", OPTIONAL, Document, published, published_fields),
    CYAML_FIELD_MAPPING("quick", OPTIONAL, Document, quick, scale_fields),
    CYAML_FIELD_SEQUENCE("plots", OPTIONAL, Document, plots, &word_schema, 1, RT_MAX_PLOTS),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t document_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, Document, document_fields)};

/* ---- from words to meanings ---- */

static RtStatus parse_flag(const char *word, bool *flag, RtError *error) {
    *flag = strcmp(word, "yes") == 0 || strcmp(word, "true") == 0;
    if (*flag || !*word || strcmp(word, "no") == 0 || strcmp(word, "false") == 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "'%s' will not do: it must be yes or no", word);
}

static RtStatus parse_size(const char *word, uint32_t *width, uint32_t *height, RtError *error) {
    if (!*word || rt_image_size_parse(word, width, height)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "'%s' will not do: it must be WIDTHxHEIGHT, each 1..%d, as in 512x512", word,
                   RT_MAX_IMAGE_SIDE);
}

/* The status, its message led by the line of the value at `where`, an index into a list filled in. */
static RtStatus place(const RtYamlFile *file, RtStatus status, const char *where, uint32_t index,
                      RtError *error) {
    char path[RT_MAX_LABEL];
    const char *bracket = strchr(where, '#');
    if (status == RT_OK) return RT_OK;
    if (bracket) {
        snprintf(path, sizeof path, "%.*s[%u]%s", (int)(bracket - where), where, index, bracket + 1);
    } else {
        snprintf(path, sizeof path, "%s", where);
    }
    return rt_yaml_file_place(file, status, path, error);
}

static RtStatus take_trial(const RtYamlFile *file, uint32_t i, const char *folder, RtTrial *trial,
                           RtError *error) {
    const TrialEntry *entry = &((const Document *)file->data)->scenes[i];
    RT_TRY(place(file, rt_trial_set_scene(trial, entry->scene, folder, error), "scenes#.scene", i, error));
    if (*entry->label) strcpy(trial->label, entry->label);
    trial->depth = entry->depth ? entry->depth : RT_DEFAULT_DEPTH;
    RT_TRY(
        place(file, parse_size(entry->size, &trial->width, &trial->height, error), "scenes#.size", i, error));
    RT_TRY(place(file, parse_flag(entry->corners, &trial->corners, error), "scenes#.corners", i, error));
    RT_TRY(place(file, parse_flag(entry->light_from_outside, &trial->light_from_outside, error),
                 "scenes#.light_from_outside", i, error));
    RT_TRY(place(file, parse_flag(entry->optional, &trial->optional, error), "scenes#.optional", i, error));
    return RT_OK;
}

/* A label that is none leaves an index that rt_experiment_check refuses. */
static void take_baseline(const Document *d, RtExperiment *experiment) {
    experiment->baseline = 0;
    while (*d->baseline && experiment->baseline < experiment->contender_count &&
           strcmp(experiment->contenders[experiment->baseline].label, d->baseline) != 0) {
        experiment->baseline++;
    }
}

/* Leaves the contender out on all trials that its `scenes` do not name; none named: on none. */
static RtStatus take_scenes(const RtYamlFile *file, uint32_t i, RtExperiment *experiment, RtError *error) {
    const ContenderEntry *entry = &((const Document *)file->data)->accelerators[i];
    uint32_t on = 0;
    for (uint32_t k = 0; k < entry->scenes_count; k++) {
        uint32_t trial = rt_trial_find(experiment, entry->scenes[k].text);
        if (trial == experiment->trial_count) {
            RtStatus status = rt_fail(error, RT_BAD_INPUT, "'%s' is not the label of one of the scenes",
                                      entry->scenes[k].text);
            return place(file, status, "accelerators#.scenes", i, error);
        }
        on |= UINT32_C(1) << trial;
    }
    experiment->contenders[i].left_out = entry->scenes_count ? ~on : 0;
    return RT_OK;
}

static RtStatus take_contenders(const RtYamlFile *file, RtExperiment *experiment, RtError *error) {
    const Document *d = file->data;
    experiment->contender_count = d->accelerators_count;
    for (uint32_t i = 0; i < d->accelerators_count; i++) {
        const ContenderEntry *entry = &d->accelerators[i];
        RtContender *contender = &experiment->contenders[i];
        strcpy(contender->spec, entry->accel);
        snprintf(contender->label, RT_MAX_LABEL, "%s", *entry->label ? entry->label : entry->accel);
        contender->every = entry->every ? entry->every : 1;
        RT_TRY(take_scenes(file, i, experiment, error));
    }
    return RT_OK;
}

/* A label may belong to several contenders, each on other scenes: all of them are ours. */
static RtStatus take_published(const RtYamlFile *file, RtExperiment *experiment, RtError *error) {
    const PublishedEntry *entry = &((const Document *)file->data)->published;
    RtPublishedSetup *published = &experiment->published;
    published->table_count = entry->tables_count;
    for (uint32_t i = 0; i < entry->tables_count; i++) strcpy(published->tables[i], entry->tables[i].text);
    strcpy(published->reasons, entry->reasons);
    memcpy(published->tolerance, &entry->tolerance, sizeof published->tolerance);
    for (uint32_t i = 0; i < entry->ours_count; i++) {
        bool found = false;
        for (uint32_t c = 0; c < experiment->contender_count; c++) {
            if (strcmp(experiment->contenders[c].label, entry->ours[i].text) != 0) continue;
            experiment->contenders[c].ours = found = true;
        }
        if (found) continue;
        RtStatus status = rt_fail(error, RT_BAD_INPUT, "'%s' is not the label of one of the accelerators",
                                  entry->ours[i].text);
        return place(file, status, "published.ours#", i, error);
    }
    return RT_OK;
}

static RtStatus take_lists(const RtYamlFile *file, RtExperiment *experiment, RtError *error) {
    const Document *d = file->data;
    experiment->trial_count = d->scenes_count;
    for (uint32_t i = 0; i < d->scenes_count; i++) {
        RT_TRY(take_trial(file, i, experiment->folder, &experiment->trials[i], error));
    }
    RT_TRY(take_contenders(file, experiment, error));
    RT_TRY(take_published(file, experiment, error));
    if (d->rays_count) experiment->kind_count = d->rays_count;
    for (uint32_t i = 0; i < d->rays_count; i++) {
        RT_TRY(
            place(file, rt_ray_kind_parse(d->rays[i].text, &experiment->kinds[i], error), "rays#", i, error));
    }
    experiment->plot_count = d->plots_count;
    for (uint32_t i = 0; i < d->plots_count; i++) strcpy(experiment->plots[i], d->plots[i].text);
    take_baseline(d, experiment);
    return RT_OK;
}

static RtStatus take_quick(const RtYamlFile *file, RtExperiment *experiment, RtError *error) {
    const Scale *quick = &((const Document *)file->data)->quick;
    experiment->quick = true;
    if (quick->limit) experiment->limit = quick->limit;
    if (quick->rounds) experiment->rounds = quick->rounds;
    if (quick->milliseconds) experiment->milliseconds = quick->milliseconds;
    for (uint32_t i = 0; i < experiment->trial_count; i++) {
        RtTrial *trial = &experiment->trials[i];
        if (quick->depth) trial->depth = quick->depth;
        RT_TRY(place(file, parse_size(quick->size, &trial->width, &trial->height, error), "quick.size", 0,
                     error));
    }
    return RT_OK;
}

static RtStatus take_document(const RtYamlFile *file, bool quick, RtExperiment *experiment, RtError *error) {
    const Document *d = file->data;
    strcpy(experiment->name, d->name);
    strcpy(experiment->question, d->question);
    strcpy(experiment->prediction, d->prediction);
    if (d->limit) experiment->limit = d->limit;
    if (d->together) experiment->together = d->together;
    if (d->rounds) experiment->rounds = d->rounds;
    if (d->milliseconds) experiment->milliseconds = d->milliseconds;
    if (d->seed) experiment->seed = d->seed;
    RT_TRY(place(file, parse_flag(d->count_only, &experiment->count_only, error), "count_only", 0, error));
    RT_TRY(take_lists(file, experiment, error));
    if (quick) RT_TRY(take_quick(file, experiment, error));
    char where[RT_MAX_LABEL];
    RtStatus status = rt_experiment_check(experiment, where, error);
    return place(file, status, where, 0, error);
}

RtStatus rt_experiment_load(RtExperiment *experiment, const char *path, bool quick, RtError *error) {
    rt_experiment_init(experiment);
    if (strlen(path) >= RT_MAX_PATH)
        return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", path);
    strcpy(experiment->path, path);
    rt_path_folder(path, experiment->folder);
    RtYamlFile file;
    RT_TRY(rt_yaml_file_open(&file, path, &document_schema, error));
    experiment->fingerprint = XXH3_64bits(file.text, file.length);
    RtStatus status = take_document(&file, quick, experiment, error);
    rt_yaml_file_close(&file);
    return status;
}
