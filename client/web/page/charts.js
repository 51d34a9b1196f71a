// Charts drawn by uPlot: points with error bars, exact lines, and steps. Each chart has a legend, a
// line with the values under the pointer, and a table of its numbers.
//
// A chart is given by
//   {title, xLabel, yLabel, logX, logY, fromZero, top, note, lines}; y above `top` is cut off
// and a line by
//   {label, kind, colour, x, y, error, marks, shift, stepped}
//   kind    'measured' (symbols with error bars), 'exact' (a line), 'limit' (a dashed line), or
//           'steps' (filled from 0; y[i] holds from x[i] to x[i + 1])
//   colour  0, 1, ...: index of colour and symbol
//   error   the standard error of each y; all or some may be missing
//   marks   true for an exact line or a limit that is a mark at each x, with nothing between
//   stepped true for a line where y[i] holds from x[i] to x[i + 1]
//   shift   moves symbols and error bars along x, to the middle of steps
(function (ballpiston) {
  'use strict';

  const {element, isNumber, valueText, withError} = ballpiston;

  const HEIGHT = 260;
  const COLOURS = 6; // --line-0 to --line-5 in style.css
  const SYMBOL_RADIUS = 3.5;
  const MOST_TABLE_ROWS = 200;
  const MOST_DECADES = 6; // that have a label on a log axis, about
  const LEAST_WIDTH = 1e-16; // of a range of x; uPlot ignores smaller ones
  const ROOM = 0.06; // of the range of y, above and below

  const charts = new Set();

  const pixels = () => devicePixelRatio || 1;
  const colours = new Map(); // those of style.css that were asked for, in the shown theme

  // Only a property that is a colour resolves light-dark().
  function styleOf(name) {
    if (!colours.has(name)) {
      const root = document.documentElement;
      root.style.columnRuleColor = `var(${name})`;
      colours.set(name, getComputedStyle(root).columnRuleColor);
    }
    return colours.get(name);
  }
  const colourOf = (line) => styleOf(`--line-${line.colour % COLOURS}`);

  // Symbols distinguish lines for readers who cannot distinguish the colours.
  const SYMBOLS = [
    (c, x, y, r) => c.arc(x, y, r, 0, 2 * Math.PI),
    (c, x, y, r) => c.rect(x - r, y - r, 2 * r, 2 * r),
    (c, x, y, r) => polygon(c, x, y, 1.3 * r, 3),
    (c, x, y, r) => polygon(c, x, y, 1.3 * r, 4),
    (c, x, y, r) => polygon(c, x, y, 1.2 * r, 5),
    (c, x, y, r) => polygon(c, x, y, -1.3 * r, 3),
  ];

  function polygon(c, x, y, r, corners) {
    for (let i = 0; i < corners; ++i) {
      const angle = (2 * Math.PI * i) / corners;
      c.lineTo(x + r * Math.sin(angle), y - r * Math.cos(angle));
    }
    c.closePath();
  }

  function drawSymbol(c, line, x, y, radius) {
    c.beginPath();
    SYMBOLS[line.colour % SYMBOLS.length](c, x, y, radius);
    c.fill();
  }

  function drawLine(c, ...ends) {
    c.beginPath();
    for (const end of ends) c.lineTo(...end);
    c.stroke();
  }

  function drawMeasured(u, line) {
    const c = u.ctx;
    c.fillStyle = c.strokeStyle = colourOf(line);
    c.lineWidth = 1.5 * pixels();
    c.setLineDash(line.kind === 'limit' ? [6 * pixels(), 3 * pixels()] : []);
    const radius = SYMBOL_RADIUS * pixels();
    // A logarithmic axis has no place for an end of an error bar at or below 0.
    const end = (y) => u.valToPos(Math.max(y, u.scales.y.min), 'y', true);
    for (let i = 0; i < line.x.length; ++i) {
      const x = line.x[i] + (line.shift ?? 0);
      if (!isNumber(line.y[i]) || x < u.scales.x.min || x > u.scales.x.max) continue;
      const [value, error] = [line.y[i], line.error?.[i]];
      const left = u.valToPos(x, 'x', true);
      if (error > 0) drawLine(c, [left, end(value - error)], [left, end(value + error)]);
      const y = u.valToPos(value, 'y', true);
      if (line.marks) drawLine(c, [left - 3 * radius, y], [left + 3 * radius, y]);
      else drawSymbol(c, line, left, y, radius);
    }
  }

  function drawAllMeasured(u, lines) {
    const c = u.ctx;
    c.save();
    c.beginPath();
    c.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    c.clip();
    for (const line of lines) if (line.kind === 'measured' || line.marks) drawMeasured(u, line);
    c.restore();
  }

  // The range of all values and error bars whose x is in [left, right].
  function rangeOfY(chart, [left, right]) {
    let min = Infinity,
      max = -Infinity;
    const see = (y) => {
      if (!isNumber(y) || (chart.logY && y <= 0)) return;
      min = Math.min(min, y);
      max = Math.max(max, y);
    };
    if (chart.fromZero) see(0);
    for (const line of chart.lines) {
      for (let i = 0; i < line.x.length; ++i) {
        if (line.x[i] < left || line.x[i] > right) continue;
        see(line.y[i] - (line.error?.[i] ?? 0));
        see(line.y[i] + (line.error?.[i] ?? 0));
      }
    }
    if (min > max) return chart.logY ? [1, 10] : [0, 1];
    const factor = max > min ? (max / min) ** ROOM : 2;
    if (chart.logY) return [min / factor, max * factor];
    return withRoom(min, Math.min(max, chart.top ?? max), chart.fromZero);
  }

  function withRoom(min, max, fromZero) {
    const room = max > min ? ROOM * (max - min) : Math.abs(max) * ROOM || 1;
    return [fromZero && min === 0 ? 0 : min - room, max + room];
  }

  // A range that the reader selected does not reach one end of the data.
  const isSelected = (x, min, max) => min > x[0] || max < x.at(-1);

  function rangeOfX(chart, x, min, max) {
    if (isSelected(x, min, max)) return [min, max];
    if (min === null || max === null) return chart.logX ? [1, 10] : [0, 1];
    if (chart.logX) return min === max ? [min / 2, max * 2] : [min / 1.1, max * 1.1];
    if (chart.lines.some((line) => line.kind === 'steps')) return [min, max];
    return withRoom(min, max, false);
  }

  function uplotSeries(line) {
    const stepped = uPlot.paths.stepped({align: 1});
    const forms = {
      measured: {paths: () => null}, // drawAllMeasured draws it
      steps: {width: 1, fill: () => styleOf('--fill'), paths: stepped},
      exact: line.stepped ? {width: 2, paths: stepped} : {width: 1.5},
      limit: {width: 1.5, dash: [6, 5]},
    };
    const common = {label: line.label, points: {show: false}, spanGaps: true};
    const form = line.marks ? forms.measured : forms[line.kind];
    return {...common, stroke: () => colourOf(line), ...form};
  }

  function axis(label, more) {
    return {
      label,
      labelSize: 20,
      labelGap: 2,
      labelFont: '13px system-ui, sans-serif',
      font: '12px system-ui, sans-serif',
      stroke: () => styleOf('--soft'),
      grid: {stroke: () => styleOf('--grid'), width: 1},
      ticks: {stroke: () => styleOf('--grid'), width: 1, size: 5},
      ...more,
    };
  }

  // A tick label with enough digits to be different from the others.
  function tickText(tick) {
    if (tick === null) return '';
    tick = Number(tick.toPrecision(10));
    const size = Math.abs(tick);
    if (size >= 1e5 || (size > 0 && size < 1e-4)) return tick.toExponential().replace('e+', 'e');
    return String(tick);
  }

  const tickTexts = (u, ticks) => ticks.map(tickText);

  // Ticks of a log axis: 1, 2 and 5 of each decade; only 1, of some decades, if there are many;
  // else multiples of `step`, if less than two of those ticks are in the range.
  function logTicks(u, axis, min, max, step) {
    const [first, last] = [Math.log10(min), Math.log10(max)];
    const digits = last - first > 3 ? [1] : [1, 2, 5];
    const stride = Math.ceil((last - first) / MOST_DECADES);
    const ticks = [];
    for (let e = stride * Math.floor(first / stride); e <= last; e += stride) {
      ticks.push(...digits.map((digit) => digit * 10 ** e));
    }
    const shown = ticks.filter((tick) => tick >= min && tick <= max);
    if (shown.length > 1) return shown;
    const count = Math.floor(max / step) - Math.ceil(min / step) + 1;
    return Array.from({length: count}, (_, i) => (Math.ceil(min / step) + i) * step);
  }

  const LOG = {splits: logTicks, filter: (u, ticks) => ticks}; // of an axis

  function widthOfTicks(u, texts) {
    const longest = Math.max(1, ...(texts ?? []).map((text) => text.length));
    return 14 + 7 * longest;
  }

  // All lines over the union of their x. Values that a line does not have are undefined.
  function aligned(lines) {
    return lines.length ? uPlot.join(lines.map((line) => [line.x, line.y])) : [[]];
  }

  // A chart of the same shape keeps its uPlot object and the zoom. Otherwise a new object is made.
  function shapeOf({xLabel, yLabel, logX, logY, lines}) {
    const kinds = lines.map(({label, kind, colour}) => [label, kind, colour]);
    return JSON.stringify([xLabel, yLabel, logX, logY, kinds]);
  }

  function symbolKey(line) {
    const canvas = element('canvas', {class: 'key', 'aria-hidden': 'true', width: 56, height: 28});
    const c = canvas.getContext('2d');
    c.strokeStyle = c.fillStyle = colourOf(line);
    c.lineWidth = 3;
    if (line.kind === 'steps') {
      c.fillStyle = styleOf('--fill');
      c.fillRect(6, 4, 44, 20);
      c.strokeRect(6, 4, 44, 20);
    } else if (line.kind === 'measured') {
      c.fillRect(26, 2, 3, 24);
      drawSymbol(c, line, 28, 14, 7);
    } else {
      if (line.kind === 'limit') c.setLineDash([10, 8]);
      drawLine(c, [2, 14], [54, 14]);
    }
    return canvas;
  }

  function noteOf(chart, x) {
    const isTooNarrow = x.at(-1) > x[0] && x.at(-1) - x[0] < LEAST_WIDTH;
    return isTooNarrow ? `The range of ${chart.xLabel} is too small for a picture.` : chart.note;
  }

  // The value of the line at x, with its error; empty if it has none. The picture shows the last of
  // several values too.
  function textAt(line, x) {
    const i = line.x.lastIndexOf(x);
    return isNumber(line.y[i]) ? withError(line.y[i], line.error?.[i]) : '';
  }

  function tableOf(chart) {
    const columns = ballpiston.numberColumns(chart.xLabel, ...chart.lines.map(({label}) => label));
    const [x] = aligned(chart.lines);
    const step = Math.max(1, Math.ceil(x.length / MOST_TABLE_ROWS));
    const rows = x
      .filter((_, i) => i % step === 0)
      .map((at) => [valueText(at), ...chart.lines.map((line) => textAt(line, at))]);
    const caption = step === 1 ? chart.title : `${chart.title}: every ${step}th row`;
    return ballpiston.table(caption, columns, rows, {class: 'compact'});
  }

  class Chart {
    constructor() {
      this.title = element('figcaption');
      this.plot = element('div', {class: 'plot', role: 'img'});
      this.legend = element('ul', {class: 'legend'});
      this.readout = element('p', {class: 'readout', 'aria-hidden': 'true'});
      this.note = element('p', {class: 'note', hidden: true});
      this.numbers = element('div', {class: 'scroll', tabindex: '0', role: 'region'});
      this.details = element(
        'details',
        {ontoggle: () => this.showNumbers()},
        element('summary', {}, 'Numbers'),
        this.numbers,
      );
      const parts = [this.title, this.legend, this.plot, this.readout, this.note, this.details];
      this.element = element('figure', {class: 'chart'}, parts);
      this.uplot = null;
      charts.add(this);
      this.resizing = new ResizeObserver(() => this.resize());
      this.resizing.observe(this.plot);
    }

    // Shows `chart`. Draws it when the element is in the page and has a width.
    show(chart) {
      this.chart = chart;
      this.title.textContent = chart.title;
      this.numbers.setAttribute('aria-label', `Numbers: ${chart.title}`);
      const data = aligned(chart.lines);
      this.note.textContent = noteOf(chart, data[0]) ?? '';
      this.note.hidden = this.note.textContent === '';
      this.plot.setAttribute('aria-label', this.description());
      if (this.shape !== shapeOf(chart)) this.clear();
      if (this.uplot) this.replace(data);
      else this.resize();
      this.showNumbers();
    }

    // Keeps the zoom if its range still overlaps the data.
    replace(data) {
      const {min, max} = this.uplot.scales.x;
      const hasData = max >= data[0][0] && min <= data[0].at(-1);
      const isZoomed = hasData && isSelected(this.uplot.data[0], min, max);
      this.uplot.setData(data, !isZoomed);
      if (isZoomed) this.uplot.redraw();
    }

    description() {
      const {title, xLabel, yLabel, lines} = this.chart;
      const last = lines
        .filter((line) => line.kind === 'measured' && line.y.length)
        .map((line) => `${line.label}, last ${withError(line.y.at(-1), line.error?.at(-1))}`);
      return `Chart: ${title}. ${yLabel} against ${xLabel}. ${last.slice(0, 4).join('; ')}`;
    }

    clear() {
      this.uplot?.destroy();
      this.uplot = null;
      this.shape = null;
    }

    remove() {
      this.clear();
      this.resizing.disconnect();
      charts.delete(this);
      this.element.remove();
    }

    resize() {
      const width = Math.floor(this.plot.clientWidth);
      if (!this.chart || width === 0) return;
      if (this.uplot) this.uplot.setSize({width, height: HEIGHT});
      else this.make(width);
    }

    make(width) {
      const {chart} = this;
      this.shape = shapeOf(chart);
      const narrow = width < 420;
      this.uplot = new uPlot(
        {
          width,
          height: HEIGHT,
          legend: {show: false},
          padding: [10, 14, 0, 0],
          cursor: {drag: {x: true, y: false}, points: {show: false}},
          scales: {
            x: {
              time: false,
              distr: chart.logX ? 3 : 1,
              range: (u, min, max) => (this.xRange = rangeOfX(this.chart, u.data[0], min, max)),
            },
            y: {distr: chart.logY ? 3 : 1, range: () => rangeOfY(this.chart, this.xRange)},
          },
          axes: [
            axis(chart.xLabel, {
              values: tickTexts,
              size: 28,
              space: narrow ? 55 : 70,
              ...(chart.logX && LOG),
            }),
            axis(chart.yLabel, {values: tickTexts, size: widthOfTicks, ...(chart.logY && LOG)}),
          ],
          series: [{}, ...chart.lines.map(uplotSeries)],
          hooks: {
            draw: [(u) => drawAllMeasured(u, this.chart.lines)],
            setCursor: [(u) => this.read(u)],
          },
        },
        aligned(chart.lines),
        this.plot,
      );
      this.legend.replaceChildren(
        ...chart.lines.map((line) => element('li', {}, symbolKey(line), line.label)),
      );
    }

    read(u) {
      const {lines, xLabel} = this.chart;
      let i = u.cursor.idx; // of the nearest x, but a step holds from its x to the next one
      const isStep = lines.some((line) => line.stepped || line.kind === 'steps');
      if (isStep && u.data[0][i] > u.posToVal(u.cursor.left, 'x')) i = Math.max(i - 1, 0);
      const x = u.data[0][i];
      const parts = lines.map((line) => textAt(line, x) && `${line.label}: ${textAt(line, x)}`);
      this.readout.textContent = isNumber(i)
        ? [`${xLabel} = ${valueText(x)}`, ...parts.filter(Boolean)].join(' · ')
        : '';
    }

    showNumbers() {
      if (this.details.open) this.numbers.replaceChildren(tableOf(this.chart));
    }

    // Draws the chart anew with the same zoom. A chart that is hidden loses its zoom.
    repaint() {
      const {min, max} = this.uplot?.scales.x ?? {};
      const isZoomed = this.uplot && isSelected(this.uplot.data[0], min, max);
      this.clear();
      this.resize();
      if (isZoomed) this.uplot?.setScale('x', {min, max});
    }
  }

  // The kinds of lines that measured values are compared with, and their labels.
  const COMPARED = {exact: 'exact', limit: 'Markov limit'};

  // The lines of one series, from its places {x, value, error, exact, limit, source} in the order
  // of x. A series without a label is the only one of its chart: its label is the places' sources.
  function seriesLines(places, label = '', colour = 0) {
    const line = (field, more) => ({
      x: places.map((at) => at.x),
      y: places.map((at) => at[field] ?? null),
      ...more,
    });
    const sources = new Set(places.map((at) => at.source));
    const name = label || [...sources].join(', ') || 'measured';
    const measured = {label: name, kind: 'measured', colour};
    const compared = Object.keys(COMPARED)
      .filter((kind) => places.some((at) => isNumber(at[kind])))
      .map((kind) =>
        line(kind, {
          label: [label, COMPARED[kind]].filter(Boolean).join(', '),
          kind,
          colour: label ? colour : 1,
        }),
      );
    return [line('value', {...measured, error: places.map((at) => at.error)}), ...compared];
  }

  // Called after a change of the theme. Sends 'repaint' to the window.
  function repaintCharts() {
    colours.clear();
    charts.forEach((chart) => chart.repaint());
    dispatchEvent(new Event('repaint'));
  }
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', repaintCharts);

  function setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    repaintCharts();
  }

  // Pages are printed with the light theme.
  let screenTheme;
  addEventListener('beforeprint', () => {
    screenTheme = document.documentElement.dataset.theme ?? 'auto';
    setTheme('light');
  });
  addEventListener('afterprint', () => setTheme(screenTheme));

  // Called when the reader leaves a view.
  const removeCharts = () => charts.forEach((chart) => chart.remove());

  Object.assign(ballpiston, {Chart, seriesLines, styleOf, drawLine, setTheme, removeCharts});
})((globalThis.ballpiston ??= {}));
