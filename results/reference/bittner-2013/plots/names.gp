# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "bittner-2013"
format = "svg"
paper = "page"
scenes = "bunny dragon teapot gears lattice balls tree hall city forest "
files = "bunny dragon teapot gears lattice balls tree hall city forest "
accels = "sweep sweep-optimised medians medians-optimised "
colors = "#d55e00 #4b2100 #903f00 #f0c7a6 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "bunny/primary=32768 bunny/shadow=13256 bunny/diffuse=13426 bunny/random=50000 dragon/primary=32768 dragon/shadow=12449 dragon/diffuse=12601 dragon/random=50000 teapot/primary=32768 teapot/shadow=49876 teapot/diffuse=40335 teapot/random=50000 gears/primary=32768 gears/shadow=45328 gears/diffuse=30583 gears/random=50000 lattice/primary=32768 lattice/shadow=45319 lattice/diffuse=32519 lattice/random=50000 balls/primary=32768 balls/shadow=44529 balls/diffuse=32768 balls/random=50000 tree/primary=32768 tree/shadow=45567 tree/diffuse=42337 tree/random=50000 hall/primary=32768 hall/shadow=42728 hall/diffuse=32768 hall/random=50000 city/primary=32768 city/shadow=36655 city/diffuse=41823 city/random=50000 forest/primary=32768 forest/shadow=40406 forest/diffuse=44804 forest/random=50000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
