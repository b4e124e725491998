# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "dammertz-2008"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest "
files = "bunny dragon hall forest "
accels = "kd kd-exact vectors-of-4 widest-vectors no-vectors bih "
colors = "#5b4a9f #201a38 #0072b2 #00283e #cc79a7 #17becf "
markers = "7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "diffuse random "
sets = "bunny/diffuse=13426 bunny/random=20000 dragon/diffuse=12559 dragon/random=20000 hall/diffuse=16384 hall/random=20000 forest/diffuse=15616 forest/random=20000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
