# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "octree-leaf"
format = "svg"
paper = "page"
scenes = "uniform clustered balls bunny "
files = "uniform clustered balls bunny "
accels = "leaf:max_leaf_size=1 leaf:max_leaf_size=2 leaf:max_leaf_size=3 leaf:max_leaf_size=4 leaf:max_leaf_size=6 leaf:max_leaf_size=8 leaf:max_leaf_size=16 leaf:max_leaf_size=32 depth:max_depth=3 depth:max_depth=4 depth:max_depth=5 depth:max_depth=6 depth:max_depth=7 depth:max_depth=8 depth:max_depth=9 depth:max_depth=10 "
colors = "#56b4e9 #1e3f52 #254e64 #2c5c77 #336b8a #3a7a9d #4188b0 #4897c3 #4fa5d6 #66bbeb #75c2ed #85c9ef #95d0f1 #a4d7f3 #b4def5 #c4e5f7 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow random "
sets = "uniform/primary=4096 uniform/shadow=4974 uniform/random=5000 clustered/primary=4096 clustered/shadow=2624 clustered/random=5000 balls/primary=4096 balls/shadow=4608 balls/random=5000 bunny/primary=4096 bunny/shadow=3314 bunny/random=5000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
