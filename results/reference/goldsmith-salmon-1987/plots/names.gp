# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "goldsmith-salmon-1987"
format = "svg"
paper = "page"
scenes = "scattered:n=1000 scattered:n=3162 scattered:n=10000 scattered:n=31623 scattered:n=100000 balls gears mount tetra tree teapot "
files = "scattered-n-1000 scattered-n-3162 scattered-n-10000 scattered-n-31623 scattered-n-100000 balls gears mount tetra tree teapot "
accels = "inserted as-given halved by-area "
colors = "#cc79a7 #472a3a #8a5271 #edd0e0 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary random "
sets = "scattered:n=1000/primary=16384 scattered:n=1000/random=20000 scattered:n=3162/primary=16384 scattered:n=3162/random=20000 scattered:n=10000/primary=16384 scattered:n=10000/random=20000 scattered:n=31623/primary=16384 scattered:n=31623/random=20000 scattered:n=100000/primary=16384 scattered:n=100000/random=20000 balls/primary=16384 balls/random=20000 gears/primary=16384 gears/random=20000 mount/primary=16384 mount/random=20000 tetra/primary=16384 tetra/random=20000 tree/primary=16384 tree/random=20000 teapot/primary=16384 teapot/random=20000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
