// #orbit: one orbit of the reference billiard, from TraceOrbit. The page plays it while it arrives.
(function (ballpiston) {
  'use strict';

  const {element, button, valueText} = ballpiston;

  const MOST_AHEAD = 3000; // events that are read before they are played
  const MOST_LISTED = 8;
  const MOST_EXCHANGES = 200; // in the chart of energies
  const CHART_EVERY = 500; // ms
  const LONGEST_FRAME = 0.1; // seconds, so that an orbit does not jump after its tab was hidden
  const SPEEDS = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20]; // units of time per second
  const MOST_HEIGHT = 0.7; // of the window

  // Fields of text: in a field of type number some browsers read 0,5 as 5.
  const NUMBER = {
    inputmode: 'decimal',
    pattern: '([0-9]+[.]?[0-9]*|[.][0-9]+)([eE]-?[0-9]+)?',
    title: 'a number such as 0.5 or 1e3',
  };
  const FIELDS = [
    {name: 'rho', label: 'ρ, radius of the discs', value: '0.5296', ...NUMBER},
    {name: 'delta', label: 'δ, reach of the piston', value: '0.2', ...NUMBER},
    {name: 'cells', label: 'Cells, N or NxM; empty: a pair', value: ''},
    {name: 'temperature', label: 'Temperature of a gas', value: '1', ...NUMBER},
    {name: 'seed', label: 'Seed', value: '0', pattern: '[0-9]*'},
    {
      name: 'events',
      label: 'Events',
      value: '10000',
      inputmode: 'decimal',
      pattern: '[0-9]+([eE][0-9]+)?',
      title: 'a whole number such as 10000 or 1e4',
    },
  ];

  function fieldElement({name, label, ...more}) {
    return element(
      'label',
      {class: 'field'},
      element('span', {}, label),
      element('input', {
        name,
        ...more,
        required: name === 'rho' || name === 'delta' || name === 'events',
        autocomplete: 'off',
      }),
    );
  }

  function requestOf(form) {
    const given = Object.fromEntries(new FormData(form));
    const request = {
      rho: Number(given.rho),
      delta: Number(given.delta),
      cells: given.cells.trim(),
      seed: given.seed || '0',
      events: Number(given.events),
    };
    if (request.cells !== '') request.temperature = Number(given.temperature || 1);
    return request;
  }

  function eventText(event) {
    const bodies = ['ball', 'piston']
      .filter((name) => event[name] !== undefined)
      .map((name) => `${name} ${event[name]}: energy ${valueText(event[`${name}_energy`], 1e-3)}`);
    return [`t = ${event.time.toFixed(4)}`, ballpiston.words(event.event), ...bodies].join(', ');
  }

  class OrbitView {
    constructor(main, signal) {
      this.signal = signal;
      this.played = new EventTarget(); // sends 'advance' after events were played
      this.speed = SPEEDS.indexOf(1);
      this.charted = 0; // when the chart was last drawn in a frame
      this.isPlaying = !matchMedia('(prefers-reduced-motion: reduce)').matches;
      const onsubmit = (event) => {
        event.preventDefault();
        this.trace();
      };
      const submit = element('button', {type: 'submit'}, 'Trace');
      this.form = element('form', {class: 'fields', onsubmit}, FIELDS.map(fieldElement), submit);
      const about = 'One orbit of the reference billiard, as ballpiston trace prints it.';
      main.append(
        element('h1', {tabindex: '-1'}, 'Orbit'),
        element('p', {class: 'soft'}, about),
        this.form,
        this.stage(),
        this.controls(),
        this.below(),
      );
    }

    stage() {
      this.canvas = element('canvas', {
        class: 'orbit',
        role: 'img',
        tabindex: '0',
        'aria-label': 'The orbit',
        onkeydown: (event) => this.onKey(event),
      });
      const resizing = new ResizeObserver(() => this.fit());
      resizing.observe(document.getElementById('main'));
      addEventListener('repaint', () => this.draw(), {signal: this.signal});
      this.signal.addEventListener('abort', () => resizing.disconnect());
      return this.canvas;
    }

    controls() {
      this.playButton = button('', () => this.play(!this.isPlaying));
      this.stepButton = button('Next exchange', () => this.toNextExchange());
      this.speedText = element('span');
      this.speedInput = element('input', {
        type: 'range',
        min: 0,
        max: SPEEDS.length - 1,
        step: 1,
        value: this.speed,
        oninput: () => this.setSpeed(Number(this.speedInput.value)),
      });
      const size = {width: 160, height: 12};
      const scale = element('canvas', {...size, class: 'scale', 'aria-hidden': 'true'});
      ballpiston.drawEnergyScale(scale);
      this.scaleEnd = element('span', {}, '');
      const choice = (tag, label, ...parts) =>
        element(tag, {class: 'choice'}, element('span', {}, label), parts);
      this.setSpeed(this.speed);
      this.play(this.isPlaying);
      return element(
        'div',
        {class: 'choices'},
        this.playButton,
        this.stepButton,
        choice('label', 'Speed', this.speedInput, this.speedText),
        choice('span', 'Energy 0', scale, this.scaleEnd),
      );
    }

    below() {
      this.clock = element('p', {class: 'readout'});
      this.chart = null;
      this.chartPlace = element('div');
      this.list = element('ol', {class: 'events', 'aria-label': 'Last events, newest first'});
      const keys =
        'Keys, while the picture has the focus: space plays and pauses, ' +
        'n goes to the next exchange of ball and piston, + and − change the speed.';
      const title = element('h2', {}, 'Last events');
      const about = element('p', {class: 'soft'}, keys);
      return element('div', {}, this.clock, about, this.chartPlace, title, this.list);
    }

    onKey(event) {
      const keys = {
        ' ': () => this.play(!this.isPlaying),
        n: () => this.toNextExchange(),
        '+': () => this.setSpeed(this.speed + 1),
        '-': () => this.setSpeed(this.speed - 1),
      };
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    }

    play(isPlaying) {
      this.isPlaying = isPlaying;
      this.isSeeking = false;
      this.playButton.textContent = isPlaying ? 'Pause' : 'Play';
    }

    setSpeed(speed) {
      this.speed = Math.min(Math.max(speed, 0), SPEEDS.length - 1);
      this.speedInput.value = this.speed;
      const shown = SPEEDS[this.speed];
      this.speedText.textContent = `${shown} ${shown === 1 ? 'unit' : 'units'} of time per second`;
      this.speedInput.setAttribute('aria-valuetext', this.speedText.textContent);
    }

    // If no exchange is known, goes to the last known event, and on when events arrive.
    toNextExchange() {
      if (!this.motion) return;
      const time = this.motion.timeOfNext('ball_piston');
      this.isSeeking = time === undefined;
      this.advanceTo(time ?? Infinity);
      this.draw();
    }

    // Begins a new trace and ends the previous one.
    async trace() {
      this.tracing?.abort();
      ballpiston.clearBanner();
      const tracing = (this.tracing = new AbortController());
      const signal = AbortSignal.any([this.signal, tracing.signal]);
      const request = requestOf(this.form);
      try {
        await ballpiston.keepTrying((progress) => this.read(request, progress, signal), signal);
      } catch (error) {
        if (signal.aborted || error instanceof ballpiston.CallError) return; // the banner shows it
        throw error;
      }
    }

    // The same request gives the same events: a retry skips the known events.
    async read(request, progress, signal) {
      let known = this.request === request ? this.motion.count + this.motion.events.length : 0;
      const messages = ballpiston.streamWhileVisible('TraceService/TraceOrbit', request, signal);
      for await (const {start, events = []} of messages) {
        progress();
        if (start && this.request !== request) this.begin(request, start);
        this.motion.events.push(...events.slice(known));
        known = Math.max(0, known - events.length);
        if (this.isSeeking) this.toNextExchange();
        await this.roomFor(signal);
      }
      this.motion.hasEnded = true;
      this.draw();
    }

    async roomFor(signal) {
      while (this.motion.events.length > MOST_AHEAD && !signal.aborted) {
        await ballpiston.until(this.played, 'advance', signal);
      }
    }

    begin(request, start) {
      this.request = request;
      this.isSeeking = false;
      this.motion = new ballpiston.OrbitMotion(start);
      this.picture = new ballpiston.OrbitPicture(this.canvas, start);
      this.exchanges = [];
      this.list.replaceChildren();
      this.chart?.remove();
      this.chart = new ballpiston.Chart();
      this.chartPlace.append(this.chart.element);
      this.scaleEnd.textContent = this.picture.isPair
        ? '1/2'
        : `${valueText(this.picture.mostEnergy)} and more`;
      this.note(start.balls, start.pistons, 0);
      this.fit();
      this.drawChart();
    }

    // Gives the canvas the pixel density of the screen and the shape of the picture.
    fit() {
      if (!this.picture) return;
      const room = this.canvas.parentElement.clientWidth;
      const height = Math.min(room / this.picture.aspect, MOST_HEIGHT * innerHeight);
      const width = height * this.picture.aspect;
      const ratio = devicePixelRatio || 1;
      const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
      if (this.canvas.width !== w || this.canvas.height !== h) {
        Object.assign(this.canvas, {width: w, height: h});
        this.canvas.style.width = `${Math.round(width)}px`;
      }
      this.draw();
    }

    advanceTo(time) {
      const reached = this.motion.advanceTo(time);
      if (reached.length === 0) return;
      for (const event of reached) {
        if (this.picture.isPair && event.ball !== undefined) {
          this.picture.remember({x: event.ball_x, y: event.ball_y});
        }
        if (event.event === 'ball_piston')
          this.note(this.motion.balls, this.motion.pistons, event.time);
      }
      const items = reached.slice(-MOST_LISTED).map((event) => element('li', {}, eventText(event)));
      this.list.prepend(...items.reverse());
      while (this.list.childElementCount > MOST_LISTED) this.list.lastChild.remove();
      this.played.dispatchEvent(new Event('advance'));
    }

    // Stores the mean energies after an exchange, for the chart.
    note(balls, pistons, time) {
      const mean = (bodies) => bodies.reduce((sum, body) => sum + body.energy, 0) / bodies.length;
      this.exchanges.push({time, ball: mean(balls), piston: mean(pistons)});
      if (this.exchanges.length > MOST_EXCHANGES) this.exchanges.shift();
    }

    drawChart() {
      this.chartTime = this.motion.time;
      const {isPair} = this.picture;
      const steps = [...this.exchanges, {...this.exchanges.at(-1), time: this.motion.time}];
      const x = steps.map((at) => at.time);
      const lines = ['ball', 'piston'].map((name, colour) => {
        const shape = {kind: 'exact', stepped: true, colour};
        return {...shape, label: isPair ? name : `${name}s`, x, y: steps.map((at) => at[name])};
      });
      this.chart.show({
        title: isPair ? 'Energies of ball and piston' : 'Mean energies of balls and pistons',
        xLabel: 'time',
        yLabel: 'energy',
        fromZero: true,
        lines,
      });
    }

    draw() {
      if (!this.motion) return;
      this.picture.draw(this.motion);
      const {motion} = this;
      this.clock.textContent =
        `t = ${motion.time.toFixed(2)}, ${ballpiston.countText(motion.count)} events` +
        (motion.hasEnded && motion.events.length === 0 ? '; the trace has ended' : '');
      this.canvas.setAttribute(
        'aria-label',
        this.picture.isPair
          ? 'Cell with one ball and one piston'
          : `Gas of ${motion.balls.length} balls and ${motion.pistons.length} pistons`,
      );
    }

    frame(now) {
      if (this.signal.aborted) return;
      const seconds = Math.min((now - (this.last ?? now)) / 1000, LONGEST_FRAME);
      this.last = now;
      if (this.motion && this.isPlaying) {
        this.advanceTo(this.motion.time + SPEEDS[this.speed] * seconds);
        this.draw();
      }
      if (this.motion && this.motion.time !== this.chartTime && now - this.charted > CHART_EVERY) {
        this.charted = now;
        this.drawChart();
      }
      requestAnimationFrame((then) => this.frame(then));
    }
  }

  function showOrbit(main, signal) {
    document.title = 'Orbit – ballpiston';
    const view = new OrbitView(main, signal);
    view.trace();
    requestAnimationFrame((now) => view.frame(now));
  }

  Object.assign(ballpiston, {showOrbit});
})((globalThis.ballpiston ??= {}));
