/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/observe.h"

_Thread_local const RtTraceObserver *rt_trace_observer;

void rt_observe(const RtTraced *event) {
    rt_trace_observer->observe(rt_trace_observer->context, event);
}

void rt_traced_count(const RtTraced *event, RtTally *tally) {
    switch (event->kind) {
    case RT_TRACED_STEP:
        tally->steps++;
        tally->leaf_steps += event->leaf;
        tally->empty_steps += event->empty;
        break;
    case RT_TRACED_EXTENT_TEST: tally->extent_tests++; break;
    case RT_TRACED_OBJECT_TEST: tally->object_tests++; break;
    case RT_TRACED_OBJECT_HIT: tally->object_hits++; break;
    case RT_TRACED_CSG_TEST: tally->csg_tests++; break;
    case RT_TRACED_REPEAT_AVOIDED: tally->repeats_avoided++; break;
    case RT_TRACED_PASSED_ON: tally->passed_on++; break;
    case RT_TRACED_ENTERED: tally->instances_entered++; break;
    case RT_TRACED_CSG_RESULT:
    case RT_TRACED_LEFT:
    case RT_TRACED_KIND_COUNT: break;
    }
}
