// Cells, balls and pistons on a canvas. The colour of a body shows its energy, in the colour scale
// cividis, which readers with colour vision deficiency can also read.
(function (ballpiston) {
  'use strict';

  const CIVIDIS = [
    [0, 34, 78],
    [53, 69, 108],
    [102, 105, 112],
    [148, 142, 119],
    [200, 184, 102],
    [254, 232, 56],
  ];
  const EDGE = 0.06; // margin around the cells
  const BALL = 0.025; // radius of the picture of a ball, which is a point
  const TRAIL = 60; // corners of the pair's trail

  const styleOf = (name) => ballpiston.styleOf(name);

  // `share`: the energy as a share of mostEnergy, from 0 to 1.
  function colourOf(share) {
    const at = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1);
    const i = Math.min(Math.floor(at), CIVIDIS.length - 2);
    const mixed = (c, k) => Math.round(c + (at - i) * (CIVIDIS[i + 1][k] - c));
    return `rgb(${CIVIDIS[i].map(mixed).join(',')})`;
  }

  function shapeOf(cells = '1') {
    const [columns, rows = 1] = cells.split('x').map(Number);
    return {columns, rows};
  }

  class OrbitPicture {
    constructor(canvas, start) {
      this.canvas = canvas;
      this.start = start;
      this.isPair = start.cells === undefined;
      this.shape = shapeOf(start.cells);
      // A ball of a pair has at most the energy 1/2. In a gas one ball in seven has more than 2 T.
      this.mostEnergy = this.isPair ? 0.5 : 2 * start.temperature;
      this.trail = [];
    }

    // The shown part of the plane.
    get bounds() {
      const {columns, rows} = this.shape;
      const way = 0.5 - this.start.tip + this.start.delta; // of a piston, to either side of an edge
      const left = this.isPair ? 0 : way;
      const up = rows > 1 ? way : 0;
      return {
        left: -0.5 - left - EDGE,
        right: columns - 0.5 + way + EDGE,
        bottom: -0.5 - up - EDGE,
        top: rows - 0.5 + up + EDGE,
      };
    }

    get aspect() {
      const {left, right, bottom, top} = this.bounds;
      return (right - left) / (top - bottom);
    }

    // Sets the canvas to the lengths of the plane, with y upwards.
    prepare() {
      const {left, right, bottom, top} = this.bounds;
      const {width, height} = this.canvas;
      this.scale = Math.min(width / (right - left), height / (top - bottom));
      const c = this.canvas.getContext('2d');
      c.setTransform(1, 0, 0, 1, 0, 0);
      c.fillStyle = styleOf('--free');
      c.fillRect(0, 0, width, height);
      const [x, y] = [(left + right) / 2, (bottom + top) / 2]; // of the middle
      c.setTransform(this.scale, 0, 0, -this.scale, width / 2, height / 2);
      c.translate(-x, -y);
      return c;
    }

    get pixel() {
      return 1 / this.scale;
    }

    remember(ball) {
      this.trail.push({x: ball.x, y: ball.y});
      if (this.trail.length > TRAIL) this.trail.shift();
    }

    draw(motion) {
      const c = this.prepare();
      this.drawDiscs(c);
      const balls = motion.now(motion.balls);
      if (this.isPair) this.drawTrail(c, balls[0]);
      motion.now(motion.pistons).forEach((piston) => this.drawPiston(c, piston));
      balls.forEach((ball) => this.drawBall(c, ball));
    }

    // All discs are one shape, so that overlaps of discs have the same colour as the discs.
    drawDiscs(c) {
      const {columns, rows} = this.shape;
      c.beginPath();
      for (let i = -1; i <= columns + 1; ++i) {
        for (let j = -1; j <= rows + 1; ++j) {
          c.moveTo(i - 0.5 + this.start.rho, j - 0.5);
          c.arc(i - 0.5, j - 0.5, this.start.rho, 0, 2 * Math.PI);
        }
      }
      c.fillStyle = styleOf('--disc');
      c.fill();
    }

    drawTrail(c, ball) {
      c.strokeStyle = styleOf('--soft');
      c.lineWidth = this.pixel;
      const corners = [...this.trail, ball];
      for (let i = 1; i < corners.length; ++i) {
        c.globalAlpha = i / corners.length;
        const [from, to] = [corners[i - 1], corners[i]];
        ballpiston.drawLine(c, [from.x, from.y], [to.x, to.y]);
      }
      c.globalAlpha = 1;
    }

    // A piston that crosses the left or lower edge of a gas is drawn at the opposite edge too.
    drawPiston(c, piston) {
      const {columns, rows} = this.shape;
      this.drawSegment(c, piston, 0, 0);
      if (this.isPair) return;
      if (piston.vertical) this.drawSegment(c, piston, columns, 0);
      else this.drawSegment(c, piston, 0, rows);
    }

    drawSegment(c, piston, dx, dy) {
      const half = this.start.eta / 2;
      const [alongX, alongY] = piston.vertical ? [0, half] : [half, 0];
      const x = piston.x + dx,
        y = piston.y + dy;
      const draw = (style, width) => {
        c.strokeStyle = style;
        c.lineWidth = width * this.thickness;
        ballpiston.drawLine(c, [x - alongX, y - alongY], [x + alongX, y + alongY]);
      };
      draw(styleOf('--text'), 7);
      draw(colourOf(piston.energy / this.mostEnergy), 4);
    }

    // The width of a thin line, in cells: one pixel of the layout, or less if there are many cells.
    get thickness() {
      return this.pixel * (devicePixelRatio || 1) * Math.min(1, this.scale / 150);
    }

    drawBall(c, ball) {
      c.beginPath();
      c.arc(ball.x, ball.y, BALL, 0, 2 * Math.PI);
      c.fillStyle = colourOf(ball.energy / this.mostEnergy);
      c.fill();
      c.strokeStyle = styleOf('--text');
      c.lineWidth = 1.5 * this.thickness;
      c.stroke();
    }
  }

  // Draws the colour scale of the energies as a strip.
  function drawEnergyScale(canvas) {
    const c = canvas.getContext('2d');
    for (let x = 0; x < canvas.width; ++x) {
      c.fillStyle = colourOf(x / (canvas.width - 1));
      c.fillRect(x, 0, 1, canvas.height);
    }
  }

  Object.assign(ballpiston, {OrbitPicture, drawEnergyScale});
})((globalThis.ballpiston ??= {}));
