#include "base/yaml_file.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/yaml_walk.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- libcyaml ---- */

/* In front of each block of libcyaml's: its size, so that lists grow by doubling. */
typedef struct Header {
    size_t room;
    char pad[RT_CACHE_LINE - sizeof(size_t)];
} Header;

static void *reallocate(void *context, void *block, size_t size) {
    (void)context;
    Header *old = block ? (Header *)block - 1 : NULL;
    if (size == 0) {
        rt_free(old);
        return NULL;
    }
    if (old && size <= old->room) return block;
    size_t room = old && size < 2 * old->room ? 2 * old->room : size;
    Header *new = room < SIZE_MAX - sizeof(Header) ? rt_alloc(1, sizeof(Header) + room) : NULL;
    if (!new) return NULL;
    new->room = room;
    if (old) memcpy(new + 1, block, old->room);
    rt_free(old);
    return new + 1;
}

enum { TEXT_OF_LOG = 256 };

/* Keeps the first complaint of libcyaml, which would print it. */
static void keep_message(cyaml_log_t level, void *context, const char *format, va_list arguments) {
    (void)level;
    char *message = context;
    if (message[0] == '\0') vsnprintf(message, TEXT_OF_LOG, format, arguments);
}

static RtStatus fill_data(RtYamlFile *file, RtError *error) {
    char message[TEXT_OF_LOG] = "";
    cyaml_config_t config = {.log_fn = keep_message,
                             .log_ctx = message,
                             .mem_fn = reallocate,
                             .log_level = CYAML_LOG_WARNING,
                             .flags = CYAML_CFG_NO_ALIAS};
    cyaml_err_t result =
        cyaml_load_data((const uint8_t *)file->text, file->length, &config, file->schema, &file->data, NULL);
    if (result == CYAML_ERR_OOM) return rt_fail_memory(error, file->path, file->length);
    if (result == CYAML_OK && file->data) return RT_OK;
    message[strcspn(message, "\n")] = '\0';
    return rt_fail(error, RT_BAD_INPUT, "%s: %s (%s)", file->path, cyaml_strerror(result), message);
}

/* ---- all of it ---- */

RtStatus rt_yaml_file_open(RtYamlFile *file, const char *path, const cyaml_schema_value_t *schema,
                           RtError *error) {
    char *text;
    size_t length;
    RT_TRY(rt_file_read(path, RT_YAML_MAX_BYTES, &text, &length, error));
    return rt_yaml_file_take(file, path, text, length, schema, error);
}

RtStatus rt_yaml_file_take(RtYamlFile *file, const char *path, char *text, size_t length,
                           const cyaml_schema_value_t *schema, RtError *error) {
    *file = (RtYamlFile){.path = path, .text = text, .length = length, .schema = schema};
    RtStatus status = rt_yaml_check(file, error);
    if (status == RT_OK) status = fill_data(file, error);
    if (status != RT_OK) rt_yaml_file_close(file);
    return status;
}

RtStatus rt_yaml_file_place(const RtYamlFile *file, RtStatus status, const char *where, RtError *error) {
    if (!error || status == RT_OK || status == RT_NO_MEMORY) return status;
    size_t line, column;
    rt_yaml_locate(file, where, &line, &column);
    RtError inner = *error;
    rt_fail_at(error, file->path, line, column, "%s%s%s", where, where[0] ? ": " : "", inner.message);
    error->status = status;
    return status;
}

void rt_yaml_file_close(RtYamlFile *file) {
    const cyaml_config_t config = {.mem_fn = reallocate};
    if (file->data) cyaml_free(&config, file->schema, file->data, 0);
    rt_free(file->text);
    *file = (RtYamlFile){0};
}
