# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "rubin-whitted-1980"
format = "svg"
paper = "page"
scenes = "scattered:n=100 scattered:n=1000 scattered:n=10000 scattered:n=100000 mount:size=3 mount:size=4 mount:size=5 mount:size=6 mount:size=7 mount:size=8 "
files = "scattered-n-100 scattered-n-1000 scattered-n-10000 scattered-n-100000 mount-size-3 mount-size-4 mount-size-5 mount-size-6 mount-size-7 mount-size-8 "
accels = "oriented aligned brute "
colors = "#cc79a7 #472a3a #7f7f7f "
markers = "7 5 9 "
dashes = "1 1 1 "
groups = "\"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "scattered:n=100/primary=16384 scattered:n=100/shadow=18631 scattered:n=1000/primary=16384 scattered:n=1000/shadow=16128 scattered:n=10000/primary=16384 scattered:n=10000/shadow=15360 scattered:n=100000/primary=16384 scattered:n=100000/shadow=17664 mount:size=3/primary=16384 mount:size=3/shadow=15360 mount:size=4/primary=16384 mount:size=4/shadow=16384 mount:size=5/primary=16384 mount:size=5/shadow=16384 mount:size=6/primary=16384 mount:size=6/shadow=16569 mount:size=7/primary=16384 mount:size=7/shadow=16128 mount:size=8/primary=16384 mount:size=8/shadow=15616 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
