# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "walter-2008"
format = "svg"
paper = "page"
scenes = "balls tree teapot hall bunny dragon forest soup:n=1000 soup:n=3200 soup:n=10240 soup:n=32768 soup:n=104858 "
files = "balls tree teapot hall bunny dragon forest soup-n-1000 soup-n-3200 soup-n-10240 soup-n-32768 soup-n-104858 "
accels = "from-the-top agglomerative insertion medians "
colors = "#cc79a7 #472a3a #8a5271 #edd0e0 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "balls/primary=4672 balls/shadow=4928 balls/diffuse=4672 balls/random=5000 tree/primary=4672 tree/shadow=4992 tree/diffuse=4672 tree/random=5000 teapot/primary=4672 teapot/shadow=4992 teapot/diffuse=4480 teapot/random=5000 hall/primary=4672 hall/shadow=4992 hall/diffuse=4672 hall/random=5000 bunny/primary=4672 bunny/shadow=4416 bunny/diffuse=4466 bunny/random=5000 dragon/primary=4672 dragon/shadow=4129 dragon/diffuse=4217 dragon/random=5000 forest/primary=4672 forest/shadow=4736 forest/diffuse=4992 forest/random=5000 soup:n=1000/primary=4672 soup:n=1000/shadow=4704 soup:n=1000/diffuse=3134 soup:n=1000/random=5000 soup:n=3200/primary=4672 soup:n=3200/shadow=3328 soup:n=3200/diffuse=4507 soup:n=3200/random=5000 soup:n=10240/primary=4672 soup:n=10240/shadow=4669 soup:n=10240/diffuse=3136 soup:n=10240/random=5000 soup:n=32768/primary=4672 soup:n=32768/shadow=4361 soup:n=32768/diffuse=4416 soup:n=32768/random=5000 soup:n=104858/primary=4672 soup:n=104858/shadow=4352 soup:n=104858/diffuse=3904 soup:n=104858/random=5000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
