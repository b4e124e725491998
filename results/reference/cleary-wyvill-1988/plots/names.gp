# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "cleary-wyvill-1988"
format = "svg"
paper = "page"
scenes = "scattered:n=100 scattered:n=1000 scattered:n=10000 scattered:n=100000 sparse:n=100 sparse:n=1000 sparse:n=10000 sparse:n=100000 teapot:size=4 teapot:size=9 teapot:size=18 teapot:size=39 "
files = "scattered-n-100 scattered-n-1000 scattered-n-10000 scattered-n-100000 sparse-n-100 sparse-n-1000 sparse-n-10000 sparse-n-100000 teapot-size-4 teapot-size-9 teapot-size-18 teapot-size-39 "
accels = "grid:density=0.25 grid:density=0.5 grid:density=1 grid:density=2 grid:density=4 grid:density=8 grid:density=16 grid:density=32 grid:density=64 "
colors = "#009e73 #003728 #00513b #006b4e #008460 #29ae8a #53bea1 #7ccdb7 #a6ddce "
markers = "7 5 9 11 13 6 4 8 10 "
dashes = "1 1 1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary random "
sets = "scattered:n=100/primary=8192 scattered:n=100/random=10000 scattered:n=1000/primary=8192 scattered:n=1000/random=10000 scattered:n=10000/primary=8192 scattered:n=10000/random=10000 scattered:n=100000/primary=8192 scattered:n=100000/random=10000 sparse:n=100/primary=8192 sparse:n=100/random=10000 sparse:n=1000/primary=8192 sparse:n=1000/random=10000 sparse:n=10000/primary=8192 sparse:n=10000/random=10000 sparse:n=100000/primary=8192 sparse:n=100000/random=10000 teapot:size=4/primary=8192 teapot:size=4/random=10000 teapot:size=9/primary=8192 teapot:size=9/random=10000 teapot:size=18/primary=8192 teapot:size=18/random=10000 teapot:size=39/primary=8192 teapot:size=39/random=10000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
