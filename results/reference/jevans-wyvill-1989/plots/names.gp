# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "jevans-wyvill-1989"
format = "svg"
paper = "page"
scenes = "scattered clustered balls teapot stadium bunny "
files = "scattered clustered balls teapot stadium bunny "
accels = "nested:depth=1 nested:depth=2 nested:depth=3 octree "
colors = "#009e73 #003728 #a6ddce #56b4e9 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "scattered/primary=9344 scattered/shadow=8832 clustered/primary=9344 clustered/shadow=9503 balls/primary=9344 balls/shadow=9856 teapot/primary=9344 teapot/shadow=9216 stadium/primary=9344 stadium/shadow=9984 bunny/primary=9344 bunny/shadow=6600 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
