# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "extent-cost"
format = "svg"
paper = "page"
scenes = "spheres:radius=0.25 spheres:radius=0.5 spheres:radius=1 spheres:radius=2 spheres:radius=4 spheres:radius=8 triangles:radius=0.25 triangles:radius=0.5 triangles:radius=1 triangles:radius=2 triangles:radius=4 triangles:radius=8 "
files = "spheres-radius-0.25 spheres-radius-0.5 spheres-radius-1 spheres-radius-2 spheres-radius-4 spheres-radius-8 triangles-radius-0.25 triangles-radius-0.5 triangles-radius-1 triangles-radius-2 triangles-radius-4 triangles-radius-8 "
accels = "box sphere obb slabs-7 "
colors = "#e69f00 #513800 #9b6b00 #f6dda6 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow random "
sets = "spheres:radius=0.25/primary=1798 spheres:radius=0.25/shadow=1891 spheres:radius=0.25/random=2000 spheres:radius=0.5/primary=1798 spheres:radius=0.5/shadow=1705 spheres:radius=0.5/random=2000 spheres:radius=1/primary=1798 spheres:radius=1/shadow=1643 spheres:radius=1/random=2000 spheres:radius=2/primary=1798 spheres:radius=2/shadow=1891 spheres:radius=2/random=2000 spheres:radius=4/primary=1798 spheres:radius=4/shadow=1705 spheres:radius=4/random=2000 spheres:radius=8/primary=1798 spheres:radius=8/shadow=1333 spheres:radius=8/random=2000 triangles:radius=0.25/primary=1798 triangles:radius=0.25/shadow=1182 triangles:radius=0.25/random=2000 triangles:radius=0.5/primary=1798 triangles:radius=0.5/shadow=1613 triangles:radius=0.5/random=2000 triangles:radius=1/primary=1798 triangles:radius=1/shadow=1767 triangles:radius=1/random=2000 triangles:radius=2/primary=1798 triangles:radius=2/shadow=1798 triangles:radius=2/random=2000 triangles:radius=4/primary=1798 triangles:radius=4/shadow=1673 triangles:radius=4/random=2000 triangles:radius=8/primary=1798 triangles:radius=8/shadow=1509 triangles:radius=8/random=2000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
