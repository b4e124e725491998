# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "wald-benthin-boulos-2008"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest "
files = "bunny dragon hall forest "
accels = "single one-at-a-time packets embree-single embree-packets "
colors = "#0072b2 #00283e #a6cee4 #7b3294 #2b1234 "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection diffuse occlusion random "
sets = "bunny/primary=29184 bunny/shadow=26624 bunny/diffuse=26880 bunny/occlusion=26880 bunny/random=30000 dragon/primary=29184 dragon/shadow=24807 dragon/diffuse=25088 dragon/occlusion=25088 dragon/random=30000 hall/primary=29184 hall/shadow=29440 hall/reflection=25344 hall/diffuse=29184 hall/occlusion=29184 hall/random=30000 forest/primary=29184 forest/shadow=28416 forest/diffuse=29696 forest/occlusion=29696 forest/random=30000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
