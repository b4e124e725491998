# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "tightness"
format = "svg"
paper = "page"
scenes = "balls:size=3 jewel bunny "
files = "balls-size-3 jewel bunny "
accels = "box sphere obb slabs-3 slabs-4 slabs-5 slabs-6 slabs-7 slabs-9 slabs-11 slabs-13 "
colors = "#e69f00 #513800 #6e4c00 #8c6100 #aa7600 #c88a00 #e9ab21 #edb842 #f0c463 #f3d185 #f6dda6 "
markers = "7 5 9 11 13 6 4 8 10 12 7 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary "
sets = "balls:size=3/primary=993 jewel/primary=993 bunny/primary=993 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
