// SPDX-License-Identifier: Apache-2.0
// The white knight of scenes/chess.yaml on the second square of its row.
include <pieces.scad>
translate([-2.5, -3.5, 0.001]) rotate(90) {
    foot();
    cone(0.1, 0.26, 0.34, 0.18);
    difference() {
        hull() polyhedron(
            points = [[-0.2, -0.13, 0.28], [-0.2, 0.13, 0.28], [0.2, -0.13, 0.28], [0.2, 0.13, 0.28],
                      [-0.24, -0.1, 0.7], [-0.24, 0.1, 0.7], [-0.06, -0.07, 1.02], [-0.06, 0.07, 1.02],
                      [0.38, -0.09, 0.66], [0.38, 0.09, 0.66], [0.36, -0.08, 0.78], [0.36, 0.08, 0.78]],
            faces = [for (i = [0 : 9]) [i, i + 1, i + 2]]);
        translate([0.34, -1, 0.5]) rotate([-90, 0, 0]) cylinder(h = 2, r = 0.14);
        block([-0.3, -0.03, 0.9], [0.3, 0.03, 1.2]);
        block([0.24, -1, 0.695], [1, 1, 0.71]);
        ball([0.12, -0.11, 0.84], 0.035);
        ball([0.12, 0.11, 0.84], 0.035);
    }
}
