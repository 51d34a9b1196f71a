// Calls and streams in the Connect protocol (connectrpc.com/docs/protocol), in JSON, to the gateway
// that served this page.
(function (ballpiston) {
  'use strict';

  const PACKAGE = '/ballpiston.v1.';
  const HEADER_BYTES = 5; // of an envelope: flags, and the length as 4 bytes, big-endian
  const LAST = 2; // the flag of the last envelope: {} or {"error": {...}}
  const FINAL = new Set([
    'unauthenticated',
    'permission_denied',
    'not_found',
    'invalid_argument',
    'failed_precondition',
    'out_of_range',
    'unimplemented',
    'data_loss',
  ]);

  // `code` is an error code of the protocol, such as not_found; `reason` a word of the server, such
  // as JOB_NOT_FOUND. `isFinal`: a retry gives the same error.
  class CallError extends Error {
    constructor(code, message, reason) {
      super(message || code);
      this.code = code;
      this.isFinal = FINAL.has(code) || reason === 'TOO_MANY_POINTS';
    }
  }

  function errorOf(json, code) {
    const reason = json?.details?.find(({debug}) => debug?.reason)?.debug.reason;
    return new CallError(json?.code ?? code, json?.message, reason);
  }

  const unavailable = (message) => new CallError('unavailable', message);
  const cutOff = () => unavailable('the answer ended too early');

  async function post(method, type, body, signal) {
    const token = ballpiston.token();
    let response;
    try {
      response = await fetch(PACKAGE + method, {
        method: 'POST',
        body,
        signal,
        cache: 'no-store',
        headers: {'Content-Type': type, ...(token && {Authorization: `Bearer ${token}`})},
      });
    } catch (error) {
      if (signal?.aborted) throw error;
      throw unavailable(`no answer from ${location.host}: ballpiston web no longer runs there`);
    }
    if (response.ok) return response;
    const error = await response.json().catch(() => null);
    // An answer without JSON is incomplete, or is not from the gateway.
    const code = response.status < 500 ? 'invalid_argument' : 'unknown';
    throw errorOf(error ?? {message: `HTTP status ${response.status}`}, code);
  }

  // `method` is SERVICE/METHOD, for instance EnsembleService/GetEnsembleJob.
  async function call(method, request, signal) {
    const response = await post(method, 'application/json', JSON.stringify(request), signal);
    try {
      return await response.json();
    } catch (error) {
      if (signal?.aborted) throw error;
      throw cutOff();
    }
  }

  function envelope(message) {
    const text = new TextEncoder().encode(JSON.stringify(message));
    const bytes = new Uint8Array(HEADER_BYTES + text.length);
    new DataView(bytes.buffer).setUint32(1, text.length);
    bytes.set(text, HEADER_BYTES);
    return bytes;
  }

  // A function that reads a requested number of bytes from a stream.
  function bytesOf(reader) {
    let known = new Uint8Array();
    return async (count) => {
      while (known.length < count) {
        const {value, done} = await reader.read();
        if (done) throw cutOff();
        const longer = new Uint8Array(known.length + value.length);
        longer.set(known);
        longer.set(value, known.length);
        known = longer;
      }
      const taken = known.slice(0, count);
      known = known.subarray(count);
      return taken;
    };
  }

  // The messages of a stream. Reads only as fast as the caller uses them. The server then also
  // computes only at this speed.
  async function* stream(method, request, signal) {
    const response = await post(method, 'application/connect+json', envelope(request), signal);
    const reader = response.body.getReader();
    try {
      const take = bytesOf(reader);
      for (;;) {
        const header = await take(HEADER_BYTES);
        const text = await take(new DataView(header.buffer).getUint32(1));
        const message = JSON.parse(new TextDecoder().decode(text));
        const isLast = header[0] & LAST;
        if (isLast && message.error) throw errorOf(message.error, 'unknown');
        if (isLast) return;
        yield message;
      }
    } catch (error) {
      if (signal?.aborted || error instanceof CallError) throw error;
      throw cutOff();
    } finally {
      reader.cancel().catch(() => {});
    }
  }

  Object.assign(ballpiston, {CallError, call, stream});
})((globalThis.ballpiston ??= {}));
