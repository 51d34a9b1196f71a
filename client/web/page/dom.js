// Makes elements of the page from text. Strings become text nodes and are never parsed as HTML.
(function (ballpiston) {
  'use strict';

  // A function as an attribute's value is a listener: {onclick: f}. An attribute with the value
  // false, null or undefined is left out; the value true makes an empty attribute.
  function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (typeof value === 'function') {
        made.addEventListener(name.slice(2), value);
      } else if (value !== false && value !== null && value !== undefined) {
        made.setAttribute(name, value === true ? '' : String(value));
      }
    }
    made.append(...children.flat().filter((child) => child !== null && child !== undefined));
    return made;
  }

  function button(text, onclick, attributes = {}) {
    return element('button', {type: 'button', onclick, ...attributes}, text);
  }

  // Columns of a table.
  const textColumns = (...labels) => labels.map((label) => ({label, number: false}));
  const numberColumns = (...labels) => labels.map((label) => ({label, number: true}));

  // Roles are explicit, because the style sheet displays rows as grids: some browsers then drop the
  // implied roles.
  // `columns`: of textColumns() and numberColumns(); `rows`: arrays of texts or nodes.
  function table(caption, columns, rows, attributes = {}) {
    const body = element('tbody', {role: 'rowgroup'});
    body.append(...rows.map((cells) => tableRow(columns, cells)));
    const heads = columns.map(({label, number}) =>
      element('th', {role: 'columnheader', scope: 'col', class: number && 'number'}, label),
    );
    return element(
      'table',
      {role: 'table', ...attributes},
      element('caption', {}, caption),
      element('thead', {role: 'rowgroup'}, element('tr', {role: 'row'}, heads)),
      body,
    );
  }

  // On narrow screens a row is a card, and each cell shows its column's label.
  function tableRow(columns, cells) {
    const parts = cells.map((cell, i) => {
      const {label, number} = columns[i];
      return element('td', {role: 'cell', 'data-label': label, class: number && 'number'}, cell);
    });
    return element('tr', {role: 'row'}, parts);
  }

  // The rows of a table that changes. Each row has a key.
  class LiveRows {
    constructor(table, columns) {
      Object.assign(this, {columns, body: table.querySelector('tbody'), rows: new Map()});
    }

    // Returns the row of the key. If the text `seen` has changed since the last call, replaces the
    // row and keeps the focus; `makeCells` returns the cells. Inserts a new row before the node
    // `next`.
    put(key, seen, makeCells, next) {
      const known = this.rows.get(key);
      if (known?.seen === seen) return known.row;
      const row = tableRow(this.columns, makeCells());
      const hadFocus = known?.row.contains(document.activeElement);
      if (known) known.row.replaceWith(row);
      else this.body.insertBefore(row, next);
      if (hadFocus) row.querySelector('a, button').focus();
      this.rows.set(key, {row, seen});
      return row;
    }

    remove(key) {
      this.rows.get(key).row.remove();
      this.rows.delete(key);
    }
  }

  // `pairs`: [[term, text or node], ...]. A term without text is left out.
  function facts(pairs) {
    const list = element('dl', {class: 'facts'});
    for (const [term, text] of pairs) {
      if (text === null || text === undefined || text === '') continue;
      list.append(element('div', {}, element('dt', {}, term), element('dd', {}, text)));
    }
    return list;
  }

  // A drop-down list with a label. `options`: [{value, label}].
  function choice(label, options, chosen, onChoose) {
    const select = element(
      'select',
      {onchange: () => onChoose(select.value)},
      options.map((option) =>
        element('option', {value: option.value, selected: option.value === chosen}, option.label),
      ),
    );
    return element('label', {class: 'choice'}, element('span', {}, label), select);
  }

  Object.assign(ballpiston, {element, button, facts, choice});
  Object.assign(ballpiston, {textColumns, numberColumns, table, LiveRows});
})((globalThis.ballpiston ??= {}));
