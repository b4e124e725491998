# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "arena-streams"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest tetra soup clusters stadium "
files = "bunny dragon hall forest tetra soup clusters stadium "
accels = "wide visionaray embree-1-medium-avx2 embree-8-medium-avx2 embree-16-medium-avx2 embree-stream-medium-avx2 embree-1-high-avx2 embree-8-high-avx2 embree-16-high-avx2 embree-stream-high-avx2 embree-1-medium-avx512 embree-8-medium-avx512 embree-16-medium-avx512 embree-stream-medium-avx512 embree-1-high-avx512 embree-8-high-avx512 embree-16-high-avx512 embree-stream-high-avx512 "
colors = "#0072b2 #17becf #7b3294 #2b1234 #351640 #3f1a4c #491e58 #532264 #5d2670 #672a7c #712e88 #87459e #9458a8 #a06bb2 #ac7ebc #b891c6 #c5a4d0 #d1b7da "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse occlusion random "
sets = "bunny/primary=131072 bunny/shadow=106496 bunny/diffuse=107520 bunny/occlusion=107520 bunny/random=131072 dragon/primary=131072 dragon/shadow=99307 dragon/diffuse=100352 dragon/occlusion=100352 dragon/random=131072 hall/primary=131072 hall/shadow=125952 hall/diffuse=131072 hall/occlusion=131072 hall/random=131072 forest/primary=131072 forest/shadow=125214 forest/diffuse=117760 forest/occlusion=117760 forest/random=131072 tetra/primary=131072 tetra/shadow=75689 tetra/diffuse=81920 tetra/occlusion=81920 tetra/random=131072 soup/primary=131072 soup/shadow=103798 soup/diffuse=94208 soup/occlusion=94208 soup/random=131072 clusters/primary=131072 clusters/shadow=75776 clusters/diffuse=101763 clusters/occlusion=101763 clusters/random=131072 stadium/primary=131072 stadium/shadow=123904 stadium/diffuse=125952 stadium/occlusion=125952 stadium/random=131072 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
