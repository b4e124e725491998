// SPDX-License-Identifier: Apache-2.0
// The tree of scenes/csg-bracket.yaml, written a second time by hand.
$fn = 96;
module end() { translate([2.5, 0, 0]) cylinder(h = 0.6, r = 1.5); }
module rib() {
    polyhedron(
        points = [[1, -0.2, 0.6], [1, 0.2, 0.6], [2.4, -0.2, 0.6], [2.4, 0.2, 0.6], [1, -0.2, 2], [1, 0.2, 2]],
        faces = [[0, 2, 3, 1], [0, 4, 2], [1, 3, 5], [0, 1, 5, 4], [2, 4, 5, 3]]);
}
module hole() {
    translate([3, 0.75, -1]) cylinder(h = 2, r = 0.22);
    translate([3, 0.75, 0.3]) cylinder(h = 0.35, r1 = 0.22, r2 = 0.5);
}
difference() {
    union() {
        translate([-2.5, -1.5, 0]) cube([5, 3, 0.6]);
        end();
        rotate(180) end();
        translate([-1, -0.6, 0.6]) cube([2, 1.2, 1.8]);
        translate([0, -0.9, 2.4]) rotate([-90, 0, 0]) cylinder(h = 1.8, r = 1);
        rib();
        rotate(180) rib();
    }
    translate([0, -2, 2.4]) rotate([-90, 0, 0]) cylinder(h = 4, r = 0.55);
    translate([0, -1, 2.4]) rotate([-90, 0, 0]) cylinder(h = 0.3, r = 0.8);
    hole();
    translate([0, -1.5, 0]) hole();
    translate([-6, 0, 0]) hole();
    translate([-6, -1.5, 0]) hole();
    translate([-0.12, -2, 3]) cube([0.24, 4, 1]);
}
