// The figure of "How the ramp law works": velocity and acceleration over time, as this server's calculators answer.
(() => {
  const FIELDS = [
    ["distance", "Distance [µsteps]", 500, 100000, 20000],
    ["vmax", "Highest speed [pps]", 1000, 60000, 20000],
    ["amax", "Acceleration [pps²]", 10000, 400000, 80000],
    ["bow", "Bow [1000 pps³]; right end: none", 100, 10000, 600],
  ];
  const WIDTH = 720;
  const HEIGHT = 300;
  const LEFT = 70;
  const NO_BOW = 10000;

  async function ramp({ distance, vmax, amax, bow }) {
    const limits = { vmax, amax, dmax: amax };
    const body =
      bow >= NO_BOW
        ? { model: "trapezoid", distance, parameters: limits, samples: 300 }
        : { model: "s_ramp", distance, parameters: { ...limits, bow1: bow * 1000 }, samples: 300 };
    const answer = await fetch("/api/v1/calc/ramp", {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(body),
    });
    if (!answer.ok) throw new Error((await answer.json()).detail ?? answer.statusText);
    return answer.json();
  }

  function line(times, values, duration, top, bottom, colour) {
    const highest = Math.max(...values.map(Math.abs), 1);
    const low = Math.min(...values) < 0 ? -highest : 0;
    const x = (t) => LEFT + (t / duration) * (WIDTH - LEFT - 10);
    const y = (v) => bottom - ((v - low) / (highest - low)) * (bottom - top);
    const points = times.map((t, i) => `${x(t).toFixed(1)},${y(values[i]).toFixed(1)}`).join(" ");
    const label = highest.toLocaleString("en", { maximumSignificantDigits: 3 });
    return `<line x1="${LEFT}" x2="${WIDTH}" y1="${y(0)}" y2="${y(0)}" stroke="currentColor" opacity="0.3"/>
      <text x="${LEFT - 8}" y="${y(highest) + 5}" text-anchor="end">${label}</text>
      <polyline points="${points}" fill="none" stroke="${colour}" stroke-width="2"/>`;
  }

  function draw(figure, { time_s, velocity_pps, acceleration_pps2, duration_s }) {
    figure.innerHTML = `<svg viewBox="0 0 ${WIDTH} ${HEIGHT}" role="img"
        aria-label="Velocity and acceleration over ${duration_s.toFixed(3)} s">
      ${line(time_s, velocity_pps, duration_s, 26, 140, "#0b7285")}
      <text x="${LEFT}" y="14">velocity [pps]</text>
      ${line(time_s, acceleration_pps2, duration_s, 176, 290, "#b87400")}
      <text x="${LEFT}" y="166">acceleration [pps²]</text>
      <text x="${WIDTH - 4}" y="14" text-anchor="end">${duration_s.toFixed(3)} s</text>
    </svg>`;
  }

  function make(place) {
    const form = document.createElement("form");
    const figure = document.createElement("div");
    const said = document.createElement("p");
    said.setAttribute("role", "status");
    for (const [name, label, low, high, value] of FIELDS) {
      const field = document.createElement("label");
      field.innerHTML = `${label} <input type="range" name="${name}" min="${low}" max="${high}" value="${value}">
        <output>${value.toLocaleString("en")}</output>`;
      form.append(field);
    }
    let asked = 0;
    async function show() {
      const mine = ++asked;
      const wanted = Object.fromEntries(FIELDS.map(([name]) => [name, Number(form.elements[name].value)]));
      for (const label of form.querySelectorAll("label")) {
        label.querySelector("output").value = Number(label.querySelector("input").value).toLocaleString("en");
      }
      try {
        const found = await ramp(wanted);
        if (mine === asked) {
          draw(figure, found);
          said.textContent = "";
        }
      } catch (error) {
        if (mine === asked) said.textContent = `No figure: ${error.message}`;
      }
    }
    form.addEventListener("input", show);
    form.addEventListener("submit", (event) => event.preventDefault());
    place.replaceChildren(form, figure, said);
    show();
  }

  for (const place of document.querySelectorAll("[data-live='ramp']")) make(place);
})();
