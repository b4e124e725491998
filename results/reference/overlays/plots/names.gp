# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "overlays"
format = "svg"
paper = "page"
scenes = "balls scattered bunny "
files = "balls scattered bunny "
accels = "brute octree item+octree light+octree cache+octree item+light+octree item+cache+octree cache+light+octree item+cache+light+octree grid item+grid light+grid cache+grid item+light+grid item+cache+grid cache+light+grid item+cache+light+grid bvh item+bvh light+bvh cache+bvh item+light+bvh item+cache+bvh cache+light+bvh item+cache+light+bvh wide item+wide light+wide cache+wide item+light+wide item+cache+wide cache+light+wide item+cache+light+wide "
colors = "#7f7f7f #56b4e9 #a6761d #b2182b #66a61e #3a290a #48330d #243a0b #553c0f #009e73 #634611 #3e080f #34550f #705014 #7e5916 #457014 #8b6318 #d55e00 #996c1b #78101d #558b19 #ae8332 #b78f47 #87b94f #bf9c5c #0072b2 #c7a971 #e4aeb5 #a8cd80 #cfb686 #d8c29b #c9e0b0 #e0cfb0 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 9 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2 2 3 3 3 3 3 3 3 3 3 3 4 4 4 "
groups = "\"no structure\" \"bases\" \"over octree\" \"over octree\" \"over octree\" \"over octree\" \"over octree\" \"over octree\" \"over octree\" \"bases\" \"over grid\" \"over grid\" \"over grid\" \"over grid\" \"over grid\" \"over grid\" \"over grid\" \"bases\" \"over bvh\" \"over bvh\" \"over bvh\" \"over bvh\" \"over bvh\" \"over bvh\" \"over bvh\" \"bases\" \"over wide\" \"over wide\" \"over wide\" \"over wide\" \"over wide\" \"over wide\" \"over wide\" "
without = "brute"
among = "bases"
kinds = "primary shadow reflection transmission "
sets = "balls/primary=16384 balls/shadow=59250 balls/reflection=10855 scattered/primary=16384 scattered/shadow=24310 scattered/reflection=10588 scattered/transmission=7569 bunny/primary=65536 bunny/shadow=13256 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
