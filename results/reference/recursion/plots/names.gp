# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "recursion"
format = "svg"
paper = "page"
scenes = "balls-1 balls-2 balls-3 balls-4 balls-5 balls-6 gears-1 gears-2 gears-3 gears-4 gears-5 gears-6 "
files = "balls-1 balls-2 balls-3 balls-4 balls-5 balls-6 gears-1 gears-2 gears-3 gears-4 gears-5 gears-6 "
accels = "bvh wide "
colors = "#d55e00 #0072b2 "
markers = "7 5 "
dashes = "1 1 "
groups = "\"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission "
sets = "balls-1/primary=65536 balls-1/shadow=177175 balls-2/primary=65536 balls-2/shadow=206880 balls-2/reflection=21399 balls-3/primary=65536 balls-3/shadow=222642 balls-3/reflection=32768 balls-4/primary=65536 balls-4/shadow=232187 balls-4/reflection=39760 balls-5/primary=65536 balls-5/shadow=238320 balls-5/reflection=44168 balls-6/primary=65536 balls-6/shadow=242265 balls-6/reflection=47027 gears-1/primary=65536 gears-1/shadow=283151 gears-2/primary=65536 gears-2/shadow=342524 gears-2/reflection=30202 gears-2/transmission=9608 gears-3/primary=65536 gears-3/shadow=407948 gears-3/reflection=43302 gears-3/transmission=21196 gears-4/primary=65536 gears-4/shadow=475275 gears-4/reflection=58807 gears-4/transmission=34611 gears-5/primary=65536 gears-5/shadow=562576 gears-5/reflection=76234 gears-5/transmission=50242 gears-6/primary=65536 gears-6/shadow=651492 gears-6/reflection=97339 gears-6/transmission=67732 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
