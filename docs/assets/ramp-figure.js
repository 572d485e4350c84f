// The figures of "How the ramp law works", as this server's calculators answer: velocity and acceleration over time, and
// what a TMC428 makes of its numbers.
(() => {
  const RAMP_FIELDS = [
    ["distance", "Distance [µsteps]", 500, 100000, 20000],
    ["vmax", "Highest speed [pps]", 1000, 60000, 20000],
    ["amax", "Acceleration [pps²]", 10000, 400000, 80000],
    ["bow", "Bow [1000 pps³]; right end: none", 100, 10000, 600],
  ];
  const REGISTER_FIELDS = [
    ["v", "v_max", 1, 2047, 1500],
    ["a", "a_max", 1, 2047, 400],
    ["pulse_div", "pulse_div", 0, 13, 3],
    ["ramp_div", "ramp_div", 0, 13, 7],
  ];
  const WIDTH = 720;
  const HEIGHT = 300;
  const LEFT = 70;
  const NO_BOW = 10000;

  async function ask(calculator, body) {
    const answer = await fetch(`/api/v1/calc/${calculator}`, {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(body),
    });
    if (!answer.ok) throw new Error((await answer.json()).detail ?? answer.statusText);
    return answer.json();
  }

  function ramp({ distance, vmax, amax, bow }) {
    const limits = { vmax, amax, dmax: amax };
    const body =
      bow >= NO_BOW
        ? { model: "trapezoid", distance, parameters: limits, samples: 300 }
        : { model: "s_ramp", distance, parameters: { ...limits, bow1: bow * 1000 }, samples: 300 };
    return ask("ramp", body);
  }

  async function registers({ v, a, pulse_div, ramp_div }) {
    const divided = { pulse_div, ramp_div };
    const wanted = { velocity: { value: v, unit: "chip" }, acceleration: { value: a, unit: "chip" } };
    const [units, pair] = await Promise.all([
      ask("units", { model: "tmc428", ...divided, ...wanted }),
      ask("pmul-pdiv", { chip: "tmc428", a_max: a, ...divided }),
    ]);
    return { ...units, pair };
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

  function tell(figure, { velocity, acceleration, acceleration_time_s, acceleration_steps, pair }) {
    const exact = (value, digits = 6) => value.toLocaleString("en", { maximumSignificantDigits: digits });
    const chosen = pair.candidates.find((each) => each.pmul === pair.pmul && each.pdiv === pair.pdiv);
    const rows = [
      ["velocity", `${exact(velocity.pps)} pps`],
      ["acceleration", `${exact(acceleration.pps2)} pps²`],
      ["that velocity is reached after", `${exact(acceleration_time_s, 4)} s, ${exact(acceleration_steps)} microsteps`],
      ["p, wanted", exact(pair.p_ideal)],
      ["p, 5 % smaller", exact(pair.p_reduced)],
      ["pair", `pmul ${pair.p_mul}, pdiv ${pair.pdiv}: p = ${exact(pair.p)}`],
      ["beyond the target", chosen ? `${chosen.overshoot_steps} microsteps` : "–"],
    ];
    figure.innerHTML = `<table>${rows.map(([what, value]) => `<tr><th scope="row">${what}</th><td>${value}</td></tr>`).join("")}</table>`;
  }

  function make(place, fields, calculate, show) {
    const form = document.createElement("form");
    const figure = document.createElement("div");
    const said = document.createElement("p");
    said.setAttribute("role", "status");
    for (const [name, label, low, high, value] of fields) {
      const field = document.createElement("label");
      field.innerHTML = `${label} <input type="range" name="${name}" min="${low}" max="${high}" value="${value}">
        <output>${value.toLocaleString("en")}</output>`;
      form.append(field);
    }
    let asked = 0;
    async function update() {
      const mine = ++asked;
      const wanted = Object.fromEntries(fields.map(([name]) => [name, Number(form.elements[name].value)]));
      for (const label of form.querySelectorAll("label")) {
        label.querySelector("output").value = Number(label.querySelector("input").value).toLocaleString("en");
      }
      try {
        const found = await calculate(wanted);
        if (mine === asked) {
          show(figure, found);
          said.textContent = "";
        }
      } catch (error) {
        if (mine !== asked) return;
        figure.replaceChildren();
        said.textContent = `No figure: ${error.message}`;
      }
    }
    form.addEventListener("input", update);
    form.addEventListener("submit", (event) => event.preventDefault());
    place.replaceChildren(form, figure, said);
    update();
  }

  for (const place of document.querySelectorAll("[data-live='ramp']")) make(place, RAMP_FIELDS, ramp, draw);
  for (const place of document.querySelectorAll("[data-live='registers']")) {
    make(place, REGISTER_FIELDS, registers, tell);
  }
})();
