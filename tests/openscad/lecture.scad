// SPDX-License-Identifier: Apache-2.0
// The tree of scenes/csg-lecture.yaml, written a second time by hand.
$fn = 64;
union() {
    difference() {
        intersection() {
            cube(2, center = true);
            sphere(1.35);
        }
        translate([0, 0, -2]) cylinder(h = 4, r = 0.6);
    }
    translate([0, 0, -1]) rotate_extrude() translate([0.95, 0]) circle(0.22);
}
