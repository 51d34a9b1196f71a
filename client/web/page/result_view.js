// One point of a job: its estimates, histograms with the exact law, curves, and remarks. Charts and
// tables are kept when their numbers change.
(function (ballpiston) {
  'use strict';

  const {element, textColumns, numberColumns} = ballpiston;
  const {isNumber, valueText, countText, words, parametersText} = ballpiston;

  const MOST_BINS = 60; // shown; the result has more
  const FAR = 4; // standard errors

  const CURVE_LABELS = {
    energy_autocorrelation: 'Autocorrelation of the piston’s energy',
    mean_energy: 'Mean energy of the piston',
    survival: 'Survival: probability of no collision up to a time',
    temperature_profile: 'Temperature profile',
  };

  // ---- Estimates

  const COLUMNS = [
    ...textColumns('Estimate'),
    ...numberColumns('Value', 'Error', 'Exact', 'z', 'Model error'),
  ];

  // In the units of the value.
  function modelErrorText(error) {
    return isNumber(error) ? String(Number(error.toPrecision(2))) : 'unknown';
  }

  // The closed form; else the Markov limit; else the noise floor, which is the mean of the estimate
  // if the two laws are equal.
  function yardstick(estimate) {
    const {exact, limit, noise_floor: floor, standard_error: error} = estimate;
    if (isNumber(exact))
      return isNumber(error) && error >= 0 ? valueText(exact, error / 10) : valueText(exact);
    if (isNumber(limit)) return `limit ${valueText(limit, error)}`;
    if (isNumber(floor)) return `floor ${valueText(floor, error)}`;
    return '';
  }

  function zElement(z) {
    if (!isNumber(z)) return '';
    return element('span', {class: Math.abs(z) > FAR ? 'far' : null}, ballpiston.signedText(z));
  }

  function estimateTable(point, caption) {
    const rows = (point.estimates ?? []).map((estimate) => [
      words(estimate.name),
      valueText(estimate.value, estimate.standard_error),
      ballpiston.errorText(estimate.value, estimate.standard_error),
      yardstick(estimate),
      zElement(estimate.z_score),
      modelErrorText(estimate.model_error),
    ]);
    return ballpiston.table(caption, COLUMNS, rows, {class: 'estimates'});
  }

  function healthText(health) {
    if (!health) return null;
    const escapes =
      health.escapes > 0
        ? `${countText(health.escapes)} orbits left the cell: a defect`
        : 'no orbit left the cell';
    return (
      `${escapes}; largest relative error of the energy ` +
      `${Number((health.max_energy_error ?? 0).toPrecision(2))}`
    );
  }

  function pointFacts(point) {
    return ballpiston.facts([
      ['Model', words(point.model)],
      ['Why this model', point.reason],
      ['Samples', point.samples > 0 ? countText(point.samples) : null],
      ['Health', healthText(point.health)],
    ]);
  }

  function remarks(point) {
    if (!point.remarks?.length) return null;
    return element(
      'ul',
      {class: 'remarks'},
      point.remarks.map((text) => element('li', {}, text)),
    );
  }

  // ---- Histograms

  const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);

  // Sums of `size` neighbours.
  function merged(numbers, size) {
    const sums = [];
    for (let i = 0; i < numbers.length; i += size) sums.push(sum(numbers.slice(i, i + size)));
    return sums;
  }

  // The number of bins that are shown as one, so that each is wide enough to see. A divisor of the
  // number of bins.
  function mergedBins(bins) {
    if (bins < 2 * MOST_BINS) return 1;
    let size = Math.ceil(bins / MOST_BINS);
    while (bins % size !== 0) ++size;
    return size;
  }

  const NAMES = {
    alpha: 'Ingoing angle α',
    ball_speed: 'Speed of the balls',
    piston_energy: 'Energy of the piston',
    piston_speed: 'Speed of the pistons',
  };
  const X_LABELS = {alpha: 'α', ball_speed: 'speed', piston_energy: 'ε', piston_speed: 'speed'};

  const LAWS = {
    alpha: 'equilibrium law h⁽¹⁾, exact',
    piston_energy: 'master equation, the limit δ → 0',
  };

  // At first most orbits are in the bin of their start. This bin is cut off, so that the others are
  // visible.
  const MOST_OVER_SECOND = 4;
  function topOf(densities) {
    const [most, second] = [...densities].sort((a, b) => b - a);
    return most > MOST_OVER_SECOND * second ? 2 * second : undefined;
  }

  function histogramNote(histogram, size, densities, width) {
    if (size > 1) return `${histogram.counts.length} bins, shown in groups of ${size}`;
    if (topOf(densities) === undefined) return null;
    const share = Math.max(...densities) * width;
    return `The highest bin is cut off: it contains ${(100 * share).toFixed(1)} %.`;
  }

  function histogramTitle(histogram) {
    const name = NAMES[histogram.name] ?? words(histogram.name);
    const sign = histogram.sigma > 0 ? ', σ = +1' : histogram.sigma < 0 ? ', σ = −1' : '';
    const time = isNumber(histogram.time) ? `, time ${valueText(histogram.time)}` : '';
    return name + sign + time;
  }

  // Densities relative to `total`: the counts of this histogram and of the histogram with the other
  // sign.
  function histogramChart(histogram, total) {
    const expected = histogram.expected_probabilities ?? [];
    const bins = Math.max(histogram.counts.length, expected.length);
    const size = mergedBins(bins);
    const width = (size * (histogram.upper - histogram.lower)) / bins;
    const counts = merged(histogram.counts, size);
    const x = Array.from({length: bins / size}, (_, i) => histogram.lower + i * width);
    const density = (share) => share / width;
    const edges = [...x, histogram.upper];
    const held = (y) => [...y, y.at(-1)]; // to the upper edge
    const measured = counts.map((count) => density(count / total));
    const law = merged(expected, size).map(density);
    const lines = [];
    if (total > 0) {
      lines.push(
        {label: 'measured', kind: 'steps', colour: 0, x: edges, y: held(measured)},
        {
          label: 'measured, with error',
          kind: 'measured',
          colour: 0,
          x,
          y: measured,
          shift: width / 2,
          error: counts.map((count) => density(Math.sqrt(count) / total)),
        },
      );
    }
    if (law.length) {
      lines.push({
        label: LAWS[histogram.name] ?? 'exact law',
        kind: 'exact',
        stepped: true,
        colour: 1,
        x: edges,
        y: held(law),
      });
    }
    return {
      title: histogramTitle(histogram),
      xLabel: X_LABELS[histogram.name] ?? histogram.name,
      yLabel: 'probability density',
      fromZero: true,
      top: topOf(total > 0 ? measured : law),
      lines,
      note: histogramNote(histogram, size, total > 0 ? measured : law, width),
    };
  }

  function histogramCharts(point) {
    const histograms = point.histograms ?? [];
    const totalOf = ({name, time}) =>
      sum(histograms.filter((h) => h.name === name && h.time === time).flatMap((h) => h.counts));
    return histograms
      .map((histogram) => ({histogram, total: totalOf(histogram)}))
      .filter(({histogram, total}) => {
        const isLawAlone = !histogram.counts.length && histogram.expected_probabilities.length;
        return total > 0 || isLawAlone;
      })
      .map(({histogram, total}) => histogramChart(histogram, total));
  }

  // ---- Curves

  function curveChart(curve, source) {
    const isProfile = curve.points.some((at) => isNumber(at.position));
    const places = curve.points.map(({position, time, value, standard_error: error, limit}) => ({
      x: (isProfile ? position : time) ?? 0,
      value,
      error,
      limit,
      source,
    }));
    return {
      title: CURVE_LABELS[curve.name] ?? words(curve.name),
      xLabel: isProfile ? 'position (cells)' : 'time (cells over unit speed)',
      yLabel: 'value',
      lines: ballpiston.seriesLines(places),
    };
  }

  const curveCharts = (point) =>
    (point.curves ?? [])
      .filter((curve) => curve.points.length)
      .map((curve) => curveChart(curve, ballpiston.sourceOf(point)));

  // ---- The whole point

  class ResultView {
    constructor() {
      this.text = element('div');
      this.pictures = element('div', {class: 'charts'});
      this.element = element('div', {}, this.text, this.pictures);
      this.charts = [];
    }

    // `further`: more charts, shown before the histograms, in the form of Chart.
    show(point, further = []) {
      const text = element(
        'div',
        {},
        estimateTable(point, `Estimates at ${parametersText(point.parameters)}`),
        remarks(point),
        pointFacts(point),
      );
      // New elements would end the reader's selection of text.
      if (!text.isEqualNode(this.text)) this.text.replaceChildren(...text.childNodes);
      this.showCharts([...further, ...histogramCharts(point), ...curveCharts(point)]);
    }

    showCharts(wanted) {
      while (this.charts.length > wanted.length) this.charts.pop().remove();
      wanted.forEach((chart, i) => {
        if (!this.charts[i]) {
          this.charts.push(new ballpiston.Chart());
          this.pictures.append(this.charts[i].element);
        }
        this.charts[i].show(chart);
      });
    }

    remove() {
      this.showCharts([]);
      this.element.remove();
    }
  }

  // ---- Points as rows of a table

  const POINT_COLUMNS = [
    ...textColumns('Point', 'Parameters', 'Model'),
    ...numberColumns('Value', 'Exact', 'z'),
  ];

  // The cells of a point's row, with its first estimate. `name` is the first cell.
  function pointCells(point, name) {
    const first = point.estimates?.[0] ?? {};
    return [
      name,
      parametersText(point.parameters),
      words(point.model),
      ballpiston.withError(first.value, first.standard_error),
      isNumber(first.exact) ? valueText(first.exact, first.standard_error / 10) : '',
      zElement(first.z_score),
    ];
  }

  Object.assign(ballpiston, {ResultView, POINT_COLUMNS, pointCells});
})((globalThis.ballpiston ??= {}));
