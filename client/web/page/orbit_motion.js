// The positions of the balls and pistons of a trace at a given time. Between its events a body
// moves with constant velocity.
(function (ballpiston) {
  'use strict';

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

    add(events) {
      this.events.push(...events);
    }

    // Advances to `time`, at most to the last known event. Returns the events on the way.
    advanceTo(time) {
      const reached = [];
      while (reached.length < this.events.length && this.events[reached.length].time <= time) {
        this.apply(this.events[reached.length]);
        reached.push(this.events[reached.length]);
      }
      this.events.splice(0, reached.length);
      this.count += reached.length;
      this.time = this.events.length ? time : (reached.at(-1)?.time ?? this.time);
      return reached;
    }

    // The time of the next known event of this kind, or undefined.
    timeOfNext(kind) {
      return this.events.find((event) => event.event === kind)?.time;
    }

    apply(event) {
      if (event.ball !== undefined) {
        this.balls[event.ball] = {
          x: event.ball_x,
          y: event.ball_y,
          vx: event.ball_vx,
          vy: event.ball_vy,
          energy: event.ball_energy,
          time: event.time,
        };
      }
      if (event.piston !== undefined) {
        const {vertical} = this.pistons[event.piston];
        this.pistons[event.piston] = {
          x: event.piston_x,
          y: event.piston_y,
          vx: event.piston_vx,
          vy: event.piston_vy,
          energy: event.piston_energy,
          time: event.time,
          vertical,
        };
      }
    }

    ballsNow() {
      return this.balls.map((ball) => ({...ball, ...place(ball, this.time)}));
    }

    pistonsNow() {
      return this.pistons.map((piston) => ({...piston, ...place(piston, this.time)}));
    }
  }

  ballpiston.OrbitMotion = OrbitMotion;
})((globalThis.ballpiston ??= {}));
