// One frame of the best setting, launch by launch: a lane for every depth, coloured by stage.

/** The launches as objects, times in seconds since the first was queued. */
function launchesOf(profile) {
    const {columns, rows} = profile.launches, column = Object.fromEntries(columns.map((name, i) => [name, i]));
    if (!rows.length) return [];
    const start = rows[0][column.queued];
    return rows.map(row => ({
                        stage: row[column.stage],
                        depth: row[column.depth],
                        wave: row[column.wave],
                        itemsIn: row[column.items_in],
                        itemsOut: row[column.items_out],
                        from: row[column.started] - start,
                        to: row[column.ended] - start
                    }));
}

/** Launches that would touch on the screen become one mark, so that a long frame stays light. */
function merged(launches, smallest) {
    const marks = [], open = new Map();
    for (const launch of launches) {
        const key = `${launch.depth} ${launch.stage}`, mark = open.get(key);
        if (mark && launch.from - mark.to < smallest) {
            mark.to = launch.to;
            mark.count++;
        } else {
            open.set(key, {...launch, count: 1});
            marks.push(open.get(key));
        }
    }
    return marks;
}

const launchTitle = mark => mark.count > 1 ?
    `${mark.stage}, depth ${mark.depth}: ${grouped(mark.count)} launches from ${secondsName(mark.from)} to ${
        secondsName(mark.to)}` :
    `${mark.stage}${mark.depth === null ? '' : `, depth ${mark.depth}, wave ${mark.wave}`}: ${
        grouped(mark.itemsIn)} items in, ` +
        `${grouped(mark.itemsOut)} out, ${secondsName(mark.to - mark.from)}`;

function lanes(name, launches) {
    const depths =
        [...new Set(launches.map(launch => launch.depth))].filter(depth => depth !== null).sort((p, q) => p - q);
    const rows = launches.some(launch => launch.depth === null) ? [...depths, null] : depths;
    const line = Math.max(9, Math.min(26, 400 / rows.length));
    const a = area(1000, line * rows.length + 62, {top: 6, bottom: 56}), from = launches[0].from,
          to = Math.max(...launches.map(launch => launch.to));
    const x = linear([from, to], [a.left, a.right]), unit = to - from < 0.002 ? 1e6 : 1e3;
    let body = words(16, (a.top + a.bottom) / 2, 'depth', {kind: 'axis-name', turn: '-90'});
    rows.forEach((depth, r) => {
        const y = a.top + r * line;
        body += rule(a.left, y + line, a.right, y + line) +
            words(a.left - 8, y + line / 2 + 4, depth === null ? 'film' : String(depth),
                  {anchor: 'end', size: Math.min(13, line + 1)});
    });
    for (const mark of merged(launches, (to - from) / 2500)) {
        const y = a.top + rows.indexOf(mark.depth) * line;
        body += titled(
            box(x(mark.from), y + 1.5, Math.max(x(mark.to) - x(mark.from), 0.6), line - 3, stageColour(mark.stage),
                'class="mark"'),
            launchTitle(mark));
    }
    const marks = steps((to - from) * unit, 8)
                      .filter(time => time <= (to - from) * unit)
                      .map(time => [x(from + time / unit), short(time)]);
    return svg(a.width, a.height, name, body + bottomAxis(a, marks, unit === 1e6 ? 'microseconds' : 'milliseconds'));
}

/** From one generate to the next, in the middle of the frame; null if there is only one. */
function oneBatch(launches) {
    const starts = launches.flatMap((launch, i) => launch.stage === 'generate' ? [i] : []);
    if (starts.length < 3) return null;
    const middle = Math.floor((starts.length - 1) / 2);
    return launches.slice(starts[middle], starts[middle + 1]);
}

function timelineFigure() {
    const title = 'A frame in time';
    const launches = launchesOf(sweep.timeline.profile), batch = oneBatch(launches);
    const setting = sweep.settings[sweep.timeline.setting];
    const left = sweep.timeline.launches_left_out;
    const stages = stageNames.filter(name => launches.some(launch => launch.stage === name));
    const shown = batch || launches;
    const plot = legend(stages.map(name => [stageColour(name), name])) +
        `<h3>${left ? 'The beginning of the frame' : 'The whole frame'}</h3>` + lanes('The whole frame', launches) +
        (batch ? '<h3>One batch of camera rays and all that came of it</h3>' + lanes('One batch', batch) : '');
    return figure(
        'timeline', title,
        `One frame with ${settingName(setting)}. The deepest queue that holds half a batch goes first; fewer rays ` +
            'wait for more of their depth, and once all camera rays are generated ' +
            `each depth is emptied in turn. Gaps are time in which the device ran nothing.${
                left ? ` The last ${grouped(left)} launches are in trace.json only.` : ''}`,
        plot,
        table(
            batch ? 'Launches of this batch' : 'Launches',
            ['start', '=stage', 'depth', 'wave', 'items in', 'items out', 'duration'],
            shown.map(
                launch =>
                    [secondsName(launch.from), launch.stage, launch.depth === null ? '' : launch.depth,
                     launch.wave === null ? '' : launch.wave, grouped(launch.itemsIn), grouped(launch.itemsOut),
                     secondsName(launch.to - launch.from)])));
}
