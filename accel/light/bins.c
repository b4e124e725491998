/* SPDX-License-Identifier: Apache-2.0 */
/* What falls into the tiles of a light: objects are placed, chunk by chunk on all threads, and counted by
 * chunk and tile; sums over tiles, and of a tile over chunks, say where each goes. So a tile has its objects
 * in one order, whatever the number of threads. */
#include "accel/light/light.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

enum { MAX_CHUNKS = 64, LEAST_OF_CHUNK = 512 };

typedef struct Chunk {
    RtLightPlace *places;
    uint32_t count, capacity;
    uint32_t *at; /* [tiles]: how many it has, then where the next goes */
} Chunk;

typedef struct Binning {
    const RtLightBuffer *buffer;
    uint32_t light, tiles, objects, of_chunk, chunk_count;
    Chunk chunks[MAX_CHUNKS];
    uint32_t *out;
} Binning;

/* ---- placing ---- */

/* An object of any shape, on all faces. */
static void place_object(const Binning *b, Chunk *chunk, uint32_t id, int face_from, int face_to) {
    RtLightFootprint at;
    if (rt_light_is_near(b->buffer, b->light, id)) return;
    for (int face = face_from; face <= face_to; face++) {
        if (!rt_light_footprint(b->buffer, b->light, face, id, &at)) continue;
        chunk->places[chunk->count++] =
            (RtLightPlace){.object = b->buffer->isa.base.scene->geometry.objects[id] | RT_LIGHT_ALONE,
                           .lo = {(uint16_t)at.lo[0], (uint16_t)at.lo[1]},
                           .hi = {(uint16_t)at.hi[0], (uint16_t)at.hi[1]},
                           .face = (uint8_t)face};
    }
}

/* Up to sixteen triangles. */
static void place_triangles(const Binning *b, Chunk *chunk, uint32_t first, uint32_t count) {
    const RtGeometry *g = &b->buffer->isa.base.scene->geometry;
    RtLightPlace found[6 * 16];
    uint32_t found_count = b->buffer->painting->place(b->buffer, b->light, first, count, found);
    for (uint32_t i = 0; i < found_count; i++) {
        if (!found[i].drawn) {
            place_object(b, chunk, g->triangle_ids[found[i].object], found[i].face, found[i].face);
            continue;
        }
        found[i].object = rt_ref(RT_SHAPE_TRIANGLE, found[i].object);
        chunk->places[chunk->count++] = found[i];
    }
}

/* Calls `visit` code for each tile of a place. */
#define EACH_TILE(buffer, light, place, tile)                                                                \
    const RtLightGrid *grid = &(buffer)->cubes[light].grids[(place)->face];                                  \
    for (uint32_t row = (place)->lo[1]; row <= (place)->hi[1]; row++)                                        \
        for (uint32_t column = (place)->lo[0], tile = grid->first_tile + row * grid->columns + column;       \
             column <= (place)->hi[0]; column++, tile++)

/* Objects are numbered shape by shape, triangles first. */
static uint32_t other_object(const RtGeometry *g, uint32_t number) {
#define AMONG(CONSTANT, name, Type)                                                                          \
    if (RT_SHAPE_##CONSTANT != RT_SHAPE_TRIANGLE) {                                                          \
        if (number < g->name##_count) return g->name##_ids[number];                                          \
        number -= g->name##_count;                                                                           \
    }
    RT_SHAPES(AMONG)
#undef AMONG
    return RT_NO_OBJECT;
}

static RtStatus place_chunk(void *context, size_t item, int thread, RtError *error) {
    (void)thread;
    Binning *b = context;
    const RtGeometry *g = &b->buffer->isa.base.scene->geometry;
    Chunk *chunk = &b->chunks[item];
    uint32_t first = (uint32_t)item * b->of_chunk, end = first + b->of_chunk;
    if (end > b->objects) end = b->objects;
    chunk->at = rt_alloc(b->tiles, sizeof(uint32_t));
    if (!chunk->at) return rt_fail_memory(error, "the tiles of a light buffer", b->tiles * sizeof(uint32_t));
    for (uint32_t i = first, next; i < end; i = next) {
        next = i < g->triangle_count ? i + 16 : i + 1;
        if (i < g->triangle_count && next > g->triangle_count) next = g->triangle_count;
        if (next > end) next = end;
        RT_TRY(rt_reserve(&chunk->places, &chunk->capacity, chunk->count + 6 * (uint64_t)16,
                          sizeof(RtLightPlace), error));
        if (i < g->triangle_count) {
            place_triangles(b, chunk, i, next - i);
        } else {
            place_object(b, chunk, other_object(g, i - g->triangle_count), 0, 5);
        }
    }
    for (uint32_t i = 0; i < chunk->count; i++) {
        EACH_TILE(b->buffer, b->light, &chunk->places[i], tile) chunk->at[tile]++;
    }
    return RT_OK;
}

/* ---- sums, and filling ---- */

static RtStatus sum_tiles(Binning *b, RtLightBins *bins, RtError *error) {
    uint64_t sum = 0;
    for (uint32_t tile = 0; tile < b->tiles; tile++) {
        bins->first[tile] = (uint32_t)sum;
        for (uint32_t i = 0; i < b->chunk_count; i++) {
            uint32_t count = b->chunks[i].at[tile];
            b->chunks[i].at[tile] = (uint32_t)sum;
            sum += count;
        }
        if (sum > UINT32_MAX)
            return rt_fail(error, RT_BAD_INPUT,
                           "a light buffer of so many cells has too "
                           "many objects in its tiles: fewer cells "
                           "would do");
    }
    bins->first[b->tiles] = (uint32_t)sum;
    bins->objects = rt_alloc_unset((size_t)sum, sizeof(uint32_t));
    return bins->objects ? RT_OK
                         : rt_fail_memory(error, "the tiles of a light buffer", sum * sizeof(uint32_t));
}

static RtStatus fill_chunk(void *context, size_t item, int thread, RtError *error) {
    (void)thread, (void)error;
    Binning *b = context;
    Chunk *chunk = &b->chunks[item];
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t object = chunk->places[i].object;
        EACH_TILE(b->buffer, b->light, &chunk->places[i], tile) b->out[chunk->at[tile]++] = object;
    }
    return RT_OK;
}

RtStatus rt_light_fill_bins(const RtLightBuffer *buffer, uint32_t light, int threads, RtLightBins *bins,
                            RtError *error) {
    Binning b = {.buffer = buffer,
                 .light = light,
                 .tiles = buffer->cubes[light].tile_count,
                 .objects = buffer->isa.base.scene->geometry.object_count};
    b.of_chunk = (b.objects + MAX_CHUNKS - 1) / MAX_CHUNKS;
    if (b.of_chunk < LEAST_OF_CHUNK) b.of_chunk = LEAST_OF_CHUNK;
    b.of_chunk = (b.of_chunk + 15) / 16 * 16;
    b.chunk_count = (b.objects + b.of_chunk - 1) / b.of_chunk;
    bins->first = rt_alloc((size_t)b.tiles + 1, sizeof(uint32_t));
    RtStatus status = bins->first ? RT_OK
                                  : rt_fail_memory(error, "the tiles of a light buffer",
                                                   (b.tiles + (size_t)1) * sizeof(uint32_t));
    if (status == RT_OK) status = rt_parallel_for(b.chunk_count, threads, place_chunk, &b, error);
    if (status == RT_OK) status = sum_tiles(&b, bins, error);
    b.out = bins->objects;
    if (status == RT_OK) status = rt_parallel_for(b.chunk_count, threads, fill_chunk, &b, error);
    for (uint32_t i = 0; i < b.chunk_count; i++) {
        rt_free(b.chunks[i].places);
        rt_free(b.chunks[i].at);
    }
    return status;
}
