# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "arena"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest tetra soup clusters stadium "
files = "bunny dragon hall forest tetra soup clusters stadium "
accels = "wide bvh tinybvh tinybvh-bvh4 madmann91 madmann91-robust nanort fastbvh visionaray embree-1-medium-avx2 embree-1-high-avx2 embree-1-medium-avx512 embree-1-high-avx512 "
colors = "#0072b2 #d55e00 #17becf #084348 #0d6c75 #1295a2 #49ccd9 #7cdae4 #aee8ee #7b3294 #2b1234 #532264 #d1b7da "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse occlusion random "
sets = "bunny/primary=131072 bunny/shadow=106496 bunny/diffuse=107520 bunny/occlusion=107520 bunny/random=131072 dragon/primary=131072 dragon/shadow=99307 dragon/diffuse=100352 dragon/occlusion=100352 dragon/random=131072 hall/primary=131072 hall/shadow=125952 hall/diffuse=131072 hall/occlusion=131072 hall/random=131072 forest/primary=131072 forest/shadow=125214 forest/diffuse=117760 forest/occlusion=117760 forest/random=131072 tetra/primary=131072 tetra/shadow=75689 tetra/diffuse=81920 tetra/occlusion=81920 tetra/random=131072 soup/primary=131072 soup/shadow=103798 soup/diffuse=94208 soup/occlusion=94208 soup/random=131072 clusters/primary=131072 clusters/shadow=75776 clusters/diffuse=101763 clusters/occlusion=101763 clusters/random=131072 stadium/primary=131072 stadium/shadow=123904 stadium/diffuse=125952 stadium/occlusion=125952 stadium/random=131072 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
