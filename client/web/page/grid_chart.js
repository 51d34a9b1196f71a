// A chart of one estimate of all points against a parameter of the grid, with the exact values as
// marks. The reader chooses the estimate, the parameter, and values, ratios or z.
(function (ballpiston) {
  'use strict';

  const {element, choice, isNumber, words, symbolOf, parameterPairs} = ballpiston;

  const MOST_LINES = 6; // the number of different colours and symbols
  const MOST_WITHOUT_LOG = 30; // ratio of the largest to the smallest number

  const SHOWN = [
    {value: 'value', label: 'value'},
    {value: 'ratio', label: 'value / exact'},
    {value: 'z', label: 'z, (value − exact)/error'},
  ];

  // {parameter: set of its values} for the parameters with more than one value.
  function varyingParameters(points) {
    const values = {};
    for (const point of points) {
      for (const [name, value] of parameterPairs(point.parameters)) {
        (values[name] ??= new Set()).add(value);
      }
    }
    for (const name of Object.keys(values)) if (values[name].size < 2) delete values[name];
    return values;
  }

  // A lattice NxM is not a number.
  const isAxis = (values) => [...values].every((value) => isNumber(Number(value)));

  const axesOf = (points) =>
    Object.entries(varyingParameters(points))
      .filter(([, values]) => isAxis(values))
      .sort(([, a], [, b]) => b.size - a.size)
      .map(([name]) => name);

  const estimatesOf = (points) => [
    ...new Set(points.flatMap((point) => point.estimates.map((estimate) => estimate.name))),
  ];

  // Groups of points whose parameters differ only in `axis`: [[label, points], ...].
  function groups(points, axis) {
    const varying = varyingParameters(points);
    const labelOf = ({parameters}) =>
      ballpiston.pairsText(
        parameterPairs(parameters).filter(([name]) => name !== axis && varying[name]),
      );
    const grouped = new Map();
    for (const point of points) {
      const label = labelOf(point);
      if (!grouped.has(label)) grouped.set(label, []);
      grouped.get(label).push(point);
    }
    return [...grouped];
  }

  // At most MOST_LINES of the groups, evenly selected.
  function spread(grouped) {
    if (grouped.length <= MOST_LINES) return grouped;
    const step = (grouped.length - 1) / (MOST_LINES - 1);
    return Array.from({length: MOST_LINES}, (_, i) => grouped[Math.round(i * step)]);
  }

  // {value, error, exact} in the form `shown`; value is null if the estimate lacks this form.
  function inForm(estimate, shown) {
    const {value, standard_error: error, exact, limit, z_score: z} = estimate ?? {};
    if (shown === 'z')
      return {value: z ?? null, error: isNumber(z) ? 1 : null, exact: isNumber(z) ? 0 : null};
    if (shown === 'value') return {value: value ?? null, error, exact, limit};
    if (!isNumber(exact) || exact === 0) return {value: null};
    return {
      value: value / exact,
      error: isNumber(error) ? error / Math.abs(exact) : null,
      exact: 1,
    };
  }

  function placesOf(points, axis, name, shown) {
    return points
      .map((point) => ({
        x: Number(point.parameters[axis]),
        source: ballpiston.sourceOf(point),
        ...inForm(ballpiston.estimateOf(point, name), shown),
      }))
      .filter((at) => at.value !== null)
      .sort((a, b) => a.x - b.x);
  }

  function isWide(numbers) {
    const sorted = [...new Set(numbers.filter(isNumber))].sort((a, b) => a - b);
    const [least, most] = [sorted[0], sorted.at(-1)];
    return sorted.length > 2 && least > 0 && most / least > MOST_WITHOUT_LOG;
  }

  class GridChart {
    constructor() {
      this.choices = element('div', {class: 'choices'});
      this.chart = new ballpiston.Chart();
      this.element = element('div', {}, this.choices, this.chart.element);
      this.chosen = {estimate: null, axis: null, shown: 'value'};
    }

    // Shows nothing and returns false if every parameter has fewer than two values.
    show(points) {
      this.points = points;
      const axes = axesOf(points);
      this.element.hidden = axes.length === 0;
      if (axes.length === 0) return false;
      this.offer(estimatesOf(points), axes);
      this.draw();
      return true;
    }

    // Makes the drop-down lists again only if their options changed, so that an open list stays
    // open.
    offer(estimates, axes) {
      const offered = JSON.stringify([estimates, axes]);
      if (offered === this.offered) return;
      this.offered = offered;
      if (!estimates.includes(this.chosen.estimate)) this.chosen.estimate = estimates[0];
      if (!axes.includes(this.chosen.axis)) this.chosen.axis = axes[0];
      const chooser = (label, field, options) =>
        choice(label, options, this.chosen[field], (value) => {
          this.chosen[field] = value;
          this.draw();
        });
      const named = (names, text) => names.map((name) => ({value: name, label: text(name)}));
      this.choices.replaceChildren(
        chooser('Estimate', 'estimate', named(estimates, words)),
        chooser('Against', 'axis', named(axes, symbolOf)),
        chooser('Show', 'shown', SHOWN),
      );
    }

    draw() {
      const {estimate, axis, shown} = this.chosen;
      const grouped = groups(this.points, axis);
      const drawn = spread(grouped);
      const lines = drawn.flatMap(([label, points], i) =>
        ballpiston.seriesLines(placesOf(points, axis, estimate, shown), label, i),
      );
      for (const line of lines) line.marks = shown === 'value' && line.kind !== 'measured';
      const hasValues = lines.some((line) => line.y.length);
      this.chart.show({
        title: `${words(estimate)} against ${symbolOf(axis)}`,
        xLabel: symbolOf(axis),
        yLabel: SHOWN.find((form) => form.value === shown).label,
        lines,
        logX: isWide(lines.flatMap((line) => line.x)),
        logY: isWide(lines.flatMap((line) => line.y)),
        note: !hasValues
          ? 'No exact value is known.'
          : drawn.length < grouped.length
            ? `${drawn.length} of ${grouped.length} lines, evenly selected`
            : null,
      });
    }

    remove() {
      this.chart.remove();
      this.element.remove();
    }
  }

  ballpiston.GridChart = GridChart;
})((globalThis.ballpiston ??= {}));
