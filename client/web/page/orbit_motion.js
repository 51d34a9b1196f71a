// The positions of the balls and pistons of a trace at a given time. Between its events a body
// moves with constant velocity.
(function (ballpiston) {
  'use strict';

  const FIELDS = ['x', 'y', 'vx', 'vy', 'energy']; // the fields of a body in an event

  const place = (body, time) => ({
    x: body.x + (time - body.time) * body.vx,
    y: body.y + (time - body.time) * body.vy,
  });

  class OrbitMotion {
    // `start`: a TraceStart.
    constructor(start) {
      const atStart = (body) => ({...body, time: 0});
      this.start = start;
      this.balls = start.balls.map(atStart);
      this.pistons = start.pistons.map(atStart);
      this.events = []; // known events that are not yet reached, in the order of time
      this.time = 0;
      this.count = 0; // number of reached events
      this.hasEnded = false; // no event follows the known ones
    }

    // Advances to `time`, at most to the last known event. Returns the events on the way.
    advanceTo(time) {
      const next = this.events.findIndex((event) => event.time > time);
      const reached = this.events.splice(0, next < 0 ? this.events.length : next);
      reached.forEach((event) => this.apply(event));
      this.count += reached.length;
      this.time = this.events.length ? time : (reached.at(-1)?.time ?? this.time);
      return reached;
    }

    // The time of the next known event of this kind, or undefined.
    timeOfNext(kind) {
      return this.events.find((event) => event.event === kind)?.time;
    }

    // A ball, a piston or both take part in an event.
    apply(event) {
      for (const name of ['ball', 'piston']) {
        const body = this[`${name}s`][event[name]];
        if (!body) continue;
        for (const field of FIELDS) body[field] = event[`${name}_${field}`];
        body.time = event.time;
      }
    }

    // The balls or the pistons with their present positions.
    now(bodies) {
      return bodies.map((body) => ({...body, ...place(body, this.time)}));
    }
  }

  ballpiston.OrbitMotion = OrbitMotion;
})((globalThis.ballpiston ??= {}));
