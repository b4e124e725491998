# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "woop-2013"
format = "svg"
paper = "page"
scenes = "bunny dragon hall teapot "
files = "bunny dragon hall teapot "
accels = "wide fast robust fast-packets robust-packets "
colors = "#0072b2 #7b3294 #2b1234 #532264 #d1b7da "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "bunny/primary=29184 bunny/shadow=26624 bunny/diffuse=26880 bunny/random=30000 dragon/primary=29184 dragon/shadow=24807 dragon/diffuse=25088 dragon/random=30000 hall/primary=29184 hall/shadow=29440 hall/diffuse=29184 hall/random=30000 teapot/primary=29184 teapot/shadow=28416 teapot/diffuse=26880 teapot/random=30000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
