// SPDX-License-Identifier: Apache-2.0
// What the program recorded, as src/report/explore_record.h describes it.

import { light } from './light.js';

export const UNNAMED = 'unknown';

// The bytes of one part of the page: a compressed data URL.
async function unpack(name) {
  const text = document.getElementById(`part-${name}`).textContent;
  const bytes = Uint8Array.from(atob(text.slice(text.indexOf(',') + 1)), (char) => char.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

class Reader {
  constructor(bytes, at = 0) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = at;
  }
  get done() { return this.at >= this.bytes.length; }
  number() {
    let value = 0, scale = 1;
    for (;;) {
      const byte = this.bytes[this.at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  }
  length() {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }
  float() {
    this.at += 4;
    return this.view.getFloat32(this.at - 4, true);
  }
  vector() { return [this.float(), this.float(), this.float()]; }
  box() { return { lo: this.vector(), hi: this.vector() }; }
  object() {
    const code = this.number();
    return code === 0 ? null : code === 1 ? UNNAMED : code - 2;
  }
}

// Where the record of each pixel begins.
function places(bytes) {
  const reader = new Reader(bytes), list = [];
  while (!reader.done) {
    const number = reader.number(), length = reader.length();
    list[number] = reader.at;
    reader.at += length;
  }
  return list;
}

function many(count, read) {
  return Array.from({ length: count }, read);
}

function readRay(reader, kinds) {
  const ray = { kind: kinds[reader.number()], level: reader.number(), parent: reader.number() - 1, source: reader.number() };
  const flags = reader.number();
  Object.assign(ray, { total: (flags & 1) !== 0, cut: (flags & 2) !== 0, org: reader.vector(), dir: reader.vector(),
    tmax: reader.float(), object: reader.object(), t: reader.float(), added: reader.vector() });
  if (ray.kind === 'shadow') ray.diffuse = reader.vector();
  if (ray.kind === 'primary') ray.candidates = many(reader.number(), () => ({ object: reader.object(), t: reader.float() }));
  return ray;
}

function readCell(reader) {
  const number = reader.number() - 1;
  if (number < 0) return null;
  return { number, length: reader.number(), object: reader.object(), cut: reader.number() === 1 };
}

function readPath(reader, counters, accelerator) {
  const path = { object: reader.object(), t: reader.float(), tally: {} };
  for (const { name } of counters) path.tally[name] = reader.number();
  path.cell = readCell(reader);
  path.count = reader.number();
  path.rows = many(reader.number(), () => {
    const event = accelerator.events[reader.number()];
    return { ...event, t: event.form.hit ? reader.float() : null };
  });
  return path;
}

function readEvents(bytes, forms) {
  const reader = new Reader(bytes), events = [];
  while (!reader.done)
    events.push({ form: forms[reader.number()], index: reader.number(), box: reader.number() ? reader.box() : null });
  return events;
}

function readBoxes(bytes) {
  const reader = new Reader(bytes), boxes = [];
  while (!reader.done) {
    const box = reader.box();
    boxes.push({ ...box, depth: reader.number(), list: reader.number() - 1 });
  }
  return boxes;
}

function readObjects(bytes) {
  const reader = new Reader(bytes);
  const part = (floats) => many(reader.number(), () => ({ at: many(floats, () => reader.float()), material: reader.number() }));
  return { spheres: part(4), triangles: part(9), boxes: part(6) };
}

// Of each light the six sides of its cube, and the longest list.
function readCells(bytes, side) {
  const reader = new Reader(bytes), lights = [];
  while (!reader.done) {
    const sides = many(6, () => many(side * side, () => ({ number: reader.number() - 1, length: reader.number() })));
    lights.push({ sides, longest: sides.flat().reduce((most, { length }) => Math.max(most, length), 0) });
  }
  return lights;
}

// Everything but the pixels, which `pixel(column, row)` reads when they are asked for.
export async function load() {
  const data = JSON.parse(document.getElementById('data').textContent);
  const rays = await unpack('rays'), rayPlaces = places(rays), shapes = await unpack('shapes');
  data.image = await unpack('image');
  data.objects = readObjects(await unpack('objects'));
  for (const [i, accelerator] of data.accelerators.entries()) {
    accelerator.events = readEvents(await unpack(`events-${i}`), accelerator.forms);
    accelerator.boxList = readBoxes(await unpack(`boxes-${i}`));
    accelerator.cells = readCells(await unpack(`cells-${i}`), data.cell_map);
    accelerator.paths = await unpack(`paths-${i}`);
    accelerator.places = places(accelerator.paths);
  }
  data.nameOf = (object) => object === null ? 'nothing' : object === UNNAMED ? 'an object that it does not name' :
    `object ${object}, ${data.scene.shapes[shapes[object]]}`;
  data.pixel = (column, row) => {
    const place = row * data.columns + column, reader = new Reader(rays, rayPlaces[place]), tree = [];
    const end = reader.at + reader.view.getUint32(reader.at - 4, true);
    while (reader.at < end) tree.push(readRay(reader, data.kinds));
    for (const accelerator of data.accelerators) {
      const from = new Reader(accelerator.paths, accelerator.places[place]);
      for (const ray of tree) (ray.paths ??= []).push(readPath(from, data.counters, accelerator));
    }
    return light(tree);
  };
  return data;
}
