'use strict';
// Adds to a page that can be read without it: the table of all vehicles (sorting, filter, CSV), the curves of one
// vehicle, and zoom in the maps.
(() => {
  const element = (name, attributes = {}, ...children) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };
  const byId = (id) => document.getElementById(id);

  // ---- the table of vehicles ----
  const PAGE = 50;
  const holder = byId('data');
  const data = holder ? JSON.parse(holder.textContent) : null;

  // The value of a column in a row: a number, a text, or null.
  const valueOf = (column, row) => {
    const value = column.values[row];
    if (value === null || value === undefined) return null;
    if (column.words) return column.words[value];
    return column.decimals === undefined ? value : value / 10 ** column.decimals;
  };
  const shown = (value) => (value === null ? '–' : String(value));

  function vehicles() {
    const table = byId('vehicles-table');
    if (!table || !data) return null;
    const { columns } = data;
    const body = table.tBodies[0];
    const heads = [...table.tHead.rows[0].cells];
    const all = columns.length ? [...columns[0].values.keys()] : [];
    const idColumn = columns.find((column) => column.name === 'id');
    const runColumn = columns.find((column) => column.name === 'run');
    const errors = columns.findIndex((column) => column.name === 'error_rms');
    let [sorted, descending] = errors >= 0 ? [errors, true] : [0, false];
    let rows = all;
    let first = 0;
    let selected = null;

    const compare = (column) => (a, b) => {
      const [x, y] = [valueOf(column, a), valueOf(column, b)];
      // What has no value comes last, whatever the direction.
      if (x === null || y === null) return (x === null) - (y === null) || a - b;
      const order = typeof x === 'number' ? x - y : x < y ? -1 : x > y ? 1 : 0;
      return (descending ? -order : order) || a - b;
    };

    // Words that some text of the row holds, and conditions such as error_rms>0.1; all of them must hold.
    const conditions = (text) => text.trim().split(/\s+/).filter(Boolean).map((word) => {
      const [, name, sign, limit] = /^(\w+)(>=|<=|>|<|=)(.+)$/.exec(word) ?? [];
      const column = columns.find((known) => known.name === name);
      if (column) {
        const number = Number(limit);
        return (row) => {
          const value = valueOf(column, row);
          if (value === null) return false;
          if (sign === '=') return String(value) === limit || value === number;
          return { '>': value > number, '<': value < number, '>=': value >= number, '<=': value <= number }[sign];
        };
      }
      const wanted = word.toLowerCase();
      const texts = columns.filter((known) => known.decimals === undefined);
      return (row) => texts.some((known) => String(valueOf(known, row)).toLowerCase().includes(wanted));
    });

    function draw() {
      first = Math.max(0, Math.min(first, Math.floor((rows.length - 1) / PAGE) * PAGE));
      const slice = rows.slice(first, first + PAGE);
      body.replaceChildren(...slice.map((row) => {
        const cells = columns.map((column) => {
          return element('td', column.decimals === undefined ? { class: 'text' } : {}, shown(valueOf(column, row)));
        });
        const line = element('tr', { class: row === selected ? 'selectable selected' : 'selectable' }, ...cells);
        line.addEventListener('click', () => select(row));
        return line;
      }));
      heads.forEach((head, index) => {
        head.setAttribute('aria-sort', index === sorted ? (descending ? 'descending' : 'ascending') : 'none');
      });
      const of = data.shown < data.all ? ` (of ${data.all} in the run)` : '';
      byId('count').textContent = `${rows.length} of ${all.length} vehicles${of}`;
      byId('place').textContent = rows.length ? `${first + 1}–${Math.min(first + PAGE, rows.length)}` : 'none';
      byId('before').disabled = first === 0;
      byId('after').disabled = first + PAGE >= rows.length;
    }

    function update() {
      const tests = conditions(byId('filter').value);
      rows = all.filter((row) => tests.every((test) => test(row))).sort(compare(columns[sorted]));
      first = 0;
      draw();
    }

    function select(row) {
      const id = valueOf(idColumn, row);
      const run = runColumn ? valueOf(runColumn, row) : '';
      selected = row;
      const hash = '#veh=' + encodeURIComponent(id) + (run ? '&run=' + run : '');
      if (location.hash !== hash) history.replaceState(null, '', hash);
      draw();
      panel(id, run, row);
    }

    // The vehicle that the address names.
    function follow() {
      const found = /^#veh=([^&]*)(?:&run=(.*))?$/.exec(location.hash);
      if (!found && data.selected === null) return;
      let id = data.selected;
      try { if (found) id = decodeURIComponent(found[1]); } catch { return; }
      const run = found?.[2];
      const row = all.find((at) => String(valueOf(idColumn, at)) === id && (!run || valueOf(runColumn, at) === run));
      if (row !== undefined) {
        first = Math.floor(rows.indexOf(row) / PAGE) * PAGE;
        select(row);
        byId('panel').scrollIntoView({ block: 'start' });
      } else if (found) {
        notFound(id);
      }
    }

    function csv() {
      const quoted = (value) => {
        const text = value === null ? '' : String(value);
        return /[",\n\r]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
      };
      const lines = [columns.map((column) => quoted(column.name)), ...rows.map((row) => columns.map((column) => quoted(valueOf(column, row))))];
      const text = lines.map((line) => line.join(',')).join('\n') + '\n';
      const link = element('a', { download: 'vehicles-shown.csv', href: URL.createObjectURL(new Blob([text], { type: 'text/csv' })) });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
      return text;
    }

    heads.forEach((head, index) => {
      const sort = () => {
        [sorted, descending] = [index, index === sorted ? !descending : columns[index].decimals !== undefined];
        update();
      };
      head.classList.add('sortable');
      head.tabIndex = 0;
      head.addEventListener('click', sort);
      head.addEventListener('keydown', (event) => {
        if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); sort(); }
      });
    });
    let waiting;
    byId('filter').addEventListener('input', () => { clearTimeout(waiting); waiting = setTimeout(update, 120); });
    byId('csv').addEventListener('click', csv);
    byId('before').addEventListener('click', () => { first -= PAGE; draw(); });
    byId('after').addEventListener('click', () => { first += PAGE; draw(); });
    table.caption?.replaceChildren('Click a header to sort, a row for its curves. Hold the pointer over a header to read what the column means. Numbers are rounded to about four digits; the files beside the page have them all.');
    byId('tools').hidden = false;
    update();
    follow();
    addEventListener('hashchange', follow);
    return { csv };
  }

  // ---- one vehicle ----
  const HUES = [['#1765ad', '#5fb0f5'], ['#d1610a', '#ff9d4d'], ['#2e8540', '#63c97c'], ['#a02c8c', '#f08ad8']];
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  let redraw = null;

  function opened(title) {
    const box = byId('panel');
    const close = element('button', { class: 'close', type: 'button' }, 'Close');
    close.addEventListener('click', () => {
      box.hidden = true;
      redraw = null;
      history.replaceState(null, '', location.pathname + location.search);
    });
    box.replaceChildren(close, element('h3', {}, title));
    box.hidden = false;
    return box;
  }

  function notFound(id) {
    const why = data.shown < data.all ? ' The page holds a part of the vehicles: sumo-mfc report DIR --vehicle ID puts one in.' : '';
    opened(`Vehicle ${id}`).append(element('p', {}, 'It is not in the table of this page.' + why));
  }

  function panel(id, run, row) {
    const box = opened(`Vehicle ${id}${run ? ', ' + run : ''}`);
    const facts = element('dl', { class: 'facts' });
    for (const column of data.columns) {
      const text = shown(valueOf(column, row)) + (column.unit ? ' ' + column.unit : '');
      facts.append(element('div', { title: column.meaning }, element('dt', {}, column.name), element('dd', {}, text)));
    }
    const found = data.series.filter((series) => series.id === id && series.run === run);
    const series = found.find((one) => one.source === 'trace') ?? found[0];
    const curves = element('div', { class: 'curves' });
    if (series) {
      box.append(element('p', { class: 'soft' }, `Curves from the ${series.source}. Drag to zoom, double-click to see all.`), curves);
      redraw = () => drawCurves(curves, series);
      redraw();
    } else {
      redraw = null;
      box.append(element('p', { class: 'soft' }, 'No curves: the vehicle is neither traced (run --trace ID) nor in the sample, or this page leaves its curves out for their size; sumo-mfc report DIR --vehicle ID puts them in.'));
    }
    box.append(element('details', {}, element('summary', {}, 'All columns'), facts));
  }

  function drawCurves(box, series) {
    box.replaceChildren();
    const [time, ...columns] = series.columns;
    const values = (column) => column.values.map((_, row) => valueOf(column, row));
    const times = values(time);
    const groups = new Map();
    for (const column of columns) {
      // Differences are small beside what they are differences of.
      const key = column.name.includes(' − ') ? column.name : column.unit || column.name;
      groups.set(key, [...(groups.get(key) ?? []), column]);
    }
    // All places first: how wide one is depends on how many there are.
    const places = [...groups.values()].map((group) => [group, box.appendChild(element('div'))]);
    for (const [group, place] of places) {
      const axis = { stroke: colour('--soft'), grid: { stroke: colour('--line'), width: 1 }, ticks: { stroke: colour('--line') } };
      const line = (column, index) => ({
        label: column.name + (column.unit ? ` [${column.unit}]` : ''),
        stroke: HUES[index % HUES.length][dark.matches ? 1 : 0],
        width: 1.6,
        dash: column.name === 'target' ? [6, 4] : undefined,
      });
      new uPlot({
        width: Math.max(260, Math.floor(place.clientWidth)),
        height: 220,
        scales: { x: { time: false } },
        axes: [{ ...axis }, { ...axis, size: 62 }],
        series: [{ label: 'time [s]' }, ...group.map(line)],
      }, [times, ...group.map(values)], place);
    }
  }
  dark.addEventListener('change', () => redraw?.());
  let resized;
  addEventListener('resize', () => { clearTimeout(resized); resized = setTimeout(() => redraw?.(), 200); });

  // ---- maps ----
  for (const figure of document.querySelectorAll('figure.zoom')) {
    const map = figure.querySelector('svg.map');
    if (!map) continue;
    const whole = map.getAttribute('viewBox').split(' ').map(Number);
    let view = [...whole];
    const dots = [...map.querySelectorAll('.event')];
    const show = () => {
      map.setAttribute('viewBox', view.join(' '));
      // Dots keep their size on the screen.
      dots.forEach((dot) => dot.setAttribute('r', 5 * view[2] / whole[2]));
    };
    // A point of the screen as shares of the map.
    const share = (event) => {
      const box = map.getBoundingClientRect();
      return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    };
    const zoom = (factor, [x, y] = [0.5, 0.5]) => {
      const width = Math.min(whole[2], Math.max(whole[2] / 200, view[2] * factor));
      const height = width * whole[3] / whole[2];
      view = [view[0] + x * (view[2] - width), view[1] + y * (view[3] - height), width, height];
      show();
    };
    const buttons = element('div', { class: 'buttons' });
    for (const [text, title, action] of [['+', 'closer', () => zoom(0.6)], ['−', 'farther', () => zoom(1 / 0.6)], ['⟲', 'whole network', () => { view = [...whole]; show(); }]]) {
      const button = element('button', { type: 'button', title }, text);
      button.addEventListener('click', action);
      buttons.append(button);
    }
    figure.querySelector('.drawing').append(buttons);
    // The wheel scrolls the page; with Ctrl, or a pinch on a touchpad, it zooms.
    map.addEventListener('wheel', (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      zoom(event.deltaY > 0 ? 1.15 : 1 / 1.15, share(event));
    }, { passive: false });
    let from = null;
    map.addEventListener('pointerdown', (event) => { from = [event.clientX, event.clientY, ...view]; map.setPointerCapture(event.pointerId); });
    map.addEventListener('pointermove', (event) => {
      if (!from) return;
      const box = map.getBoundingClientRect();
      view[0] = from[2] - (event.clientX - from[0]) / box.width * view[2];
      view[1] = from[3] - (event.clientY - from[1]) / box.height * view[3];
      show();
    });
    for (const name of ['pointerup', 'pointercancel']) map.addEventListener(name, () => { from = null; });
    map.addEventListener('dblclick', (event) => zoom(0.5, share(event)));
  }

  window.report = vehicles();
})();
