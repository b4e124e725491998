# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "glassner-1984"
format = "svg"
paper = "page"
scenes = "scattered:n=100 scattered:n=1000 scattered:n=10000 scattered:n=100000 scattered:n=1000000 tetra:size=3 tetra:size=4 tetra:size=5 tetra:size=6 tetra:size=7 tetra:size=8 tetra:size=9 balls:size=2 balls:size=3 balls:size=4 balls:size=5 "
files = "scattered-n-100 scattered-n-1000 scattered-n-10000 scattered-n-100000 scattered-n-1000000 tetra-size-3 tetra-size-4 tetra-size-5 tetra-size-6 tetra-size-7 tetra-size-8 tetra-size-9 balls-size-2 balls-size-3 balls-size-4 balls-size-5 "
accels = "glassner octree bvh "
colors = "#56b4e9 #1e3f52 #d55e00 "
markers = "7 5 9 "
dashes = "1 1 1 "
groups = "\"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "scattered:n=100/primary=9344 scattered:n=100/shadow=9287 scattered:n=1000/primary=9344 scattered:n=1000/shadow=8064 scattered:n=10000/primary=9344 scattered:n=10000/shadow=9097 scattered:n=100000/primary=9344 scattered:n=100000/shadow=8832 scattered:n=1000000/primary=9344 scattered:n=1000000/shadow=9344 tetra:size=3/primary=9344 tetra:size=3/shadow=7424 tetra:size=4/primary=9344 tetra:size=4/shadow=6817 tetra:size=5/primary=9344 tetra:size=5/shadow=6272 tetra:size=6/primary=9344 tetra:size=6/shadow=5847 tetra:size=7/primary=9344 tetra:size=7/shadow=5375 tetra:size=8/primary=9344 tetra:size=8/shadow=5094 tetra:size=9/primary=9344 tetra:size=9/shadow=9524 balls:size=2/primary=9344 balls:size=2/shadow=9728 balls:size=3/primary=9344 balls:size=3/shadow=9835 balls:size=4/primary=9344 balls:size=4/shadow=9856 balls:size=5/primary=9344 balls:size=5/shadow=9856 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
