/* SPDX-License-Identifier: Apache-2.0 */
/* The program that each room of the library is linked into, whole: see raytally_room in CMakeLists.txt. */
int main(void) {
    return 0;
}
