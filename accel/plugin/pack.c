/* SPDX-License-Identifier: Apache-2.0 */
/* Tables as bytes: numbers as they lie in memory, texts by their length and then with the 0 behind them; one
 * that is NULL has no length. */
#include "accel/plugin/library.h"

#include "core/base/memory.h"

#include <string.h>

#define NO_TEXT UINT32_MAX

/* Where the next byte goes, or comes from. */
typedef struct Cursor {
    char *at, *end;
    bool good;
} Cursor;

static void *advance(Cursor *c, size_t bytes) {
    char *at = c->at;
    c->good = c->good && (size_t)(c->end - at) >= bytes;
    if (!c->good) return NULL;
    c->at += bytes;
    return at;
}

/* ---- there ---- */

static void put(Cursor *c, const void *from, size_t bytes) {
    void *to = advance(c, bytes);
    if (to) memcpy(to, from, bytes);
}

static void put_text(Cursor *c, const char *text) {
    size_t length = text ? strlen(text) : 0;
    uint32_t told = text ? (uint32_t)length : NO_TEXT;
    c->good = c->good && length < NO_TEXT;
    put(c, &told, sizeof told);
    if (text) put(c, text, length + 1);
}

static void put_param(Cursor *c, const raytally_param *p) {
    put(c, &p->type, sizeof p->type);
    put(c, &p->lo, sizeof p->lo);
    put(c, &p->hi, sizeof p->hi);
    put_text(c, p->name);
    put_text(c, p->default_text);
    put_text(c, p->choices);
    put_text(c, p->test_values);
    put_text(c, p->meaning);
    put_text(c, p->source);
}

size_t rt_tables_pack(const RtTables *tables, char *out, size_t room) {
    Cursor c = {out, out + room, true};
    put(&c, &tables->count, sizeof tables->count);
    for (uint32_t i = 0; i < tables->count; i++) {
        const raytally_accel_ops *table = &tables->at[i];
        const uint8_t shows = table->each_box != NULL;
        put_text(&c, table->name);
        put_text(&c, table->summary);
        put_text(&c, table->paper);
        put(&c, &shows, sizeof shows);
        put(&c, &table->param_count, sizeof table->param_count);
        for (uint32_t p = 0; p < table->param_count; p++) put_param(&c, &table->params[p]);
    }
    return c.good ? (size_t)(c.at - out) : 0;
}

/* ---- here ---- */

static void take(Cursor *c, void *to, size_t bytes) {
    const void *from = advance(c, bytes);
    if (from) memcpy(to, from, bytes);
}

static const char *take_text(Cursor *c) {
    uint32_t length = NO_TEXT;
    take(c, &length, sizeof length);
    if (length == NO_TEXT) return NULL;
    const char *text = advance(c, (size_t)length + 1);
    c->good = c->good && text[length] == '\0';
    return c->good ? text : NULL;
}

static void take_param(Cursor *c, raytally_param *p) {
    take(c, &p->type, sizeof p->type);
    take(c, &p->lo, sizeof p->lo);
    take(c, &p->hi, sizeof p->hi);
    p->name = take_text(c);
    p->default_text = take_text(c);
    p->choices = take_text(c);
    p->test_values = take_text(c);
    p->meaning = take_text(c);
    p->source = take_text(c);
}

static void shown_elsewhere(const void *self, raytally_show_box *show, void *viewer) {
    (void)self, (void)show, (void)viewer;
}

static void take_table(Cursor *c, raytally_accel_ops *table) {
    uint8_t shows = 0;
    *table = (raytally_accel_ops){.abi = RAYTALLY_ACCEL_ABI, .size = sizeof *table};
    table->name = take_text(c);
    table->summary = take_text(c);
    table->paper = take_text(c);
    take(c, &shows, sizeof shows);
    take(c, &table->param_count, sizeof table->param_count);
    table->each_box = shows ? shown_elsewhere : NULL;
    c->good = c->good && table->param_count <= RAYTALLY_MAX_PARAMS;
    if (!c->good || table->param_count == 0) return;
    raytally_param *params = rt_alloc(table->param_count, sizeof(raytally_param));
    table->params = params;
    c->good = params != NULL;
    for (uint32_t p = 0; p < table->param_count && c->good; p++) take_param(c, &params[p]);
}

bool rt_tables_unpack(const char *packed, size_t room, RtTables *tables) {
    Cursor c = {(char *)packed, (char *)packed + room, true};
    uint32_t count = 0;
    *tables = (RtTables){0};
    take(&c, &count, sizeof count);
    c.good = c.good && count <= RT_MOST_TABLES;
    while (c.good && tables->count < count) take_table(&c, &tables->at[tables->count++]);
    if (!c.good) rt_tables_clear(tables);
    return c.good;
}

void rt_tables_clear(RtTables *tables) {
    for (uint32_t i = 0; i < tables->count; i++) rt_free((void *)tables->at[i].params);
    *tables = (RtTables){0};
}
