// The figures, each a function of the sweep and of the series that is shown: settings that differ in capacity alone.

const stageNames = ['generate', 'intersect', 'shade', 'shadow', 'features', 'secondary', 'resolve'];
const idleParts = [
    ['first_launches', 'first launches', 'var(--first)'], ['launching', 'launching, device idle', 'var(--launching)'],
    ['host', 'host, device idle', 'var(--host)']
];
const fateParts = [
    ['missed', 'left the scene', 'var(--generate)'], ['absorbed', 'absorbed', 'var(--absorbed)'],
    ['depth_limit', 'ended by the depth limit', 'var(--resolve)'], ['weightless', 'too little weight', 'var(--shade)'],
    ['one_child', 'one child', 'var(--shadow)'], ['two_children', 'two children', 'var(--secondary)']
];
const stageColour = stage => `var(--${stage})`;

const finding = sweep.finding;
const measured = sweep.settings.filter(setting => setting.frames);
const best = finding.best === null ? null : sweep.settings[finding.best];
const knee = finding.knee === null ? null : sweep.settings[finding.knee];
const groupName = setting => setting.work_group === 0 ? 'auto' : String(setting.work_group);
const seriesKey = setting => `${setting.work_group}/${setting.threads}`;
const seriesName = setting =>
    `work-group ${groupName(setting)}, ${setting.threads} ${setting.threads === 1 ? 'thread' : 'threads'}`;
const settingName = setting => `${capacityName(setting.queue_capacity)} rays, ${seriesName(setting)}`;
const megarays = setting => setting.rays_per_second / 1e6;

/** Measured settings by series, each from the smallest capacity on. */
function allSeries() {
    const series = new Map();
    for (const setting of measured) series.set(seriesKey(setting), [...series.get(seriesKey(setting)) || [], setting]);
    for (const settings of series.values()) settings.sort((a, b) => a.queue_capacity - b.queue_capacity);
    return series;
}

/**
 * The capacity whose wave just fits each cache: [{name, bytes, rays}]. A private cache counts once a thread that has
 * it.
 */
function cacheCapacities(settings) {
    const largest = last(settings), bytesOfRay = largest.wave_bytes / largest.queue_capacity;
    return sweep.device.caches.map(cache => {
        const bytes = cache.bytes * Math.max(1, Math.ceil(largest.threads / cache.sharers));
        return {name: cache.name, bytes, rays: bytes / bytesOfRay};
    });
}

function capacityScale(a) {
    const all = sweep.settings.map(setting => setting.queue_capacity);
    const [from, to] = [Math.min(...all), Math.max(...all)];
    return logarithmic(from < to ? [from / 1.25, to * 1.25] : [from / 2, to * 2], [a.left, a.right]);
}

const capacityMarks = x => [...new Set(sweep.settings.map(setting => setting.queue_capacity))]
                               .sort((p, q) => p - q)
                               .map(rays => [x(rays), capacityName(rays)]);

const spreadTitle = setting =>
    `${settingName(setting)}: ${fixed(megarays(setting), 2)} Mrays/s; median of ${setting.frames.length} frames ` +
    `${secondsName(setting.seconds.median)}, from ${secondsName(setting.seconds.shortest)} to ${
        secondsName(setting.seconds.longest)}`;

/** Line, points and the spread of each for one series. position: setting to x. */
function seriesMarks(settings, position, y, colour, spread) {
    const at = (setting, rate) => `${position(setting).toFixed(1)},${y(rate).toFixed(1)}`;
    const path = settings.map(setting => at(setting, megarays(setting))).join(' ');
    let body =
        `<polyline points="${path}" fill="none" style="stroke:${colour}" stroke-width="2" stroke-linejoin="round"/>`;
    for (const setting of settings) {
        const [low, high] =
            [setting.seconds.longest, setting.seconds.shortest].map(seconds => setting.rays / seconds / 1e6);
        const x = position(setting);
        if (spread)
            body += `<path d="M${x} ${y(low)}V${y(high)}M${x - 4} ${y(low)}h8M${x - 4} ${
                y(high)}h8" fill="none" style="stroke:${colour}" stroke-opacity="0.5" stroke-width="1.5"/>`;
        body += titled(
            `<circle cx="${x.toFixed(1)}" cy="${y(megarays(setting)).toFixed(1)}" r="${
                setting === best ? 7 : 4.5}" class="mark" ` +
                `style="fill:${colour}" stroke="var(--surface)" stroke-width="1.5"/>`,
            spreadTitle(setting));
    }
    return body;
}

const seriesColour = i => `var(--series-${i % 6})`;
const seriesLegend = series => series.size > 1 ?
    legend([...series.values()].map((settings, i) => [seriesColour(i), seriesName(settings[0])])) :
    '';

/** Caches as dashed lines, the plateau's lower edge, and what lies left of the knee shaded. */
function throughputGround(a, x, y, settings) {
    let body = '';
    if (knee && finding.below_knee !== null)
        body += box(a.left, a.top, x(knee.queue_capacity) - a.left, a.bottom - a.top, 'var(--accent-soft)') +
            words(a.left + 8, a.bottom - 10, 'below the knee', {anchor: 'start'});
    const edge = y(megarays(best) * (1 - finding.knee_tolerance));
    body += rule(a.left, edge, a.right, edge, 'axis', 'stroke-dasharray="2 4"') +
        words(a.right + 6, edge + 4, `−${percent(finding.knee_tolerance)}`, {anchor: 'start', size: 12});
    for (const cache of cacheCapacities(settings)) {
        const place = x(cache.rays);
        if (!(place > a.left && place < a.right)) continue;
        body += titled(
                    rule(place, a.top, place, a.bottom, 'mark', 'stroke="var(--soft)" stroke-dasharray="6 4"'),
                    `A wave of ${grouped(Math.round(cache.rays))} rays takes ${bytesName(cache.bytes)}, as much as ${
                        cache.name} holds`) +
            words(place, a.top - 8, `${cache.name}, ${bytesName(cache.bytes)}`, {size: 12});
    }
    return body;
}

function throughputFigure() {
    const a = area(1000, 420, {top: 34, right: 56}), x = capacityScale(a), series = allSeries();
    const values = steps(Math.max(...measured.map(setting => setting.rays / setting.seconds.shortest / 1e6)));
    const y = linear([0, last(values)], [a.bottom, a.top]), position = setting => x(setting.queue_capacity);
    const bestSeries = series.get(seriesKey(best));
    let body = throughputGround(a, x, y, bestSeries) + valueAxis(a, y, values, 'million rays per second');
    [...series.values()].forEach((settings, i) => {
        body += seriesMarks(settings, position, y, seriesColour(i), true);
    });
    body += words(
        position(best), Math.max(y(best.rays / best.seconds.shortest / 1e6) - 10, a.top + 12),
        `best ${fixed(megarays(best), 2)}`, {kind: 'strong'});
    for (const setting of sweep.settings.filter(one => one.skipped))
        body += titled(
            `<path d="M${position(setting) - 5} ${
                a.bottom - 5}l10 -10m0 10l-10 -10" style="stroke:var(--bad)" stroke-width="2" fill="none"/>`,
            `${settingName(setting)} was skipped: ${setting.skipped}`);
    body += bottomAxis(a, capacityMarks(x), 'queue capacity (rays of a wave at most)');
    const beyond =
        cacheCapacities(bestSeries)
            .filter(cache => !(x(cache.rays) > a.left && x(cache.rays) < a.right))
            .map(cache => `${cache.name} (${bytesName(cache.bytes)}) at ${grouped(Math.round(cache.rays))} rays`);
    const caption =
        'Medians of unprofiled frames; bars reach from the slowest to the fastest. Dashed: the capacity whose rays, ' +
        `hits, shadow rays and children together fill a cache; dotted: the plateau’s lower edge${
            beyond.length ? `; outside the plot: ${beyond.join(', ')}` : ''}.`;
    return figure(
        'throughput', 'Throughput against queue capacity', caption,
        seriesLegend(series) + svg(a.width, a.height, finding.headline, body),
        table(
            'All settings',
            [
                'rays of a wave', 'work-group', 'threads', 'Mrays/s', 'median', 'shortest', 'longest', 'frames',
                'device memory', 'a wave', '=state'
            ],
            sweep.settings.map(settingRow)));
}

function settingRow(setting) {
    const head = [grouped(setting.queue_capacity), groupName(setting), setting.threads];
    const state = setting.skipped ? `skipped: ${setting.skipped}` : setting.state.replace('_', ' ');
    if (!setting.frames) return [...head, '', '', '', '', '', '', '', state];
    return [
        ...head, fixed(megarays(setting), 2),
        ...['median', 'shortest', 'longest'].map(key => secondsName(setting.seconds[key])), setting.frames.length,
        bytesName(setting.device_bytes), bytesName(setting.wave_bytes), state
    ];
}

/** Stages that ran in any of the settings. */
const stagesOf = settings =>
    stageNames.filter(name => settings.some(setting => setting.profile.stages.some(stage => stage.stage === name)));
const stageOf = (setting, name) => setting.profile.stages.find(stage => stage.stage === name);

function stageFigure(settings) {
    const stages = stagesOf(settings);
    const bars = settings.map(
        setting => ({
            name: capacityName(setting.queue_capacity),
            parts: [
                ...stages.map(
                    name =>
                        ({name, colour: stageColour(name), value: (stageOf(setting, name) || {seconds: 0}).seconds})),
                ...idleParts.map(([key, name, colour]) => ({name, colour, value: setting.profile.times.frame[key]}))
            ]
        }));
    const longest = Math.max(...bars.map(bar => sum(bar.parts.map(part => part.value))));
    const [unit, unitName] = longest < 0.5 ? [1e3, 'milliseconds of a frame'] : [1, 'seconds of a frame'];
    const entries =
        [...stages.map(name => [stageColour(name), name]), ...idleParts.map(([, name, colour]) => [colour, name])];
    const plot = stackedBars({
        name: 'Time by stage',
        bars,
        unit: secondsName,
        xName: 'queue capacity (rays of a wave at most)',
        yName: unitName,
        label: value => short(value * unit)
    });
    return figure(
        'stages', 'Time by stage',
        'Where one profiled frame of each capacity spent its time, stacked from generate at the bottom to what the ' +
            'device waited for at the top.',
        legend(entries) + plot,
        table(
            'Seconds by stage', ['rays of a wave', ...bars[0].parts.map(part => part.name)],
            bars.map(
                (bar, i) => [grouped(settings[i].queue_capacity), ...bar.parts.map(part => secondsName(part.value))])));
}

function fillFigure(settings) {
    const depths = Math.max(...settings.map(setting => setting.profile.depths.length));
    const rows = Array.from({length: depths}, (_, depth) => depth)
                     .filter(depth => settings.some(setting => setting.profile.depths[depth].waves > 0));
    const at = (r, c) => settings[c].profile.depths[rows[r]];
    const wave = (r, c) => at(r, c).waves ? at(r, c).popped / (at(r, c).waves * settings[c].queue_capacity) : null;
    const queue = (r, c) => at(r, c).waves ? at(r, c).high_water / at(r, c).capacity : null;
    const place = (r, c) => `depth ${rows[r]}, capacity ${capacityName(settings[c].queue_capacity)}`;
    const map = (name, value, title) => `<div><h3>${name}</h3>${heatMap({
        name,
        rows,
        columns: settings.map(setting => capacityName(setting.queue_capacity)),
        rowName: 'depth',
        columnName: 'queue capacity',
        value,
        title,
        width: 500,
        left: 52
    })}</div>`;
    const plot = map('Waves: rays of a wave, % of the capacity (mean)', wave,
                     (r, c) => `${place(r, c)}: ${grouped(at(r, c).popped)} rays in ${grouped(at(r, c).waves)} waves`) +
        map('Queues: most rays that ever waited, % of the queue', queue,
            (r, c) => `${place(r, c)}: ${grouped(at(r, c).high_water)} of ${grouped(at(r, c).capacity)} places`);
    return figure(
        'fill', 'Queue fill by depth',
        'Waves that are nearly empty pay for their launches without using them. A deeper queue has twice the ' +
            'capacity, since a hit has two children at most.',
        `<div class="pair">${plot}</div>`,
        table(
            'Queues by capacity and depth',
            ['rays of a wave', 'depth', 'waves', 'rays', 'rays of a wave (mean)', 'most waiting', 'queue holds'],
            settings.flatMap(
                (setting, c) => rows.map(
                    (depth, r) =>
                        [grouped(setting.queue_capacity), depth, grouped(at(r, c).waves), grouped(at(r, c).popped),
                         at(r, c).waves ? grouped(Math.round(at(r, c).popped / at(r, c).waves)) : '',
                         grouped(at(r, c).high_water), grouped(at(r, c).capacity)]))));
}

/** What the stage does for an item of its queue; empty where that held none. */
const eachItem = (stage, key, digits) => stage.items_in ? fixed(stage[key] / stage.items_in, digits) : '';

function groupFigure(settings) {
    const stages = stagesOf(settings), stage = (r, c) => stageOf(settings[c], stages[r]);
    const plot = heatMap({
        name: 'Work-group fill',
        rows: stages,
        columns: settings.map(setting => capacityName(setting.queue_capacity)),
        rowName: '',
        columnName: 'queue capacity (rays of a wave at most)',
        left: 84,
        value: (r, c) => stage(r, c) ? stage(r, c).fullness : null,
        title: (r, c) => `${stages[r]}, capacity ${capacityName(settings[c].queue_capacity)}: ${
                             grouped(stage(r, c).items_in)} items in ` +
            `${grouped(stage(r, c).places)} places of ${grouped(stage(r, c).groups)} groups`
    });
    return figure(
        'groups', 'Work-group fill',
        'Items that a stage worked on, as % of the places in the work-groups that were launched for it. Shadow has a ' +
            'segment for each chunk of hits and light sample: where surfaces face away from a light they stay empty.',
        plot,
        table(
            'Work-groups by stage, and what they move for an item',
            [
                'rays of a wave', '=stage', 'launches', 'groups', 'places', 'items', 'fill', 'bytes read',
                'bytes written', 'atomics'
            ],
            settings.flatMap(
                (setting, c) =>
                    stages.map((name, r) => [stage(r, c), name, setting])
                        .filter(([one]) => one)
                        .map(
                            ([one, name]) =>
                                [grouped(setting.queue_capacity), name, grouped(one.launches), grouped(one.groups),
                                 grouped(one.places), grouped(one.items_in), percent(one.fullness, 1),
                                 eachItem(one, 'bytes_read', 1), eachItem(one, 'bytes_written', 1),
                                 eachItem(one, 'atomics', 2)]))));
}

function memoryFigure() {
    const a = area(1000, 380), series = allSeries(), mebibytes = setting => setting.device_bytes / 1048576;
    const sizes = measured.map(mebibytes), [from, to] = [Math.min(...sizes), Math.max(...sizes)];
    const x = logarithmic(from < to ? [from / 1.15, to * 1.15] : [from / 2, to * 2], [a.left, a.right]);
    const values = steps(Math.max(...measured.map(megarays)) * 1.08), y = linear([0, last(values)], [a.bottom, a.top]);
    let body = valueAxis(a, y, values, 'million rays per second'), taken = [];
    [...series.values()].forEach((settings, i) => {
        body += seriesMarks(settings, setting => x(mebibytes(setting)), y, seriesColour(i), false);
    });
    const labelled = series.get(seriesKey(best));
    for (const setting of [best, ...labelled.filter(one => one !== best)]) {
        const place = x(mebibytes(setting));
        if (taken.some(other => Math.abs(other - place) < 34)) continue;
        taken.push(place);
        // Above the marks of all series there, so that none is hidden.
        const highest = Math.max(
            ...measured.filter(one => Math.abs(x(mebibytes(one)) - place) < 20).map(one => megarays(one)));
        body += words(
            place, y(highest) - 12, capacityName(setting.queue_capacity), {kind: setting === best ? 'strong' : ''});
    }
    const first = 2 ** Math.ceil(Math.log2(from / 1.15)), marks = [];
    for (let size = first; size <= to * 1.15; size *= 2)
        for (const mark of to / from < 8 ? [size, 1.25 * size, 1.5 * size, 1.75 * size] : [size])
            if (mark <= to * 1.15) marks.push([x(mark), bytesName(mark * 1048576)]);
    body += bottomAxis(a, marks, 'device memory of the frame');
    return figure(
        'memory', 'Memory against throughput',
        'What a faster setting costs in device memory: scene, film and all queues. Labels are queue capacities.',
        seriesLegend(series) + svg(a.width, a.height, 'Memory against throughput', body),
        table(
            'Memory by setting', ['rays of a wave', 'work-group', 'threads', 'device memory', 'Mrays/s'],
            measured.map(
                setting =>
                    [grouped(setting.queue_capacity), groupName(setting), setting.threads,
                     bytesName(setting.device_bytes), fixed(megarays(setting), 2)])));
}

function fatesFigure() {
    const depths = best.profile.depths.filter(depth => depth.popped > 0);
    const bars = depths.map(depth => ({
                                name: String(depth.depth),
                                parts: fateParts.map(([key, name, colour]) => ({name, colour, value: depth.fates[key]}))
                            }));
    const [unit, unitName] = depths[0].popped < 1e6 ? [1e3, 'thousand rays'] : [1e6, 'million rays'];
    const plot = stackedBars({
        name: 'Rays by depth',
        bars,
        unit: grouped,
        xName: 'depth',
        yName: unitName,
        height: 320,
        label: value => short(value / unit)
    });
    return figure(
        'fates', 'What became of the rays', 'Camera rays have depth zero. These counts are the same for every setting.',
        legend(fateParts.map(([, name, colour]) => [colour, name])) + plot,
        table(
            'Rays by depth', ['depth', 'rays', ...fateParts.map(([, name]) => name), 'shadow rays', 'blocked'],
            depths.map(
                depth =>
                    [depth.depth, grouped(depth.popped), ...fateParts.map(([key]) => grouped(depth.fates[key])),
                     grouped(depth.shadow_rays), grouped(depth.shadow_blocked)])));
}
