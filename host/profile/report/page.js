// Puts the page together.

const fill = (id, markup) => {
    document.getElementById(id).innerHTML = markup;
};

function showHead() {
    const {scene, device} = sweep;
    document.title = `${scene.file}: Raymill sweep`;
    fill('eyebrow', escaped(`Raymill ${sweep.version} · sweep of ${scene.file}`));
    fill('headline', escaped(finding.headline));
    const samples = `${scene.samples_per_pixel} spp${
        scene.samples_chosen ?
            ` (chosen so that a frame takes about a second; the scene has ${scene.scene_samples_per_pixel})` :
            ''}`;
    fill(
        'subline',
        escaped(
            `${scene.width} × ${scene.height} pixels, ${samples}, depth ${scene.depth}, ${
                grouped(scene.primitives)} primitives, on ${device.name} ` +
            `(${device.platform} ${device.driver}, ${bytesName(device.memory)} of memory).`));
}

/** The capacities alone where nothing else differs from the best setting. */
const namesOf = settings => settings.every(setting => seriesKey(setting) === seriesKey(best)) ?
    `${settings.map(setting => capacityName(setting.queue_capacity)).join(', ')} rays` :
    settings.map(settingName).join('; ');

function showNotices() {
    const notice = (kind, markup) => `<div class="notice ${kind}">${markup}</div>`;
    const skipped = sweep.settings.filter(setting => setting.skipped),
          whole = sweep.settings.filter(setting => setting.state === 'measured');
    let markup = '';
    if (!sweep.complete)
        markup += notice(
            'warning',
            `<strong>This report is partial.</strong> The sweep was interrupted: ${whole.length} of its ${
                sweep.settings.length} settings have all ${sweep.repeats} frames, the others fewer or none.`);
    if (!finding.same_image)
        markup += notice(
            'warning',
            `<strong>The image is not the same.</strong> These settings gave another one:<ul>${
                finding.other_image.map(i => `<li>${escaped(settingName(sweep.settings[i]))}</li>`).join('')}</ul>`);
    if (finding.as_good.length)
        markup += notice(
            '',
            'These were at least once as fast as the best setting’s median frame, so they may be as good: ' +
                `${escaped(namesOf(finding.as_good.map(i => sweep.settings[i])))}.`);
    if (skipped.length)
        markup += notice(
            '',
            `Skipped:<ul>${
                skipped.map(setting => `<li>${escaped(`${settingName(setting)}: ${setting.skipped}`)}</li>`)
                    .join('')}</ul>`);
    fill('notices', markup);
}

function showTiles() {
    const tile = (value, unit, text, kind = '') => `<div class="tile ${kind}"><b>${escaped(value)} <small>${
        escaped(unit)}</small></b><span>${escaped(text)}</span></div>`;
    const frames = sum(measured.map(setting => setting.frames.length)), {median, shortest, longest} = best.seconds;
    let markup = tile(fixed(megarays(best), 2), 'Mrays/s', `best: ${settingName(best)}`) +
        tile(secondsName(median), '', `median frame, from ${secondsName(shortest)} to ${secondsName(longest)}`) +
        tile(bytesName(best.device_bytes), '', 'device memory of the best setting');
    if (finding.below_knee !== null)
        markup += tile(
            capacityName(knee.queue_capacity), 'rays',
            `the knee: hardly slower or as good, in ${bytesName(knee.device_bytes)}`);
    markup += finding.same_image ?
        tile('Same image', '', `in all ${frames} frames; film hash ${finding.film_hash}`, 'good') :
        tile('Images differ', '', `in ${finding.other_image.length} of ${measured.length} settings`, 'bad');
    fill('tiles', markup);
}

function showFigures(key) {
    const settings = allSeries().get(key);
    fill('figures', [
        throughputFigure(), stageFigure(settings), fillFigure(settings), groupFigure(settings), memoryFigure(),
        fatesFigure(), timelineFigure()
    ].join(''));
}

function showChoice() {
    const series = allSeries(), select = document.getElementById('series');
    document.getElementById('toolbar').hidden = series.size < 2;
    select.innerHTML =
        [...series]
            .map(([key, settings]) => `<option value="${key}">${escaped(seriesName(settings[0]))}</option>`)
            .join('');
    select.value = seriesKey(best);
    select.addEventListener('change', () => showFigures(select.value));
}

function showMethod() {
    fill('frames', escaped(`${sweep.repeats} ${sweep.repeats === 1 ? 'frame' : 'frames'}`));
    fill('duration', escaped(secondsName(sweep.seconds)));
}

showHead();
showNotices();
if (best) {
    showTiles();
    showChoice();
    showFigures(seriesKey(best));
}
showMethod();
