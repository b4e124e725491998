// SPDX-License-Identifier: Apache-2.0
// The white pawn of scenes/chess.yaml on the first square of its row.
include <pieces.scad>
translate([-3.5, -2.5, 0.001]) {
    foot();
    cone(0.1, 0.26, 0.52, 0.11);
    egg([0, 0, 0.52], [0.19, 0.19, 0.045]);
    ball([0, 0, 0.68], 0.17);
}
