# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "fujimoto-1986"
format = "svg"
paper = "page"
scenes = "scattered:n=1000 scattered:n=10000 scattered:n=100000 scattered:n=1000000 teapot:size=3 teapot:size=6 teapot:size=12 teapot:size=24 teapot:size=48 balls "
files = "scattered-n-1000 scattered-n-10000 scattered-n-100000 scattered-n-1000000 teapot-size-3 teapot-size-6 teapot-size-12 teapot-size-24 teapot-size-48 balls "
accels = "3ddda glassner hierarchy "
colors = "#009e73 #56b4e9 #cc79a7 "
markers = "7 5 9 "
dashes = "1 1 1 "
groups = "\"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "scattered:n=1000/primary=9344 scattered:n=1000/shadow=8064 scattered:n=10000/primary=9344 scattered:n=10000/shadow=9097 scattered:n=100000/primary=9344 scattered:n=100000/shadow=8832 scattered:n=1000000/primary=9344 scattered:n=1000000/shadow=9344 teapot:size=3/primary=9344 teapot:size=3/shadow=9216 teapot:size=6/primary=9344 teapot:size=6/shadow=9216 teapot:size=12/primary=9344 teapot:size=12/shadow=9216 teapot:size=24/primary=9344 teapot:size=24/shadow=9216 teapot:size=48/primary=9344 teapot:size=48/shadow=9216 balls/primary=9344 balls/shadow=9856 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
