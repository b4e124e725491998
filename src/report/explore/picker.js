// SPDX-License-Identifier: Apache-2.0
// The image, and the choice of a pixel on it by pointer, arrow keys or numbers.
import { byId } from './text.js';

// Calls choose(column, row), of the recorded pixels. Returns a function that marks one.
export function makePicker(data, choose) {
  const canvas = byId('image'), context = canvas.getContext('2d'), scale = Math.max(1, Math.ceil(640 / data.width));
  const pixels = new ImageData(data.width, data.height);
  for (let i = 0; i < data.width * data.height; i++) {
    for (let c = 0; c < 3; c++) pixels.data[4 * i + c] = data.image[3 * i + c];
    pixels.data[4 * i + 3] = 255;
  }
  const plain = new OffscreenCanvas(data.width, data.height);
  plain.getContext('2d').putImageData(pixels, 0, 0);
  canvas.width = data.width * scale;
  canvas.height = data.height * scale;
  const at = (place) => place * data.stride + (data.stride >> 1);
  const place = (pixel, count) => Math.min(count - 1, Math.max(0, Math.floor(pixel / data.stride)));
  let column = 0, row = 0;
  const go = (x, y) => choose(place(x, data.columns), place(y, data.rows));

  canvas.addEventListener('click', (event) => {
    const box = canvas.getBoundingClientRect();
    go((event.clientX - box.left) * data.width / box.width, (event.clientY - box.top) * data.height / box.height);
  });
  canvas.addEventListener('keydown', (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (!moves[event.key]) return;
    event.preventDefault();
    const [dx, dy] = moves[event.key], far = event.shiftKey ? 8 : 1;
    choose(Math.min(data.columns - 1, Math.max(0, column + far * dx)), Math.min(data.rows - 1, Math.max(0, row + far * dy)));
  });
  byId('pixel').addEventListener('submit', (event) => {
    event.preventDefault();
    go(Number(byId('pixel-x').value), Number(byId('pixel-y').value));
  });
  byId('pixel-x').max = data.width - 1;
  byId('pixel-y').max = data.height - 1;

  return (newColumn, newRow, said) => {
    column = newColumn;
    row = newRow;
    const x = (at(column) + 0.5) * scale, y = (at(row) + 0.5) * scale, arm = 6 * scale;
    context.imageSmoothingEnabled = false;
    context.drawImage(plain, 0, 0, canvas.width, canvas.height);
    const given = row >= data.rows; // a ray of no pixel
    for (const [color, width] of given ? [] : [['#000', 3 * scale / 2], ['#fff', scale / 2]]) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.strokeRect(x - scale, y - scale, 2 * scale, 2 * scale);
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.beginPath();
        context.moveTo(x + 2 * scale * dx, y + 2 * scale * dy);
        context.lineTo(x + arm * dx, y + arm * dy);
        context.stroke();
      }
    }
    byId('pixel-x').value = given ? '' : at(column);
    byId('pixel-y').value = given ? '' : at(row);
    byId('pixel-said').textContent = said;
    canvas.setAttribute('aria-label', `The image of ${data.scene.name}; ${said}`);
  };
}
