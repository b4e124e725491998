# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "kay-kajiya-1986"
format = "svg"
paper = "page"
scenes = "tetra tree balls mount bunny "
files = "tetra tree balls mount bunny "
accels = "slabs:slabs=3 slabs:slabs=4 slabs:slabs=5 slabs:slabs=6 slabs:slabs=7 unordered glassner "
colors = "#cc79a7 #472a3a #74455f #a05f83 #dda5c4 #edd0e0 #56b4e9 "
markers = "7 5 9 11 13 6 4 "
dashes = "1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "tetra/primary=22016 tetra/shadow=11607 tree/primary=22016 tree/shadow=27383 balls/primary=22016 balls/shadow=29696 mount/primary=22016 mount/shadow=25856 bunny/primary=22016 bunny/shadow=13256 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
