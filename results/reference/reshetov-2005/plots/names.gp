# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "reshetov-2005"
format = "svg"
paper = "page"
scenes = "hall-64 hall-256 hall-1024 bunny-64 bunny-256 bunny-1024 "
files = "hall-64 hall-256 hall-1024 bunny-64 bunny-256 bunny-1024 "
accels = "beams single one-at-a-time "
colors = "#0072b2 #00283e #a6cee4 "
markers = "7 5 9 "
dashes = "1 1 1 "
groups = "\"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "hall-64/primary=4096 hall-64/shadow=13440 hall-256/primary=21632 hall-256/shadow=26880 hall-1024/primary=30000 hall-1024/shadow=30000 bunny-64/primary=4096 bunny-64/shadow=822 bunny-256/primary=21632 bunny-256/shadow=13256 bunny-1024/primary=30000 bunny-1024/shadow=26542 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
