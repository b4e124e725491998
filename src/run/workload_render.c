/* SPDX-License-Identifier: Apache-2.0 */
/* Rendering the frame of a workload with each candidate, in interleaved rounds: how long it takes, and which
 * part of that is spent in the candidate's queries. Candidates with a stride, or of which a limit left out a
 * cell, are too slow for whole frames. Plugins are left out: their rays travel to another process. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/measure.h"
#include "render/frame.h"
#include "run/workload_state.h"

typedef struct Rendering {
    uint32_t candidate;
    const RtAccel *accel;
    RtFrameOptions options;
    double seconds[RT_MAX_ROUNDS], shares[RT_MAX_ROUNDS];
    uint32_t runs; /* the first is the warm-up */
} Rendering;

static RtStatus render_once(void *context, RtError *error) {
    Rendering *rendering = context;
    RtFrame frame;
    RT_TRY(rt_frame_trace(&frame, rendering->accel, &rendering->options, error));
    if (rendering->runs > 0) rendering->shares[rendering->runs - 1] = frame.share;
    rendering->runs++;
    rt_frame_clear(&frame);
    return RT_OK;
}

bool rt_candidate_renders(const RtExperiment *experiment, uint32_t c) {
    return experiment->render && c < experiment->candidate_count &&
           experiment->candidates[c].ray_stride == 1 && !rt_spec_is_remote(&experiment->candidates[c].parsed);
}

bool rt_workload_renders(const RtWorkloadState *workload, uint32_t c) {
    for (int k = 0; k < RT_RAY_KIND_COUNT && c < workload->experiment->candidate_count; k++) {
        if (*rt_cell_at(workload->results, workload->index, c, (RtRayKind)k)->left_out) return false;
    }
    return !workload->count_only && !workload->options->timer &&
           rt_candidate_renders(workload->experiment, c) && rt_workload_runs(workload, c);
}

/* The candidates still to be rendered, one runner each. */
static uint32_t enter(RtWorkloadState *workload, Rendering *renderings, RtRunner *runners) {
    const RtExperiment *experiment = workload->experiment;
    const RtWorkload *setup = &experiment->workloads[workload->index];
    const int threads = workload->options->timing;
    uint32_t count = 0;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (!workload->built[c] || !rt_workload_renders(workload, c) ||
            rt_build_at(workload->results, workload->index, c)->render.known)
            continue;
        Rendering *rendering = &renderings[count];
        *rendering = (Rendering){.candidate = c,
                                 .accel = workload->built[c],
                                 .options = {.depth = setup->depth,
                                             .threads = threads,
                                             .light_from_outside = setup->light_from_outside,
                                             .share = true}};
        runners[count++] = (RtRunner){.run = render_once,
                                      .context = rendering,
                                      .work = 1,
                                      .parallel = rt_thread_count(threads) > 1,
                                      .seconds = rendering->seconds};
    }
    return count;
}

static RtStatus keep(RtWorkloadState *workload, const Rendering *renderings, uint32_t count, RtError *error) {
    const RtMachine here = rt_machine_here();
    const uint32_t rounds = workload->experiment->rounds;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t c = renderings[i].candidate;
        rt_build_at(workload->results, workload->index, c)->render =
            (RtRenderResult){.known = true,
                             .rounds = rounds,
                             .threads = rt_thread_count(workload->options->timing),
                             .machine = rt_results_machine(workload->results, &here),
                             .seconds = rt_estimate(renderings[i].seconds, rounds),
                             .share = rt_estimate(renderings[i].shares, rounds)};
        RT_TRY(rt_workload_tell(workload, RT_EVENT_RENDER, c, RT_RAY_PRIMARY, error));
    }
    return RT_OK;
}

RtStatus rt_workload_render(RtWorkloadState *workload, RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    const size_t most = experiment->candidate_count;
    const RtRounds rounds = {
        .rounds = experiment->rounds, .most = experiment->rounds, .seed = experiment->seed};
    Rendering *renderings = rt_alloc(most, sizeof(Rendering));
    if (!renderings) return rt_fail_memory(error, "times of frames", most * sizeof(Rendering));
    RtRunner runners[RT_MAX_CANDIDATES];
    uint32_t count = enter(workload, renderings, runners), done;
    RtStatus status = count > 0 ? rt_rounds_run(runners, count, &rounds, &done, error) : RT_OK;
    if (status == RT_OK) status = keep(workload, renderings, count, error);
    rt_free(renderings);
    return status;
}
