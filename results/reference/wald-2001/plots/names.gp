# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "wald-2001"
format = "svg"
paper = "page"
scenes = "balls tree teapot hall bunny scattered "
files = "balls tree teapot hall bunny scattered "
accels = "optimised optimised-one-ray insertion nested-grids kd "
colors = "#0072b2 #00283e #cc79a7 #009e73 #5b4a9f "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection diffuse "
sets = "balls/primary=9344 balls/shadow=9728 balls/reflection=8192 balls/diffuse=9344 tree/primary=9344 tree/shadow=9728 tree/diffuse=8448 teapot/primary=9344 teapot/shadow=9984 teapot/reflection=8576 teapot/diffuse=8064 hall/primary=9344 hall/shadow=9728 hall/reflection=9376 hall/diffuse=9344 bunny/primary=9344 bunny/shadow=6600 bunny/diffuse=6656 scattered/primary=9344 scattered/shadow=8576 scattered/reflection=6028 scattered/diffuse=7744 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
