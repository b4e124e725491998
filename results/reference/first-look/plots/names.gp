# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "first-look"
format = "svg"
paper = "page"
scenes = "balls scattered bunny "
files = "balls scattered bunny "
accels = "brute extents clusters grid octree item+wide light+wide wide bvh kd embree-user embree ideal "
colors = "#7f7f7f #e69f00 #cc79a7 #009e73 #56b4e9 #a6761d #b2182b #0072b2 #d55e00 #5b4a9f #7b3294 #2b1234 #222222 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 "
groups = "\"no structure\" \"the four classic structures\" \"the four classic structures\" \"the four classic structures\" \"the four classic structures\" \"the two classic buffers over wide\" \"the two classic buffers over wide\" \"newer structures\" \"newer structures\" \"newer structures\" \"Embree\" \"Embree\" \"bounds object tests, not time\" "
without = "brute"
among = "the four classic structures"
kinds = "primary shadow reflection transmission "
sets = "balls/primary=65536 balls/shadow=238320 balls/reflection=44168 scattered/primary=65536 scattered/shadow=98269 scattered/reflection=42907 scattered/transmission=30913 bunny/primary=65536 bunny/shadow=13256 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
