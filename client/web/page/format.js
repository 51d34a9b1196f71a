// Numbers with their errors, times and names as text.
(function (ballpiston) {
  'use strict';

  const SYMBOLS = {
    rho: 'ρ',
    delta: 'δ',
    epsilon: 'ε',
    exponent: 'n',
    cells: 'cells',
    temperature: 'T',
    hot: 'T hot',
    cold: 'T cold',
  };
  const ERROR_DIGITS = 2;
  const DIGITS = 6; // without an error
  const EXACT_DIGITS = 12;
  const MOST_PLAIN = 1e12; // larger numbers have the exponential form
  const ROUNDING = 5e-13; // an error below this share of the value is that of rounding

  const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);

  // The number of decimal places with which `error` has ERROR_DIGITS digits.
  function decimals(error) {
    return ERROR_DIGITS - 1 - Math.floor(Math.log10(error));
  }

  function isPlain(value, places) {
    return Math.abs(value) < 1e7 && places >= 0 && places <= 9;
  }

  function isExact(value, error) {
    return isNumber(error) && error >= 0 && error < ROUNDING * Math.abs(value);
  }

  function shortText(value, digits) {
    const rounded = Number(value.toPrecision(digits));
    return Math.abs(rounded) < MOST_PLAIN ? String(rounded) : rounded.toExponential();
  }

  // As many digits as the error permits.
  function valueText(value, error) {
    if (!isNumber(value)) return '';
    if (isExact(value, error)) return shortText(value, EXACT_DIGITS);
    if (!(error > 0)) return shortText(value, DIGITS);
    const places = decimals(error);
    if (isPlain(value, places)) return value.toFixed(places);
    const digits = value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value))) + places;
    return value.toExponential(Math.min(Math.max(digits, 0), 15));
  }

  function errorText(value, error) {
    if (!isNumber(error) || isExact(value, error)) return '';
    if (error === 0) return '0';
    const places = decimals(error);
    return isPlain(error, places) ? error.toFixed(places) : error.toExponential(ERROR_DIGITS - 1);
  }

  function withError(value, error) {
    return [valueText(value, error), errorText(value, error)].filter(Boolean).join(' ± ');
  }

  function signedText(value, places = 2) {
    return isNumber(value) ? (value < 0 ? '-' : '+') + Math.abs(value).toFixed(places) : '';
  }

  const COUNT_FORMAT = new Intl.NumberFormat('en', {maximumFractionDigits: 0});

  // 1234567: 1,234,567
  function countText(count) {
    return COUNT_FORMAT.format(Number(count));
  }

  function bytesText(bytes) {
    const units = ['bytes', 'kB', 'MB', 'GB', 'TB'];
    let i = 0;
    for (; bytes >= 1000 && i < units.length - 1; ++i) bytes /= 1000;
    return `${Number(bytes.toPrecision(3))} ${units[i]}`;
  }

  function durationText(seconds) {
    if (seconds < 1) return `${Math.round(1000 * seconds)} ms`;
    if (seconds < 60) return `${Number(seconds.toPrecision(2))} s`;
    if (seconds < 3600) return `${Number((seconds / 60).toPrecision(2))} min`;
    if (seconds < 86400) return `${Number((seconds / 3600).toPrecision(2))} h`;
    return `${Number((seconds / 86400).toPrecision(3))} days`;
  }

  // The time since `date`.
  function ageText(date, now = Date.now()) {
    const age = (now - date) / 1000;
    if (Math.abs(age) < 2) return 'now';
    return age > 0 ? `${durationText(Math.floor(age))} ago` : `in ${durationText(-age)}`;
  }

  // A <time> element with the time since then. Its title is the full date and time.
  function timeElement(time) {
    if (!time) return null;
    const date = new Date(time);
    return ballpiston.element('time', {datetime: time, title: wholeTime(time)}, ageText(date));
  }

  // Made once: a new formatter for each time would take longer than the rest of a long list.
  const TIME_FORMAT = new Intl.DateTimeFormat('en-GB', {dateStyle: 'medium', timeStyle: 'long'});

  const wholeTime = (time) => (time ? TIME_FORMAT.format(new Date(time)) : '');

  // CONDITIONAL_MEAN_FREE_TIME becomes "conditional mean free time".
  const words = (name) =>
    String(name ?? '')
      .toLowerCase()
      .replaceAll('_', ' ');

  const symbolOf = (parameter) => SYMBOLS[parameter] ?? parameter;

  // The parameters that the point has, in the order of SYMBOLS.
  function parameterPairs(parameters) {
    return Object.keys(SYMBOLS)
      .filter((name) => parameters?.[name] !== undefined)
      .map((name) => [name, parameters[name]]);
  }

  // With all digits, so that different values have different texts.
  const pairsText = (pairs) =>
    pairs.map(([name, value]) => `${symbolOf(name)} = ${value}`).join(', ');
  const parametersText = (parameters) => pairsText(parameterPairs(parameters));

  const estimateOf = (point, name) => point.estimates.find((estimate) => estimate.name === name);

  // 'measured', or the model that computed the values.
  const sourceOf = (point) => (point.samples > 0 ? 'measured' : words(point.model));

  // The text as one word of a POSIX shell.
  function shellWord(text) {
    return /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
  }

  Object.assign(ballpiston, {isNumber, valueText, errorText, withError, signedText, countText});
  Object.assign(ballpiston, {bytesText, durationText, ageText, timeElement, wholeTime});
  Object.assign(ballpiston, {words, symbolOf, parameterPairs, pairsText, parametersText});
  Object.assign(ballpiston, {estimateOf, sourceOf, shellWord});
})((globalThis.ballpiston ??= {}));
