# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "meister-bittner-2018"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest "
files = "bunny dragon hall forest "
accels = "morton morton-optimised binned ploc:radius=10 ploc:radius=25 ploc:radius=100 "
colors = "#d55e00 #4b2100 #793500 #a74a00 #e39253 #f0c7a6 "
markers = "7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "bunny/primary=9344 bunny/shadow=6600 bunny/diffuse=6656 bunny/random=10000 dragon/primary=9344 dragon/shadow=6144 dragon/diffuse=6272 dragon/random=10000 hall/primary=9344 hall/shadow=9728 hall/diffuse=9344 hall/random=10000 forest/primary=9344 forest/shadow=9728 forest/diffuse=8832 forest/random=10000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
