"use strict";
// The sample: grains by subdomain, boundary grains outlined, a line for each contact as wide as its impulse, in another colour and
// broken where it slides.
(() => {
  const { colors, samples } = JSON.parse(document.getElementById("samples").textContent);
  const form = document.querySelector(".controls"), stage = document.querySelector(".stage");
  const { problem: problemBox, partition: partitionBox, time, play } = form.elements;
  const now = form.querySelector("output");
  let sample, stops, panels, timer;
  // How far spheres are turned about the vertical, and towards who looks.
  let yaw = .5, pitch = .3;

  const options = (box, names) => box.replaceChildren(...names.map((name, i) => new Option(name, i)));
  const short = value => value == null ? "–" : value.toExponential(1);

  function choose() {
    sample = samples[problemBox.value || 0];
    options(partitionBox, sample.partitions.map(split => split.name));
    partitionBox.value = sample.partitions.length - 1;
    const iterations = sample.tracks.flatMap(track => track.frames.map(frame => frame.iteration));
    stops = [...new Set(iterations)].sort((a, b) => a - b);
    if (!stops.length) stops = [0];
    time.max = stops.length - 1;
    time.value = apart(sample.tracks.filter(track => track.frames.length > 1));
    // The solution alone has no iterations.
    form.querySelector(".player").hidden = stops.length < 2;
    // Without any impulse the sample alone is shown.
    const tracks = sample.tracks.length ? sample.tracks : [{ label: "no impulse is known", ending: "", frames: [] }];
    panels = tracks.map(track => {
      const figure = document.createElement("figure"), canvas = document.createElement("canvas");
      const caption = document.createElement("figcaption");
      canvas.setAttribute("role", "img");
      figure.append(canvas, caption);
      return { track, figure, canvas, caption };
    });
    stage.replaceChildren(...panels.map(panel => panel.figure));
    draw();
  }

  // The first of the stops at which the natural maps of the tracks are furthest apart: at the end all look alike.
  function apart(tracks) {
    const at = (track, stop) => track.frames.findLast(frame => frame.iteration <= stop) ?? track.frames[0];
    const spread = stop => {
      const maps = tracks.map(track => at(track, stop).natural_map).filter(map => map > 0).map(Math.log);
      return maps.length > 1 ? Math.max(...maps) - Math.min(...maps) : 0;
    };
    const spreads = stops.map(spread), most = Math.max(...spreads);
    return most > 0 ? spreads.indexOf(most) : stops.length - 1;
  }

  const inSpace = () => sample.grains[0]?.length > 3;

  // The grains as [x, y, r, index] in the order in which they are painted, and the contacts as [x, y, x, y]: in the plane as they
  // are, in space as they are seen from afar, the nearest last.
  function seen() {
    if (!inSpace()) return { grains: sample.grains.map(([x, y, r], i) => [x, y, r, i]), contacts: sample.contacts };
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const turned = (x, y, z) => {
      const towards = cy * z - sy * x;
      return [cy * x + sy * z, cp * y - sp * towards, sp * y + cp * towards];
    };
    const grains = sample.grains.map(([x, y, r, z], i) => { const [u, v, near] = turned(x, y, z); return [u, v, r, i, near]; });
    const contacts = sample.contacts.map(([x0, y0, x1, y1, z0, z1]) =>
      [...turned(x0, y0, z0).slice(0, 2), ...turned(x1, y1, z1).slice(0, 2)]);
    return { grains: grains.sort((a, b) => a[4] - b[4]), contacts };
  }

  // The box around grains, in the units of the sample.
  function bounds(grains) {
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const [x, y, r] of grains) {
      left = Math.min(left, x - r); right = Math.max(right, x + r);
      low = Math.min(low, y - r); high = Math.max(high, y + r);
    }
    return grains.length ? { left, low, width: right - left, height: high - low } : { left: 0, low: 0, width: 1, height: 1 };
  }

  function draw() {
    const style = getComputedStyle(document.documentElement), ink = name => style.getPropertyValue(name).trim();
    const split = sample.partitions[partitionBox.value || 0], iteration = stops[time.value] ?? 0;
    const { grains, contacts } = seen(), box = bounds(grains), radii = sample.grains.map(grain => grain[2]).sort((a, b) => a - b);
    const median = radii[radii.length >> 1] || 1;
    now.textContent = stops.length > 1 ? `iteration ${iteration}` : "";
    for (const { track, canvas, caption } of panels) {
      const frame = track.frames.findLast(frame => frame.iteration <= iteration) ?? track.frames[0];
      const width = canvas.clientWidth || 320, ratio = window.devicePixelRatio || 1;
      // A column of grains must not be higher than the window.
      const scale = Math.min((width - 8) / box.width, .75 * Math.max(window.innerHeight, 400) / box.height);
      const height = Math.ceil(box.height * scale) + 8, edge = (width - box.width * scale) / 2;
      canvas.width = width * ratio; canvas.height = height * ratio;
      const c = canvas.getContext("2d");
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      const X = x => edge + (x - box.left) * scale, Y = y => height - 4 - (y - box.low) * scale;
      const disc = ([x, y, r]) => { c.beginPath(); c.arc(X(x), Y(y), r * scale, 0, 7); };
      grains.forEach(grain => {
        const fill = split.fill[grain[3]];
        disc(grain);
        c.globalAlpha = fill == null ? 1 : Number(ink("--fill"));
        c.fillStyle = fill == null ? ink("--idle") : colors[fill];
        c.fill();
        // In space what is behind shows no outline of its own through what is before.
        const outlined = inSpace() && split.multiplicity[grain[3]] > 1;
        c.globalAlpha = 1; c.lineWidth = outlined ? 1.4 : .5; c.strokeStyle = ink(outlined ? "--boundary" : "--outline"); c.stroke();
      });
      c.strokeStyle = ink("--boundary"); c.lineWidth = 1.4;
      if (!inSpace()) grains.forEach(grain => { if (split.multiplicity[grain[3]] > 1) { disc(grain); c.stroke(); } });
      // A spoke is upright where nothing spins, and lies down at the greatest spin.
      c.strokeStyle = ink("--outline"); c.lineWidth = 1;
      if (frame?.spins.length) grains.forEach(([x, y, r, i]) => {
        const angle = Math.PI / 2 * (1 + frame.spins[i] / 1000);
        c.beginPath(); c.moveTo(X(x), Y(y)); c.lineTo(X(x + r * Math.cos(angle)), Y(y + r * Math.sin(angle))); c.stroke();
      });
      const line = ([x0, y0, x1, y1]) => { c.beginPath(); c.moveTo(X(x0), Y(y0)); c.lineTo(X(x1), Y(y1)); c.stroke(); };
      c.lineWidth = 2; c.strokeStyle = ink("--boundary");
      sample.walls.forEach(line);
      // The greatest impulse of the solution is almost as wide as a grain, if that is small; what is beyond is cut at twice that.
      // In space many lie behind one another: they are thinner, and the weakest are left out.
      const widest = Math.min(Math.max((inSpace() ? .7 : 1.8) * median * scale, 1.5), 12), least = inSpace() ? 60 : 0;
      const sliding = new Set(frame?.sliding), sticks = ink("--chain"), slips = ink("--sliding");
      frame?.impulses.forEach((share, i) => {
        c.lineWidth = widest * Math.min(share / 1000, 2);
        if (c.lineWidth <= .08 || share <= least) return;
        const slides = sliding.has(i), [x0, y0, x1, y1] = contacts[i];
        c.strokeStyle = slides ? slips : sticks;
        c.lineCap = slides ? "butt" : "round";
        c.setLineDash(slides ? [Math.hypot(x1 - x0, y1 - y0) * scale / 5] : []);
        line(contacts[i]);
      });
      c.setLineDash([]);
      const over = frame && frame.iteration === track.frames.at(-1).iteration && track.ending;
      caption.textContent = !frame || !track.ending ? track.label
        : `${track.label}: iteration ${frame.iteration}, natural map ${short(frame.natural_map)}`
          + `${sliding.size ? `, ${sliding.size} contacts slide` : ""}${over ? `, ${track.ending}` : ""}`;
      canvas.setAttribute("aria-label", `${sample.problem}, ${split.name}. ${caption.textContent}`);
    }
    const boundary = split ? split.multiplicity.filter(copies => copies > 1).length : 0;
    document.querySelector("[data-key]").textContent = `${sample.grains.length} grains, ${sample.contacts.length} contacts; `
      + `colours are subdomains, outlined: ${boundary} boundary grains; the widest line is ${Number(sample.greatest_n_s.toPrecision(2))} N·s, `
      + `the greatest impulse of the solution.${panels.some(({ track }) => track.frames.some(frame => frame.sliding.length)) ? " Broken lines: contacts that slide." : ""}${sample.greatest_rad_per_s ? ` Spokes: spins, upright at rest, lying at ${Number(sample.greatest_rad_per_s.toPrecision(2))} rad/s.` : ""}${inSpace() ? " Drag to turn." : ""}`;
  }

  function stop() { clearInterval(timer); timer = undefined; play.textContent = "▶"; play.setAttribute("aria-label", "Play"); }
  play.addEventListener("click", () => {
    if (timer) return stop();
    if (time.value === time.max) time.value = 0;
    play.textContent = "⏸"; play.setAttribute("aria-label", "Pause");
    timer = setInterval(() => { if (time.value === time.max) stop(); else { time.value++; draw(); } }, 350);
    draw();
  });
  stage.addEventListener("pointermove", event => {
    if (!event.buttons || !inSpace()) return;
    yaw += event.movementX / 150;
    pitch = Math.max(-1.5, Math.min(1.5, pitch + event.movementY / 150));
    draw();
  });
  problemBox.addEventListener("change", () => { stop(); choose(); });
  partitionBox.addEventListener("change", draw);
  time.addEventListener("input", draw);
  form.addEventListener("submit", event => event.preventDefault());
  window.addEventListener("resize", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  options(problemBox, samples.map(sample => sample.problem));
  choose();
})();
