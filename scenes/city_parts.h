/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a city. Each stands at the origin of b->transform, with its front, if it has one, towards
 * -y. Lengths are in metres; quads are polygons. The number of objects of a part depends on the random
 * numbers alone. */
#ifndef RT_SCENES_CITY_PARTS_H
#define RT_SCENES_CITY_PARTS_H

#include "core/base/random.h"
#include "scenes/build.h"

enum {
    RT_CITY_ASPHALT,
    RT_CITY_PAVING,
    RT_CITY_PAINT,
    RT_CITY_WALLS, /* the first of RT_CITY_WALL_COUNT */
    RT_CITY_WALL_COUNT = 6,
    RT_CITY_GLASS = RT_CITY_WALLS + RT_CITY_WALL_COUNT,
    RT_CITY_TILES,
    RT_CITY_ROOF,
    RT_CITY_METAL,
    RT_CITY_LIGHT,
    RT_CITY_GRASS,
    RT_CITY_LEAVES,
    RT_CITY_BARK,
    RT_CITY_WATER,
    RT_CITY_CARS, /* the first of RT_CITY_CAR_COUNT */
    RT_CITY_CAR_COUNT = 4,
    RT_CITY_MATERIALS = RT_CITY_CARS + RT_CITY_CAR_COUNT
};
extern const RtMaterial rt_city_materials[RT_CITY_MATERIALS];

void rt_city_car(RtSceneBuilder *b, RtRandom *random);
void rt_city_lamp(RtSceneBuilder *b);
void rt_city_tree(RtSceneBuilder *b, RtRandom *random);

/* A square `edge` long, with the origin in its lower left corner. */
void rt_city_park(RtSceneBuilder *b, RtRandom *random, double edge);

/* Ground to build on: width along the street, depth away from it. */
typedef struct RtCityLot {
    RtSceneBuilder *b;
    RtRandom *random;
    RtVec3d corner; /* left in front, in the scene */
    int quarters;   /* turns, counter-clockwise, that bring its front from -y to where it looks */
    double width, depth;
    double downtown; /* 0 at the edge of the city to 1 in the middle */
} RtCityLot;

/* A house that fills its lot up to the walls of its neighbours, or a tower. */
void rt_city_building(const RtCityLot *lot);

#endif
