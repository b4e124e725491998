# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "grid-density"
format = "svg"
paper = "page"
scenes = "uniform clustered bunny stadium "
files = "uniform clustered bunny stadium "
accels = "grid:density=0.125 grid:density=0.25 grid:density=0.5 grid:density=1 grid:density=2 grid:density=4 grid:density=8 grid:density=16 grid:density=32 grid:density=64 grid:density=128 no-mailbox:density=0.125 no-mailbox:density=0.25 no-mailbox:density=0.5 no-mailbox:density=1 no-mailbox:density=2 no-mailbox:density=4 no-mailbox:density=8 no-mailbox:density=16 no-mailbox:density=32 no-mailbox:density=64 no-mailbox:density=128 "
colors = "#009e73 #003728 #00412f #004a36 #00533d #005d43 #00664a #006f51 #007958 #00825f #008b65 #00956c #11a47c #21ab85 #32b18e #42b797 #53bea1 #63c4aa #74cab3 #85d0bc #95d7c5 #a6ddce "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2 2 3 3 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow random "
sets = "uniform/primary=4096 uniform/shadow=4974 uniform/random=5000 clustered/primary=4096 clustered/shadow=2624 clustered/random=5000 bunny/primary=4096 bunny/shadow=3314 bunny/random=5000 stadium/primary=4096 stadium/shadow=4480 stadium/random=5000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
