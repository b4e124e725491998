# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "clustering"
format = "svg"
paper = "page"
scenes = "balls scattered bunny hall "
files = "balls scattered bunny hall "
accels = "clusters:method=agglomerative clusters:method=ploc clusters:method=goldsmith-salmon clusters:method=rubin-whitted clusters:method=sah "
colors = "#cc79a7 #472a3a #8a5271 #dda5c4 #edd0e0 "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "balls/primary=16384 balls/shadow=19712 balls/diffuse=16384 balls/random=20000 scattered/primary=16384 scattered/shadow=19677 scattered/diffuse=11264 scattered/random=20000 bunny/primary=16384 bunny/shadow=13256 bunny/diffuse=13426 bunny/random=20000 hall/primary=16384 hall/shadow=19456 hall/diffuse=16384 hall/random=20000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
