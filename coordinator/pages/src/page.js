// Interaction that a page without script lacks: values under the pointer, larger drawings, zoom into a
// dragged rectangle, logarithmic axes, and downloads of values and drawings. The script reads all data
// from data- attributes of the drawings and sends no requests.
(() => {
  "use strict";
  const SPACE = "http://www.w3.org/2000/svg";
  const numbers = text => text.split(" ").map(Number);
  const shown = value => {
    const size = Math.abs(value);
    const text = size !== 0 && (size < 1e-4 || size >= 1e6)
      ? value.toExponential(3) : String(Number(value.toPrecision(5)));
    return text.replace(/-/g, "\u2212");
  };
  const make = (name, of, text) => {
    const node = document.createElement(name);
    node.className = of;
    node.textContent = text || "";
    return node;
  };

  // Reads an axis from its drawing: a range of values and the corresponding positions.
  const axis = (svg, name) => {
    const words = svg.getAttribute("data-" + name).split(" ");
    const [low, high, from, to] = words.map(Number);
    const log = words[4] === "decades";
    const [a, b] = log ? [Math.log(low), Math.log(high)] : [low, high];
    return {
      log, low, high, from, to, label: svg.getAttribute("data-" + name + "-label"),
      value: place => {
        const at = a + (place - from) / (to - from) * (b - a);
        return log ? Math.exp(at) : at;
      },
      place: value => from + ((log ? Math.log(value) : value) - a) / (b - a) * (to - from),
    };
  };

  // Reads the values of the lines; a gap begins a new piece.
  const lines = svg => [...svg.querySelectorAll(".line[data-name]")].map(path => {
    const [x, y] = [axis(svg, "x"), path.linear || axis(svg, "y")];
    const places = (path.drawn || path.getAttribute("d")).match(/[ML][^ML]+/g) || [];
    const points = places.map(text => {
      const [px, py] = numbers(text.slice(1));
      return { begins: text[0] === "M", px, x: x.value(px), y: y.value(py) };
    });
    return { name: path.getAttribute("data-name"), path, points };
  });

  // Reads the values of a map, row by row from below.
  const map = svg => {
    const code = atob(svg.getAttribute("data-values"));
    const [low, high] = numbers(svg.getAttribute("data-range"));
    const columns = Number(svg.getAttribute("data-columns"));
    const rows = code.length / 2 / columns;
    const at = n => {
      const step = code.charCodeAt(2 * n) + 256 * code.charCodeAt(2 * n + 1);
      return step === 65535 ? NaN : low + step / 65534 * (high - low);
    };
    const [x, y] = [axis(svg, "x"), axis(svg, "y")];
    const middle = (of, n, count) => of.low + (n + 0.5) / count * (of.high - of.low);
    const cell = (of, value, count) => Math.floor((value - of.low) / (of.high - of.low) * count);
    return { x, y, columns, rows, at, middle, cell, unit: svg.getAttribute("data-unit") };
  };

  // Text about a position in the drawing; empty outside the axes.
  const reading = (svg, px, py) => {
    const of = axis(svg, "x");
    if (px < of.from || px > of.to) return "";
    if (svg.hasAttribute("data-values")) {
      const m = map(svg);
      const [x, y] = [m.x.value(px), m.y.value(py)];
      const [i, j] = [m.cell(m.x, x, m.columns), m.cell(m.y, y, m.rows)];
      if (j < 0 || j >= m.rows || i >= m.columns) return "";
      const value = m.at(j * m.columns + i);
      const said = Number.isNaN(value) ? "blank" : shown(value) + " " + m.unit;
      return said + "\n" + m.x.label + " " + shown(x) + "\n" + m.y.label + " " + shown(y);
    }
    const seen = line => getComputedStyle(line.path).display !== "none";
    const near = lines(svg).filter(line => line.points.length && seen(line)).map(line => {
      const apart = point => Math.abs(point.px - px);
      const point = line.points.reduce((a, b) => (apart(b) < apart(a) ? b : a));
      return { name: line.name, point };
    });
    if (!near.length) return "";
    const said = near.map(one => one.name + " " + shown(one.point.y));
    return [of.label + " " + shown(near[0].point.x), ...said].join("\n");
  };

  const save = (name, type, text) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
  };
  const quoted = text => '"' + text.replace(/"/g, '""') + '"';
  const csv = svg => {
    const head = ["x", "y"].map(name => quoted(svg.getAttribute("data-" + name + "-label") || name));
    if (svg.hasAttribute("data-values")) {
      const m = map(svg);
      const rows = [head.concat(quoted(m.unit)).join(",")];
      for (let n = 0; n < m.columns * m.rows; n++) {
        const value = m.at(n);
        if (Number.isNaN(value)) continue;
        const [i, j] = [n % m.columns, Math.floor(n / m.columns)];
        rows.push([m.middle(m.x, i, m.columns), m.middle(m.y, j, m.rows), value].join(","));
      }
      return rows.join("\n") + "\n";
    }
    const rows = lines(svg).flatMap(line =>
      line.points.map(point => [quoted(line.name), point.x, point.y].join(",")));
    return [["line", ...head].join(","), ...rows].join("\n") + "\n";
  };
  const alone = svg => {
    const copy = svg.cloneNode(true);
    const style = document.createElementNS(SPACE, "style");
    style.textContent = document.querySelector("style").textContent;
    copy.insertBefore(style, copy.firstChild);
    const box = svg.viewBox.baseVal;
    copy.setAttribute("width", 2 * box.width);
    copy.setAttribute("height", 2 * box.height);
    return new XMLSerializer().serializeToString(copy);
  };

  // Switches the vertical axis between linear and logarithmic.
  const decades = (svg, on) => {
    const beside = svg.querySelector(".beside");
    const old = svg.querySelector(".decades");
    if (old) old.remove();
    beside.style.display = on ? "none" : "";
    const all = lines(svg);
    if (!on) {
      all.forEach(({ path }) => path.setAttribute("d", path.drawn));
      svg.setAttribute("data-y", svg.linear);
      svg.querySelectorAll(".dot").forEach(dot => dot.setAttribute("cy", dot.drawn));
      return;
    }
    const y = axis(svg, "y");
    svg.linear = svg.linear || svg.getAttribute("data-y");
    const above = all.flatMap(line => line.points.map(p => p.y)).filter(v => v > 1e-300);
    const most = Math.ceil(Math.log10(Math.max(...above)));
    const least = Math.max(Math.floor(Math.log10(Math.min(...above))), most - 12);
    const place = value => {
      const part = (Math.log10(value) - least) / Math.max(most - least, 1);
      return y.from + Math.min(Math.max(part, 0), 1) * (y.to - y.from);
    };
    for (const { path, points } of all) {
      path.linear = path.linear || y;
      path.drawn = path.drawn || path.getAttribute("d");
      let pen = "M";
      const piece = p => {
        if (!(p.y > 0)) { pen = "M"; return ""; }
        const text = (p.begins ? "M" : pen) + p.px.toFixed(2) + " " + place(p.y).toFixed(2);
        pen = "L";
        return text;
      };
      path.setAttribute("d", points.map(piece).join(""));
    }
    svg.querySelectorAll(".dot").forEach(dot => {
      dot.drawn = dot.drawn || dot.getAttribute("cy");
      const value = y.value(Number(dot.drawn));
      dot.setAttribute("cy", value > 0 ? place(value) : y.from);
    });
    const group = document.createElementNS(SPACE, "g");
    group.setAttribute("class", "decades");
    const [left, right] = [axis(svg, "x").from, axis(svg, "x").to];
    const every = Math.ceil((most - least) / 6) || 1;
    for (let power = least; power <= most; power += every) {
      const at = place(10 ** power);
      const line = document.createElementNS(SPACE, "path");
      line.setAttribute("class", "grid");
      line.setAttribute("d", "M" + (left - 5) + " " + at + "H" + right);
      const text = document.createElementNS(SPACE, "text");
      text.setAttribute("class", "tick end");
      text.setAttribute("x", left - 8);
      text.setAttribute("y", at + 4.5);
      text.textContent = "1e" + String(power).replace("-", "\u2212");
      group.append(line, text);
    }
    svg.insertBefore(group, beside);
  };

  const tip = make("output", "reading");
  document.body.append(tip);
  const paper = (svg, event) => {
    const place = new DOMPoint(event.clientX, event.clientY);
    return place.matrixTransform(svg.getScreenCTM().inverse());
  };
  const tell = (svg, event) => {
    const { x, y } = paper(svg, event);
    tip.textContent = reading(svg, x, y);
    tip.hidden = !tip.textContent;
    const left = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8);
    tip.style.left = Math.max(left, 4) + scrollX + "px";
    tip.style.top = event.clientY + 14 + scrollY + "px";
  };
  tip.hidden = true;

  // Zooms into a rectangle dragged with the mouse; a double click restores the whole drawing.
  const zoom = svg => {
    const whole = svg.getAttribute("viewBox");
    let from = null;
    let frame = null;
    svg.addEventListener("pointerdown", event => {
      if (event.pointerType !== "mouse" || event.button !== 0) return;
      event.preventDefault();
      from = paper(svg, event);
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", event => {
      tell(svg, event);
      if (!from) return;
      const to = paper(svg, event);
      frame = frame || svg.appendChild(document.createElementNS(SPACE, "rect"));
      frame.setAttribute("class", "dragged");
      frame.setAttribute("x", Math.min(from.x, to.x));
      frame.setAttribute("y", Math.min(from.y, to.y));
      frame.setAttribute("width", Math.abs(to.x - from.x));
      frame.setAttribute("height", Math.abs(to.y - from.y));
    });
    svg.addEventListener("pointerup", () => {
      const box = frame ? ["x", "y", "width", "height"].map(n => Number(frame.getAttribute(n))) : [];
      if (frame) frame.remove();
      frame = from = null;
      if (box[2] > 8 && box[3] > 8) svg.setAttribute("viewBox", box.join(" "));
    });
    svg.addEventListener("pointerleave", () => { tip.hidden = true; });
    svg.addEventListener("dblclick", () => svg.setAttribute("viewBox", whole));
  };

  // Slider that shows one instant at a time instead of several.
  const slider = (figure, svg) => {
    const instants = [...svg.querySelectorAll(".instant")];
    if (!instants.length) return;
    const others = [...svg.querySelectorAll(".line:not(.instant), .dot")];
    const legend = figure.querySelector(".legend");
    const label = make("label", "slider");
    const input = make("input", "");
    const said = make("span", "", "some");
    Object.assign(input, { type: "range", min: -1, max: instants.length - 1, value: -1 });
    input.addEventListener("input", () => {
      const chosen = Number(input.value);
      instants.forEach((line, n) => { line.style.display = n === chosen ? "inline" : ""; });
      [...others, legend].forEach(node => { node.style.display = chosen < 0 ? "" : "none"; });
      said.textContent = chosen < 0 ? "some" : instants[chosen].getAttribute("data-name");
    });
    label.append("instant ", input, " ", said);
    svg.after(label);
  };

  const button = (text, title, act) => {
    const node = make("button", "", text);
    node.type = "button";
    node.title = title;
    node.addEventListener("click", () => act(node));
    return node;
  };
  const pressed = node => {
    const on = node.getAttribute("aria-pressed") !== "true";
    node.setAttribute("aria-pressed", on);
    return on;
  };
  const equip = svg => {
    const figure = svg.closest("figure");
    const name = figure.querySelector("figcaption").textContent.trim().replace(/[^\w.-]+/g, "-");
    const tools = make("div", "tools");
    tools.append(button("larger", "As wide as the page", node =>
      figure.classList.toggle("large", pressed(node))));
    const linear = (svg.getAttribute("data-y").split(" ")[4] || "") === "linear";
    if (linear && !svg.querySelector(".mark") && lines(svg).some(l => l.points.some(p => p.y > 0))) {
      tools.append(button("log", "Logarithmic vertical axis", node => decades(svg, pressed(node))));
    }
    tools.append(
      button("SVG", "Save the drawing", () => save(name + ".svg", "image/svg+xml", alone(svg))),
      button("CSV", "Save the values", () => save(name + ".csv", "text/csv", csv(svg))));
    figure.querySelector("figcaption").append(tools);
    slider(figure, svg);
    zoom(svg);
  };
  const equipAll = root => root.querySelectorAll("svg.plot[data-x]").forEach(equip);
  equipAll(document);
  // A script that adds drawings to the page announces them with this event.
  document.addEventListener("drawn", event => equipAll(event.target));
})();
