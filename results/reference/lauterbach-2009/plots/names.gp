# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "lauterbach-2009"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest balls "
files = "bunny dragon hall forest balls "
accels = "morton morton-30-bits morton-repaired binned sweep "
colors = "#d55e00 #4b2100 #903f00 #e39253 #f0c7a6 "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "bunny/primary=9344 bunny/shadow=6600 bunny/diffuse=6656 bunny/random=10000 dragon/primary=9344 dragon/shadow=6144 dragon/diffuse=6272 dragon/random=10000 hall/primary=9344 hall/shadow=9728 hall/diffuse=9344 hall/random=10000 forest/primary=9344 forest/shadow=9728 forest/diffuse=8832 forest/random=10000 balls/primary=9344 balls/shadow=9856 balls/diffuse=9344 balls/random=10000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
