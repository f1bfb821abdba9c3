'use strict';
// Axes, marks and tables as markup: pure functions of their arguments.

const sweep = JSON.parse(document.getElementById('data').textContent);

const escaped = text => String(text).replace(/[&<>"']/g, c => `&#${c.charCodeAt(0)};`);
const fixed = (value, digits) => value.toFixed(digits);
const percent = (share, digits = 0) => `${fixed(100 * share, digits)} %`;
const grouped = count => String(count).replace(/\B(?=(\d{3})+$)/g, '\u202f');
/** Three significant digits, without an exponent. */
const short = value => value === 0 ? '0' :
    Math.abs(value) >= 100         ? fixed(value, 0) :
                                     String(Number(value.toPrecision(3)));
const sum = values => values.reduce((a, b) => a + b, 0);
const last = values => values[values.length - 1];

/** 65536 as "64k": how the command line takes it. */
function capacityName(rays) {
    if (rays >= 1048576 && rays % 1048576 === 0) return `${rays / 1048576}M`;
    return rays >= 1024 && rays % 1024 === 0 ? `${rays / 1024}k` : String(rays);
}

function bytesName(bytes) {
    const units = ['B', 'KiB', 'MiB', 'GiB', 'TiB'];
    let unit = 0;
    for (; bytes >= 1024 && unit + 1 < units.length; unit++) bytes /= 1024;
    return `${short(bytes)} ${units[unit]}`;
}

function secondsName(seconds) {
    if (seconds >= 1) return `${fixed(seconds, 2)} s`;
    return seconds >= 1e-3 ? `${short(1e3 * seconds)} ms` : `${short(1e6 * seconds)} µs`;
}

const linear = ([from, to], [start, end]) => value => start + (end - start) * (value - from) / (to - from || 1);
const logarithmic = ([from, to], range) => {
    const scale = linear([Math.log2(from), Math.log2(to)], range);
    return value => scale(Math.log2(value));
};

/** Round steps from 0 to `top` or a little beyond: about `wanted` of them. */
function steps(top, wanted = 5) {
    const rough = (top || 1) / wanted, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 2.5, 5, 10].find(factor => factor * power >= rough * 0.999);
    const count = Math.ceil((top || step) / step - 1e-9);
    return Array.from({length: count + 1}, (_, i) => Number((i * step).toPrecision(12)));
}

const svg = (width, height, name, body) =>
    `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${escaped(name)}">${body}</svg>`;
const titled = (shape, title) =>
    shape.replace(/\/>$/, `><title>${escaped(title)}</title></${shape.match(/^<(\w+)/)[1]}>`);
const words = (x, y, text, {anchor = 'middle', kind = '', turn = '', size = ''} = {}) =>
    `<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" text-anchor="${anchor}"${kind && ` class="${kind}"`}` +
    `${turn && ` transform="rotate(${turn} ${x} ${y})"`}${size && ` font-size="${size}"`}>${escaped(text)}</text>`;
const rule = (x1, y1, x2, y2, kind = 'grid', more = '') => `<line x1="${x1.toFixed(1)}" y1="${y1.toFixed(1)}" x2="${
    x2.toFixed(1)}" y2="${y2.toFixed(1)}" class="${kind}" ${more}/>`;
const box = (x, y, width, height, fill, more = '') =>
    `<rect x="${x.toFixed(2)}" y="${y.toFixed(2)}" width="${Math.max(width, 0).toFixed(2)}" ` +
    `height="${Math.max(height, 0).toFixed(2)}" style="fill:${fill}" ${more}/>`;

/** Where a plot of `width` x `height` has its axes. */
const area = (width, height, {left = 62, right = 20, top = 26, bottom = 50} = {}) =>
    ({width, height, left, right: width - right, top, bottom: height - bottom});

/** Horizontal grid lines with their values, and the axis' name turned beside them. */
function valueAxis(a, scale, values, name, label = short) {
    const lines = values
                      .map(
                          v => rule(a.left, scale(v), a.right, scale(v)) +
                              words(a.left - 8, scale(v) + 4, label(v), {anchor: 'end'}))
                      .join('');
    return lines + words(16, (a.top + a.bottom) / 2, name, {kind: 'axis-name', turn: '-90'});
}

/** Marks below the plot at `positions` = [[x, text], ...]: smaller where texts would touch, and left out if they do. */
function bottomAxis(a, positions, name) {
    const half = (mark, size) => 0.33 * size * mark.length + 2;  // wide fonts have digits of 0.64 of their size
    const touch = positions.some(
        ([x, mark], i) => i > 0 && x - half(mark, 13) < positions[i - 1][0] + half(positions[i - 1][1], 13));
    const size = touch ? 11 : 13;
    let free = -Infinity, text = rule(a.left, a.bottom, a.right, a.bottom, 'axis');
    for (const [x, mark] of positions) {
        if (x - half(mark, size) < free) continue;
        free = x + half(mark, size);
        text += rule(x, a.bottom, x, a.bottom + 5, 'axis') + words(x, a.bottom + 20, mark, {size});
    }
    return text + words((a.left + a.right) / 2, a.height - 8, name, {kind: 'axis-name'});
}

const legend = entries => `<ul class="legend">${
    entries.map(([colour, name]) => `<li><i style="background:${colour}"></i>${escaped(name)}</li>`).join('')}</ul>`;

/** columns: names, those that start with "=" to the left; rows: cells as text. Folded away until it is asked for. */
function table(name, columns, rows) {
    const kind = i => columns[i].startsWith('=') ? ' class="word"' : '';
    const head = columns.map((column, i) => `<th${kind(i)}>${escaped(column.replace(/^=/, ''))}</th>`).join('');
    const body =
        rows.map(row => `<tr>${row.map((cell, i) => `<td${kind(i)}>${escaped(cell)}</td>`).join('')}</tr>`).join('');
    return `<details><summary>${escaped(name)}</summary><div class="scroll"><table><thead><tr>${head}</tr></thead>` +
        `<tbody>${body}</tbody></table></div></details>`;
}

const figure = (id, title, caption, plot, behind) =>
    `<figure id="${id}"><figcaption><h2>${escaped(title)}</h2><p>${escaped(caption)}</p></figcaption>` +
    `<div class="plot">${plot}</div>${behind}</figure>`;

/** Bars of stacked parts. bars: [{name, parts: [{name, colour, value}]}]. */
function stackedBars({name, bars, unit, xName, yName, height = 380, label = short}) {
    const a = area(1000, height), values = steps(Math.max(...bars.map(bar => sum(bar.parts.map(part => part.value)))));
    const y = linear([0, last(values)], [a.bottom, a.top]), slot = (a.right - a.left) / bars.length;
    const width = Math.min(slot * 0.72, 90), centre = i => a.left + (i + 0.5) * slot;
    let body = valueAxis(a, y, values, yName, label);
    bars.forEach((bar, i) => {
        const whole = sum(bar.parts.map(part => part.value));
        let base = 0;
        for (const part of bar.parts) {
            const shape =
                box(centre(i) - width / 2, y(base + part.value), width, y(base) - y(base + part.value), part.colour,
                    'class="mark" stroke="var(--surface)" stroke-width="0.7"');
            if (part.value > 0)
                body +=
                    titled(shape, `${bar.name}: ${part.name} ${unit(part.value)}, ${percent(part.value / whole, 1)}`);
            base += part.value;
        }
    });
    body += bottomAxis(a, bars.map((bar, i) => [centre(i), bar.name]), xName);
    return svg(a.width, a.height, name, body);
}

/** A field of shares in [0, 1]: darker is fuller. value(row, column): a share, or null where there is nothing. */
function heatMap({name, rows, columns, rowName, columnName, value, title, width = 1000, left = 62}) {
    const line = Math.max(15, Math.min(30, 440 / rows.length));
    const a = area(width, line * rows.length + 62, {left, right: 8, top: 8, bottom: 54});
    const cell = (a.right - a.left) / columns.length;
    let body = rowName ? words(16, (a.top + a.bottom) / 2, rowName, {kind: 'axis-name', turn: '-90'}) : '';
    rows.forEach((row, r) => {
        const y = a.top + r * line;
        body += words(a.left - 8, y + line / 2 + 4, row, {anchor: 'end', size: Math.min(13, line)});
        columns.forEach((column, c) => {
            const share = value(r, c), x = a.left + c * cell;
            if (share === null) return;
            const opacity = fixed(0.05 + 0.95 * share, 3), ink = share > 0.68 ? '--on-heat' : '--ink';
            const text = share > 0 && share < 0.005 ? '<1' : fixed(100 * share, 0);
            body += titled(
                        box(x + 1, y + 1, cell - 2, line - 2, 'var(--heat)',
                            `class="mark" rx="2" fill-opacity="${opacity}"`),
                        title(r, c)) +
                `<g pointer-events="none" style="--soft:var(${ink})">${
                        words(x + cell / 2, y + line / 2 + 4, text, {size: Math.min(12, line - 3)})}</g>`;
        });
    });
    return svg(
        a.width, a.height, name,
        body + bottomAxis(a, columns.map((column, c) => [a.left + (c + 0.5) * cell, column]), columnName));
}
