# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "macdonald-booth-1990"
format = "svg"
paper = "page"
scenes = "small large balls tetra tree "
files = "small large balls tetra tree "
accels = "kd octree-centre octree-cost best-planes half-of-space half-of-objects brute "
colors = "#5b4a9f #56b4e9 #1e3f52 #d55e00 #4b2100 #cc79a7 #7f7f7f "
markers = "7 5 9 11 13 6 4 "
dashes = "1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary random "
sets = "small/primary=16384 small/random=20000 large/primary=16384 large/random=20000 balls/primary=16384 balls/random=20000 tetra/primary=16384 tetra/random=20000 tree/primary=16384 tree/random=20000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
