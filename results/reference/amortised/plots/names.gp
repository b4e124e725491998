# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "amortised"
format = "svg"
paper = "page"
scenes = "balls bunny hall "
files = "balls bunny hall "
accels = "brute extents clusters grid octree kd bvh bvh-lbvh bvh-sweep bvh-spatial wide embree "
colors = "#7f7f7f #e69f00 #cc79a7 #009e73 #56b4e9 #5b4a9f #d55e00 #4b2100 #903f00 #f0c7a6 #0072b2 #7b3294 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse "
sets = "balls/primary=16384 balls/shadow=19712 balls/diffuse=16384 bunny/primary=16384 bunny/shadow=13256 bunny/diffuse=13426 hall/primary=16384 hall/shadow=19456 hall/diffuse=16384 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
