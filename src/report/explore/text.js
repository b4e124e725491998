// SPDX-License-Identifier: Apache-2.0
// Numbers, colours and elements.

export const byId = (id) => document.getElementById(id);
export const plural = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;

export function number(value) {
  if (!Number.isFinite(value)) return '-';
  return String(Number(value.toPrecision(6)));
}

export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null) continue;
    if (key === 'style') made.style.cssText = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// Linear light as the image shows it (IEC 61966-2-1).
export function srgb(color) {
  const channel = (c) => Math.round(255 * (c <= 0 ? 0 : c >= 1 ? 1 : c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
  return `rgb(${color.map(channel).join(', ')})`;
}
