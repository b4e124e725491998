# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "stich-2009"
format = "svg"
paper = "page"
scenes = "hall city bunny dragon soup:radius=0.25 soup:radius=1 soup:radius=4 "
files = "hall city bunny dragon soup-radius-0.25 soup-radius-1 soup-radius-4 "
accels = "binned sweep spatial spatial-8 kd "
colors = "#d55e00 #4b2100 #903f00 #f0c7a6 #5b4a9f "
markers = "7 5 9 11 13 "
dashes = "1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "hall/primary=9344 hall/shadow=9728 hall/diffuse=9344 hall/random=10000 city/primary=9344 city/shadow=9216 city/diffuse=8320 city/random=10000 bunny/primary=9344 bunny/shadow=6600 bunny/diffuse=6656 bunny/random=10000 dragon/primary=9344 dragon/shadow=6144 dragon/diffuse=6272 dragon/random=10000 soup:radius=0.25/primary=9344 soup:radius=0.25/shadow=5762 soup:radius=0.25/diffuse=7791 soup:radius=0.25/random=10000 soup:radius=1/primary=9344 soup:radius=1/shadow=9856 soup:radius=1/diffuse=6784 soup:radius=1/random=10000 soup:radius=4/primary=9344 soup:radius=4/shadow=8832 soup:radius=4/diffuse=9088 soup:radius=4/random=10000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
