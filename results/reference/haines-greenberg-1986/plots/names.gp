# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "haines-greenberg-1986"
format = "svg"
paper = "page"
scenes = "balls gears mount rings teapot tree "
files = "balls gears mount rings teapot tree "
accels = "hierarchy light:cells=20 light:cells=50 light:cells=100 light:cells=200 "
colors = "#cc79a7 #b2182b #3e080f #78101d #e4aeb5 "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "shadow "
sets = "balls/shadow=9856 gears/shadow=9856 mount/shadow=9350 rings/shadow=9728 teapot/shadow=9216 tree/shadow=9728 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
