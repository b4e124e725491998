/* SPDX-License-Identifier: Apache-2.0 */
/* Tables as bytes: numbers as in memory; a text as its length, its characters and a 0; NULL has no length.
 * Each function passes its values in one direction, to the bytes or from them. */
#include "accel/plugin/library.h"

#include "core/base/memory.h"

#include <string.h>

#define NO_TEXT UINT32_MAX

typedef struct Cursor {
    char *at, *end; /* the next byte */
    bool reading, good;
} Cursor;

static void pass(Cursor *c, void *value, size_t bytes) {
    c->good = c->good && (size_t)(c->end - c->at) >= bytes;
    if (!c->good) return;
    memcpy(c->reading ? value : c->at, c->reading ? c->at : value, bytes);
    c->at += bytes;
}

/* A text that is read stays in the bytes. */
static void pass_text(Cursor *c, const char **text) {
    size_t written = !c->reading && *text ? strlen(*text) : NO_TEXT;
    uint32_t length = written < NO_TEXT ? (uint32_t)written : NO_TEXT;
    c->good = c->good && (c->reading || !*text || length != NO_TEXT);
    if (c->reading) *text = NULL;
    pass(c, &length, sizeof length);
    c->good = c->good && (length == NO_TEXT || (size_t)(c->end - c->at) > length);
    if (!c->good || length == NO_TEXT) return;
    if (c->reading) {
        *text = c->at;
    } else {
        memcpy(c->at, *text, (size_t)length + 1);
    }
    c->at += (size_t)length + 1;
    c->good = c->at[-1] == '\0';
}

static void pass_param(Cursor *c, raytally_param *p) {
    const char **texts[] = {&p->name,        &p->default_text, &p->choices,
                            &p->test_values, &p->meaning,      &p->source};
    pass(c, &p->type, sizeof p->type);
    pass(c, &p->lo, sizeof p->lo);
    pass(c, &p->hi, sizeof p->hi);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) pass_text(c, texts[i]);
}

static void each_box_is_remote(const void *self, raytally_box_visitor *visit, void *context) {
    (void)self, (void)visit, (void)context;
}

static void pass_table(Cursor *c, raytally_accel_ops *table) {
    uint8_t shows = table->each_box != NULL;
    pass_text(c, &table->name);
    pass_text(c, &table->summary);
    pass_text(c, &table->paper);
    pass(c, &shows, sizeof shows);
    pass(c, &table->param_count, sizeof table->param_count);
    if (c->reading) {
        c->good = c->good && table->param_count <= RAYTALLY_MAX_PARAMS;
        table->each_box = shows ? each_box_is_remote : NULL;
        if (!c->good || table->param_count == 0) return;
        table->params = rt_alloc(table->param_count, sizeof(raytally_param));
        c->good = table->params != NULL;
    }
    for (uint32_t p = 0; p < table->param_count && c->good; p++)
        pass_param(c, (raytally_param *)&table->params[p]);
}

size_t rt_tables_pack(const RtTables *tables, char *out, size_t size) {
    Cursor c = {out, out + size, false, true};
    uint32_t count = tables->count;
    pass(&c, &count, sizeof count);
    for (uint32_t i = 0; i < count; i++) {
        raytally_accel_ops table = tables->at[i];
        pass_table(&c, &table);
    }
    return c.good ? (size_t)(c.at - out) : 0;
}

bool rt_tables_unpack(char *packed, size_t size, RtTables *tables) {
    Cursor c = {packed, packed + size, true, true};
    uint32_t count = 0;
    *tables = (RtTables){0};
    pass(&c, &count, sizeof count);
    c.good = c.good && count <= RT_MOST_TABLES;
    while (c.good && tables->count < count) {
        raytally_accel_ops *table = &tables->at[tables->count++];
        *table = (raytally_accel_ops){.abi = RAYTALLY_ACCEL_ABI, .size = sizeof *table};
        pass_table(&c, table);
    }
    if (!c.good) rt_tables_clear(tables);
    return c.good;
}

void rt_tables_clear(RtTables *tables) {
    for (uint32_t i = 0; i < tables->count; i++) rt_free((void *)tables->at[i].params);
    *tables = (RtTables){0};
}
