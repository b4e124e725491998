# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "coherence"
format = "svg"
paper = "page"
scenes = "balls gears bunny forest "
files = "balls gears bunny forest "
accels = "wide in-flight one-ray bvh grid embree-1 embree-16 "
colors = "#0072b2 #00283e #a6cee4 #d55e00 #009e73 #7b3294 #2b1234 "
markers = "7 5 9 11 13 6 4 "
dashes = "1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission diffuse random "
sets = "balls/primary=16384 balls/shadow=19712 balls/reflection=14592 balls/diffuse=16384 balls/random=20000 gears/primary=16384 gears/shadow=19456 gears/reflection=18944 gears/transmission=16706 gears/diffuse=15360 gears/random=20000 bunny/primary=16384 bunny/shadow=13256 bunny/diffuse=13426 bunny/random=20000 forest/primary=16384 forest/shadow=19456 forest/diffuse=14686 forest/random=20000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
