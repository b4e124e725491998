# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "wald-havran-2006"
format = "svg"
paper = "page"
scenes = "soup:n=1000 soup:n=4000 soup:n=16000 soup:n=64000 soup:n=256000 soup:n=1024000 "
files = "soup-n-1000 soup-n-4000 soup-n-16000 soup-n-64000 soup-n-256000 soup-n-1024000 "
accels = "kd-box kd-exact bvh-lbvh bvh-sweep "
colors = "#5b4a9f #201a38 #d55e00 #4b2100 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary "
sets = "soup:n=1000/primary=825 soup:n=4000/primary=825 soup:n=16000/primary=825 soup:n=64000/primary=825 soup:n=256000/primary=825 soup:n=1024000/primary=825 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
