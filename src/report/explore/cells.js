// SPDX-License-Identifier: Apache-2.0
// The cells around a light: the six sides of its cube, coloured by the lengths of their lists, the looked-up cell marked.

export const sideNames = ['-x', '+x', '-y', '+y', '-z', '+z'];

// One side as RGBA, row by row. Yellow: the longest list; grey: no cell or an empty one; red: the marked cell.
export function sidePixels(data, { sides, longest }, side, marked) {
  const pixels = new Uint8ClampedArray(4 * data.cell_map ** 2);
  sides[side].forEach(({ number, length }, i) => {
    const place = Math.log1p(length) / Math.log1p(longest || 1) * (data.scale.length - 1);
    const color = number >= 0 && number === marked ? [230, 40, 40] : length === 0 ? [128, 128, 128] : data.scale[Math.round(place)];
    pixels.set([...color, 255], 4 * i);
  });
  return pixels;
}

// Draws the sides in two rows of three, with their names, and a ring around the marked cell.
export function drawSides(data, light, marked, canvas) {
  const unit = data.cell_map, scale = 3, gap = 16, context = canvas.getContext('2d');
  canvas.width = 3 * (unit * scale + 4);
  canvas.height = 2 * (unit * scale + gap);
  context.font = '12px system-ui, sans-serif';
  context.fillStyle = getComputedStyle(canvas).color;
  context.imageSmoothingEnabled = false;
  sideNames.forEach((name, side) => {
    const part = new OffscreenCanvas(unit, unit), x = (side >> 1) * (unit * scale + 4), y = (side & 1) * (unit * scale + gap);
    part.getContext('2d').putImageData(new ImageData(sidePixels(data, light, side, marked), unit, unit), 0, 0);
    context.fillText(name, x, y + 11);
    context.drawImage(part, x, y + gap, unit * scale, unit * scale);
    const places = light.sides[side].flatMap(({ number }, i) => number === marked ? [[i % unit, Math.floor(i / unit)]] : []);
    if (places.length === 0) return;
    const [column, row] = [0, 1].map((k) => places.reduce((sum, place) => sum + place[k] + 0.5, 0) / places.length);
    for (const [color, width] of [['#000', 4], ['#fff', 2]]) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.beginPath();
      context.arc(x + column * scale, y + gap + row * scale, 9, 0, 2 * Math.PI);
      context.stroke();
    }
  });
}
