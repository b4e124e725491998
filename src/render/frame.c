/* SPDX-License-Identifier: Apache-2.0 */
/* Frames. Each thread has a worker with all its memory: a buffer of rays for each level of the ray tree, and
 * the answers of one stream.
 *
 * A level is traced in streams of at most STREAM rays. Each stream is traced and shaded, its shadow rays
 * are traced light by light, and all rays that it spawned are traced to the bottom before the next stream
 * begins. So a level never holds more than RT_MAX_SPAWN * STREAM rays, however deep the tree grows, and at
 * usual depths a level is a single stream. */
#include "render/frame.h"

#include "core/base/clock.h"
#include "core/base/elementary.h"
#include "core/base/file.h"
#include "core/base/parallel.h"

#include <png.h>
#include <pthread.h>
#include <string.h>

/* ---- the order of tiles ---- */

typedef struct Walk {
    const RtSampling *sampling;
    uint32_t across, down; /* tiles */
    bool whole;            /* visit whole or cut tiles */
    RtSample *next;
} Walk;

static uint32_t tiles_along(uint32_t samples) {
    return (samples + RT_TILE - 1) / RT_TILE;
}

size_t rt_tile_count(const RtSampling *sampling) {
    return (size_t)tiles_along(sampling->columns) * tiles_along(sampling->rows);
}

/* Does the part of the tile inside the frame consist of whole 8 x 8 blocks? */
static bool is_whole(const RtSampling *sampling, RtSample tile) {
    uint32_t right = sampling->columns - tile.column, below = sampling->rows - tile.row;
    return (right >= RT_TILE || right % 8 == 0) && (below >= RT_TILE || below % 8 == 0);
}

/* Visits the square of side x side tiles from that column and row of tiles on. */
static void walk_square(Walk *walk, uint32_t column, uint32_t row, uint32_t side) {
    if (column >= walk->across || row >= walk->down) return;
    if (side == 1) {
        RtSample tile = {column * RT_TILE, row * RT_TILE};
        if (is_whole(walk->sampling, tile) == walk->whole) *walk->next++ = tile;
        return;
    }
    side /= 2;
    for (uint32_t quarter = 0; quarter < 4; quarter++)
        walk_square(walk, column + (quarter & 1) * side, row + (quarter >> 1) * side, side);
}

void rt_tiles_in_order(const RtSampling *sampling, RtSample *tiles) {
    Walk walk = {sampling, tiles_along(sampling->columns), tiles_along(sampling->rows), true, tiles};
    uint32_t side = 1;
    while (side < walk.across || side < walk.down) side *= 2;
    walk_square(&walk, 0, 0, side);
    walk.whole = false;
    walk_square(&walk, 0, 0, side);
}

/* ---- workers ---- */

enum { STREAM = 1024, LEVEL = RT_MAX_SPAWN * STREAM };

/* Where the light of a ray goes. */
typedef struct Path {
    uint32_t sample; /* of the frame */
    float factor;    /* of the light: the product of kr and kt along the path */
    uint32_t parent; /* as in RtFrameRay, if the tile is observed */
} Path;

typedef struct Level {
    uint32_t count;
    RtRay rays[LEVEL];
    Path paths[LEVEL];
} Level;

/* The kept rays of one tile, by kind. */
typedef struct TileRays {
    uint32_t count[RT_RAY_KIND_COUNT], capacity[RT_RAY_KIND_COUNT];
    RtRay *rays[RT_RAY_KIND_COUNT];
} TileRays;

typedef struct Job Job;

typedef struct Worker {
    Job *job;
    RtQuery query;
    RtTally tallies[RT_RAY_KIND_COUNT];
    uint64_t ray_count[RT_RAY_KIND_COUNT];
    uint32_t seen[RT_TILE * RT_TILE]; /* rays of each sample of a tile that the observer saw */
    size_t tile;
    double querying, working; /* seconds in queries, and in all; with `share` */
    Level *levels;            /* [depth]; 0 holds the primary rays */

    /* The current stream: its answers, and the surfaces that it hit with the path of each. */
    RtHit hits[STREAM];
    RtSurface surfaces[STREAM];
    Path surface_paths[STREAM];

    /* Shadow rays to be traced together, and the light that arrives if they are not occluded. */
    uint32_t shadow_count;
    RtRay shadow_rays[STREAM];
    bool occluded[STREAM];
    RtVec3 shadow_lights[STREAM];
    Path shadow_paths[STREAM];
} Worker;

struct Job {
    RtFrame *frame;
    const RtFrameOptions *options;
    const RtScene *scene;
    RtView view;
    RtSample *tiles; /* [tile_count], in order */
    TileRays *kept;  /* [tile_count], or NULL */
    size_t tile_count, tiles_done;
    pthread_mutex_t lock; /* guards tiles_done and the calls of progress */
    Worker *workers;
    RtArena memory; /* of these arrays */
};

static void add_light(Worker *worker, Path path, RtVec3 light) {
    RtVec3 *color = &worker->job->frame->color[path.sample];
    *color = rt_add(*color, rt_scale(light, path.factor));
}

/* Shows a ray to the observer; returns its number in its sample. */
static uint32_t show(Worker *worker, Path path, RtFrameRay ray) {
    const RtFrameObserver *observer = worker->job->options->observer;
    if (!observer) return RT_NO_RAY;
    const uint32_t columns = worker->job->frame->sampling.columns;
    const RtSample sample = {path.sample % columns, path.sample / columns};
    ray.parent = path.parent;
    ray.factor = path.factor;
    observer->see(observer->context, sample, &ray);
    return worker->seen[rt_tile_place(sample)]++;
}

/* ---- queries ---- */

static double clock_of(const Worker *worker) {
    return worker->job->options->share ? rt_wall_seconds() : 0;
}

/* Counts rays by kind, and keeps them with keep_rays. */
static RtStatus take_rays(Worker *worker, const RtRay *rays, uint32_t count, RtError *error) {
    TileRays *to = worker->job->kept ? &worker->job->kept[worker->tile] : NULL;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t kind = rays[i].kind;
        worker->ray_count[kind]++;
        if (!to) continue;
        RT_TRY(rt_append(&to->rays[kind], &to->count[kind], &to->capacity[kind], &rays[i], sizeof(RtRay),
                         error));
    }
    return RT_OK;
}

/* Queries of one kind: shadow rays are answered by `occluded`, to worker->occluded, others by `nearest`. */
static void ask(Worker *worker, const RtRay *rays, uint32_t first, uint32_t count, RtTally *tallies) {
    if (rays[first].kind == RT_RAY_SHADOW)
        rt_occluded(&worker->query, rays + first, count, worker->occluded + first, tallies);
    else
        rt_nearest(&worker->query, rays + first, count, worker->hits + first, tallies);
}

/* A counted frame traces one ray at a time. */
static RtStatus trace_stream(Worker *worker, const RtRay *rays, const Path *paths, uint32_t count,
                             RtError *error) {
    RT_TRY(take_rays(worker, rays, count, error));
    if (!worker->job->options->counted) {
        const double start = clock_of(worker);
        ask(worker, rays, 0, count, NULL);
        worker->querying += clock_of(worker) - start;
        return RT_OK;
    }
    const uint32_t kinds = worker->job->options->cost_kinds;
    RtTally cost[RT_RAY_KIND_COUNT] = {0};
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t kind = rays[i].kind;
        ask(worker, rays, i, 1, cost);
        if (kinds == 0 || kinds >> kind & 1)
            rt_tally_add(&worker->job->frame->cost[paths[i].sample], &cost[kind]);
        rt_tally_add(&worker->tallies[kind], &cost[kind]);
        cost[kind] = (RtTally){0};
    }
    return RT_OK;
}

/* ---- one stream ---- */

static RtStatus flush_shadows(Worker *worker, RtError *error) {
    if (worker->shadow_count == 0) return RT_OK;
    RT_TRY(trace_stream(worker, worker->shadow_rays, worker->shadow_paths, worker->shadow_count, error));
    for (uint32_t i = 0; i < worker->shadow_count; i++) {
        const bool occluded = worker->occluded[i];
        RtVec3 light = occluded ? rt_vec3(0, 0, 0) : worker->shadow_lights[i];
        if (!occluded) add_light(worker, worker->shadow_paths[i], light);
        show(worker, worker->shadow_paths[i],
             (RtFrameRay){&worker->shadow_rays[i], .hit = RT_MISS, .occluded = occluded, .light = light});
    }
    worker->shadow_count = 0;
    return RT_OK;
}

/* Light by light, so that neighbours in the stream have the same target. */
static RtStatus trace_shadows(Worker *worker, uint32_t surface_count, RtError *error) {
    const RtScene *scene = worker->job->scene;
    const bool outward = worker->job->options->light_from_outside;
    for (uint32_t light = 0; light < scene->light_count; light++) {
        for (uint32_t i = 0; i < surface_count; i++) {
            uint32_t n = worker->shadow_count;
            RtSurface surface = worker->surfaces[i];
            if (outward) surface = rt_surface_outward(&surface);
            if (!rt_shadow_ray(scene, &surface, light, &worker->shadow_rays[n], &worker->shadow_lights[n]))
                continue;
            worker->shadow_paths[n] = worker->surface_paths[i];
            if (++worker->shadow_count == STREAM) RT_TRY(flush_shadows(worker, error));
        }
    }
    return flush_shadows(worker, error);
}

/* Finds the surfaces that the stream hit and adds the background for misses. Returns the number of
 * surfaces. */
static uint32_t find_surfaces(Worker *worker, const RtRay *rays, const Path *paths, uint32_t count) {
    const RtScene *scene = worker->job->scene;
    uint32_t surface_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtSurface *surface = NULL;
        RtVec3 light = scene->background;
        if (worker->hits[i].object != RT_NO_OBJECT) {
            surface = &worker->surfaces[surface_count];
            *surface = rt_surface(scene, &rays[i], worker->hits[i], rt_query_hit_memory(&worker->query));
            light = rt_ambient_light(scene, surface);
        }
        add_light(worker, paths[i], light);
        RtFrameRay shown = {&rays[i], .hit = worker->hits[i], .surface = surface, .light = light};
        uint32_t number = show(worker, paths[i], shown);
        if (surface)
            worker->surface_paths[surface_count++] = (Path){paths[i].sample, paths[i].factor, number};
    }
    return surface_count;
}

static void spawn(Worker *worker, uint32_t surface_count, Level *below) {
    below->count = 0;
    for (uint32_t i = 0; i < surface_count; i++) {
        float factors[RT_MAX_SPAWN];
        Path from = worker->surface_paths[i];
        uint32_t spawned = rt_spawn_rays(&worker->surfaces[i], below->rays + below->count, factors);
        for (uint32_t k = 0; k < spawned; k++)
            below->paths[below->count++] = (Path){from.sample, from.factor * factors[k], from.parent};
    }
}

static RtStatus trace_level(Worker *worker, uint32_t depth, RtError *error) {
    Level *level = &worker->levels[depth];
    bool deepest = depth + 1 == worker->job->options->depth;
    for (uint32_t begin = 0; begin < level->count; begin += STREAM) {
        uint32_t count = level->count - begin < STREAM ? level->count - begin : STREAM;
        const RtRay *rays = level->rays + begin;
        const Path *paths = level->paths + begin;
        RT_TRY(trace_stream(worker, rays, paths, count, error));
        for (uint32_t i = 0; depth == 0 && i < count; i++) {
            worker->job->frame->object[paths[i].sample] = worker->hits[i].object;
            worker->job->frame->depth[paths[i].sample] = worker->hits[i].t;
        }
        uint32_t surface_count = find_surfaces(worker, rays, paths, count);
        RT_TRY(trace_shadows(worker, surface_count, error));
        if (deepest) continue;
        spawn(worker, surface_count, level + 1);
        RT_TRY(trace_level(worker, depth + 1, error));
    }
    return RT_OK;
}

/* ---- tiles ---- */

static void make_primary_rays(Worker *worker, Level *level) {
    const Job *job = worker->job;
    const RtSampling *s = &job->view.sampling;
    const RtFrameObserver *observer = job->options->observer;
    level->count = 0;
    if (observer && observer->given) {
        const RtSample sample = job->tiles[worker->tile];
        level->rays[0] = *observer->given;
        level->paths[level->count++] = (Path){sample.row * s->columns + sample.column, 1, RT_NO_RAY};
        return;
    }
    for (uint32_t i = 0; i < RT_TILE * RT_TILE; i++) {
        RtSample sample = rt_tile_sample(job->tiles[worker->tile], i);
        if (sample.column >= s->columns || sample.row >= s->rows) continue;
        RtRay ray = rt_view_ray(&job->view, sample.column, sample.row);
        job->frame->object[ray.source] = RT_NO_OBJECT;
        job->frame->depth[ray.source] = INFINITY;
        if (!rt_ray_is_valid(&ray)) continue;
        level->rays[level->count] = ray;
        level->paths[level->count++] = (Path){ray.source, 1, RT_NO_RAY};
    }
}

static RtStatus trace_tile(void *context, size_t tile, int thread, RtError *error) {
    Job *job = context;
    const RtFrameOptions *o = job->options;
    Worker *worker = &job->workers[thread];
    const double start = clock_of(worker);
    worker->tile = tile;
    rt_query_begin(&worker->query);
    make_primary_rays(worker, &worker->levels[0]);
    RT_TRY(trace_level(worker, 0, error));
    worker->working += clock_of(worker) - start;
    if (!o->progress) return RT_OK;
    pthread_mutex_lock(&job->lock);
    o->progress(o->progress_context, ++job->tiles_done, job->tile_count);
    pthread_mutex_unlock(&job->lock);
    return RT_OK;
}

/* ---- memory ---- */

static RtStatus init_frame(RtFrame *frame, const RtSampling *sampling, bool counted, RtError *error) {
    const size_t samples = (size_t)sampling->columns * sampling->rows;
    if (samples > RT_MAX_FRAME_SAMPLES)
        return rt_fail(error, RT_BAD_INPUT,
                       "a frame of %u x %u samples: at most %u samples fit; take a smaller image or fewer "
                       "samples per pixel",
                       sampling->columns, sampling->rows, RT_MAX_FRAME_SAMPLES);
    frame->sampling = *sampling;
    frame->color = rt_arena_alloc(&frame->memory, samples, sizeof(RtVec3));
    frame->object = rt_arena_alloc(&frame->memory, samples, sizeof(uint32_t));
    frame->depth = rt_arena_alloc(&frame->memory, samples, sizeof(float));
    if (counted) frame->cost = rt_arena_alloc(&frame->memory, samples, sizeof(RtTally));
    return rt_arena_check(&frame->memory, "a frame", error);
}

static RtStatus init_tiles(Job *job, const RtSampling *sampling, RtError *error) {
    const RtFrameObserver *observer = job->options->observer;
    job->tile_count = observer ? 1 : rt_tile_count(sampling);
    job->tiles = rt_arena_alloc(&job->memory, job->tile_count, sizeof(RtSample));
    if (job->options->keep_rays) job->kept = rt_arena_alloc(&job->memory, job->tile_count, sizeof(TileRays));
    RT_TRY(rt_arena_check(&job->memory, "the tiles of a frame", error));
    if (observer)
        job->tiles[0] = observer->tile;
    else
        rt_tiles_in_order(sampling, job->tiles);
    return RT_OK;
}

/* Concatenates the lists of all tiles, kind by kind, and frees them on the way. */
static RtStatus join_rays(Job *job, RtError *error) {
    for (int kind = 0; job->kept && kind < RT_RAY_KIND_COUNT; kind++) {
        const uint64_t count = job->frame->ray_count[kind];
        RtRay *rays = job->frame->rays[kind] = rt_alloc_unset(count, sizeof(RtRay));
        if (!rays) return rt_fail_memory(error, "the rays of a frame", count * sizeof(RtRay));
        for (size_t i = 0; i < job->tile_count; i++) {
            TileRays *tile = &job->kept[i];
            if (tile->count[kind] == 0) continue;
            memcpy(rays, tile->rays[kind], tile->count[kind] * sizeof(RtRay));
            rays += tile->count[kind];
            rt_free(tile->rays[kind]);
            tile->rays[kind] = NULL;
        }
    }
    return RT_OK;
}

void rt_frame_clear(RtFrame *frame) {
    rt_arena_clear(&frame->memory);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_free(frame->rays[kind]);
    *frame = (RtFrame){0};
}

/* ---- the whole ---- */

static RtStatus run(Job *job, const RtAccel *accel, RtError *error) {
    int threads = rt_thread_count(job->options->threads);
    if ((size_t)threads > job->tile_count) threads = (int)job->tile_count;
    const uint32_t depth = job->options->depth;
    job->workers = rt_arena_alloc(&job->memory, (size_t)threads, sizeof(Worker));
    Level *levels = rt_arena_alloc(&job->memory, (size_t)threads * depth, sizeof(Level));
    RT_TRY(rt_arena_check(&job->memory, "the rays of threads", error));
    RtStatus status = RT_OK;
    for (int i = 0; i < threads && status == RT_OK; i++) {
        job->workers[i].job = job;
        job->workers[i].levels = levels + (size_t)i * depth;
        status = rt_query_init(&job->workers[i].query, accel, error);
    }
    double start = rt_wall_seconds();
    if (status == RT_OK) status = rt_parallel_for(job->tile_count, threads, trace_tile, job, error);
    job->frame->seconds = rt_wall_seconds() - start;
    if (status == RT_OK) status = rt_accel_check(accel, error);
    double querying = 0, working = 0;
    for (int i = 0; i < threads; i++) {
        querying += job->workers[i].querying;
        working += job->workers[i].working;
        for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
            rt_tally_add(&job->frame->tallies[kind], &job->workers[i].tallies[kind]);
            job->frame->ray_count[kind] += job->workers[i].ray_count[kind];
        }
        rt_query_clear(&job->workers[i].query);
    }
    job->frame->share = working > 0 ? querying / working : 0;
    return status == RT_OK ? join_rays(job, error) : status;
}

RtStatus rt_frame_trace(RtFrame *frame, const RtAccel *accel, const RtFrameOptions *options, RtError *error) {
    *frame = (RtFrame){0};
    if (options->depth < 1 || options->depth > RT_MAX_DEPTH)
        return rt_fail(error, RT_BAD_INPUT, "a ray tree of %u levels: expected 1..%d", options->depth,
                       RT_MAX_DEPTH);
    Job job = {.frame = frame, .options = options, .scene = accel->scene};
    const RtSampling *sampling = &accel->scene->sampling;
    RT_TRY(rt_view_init(&job.view, &accel->scene->camera, *sampling, error));
    RtStatus status = init_frame(frame, sampling, options->counted, error);
    if (status == RT_OK) status = init_tiles(&job, sampling, error);
    if (status == RT_OK) {
        pthread_mutex_init(&job.lock, NULL);
        status = run(&job, accel, error);
        pthread_mutex_destroy(&job.lock);
    }
    for (size_t i = 0; status != RT_OK && job.kept && i < job.tile_count; i++) {
        for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_free(job.kept[i].rays[kind]);
    }
    rt_arena_clear(&job.memory);
    if (status != RT_OK) rt_frame_clear(frame);
    return status;
}

/* ---- images ---- */

RtStatus rt_image_init(RtImage *image, uint32_t width, uint32_t height, RtError *error) {
    size_t pixels = (size_t)width * height;
    *image = (RtImage){width, height, rt_alloc(pixels, 3)};
    return image->rgb ? RT_OK : rt_fail_memory(error, "an image", pixels * 3);
}

void rt_image_clear(RtImage *image) {
    rt_free(image->rgb);
    *image = (RtImage){0};
}

RtFootprint rt_pixel_footprint(const RtSampling *sampling, uint32_t x, uint32_t y) {
    if (sampling->corners) return (RtFootprint){x, y, 2};
    return (RtFootprint){x * sampling->samples, y * sampling->samples, sampling->samples};
}

RtVec3 rt_frame_pixel(const RtFrame *frame, uint32_t x, uint32_t y) {
    RtFootprint f = rt_pixel_footprint(&frame->sampling, x, y);
    RtVec3d sum = {0, 0, 0};
    for (uint32_t row = f.row; row < f.row + f.span; row++) {
        const RtVec3 *samples = frame->color + (size_t)row * frame->sampling.columns + f.column;
        for (uint32_t i = 0; i < f.span; i++) sum = rt_addd(sum, rt_widen(samples[i]));
    }
    return rt_narrow(rt_scaled(sum, 1.0 / (f.span * f.span)));
}

double rt_frame_cost(const RtFrame *frame, size_t counter, uint32_t x, uint32_t y) {
    RtFootprint f = rt_pixel_footprint(&frame->sampling, x, y);
    uint64_t sum = 0;
    for (uint32_t row = f.row; row < f.row + f.span; row++) {
        const RtTally *samples = frame->cost + (size_t)row * frame->sampling.columns + f.column;
        for (uint32_t i = 0; i < f.span; i++) sum += rt_tally_get(&samples[i], counter);
    }
    return (double)sum / (f.span * f.span);
}

/* IEC 61966-2-1. */
uint8_t rt_srgb(float linear) {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    double x = (double)linear;
    double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * rt_power(x, 1 / 2.4) - 0.055;
    return (uint8_t)(encoded * 255 + 0.5);
}

RtStatus rt_image_from_frame(RtImage *image, const RtFrame *frame, RtError *error) {
    RT_TRY(rt_image_init(image, frame->sampling.width, frame->sampling.height, error));
    uint8_t *out = image->rgb;
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            RtVec3 color = rt_frame_pixel(frame, x, y);
            for (int channel = 0; channel < 3; channel++) *out++ = rt_srgb(color.at[channel]);
        }
    }
    return RT_OK;
}

/* libpng's simplified interface, which uses no longjmp. */
RtStatus rt_png_write(const RtFrame *frame, const char *path, RtError *error) {
    RT_OWNED(RtImage, image, rt_image_clear);
    RtOutput output;
    RT_TRY(rt_image_from_frame(&image, frame, error));
    RT_TRY(rt_output_open(&output, path, error));
    png_image png = {
        .version = PNG_IMAGE_VERSION, .width = image.width, .height = image.height, .format = PNG_FORMAT_RGB};
    if (!png_image_write_to_stdio(&png, output.file, 0, image.rgb, 0, NULL)) {
        rt_output_discard(&output);
        return rt_fail(error, RT_IO, "%s: writing the PNG failed: %s", path, png.message);
    }
    return rt_output_commit(&output, error);
}
