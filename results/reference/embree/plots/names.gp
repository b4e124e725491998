# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "embree"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest balls "
files = "bunny dragon hall forest balls "
accels = "wide wide-reinserted bvh embree-1-medium-avx2 embree-8-medium-avx2 embree-16-medium-avx2 embree-stream-medium-avx2 embree-1-high-avx2 embree-8-high-avx2 embree-16-high-avx2 embree-stream-high-avx2 embree-1-medium-avx512 embree-8-medium-avx512 embree-16-medium-avx512 embree-stream-medium-avx512 embree-1-high-avx512 embree-8-high-avx512 embree-16-high-avx512 embree-stream-high-avx512 "
colors = "#0072b2 #00283e #d55e00 #7b3294 #2b1234 #351640 #3f1a4c #491e58 #532264 #5d2670 #672a7c #712e88 #87459e #9458a8 #a06bb2 #ac7ebc #b891c6 #c5a4d0 #d1b7da "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse occlusion random "
sets = "bunny/primary=262144 bunny/shadow=212014 bunny/diffuse=214784 bunny/occlusion=214784 bunny/random=262144 dragon/primary=262144 dragon/shadow=198635 dragon/diffuse=201053 dragon/occlusion=201053 dragon/random=262144 hall/primary=262144 hall/shadow=243712 hall/diffuse=262144 hall/occlusion=262144 hall/random=262144 forest/primary=262144 forest/shadow=249856 forest/diffuse=235106 forest/occlusion=235106 forest/random=262144 balls/primary=262144 balls/shadow=257169 balls/diffuse=262144 balls/occlusion=262144 balls/random=262144 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
