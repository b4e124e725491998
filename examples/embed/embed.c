/* SPDX-License-Identifier: Apache-2.0 */
/* Uses raytally from a program: opens a scene, records rays, builds two accelerators, verifies one of them,
 * counts and times both, and renders a picture.
 *
 *     embed [SCENE [IMAGE.png]] */
#include <raytally/raytally.h>

#include <stdio.h>

/* All objects of the program, freed in one place. Each may be NULL. */
typedef struct Work {
    raytally_scene *scene;
    raytally_accelerator *accels[2];
    raytally_rays *rays;
} Work;

static void clear(Work *work) {
    raytally_rays_free(work->rays);
    raytally_accelerator_free(work->accels[0]);
    raytally_accelerator_free(work->accels[1]);
    raytally_scene_free(work->scene); /* after its accelerators */
}

/* Opens the scene, and builds a hierarchy and a grid over it on all processors. */
static raytally_status prepare(Work *work, const char *scene, raytally_error *error) {
    static const char *const specs[2] = {"bvh", "grid:density=20"};
    raytally_status status = raytally_scene_open(scene, &work->scene, error);
    if (status != RAYTALLY_OK) return status;
    printf("%s: %lu objects\n", scene, (unsigned long)raytally_scene_object_count(work->scene));

    /* A smaller picture than the scene's own; from here on accelerators know its samples. */
    status = raytally_scene_set_sampling(work->scene, 128, 128, 1, error);
    for (int i = 0; i < 2 && status == RAYTALLY_OK; i++) {
        status = raytally_accelerator_build(work->scene, specs[i], 0, &work->accels[i], error);
    }
    return status;
}

/* Are the grid's hits right? It is compared with brute on difficult rays. */
static raytally_status verify(const Work *work, raytally_error *error) {
    raytally_verify_options how = RAYTALLY_VERIFY_DEFAULTS;
    raytally_verify_result found;
    how.rays = 2000;
    raytally_status status =
        raytally_verify(work->scene, raytally_accelerator_spec(work->accels[1]), &how, &found, error);
    printf("verified by %lu rays: %lu equal, %lu wrong\n", (unsigned long)found.rays,
           (unsigned long)found.equal, (unsigned long)found.wrong);
    return status;
}

/* What do the rays cost? Counts are exact and the same on every machine. */
static raytally_status count(const Work *work, raytally_error *error) {
    for (int i = 0; i < 2; i++) {
        raytally_counters counters;
        raytally_statistics what;
        raytally_status status = raytally_count(work->accels[i], work->rays, 0, &counters, error);
        if (status != RAYTALLY_OK) return status;
        raytally_accelerator_describe(work->accels[i], &what);
        double rays = (double)counters.at[RAYTALLY_RAYS];
        printf("%-4.4s  %8.4f object tests, %8.4f steps a ray; %8.0f bytes\n",
               raytally_accelerator_spec(work->accels[i]), (double)counters.at[RAYTALLY_OBJECT_TESTS] / rays,
               (double)counters.at[RAYTALLY_STEPS] / rays, what.at[RAYTALLY_BYTES]);
    }
    return RAYTALLY_OK;
}

/* Which is faster? Times depend on the machine; the ratio is paired round by round, with its interval. */
static raytally_status time_both(const Work *work, raytally_error *error) {
    raytally_time_options how = RAYTALLY_TIME_DEFAULTS;
    raytally_time times[2];
    how.least = 0.005; /* seconds, to be quick; the default is that of `raytally bench` */
    raytally_status status = raytally_time_all(work->accels, 2, work->rays, &how, times, error);
    for (int i = 0; i < 2 && status == RAYTALLY_OK; i++) {
        printf("%-4.4s  %6.3f Mrays/s, ratio %.3f [%.3f, %.3f]\n", raytally_accelerator_spec(work->accels[i]),
               1e-6 / times[i].seconds.median, times[i].ratio.median, times[i].ratio.low,
               times[i].ratio.high);
    }
    return status;
}

/* Traces one ray, as a renderer would: each thread has a tracer of its own. */
static raytally_status trace_one(const Work *work, raytally_error *error) {
    raytally_tracer *tracer;
    raytally_hit hit;
    raytally_status status = raytally_tracer_new(work->accels[0], &tracer, error);
    if (status != RAYTALLY_OK) return status;
    raytally_nearest(tracer, raytally_rays_data(work->rays), 1, &hit, NULL);
    if (hit.object == RAYTALLY_NO_OBJECT) {
        printf("the first ray hits nothing\n");
    } else {
        printf("the first ray hits object %lu at t = %.9g\n", (unsigned long)hit.object, (double)hit.t);
    }
    raytally_tracer_free(tracer);
    return RAYTALLY_OK;
}

int main(int argc, char **argv) {
    const char *scene = argc > 1 ? argv[1] : "balls:size=3", *image = argc > 2 ? argv[2] : "embed.png";
    Work work = {NULL, {NULL, NULL}, NULL};
    raytally_error error = {RAYTALLY_OK, ""};

    /* If they differ, the header does not belong to the library. */
    if (raytally_abi_version() != RAYTALLY_ABI_VERSION) {
        fprintf(stderr, "embed: built for interface %d, and runs with %d\n", RAYTALLY_ABI_VERSION,
                raytally_abi_version());
        return 2;
    }
    raytally_status status = prepare(&work, scene, &error);
    if (status == RAYTALLY_OK) status = verify(&work, &error);
    if (status == RAYTALLY_OK)
        status = raytally_rays_record(work.accels[0], RAYTALLY_PRIMARY, NULL, &work.rays, &error);
    if (status == RAYTALLY_OK) status = count(&work, &error);
    if (status == RAYTALLY_OK) status = time_both(&work, &error);
    if (status == RAYTALLY_OK) status = trace_one(&work, &error);
    if (status == RAYTALLY_OK) status = raytally_render(work.accels[0], 0, 0, image, NULL, &error);
    if (status != RAYTALLY_OK) fprintf(stderr, "embed: %s\n", error.message);
    clear(&work);
    return status == RAYTALLY_OK ? 0 : status == RAYTALLY_MISMATCH ? 1 : 2;
}
