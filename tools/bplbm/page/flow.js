// The frames of the flow under their particles and bonds, by a slider, and speed, pressure or viscosity by a button.
(() => {
  const frames = JSON.parse(document.getElementById('flow-data').textContent).frames;
  const box = document.getElementById('flow'), image = box.querySelector('img'), drawing = box.querySelector('svg');
  const slider = document.getElementById('flow-slide'), play = document.getElementById('flow-play');
  const bondColors = ['#2f8f4e', '#d62728', '#1f77b4'];
  let kind = 'speed', timer = 0;

  const circles = p => Array.from({length: p.length / 3}, (_, i) =>
    `<circle cx="${p[3 * i]}" cy="${p[3 * i + 1]}" r="${p[3 * i + 2]}"/>`).join('');
  const lines = b => Array.from({length: b.length / 5}, (_, i) => {
    const [x, y, u, v, state] = b.slice(5 * i, 5 * i + 5);
    return `<path d="M${x} ${y}L${u} ${v}" stroke="${bondColors[state]}" stroke-width="${state ? 4 : 2.5}"/>`;
  }).join('');

  function show() {
    const frame = frames[slider.value];
    image.src = frame[kind];
    drawing.innerHTML = `<g fill="#f4e3c1" stroke="#222" stroke-width="1.2">${circles(frame.p)}</g>${lines(frame.b)}`;
    document.getElementById('flow-time').textContent = `t = ${frame.t} s`;
  }
  function next() {
    slider.value = (+slider.value + 1) % frames.length;
    show();
  }
  slider.oninput = show;
  play.onclick = () => {
    clearInterval(timer);
    timer = timer ? 0 : setInterval(next, Math.max(80, 4000 / frames.length));
    play.textContent = timer ? 'pause' : 'play';
  };
  for (const button of document.querySelectorAll('[data-kind]')) {
    button.onclick = () => {
      kind = button.dataset.kind;
      for (const bar of document.querySelectorAll('[data-bar]')) bar.hidden = bar.dataset.bar !== kind;
      show();
    };
  }
  show();
})();
