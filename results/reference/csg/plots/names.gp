# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "csg"
format = "svg"
paper = "page"
scenes = "small-on small-off large-on large-off "
files = "small-on small-off large-on large-off "
accels = "brute extents clusters grid octree bvh item+bvh light+bvh cache+bvh embree-user "
colors = "#7f7f7f #e69f00 #cc79a7 #009e73 #56b4e9 #d55e00 #a6761d #b2182b #66a61e #7b3294 "
markers = "7 5 9 11 13 6 4 8 10 12 "
dashes = "1 1 1 1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection diffuse random "
sets = "small-on/primary=1821 small-on/shadow=1991 small-on/reflection=1374 small-on/diffuse=1595 small-on/random=2000 small-off/primary=1821 small-off/shadow=1991 small-off/reflection=1374 small-off/diffuse=1595 small-off/random=2000 large-on/primary=1821 large-on/shadow=1646 large-on/reflection=1177 large-on/diffuse=1983 large-on/random=2000 large-off/primary=1821 large-off/shadow=1646 large-off/reflection=1177 large-off/diffuse=1983 large-off/random=2000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
