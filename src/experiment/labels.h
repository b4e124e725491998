/* SPDX-License-Identifier: Apache-2.0 */
/* Labels of scenes and accelerators. In files they are whole; on a screen they may be shortened
 * (RtWorkload.shown); names of files are made from them. */
#ifndef RT_EXPERIMENT_LABELS_H
#define RT_EXPERIMENT_LABELS_H

#include "experiment/experiment.h"

/* Makes stem and label of one of a sweep: the given label, and that with ":key=value" for what is swept. */
RtStatus rt_label_sweep(const char *given, const RtSwept *swept, char stem[RT_MAX_LABEL],
                        char label[RT_MAX_LABEL], RtError *error);

/* Makes stem and label of the last workload, from its spec and that without swept parameters: a file's name
 * without folder and extension, or a built-in's spec, with _ for characters that labels may not have. If
 * another scene then has that label, it gets a number. */
void rt_label_scene(RtExperiment *experiment, RtWorkload *workload, const char *stem, const char *spec);

/* Names the files of workload `i`. Names that are equal but for case are numbered. */
void rt_label_files(RtExperiment *experiment, uint32_t i);

/* Sets what is shown of all scenes and accelerators. */
void rt_labels_shorten(RtExperiment *experiment);

#endif
