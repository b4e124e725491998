# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "embree-ablation"
format = "svg"
paper = "page"
scenes = "bunny dragon hall forest "
files = "bunny dragon hall forest "
accels = "wide no-packets packets-always one-packet-at-a-time 4-rays-in-flight one-ray-at-a-time children-in-any-order nothing-fetched-ahead small-pages leaves-of-2 leaves-of-8 AVX2 portable 16-bins no-reinsertion reinsertion-of-all spatial-splits "
colors = "#0072b2 #00283e #00314d #003a5b #00446a #004d78 #005687 #005f95 #0069a4 #157db8 #2989bf #3e94c5 #53a0cb #68abd1 #7cb7d8 #91c2de #a6cee4 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse occlusion random "
sets = "bunny/primary=131072 bunny/shadow=106496 bunny/diffuse=107520 bunny/occlusion=107520 bunny/random=131072 dragon/primary=131072 dragon/shadow=99307 dragon/diffuse=100352 dragon/occlusion=100352 dragon/random=131072 hall/primary=131072 hall/shadow=125952 hall/diffuse=131072 hall/occlusion=131072 hall/random=131072 forest/primary=131072 forest/shadow=125214 forest/diffuse=117760 forest/occlusion=117760 forest/random=131072 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
