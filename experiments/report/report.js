'use strict';
// Draws each figure's panels, and lets one legend show and hide a curve in all of them.
const touch = matchMedia('(pointer: coarse)').matches;
const config = {
  responsive: true, displaylogo: false, scrollZoom: false,
  modeBarButtons: [['zoom2d', 'pan2d', 'resetScale2d', 'toImage']],
};
const ink = '#1b1f24', rule = '#d9dee3';

const axis = (spec) => ({
  ...spec, title: { text: spec.title.text, standoff: 8, font: { size: 13 } }, automargin: true, linecolor: ink, ticks: 'outside', ticklen: 4,
  gridcolor: rule, zeroline: false, ...(spec.type === 'log' && !spec.tickvals ? { dtick: Math.ceil((spec.range[1] - spec.range[0]) / 6), exponentformat: 'power' } : {}),
});

const layout = (spec) => ({
  ...spec, xaxis: axis(spec.xaxis), yaxis: axis(spec.yaxis), showlegend: false, height: 300,
  margin: { l: 50, r: 12, t: 28, b: 44 }, paper_bgcolor: '#fff', plot_bgcolor: '#fff',
  font: { family: 'system-ui, "DejaVu Sans", sans-serif', size: 13, color: ink },
  hoverlabel: { font: { size: 12 } }, dragmode: touch ? false : 'zoom', modebar: { orientation: 'h' },
});

const draw = (figure) => {
  const specs = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
  const boxes = [...figure.querySelectorAll('.panel')];
  const drawn = boxes.map((box, i) => Plotly.newPlot(box, specs[i].data, layout(specs[i].layout), config));
  figure.querySelectorAll('.legend button').forEach((button) => button.addEventListener('click', () => {
    const shown = button.getAttribute('aria-pressed') !== 'true';
    button.setAttribute('aria-pressed', String(shown));
    boxes.forEach((box) => {
      const own = box.data.flatMap((trace, i) => trace.meta.group === button.dataset.group ? [i] : []);
      if (own.length) Plotly.restyle(box, { visible: shown }, own);
    });
  }));
  return Promise.all(drawn);
};

const figures = [...document.querySelectorAll('figure.interactive')];
Promise.all(figures.map(draw)).then(() => { document.documentElement.dataset.drawn = figures.length; });

const panels = () => document.querySelectorAll('figure.interactive .panel');
addEventListener('beforeprint', () => {
  document.querySelectorAll('details:not(.long)').forEach((d) => { if (!d.open) { d.open = true; d.dataset.closed = ''; } });
  panels().forEach((box) => Plotly.relayout(box, { autosize: false, width: 330, height: 280 }));
});
addEventListener('afterprint', () => {
  document.querySelectorAll('details[data-closed]').forEach((d) => { d.open = false; delete d.dataset.closed; });
  panels().forEach((box) => Plotly.relayout(box, { autosize: true, width: null, height: 300 }));
});

const reveal = () => {
  const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  const folded = target && target.closest('details');
  if (folded) { folded.open = true; target.scrollIntoView(); }
};
addEventListener('hashchange', reveal);
reveal();
