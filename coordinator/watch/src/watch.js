// Steps through a recording and follows a run that goes on. Drawings come from the program, as HTML;
// in a file written with --page they are part of the page.
(() => {
  "use strict";
  const by = id => document.getElementById(id);
  const [series, against, slider] = ["series", "against", "step"].map(by);
  const stored = by("stored");
  const file = stored && JSON.parse(stored.textContent);
  let [shown, report, timer, playing, pending] = [-1, 0, 0, 0, null];
  let [known, touched] = [null, false];

  const ask = async path => {
    const answer = await fetch(path);
    if (!answer.ok) throw new Error(await answer.text());
    return answer;
  };
  const inflated = async text => {
    const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return JSON.parse(await new Response(stream).text());
  };
  const put = (node, html) => {
    node.innerHTML = html;
    node.dispatchEvent(new Event("drawn", { bubbles: true }));
  };

  // A file holds only some steps: every movement goes to the nearest of them.
  const fromFile = ({ step, go }) => {
    const { steps, windows } = file;
    const at = Math.max(steps.findIndex(one => one >= step), 0);
    const end = n => {
      while (n + 1 < steps.length && windows[n + 1] === windows[n]) n += 1;
      return n;
    };
    const first = n => {
      while (n > 0 && windows[n - 1] === windows[n]) n -= 1;
      return n;
    };
    const to = {
      stay: at, next: at + 1, previous: at - 1, first: 0, last: steps.length - 1,
      "next-window": end(Math.min(end(at) + 1, steps.length - 1)), "previous-window": first(at) - 1,
    }[go];
    const view = file.views[series.value + "/" + Math.min(Math.max(to, 0), steps.length - 1)];
    return inflated(view[against.value] || view.nothing);
  };
  const fromServer = async ({ step, go }) => {
    const of = { series: series.value, step, go, against: against.value };
    return (await ask("view?" + new URLSearchParams(of))).json();
  };

  // Shows a step. While one is on its way, only the newest further request is kept.
  const show = async (step, go = "stay") => {
    if (pending) { pending.next = [step, go]; return; }
    pending = {};
    try {
      const view = await (file ? fromFile : fromServer)({ step, go });
      // Another recording has taken the place of the one that the page knows.
      if (!file && known && view.run !== known.run) soon();
      shown = view.step;
      slider.value = shown;
      by("caption").textContent = view.caption;
      put(by("view"), view.html);
      const place = [series.value, shown, against.value].join(",");
      history.replaceState(null, "", "#" + place);
    } catch (error) {
      by("news").textContent = String(error.message || error);
    }
    const { next } = pending;
    pending = null;
    if (next) show(...next);
  };

  const play = on => {
    clearInterval(playing);
    playing = on ? setInterval(() => {
      if (shown >= Number(slider.max)) return play(false);
      return show(shown, "next");
    }, 250) : 0;
    by("play").setAttribute("aria-pressed", Boolean(on));
  };
  const turn = (select, by) => {
    const all = [...select.options].filter(option => !option.hidden);
    const now = all.findIndex(option => option.selected);
    all[(now + by + all.length) % all.length].selected = true;
    show(shown);
  };
  const difference = () => {
    if (!known || !known.difference) return;
    const [field, step] = known.difference;
    series.value = field;
    against.value = "other";
    return show(step);
  };

  // Lists the fields, and keeps the chosen one by its name: another recording has other numbers.
  const list = fields => {
    const chosen = series.selectedOptions[0]?.textContent;
    series.replaceChildren(...fields.map(([number, name]) => new Option(name, number)));
    const same = [...series.options].find(option => option.textContent === chosen);
    if (same) same.selected = true;
  };

  // Takes over the state of the run: fields, number of steps, news, and a report that has changed.
  const take = async state => {
    const first = !known;
    const newest = shown < 0 || shown >= Number(slider.max);
    const other = known && state.run !== known.run;
    const more = !known || state.steps !== known.steps;
    const found = state.difference && !(known && known.difference);
    if (first || other || JSON.stringify(state.fields) !== JSON.stringify(known.fields)) list(state.fields);
    known = state;
    document.title = state.title;
    by("stepper").hidden = !state.steps || !state.fields.length;
    slider.max = Math.max(state.steps - 1, 0);
    against.querySelector("[value=other]").hidden = !state.other;
    by("difference").hidden = !state.difference;
    const news = [];
    if (state.live) {
      news.push(file ? "The run was going on when this page was written." : "The run goes on; this page follows.");
    }
    if (state.read < 1) news.push("Reading the recording: " + Math.round(100 * state.read) + " %.");
    if (state.other && !state.difference && state.read >= 1 && !state.live) {
      news.push("Both recordings have the same values.");
    }
    if (state.remark) news.push(state.remark + ".");
    by("news").textContent = news.join(" ");
    const place = location.hash.slice(1).split(",");
    const returns = first && place.length === 3;
    if (returns) {
      [touched, series.value, against.value] = [true, place[0], place[2]];
    } else if (first && state.other) {
      against.value = "other";
    }
    if (series.selectedIndex < 0) series.selectedIndex = 0;
    if (!state.steps) {
      shown = -1;
      by("caption").textContent = "";
      put(by("view"), "");
    } else if (returns) {
      await show(Number(place[1]));
    } else if (found && !touched) {
      await difference();
    } else if (first || other || (more && newest && !playing)) {
      await show(0, "last");
    }
    if (state.report !== report && report) await renew();
    report = state.report;
  };
  const renew = async () => {
    const box = document.createElement("div");
    box.innerHTML = await (await ask("report")).text();
    document.querySelector("header").replaceWith(box.querySelector("header"));
    const open = [...by("report").querySelectorAll("details")].map(node => node.open);
    put(by("report"), box.querySelector("#report").innerHTML);
    by("report").querySelectorAll("details").forEach((node, n) => { node.open = Boolean(open[n]); });
  };
  const look = async () => {
    clearTimeout(timer);
    let pause = 500;
    try {
      const state = await (await ask("state")).json();
      await take(state);
      if (!state.live && state.read >= 1) pause = 2500;
    } catch (error) {
      by("news").textContent = "The program that serves this page has ended; the page stays as it is.";
      pause = 5000;
    }
    timer = setTimeout(look, pause);
  };

  const soon = () => { clearTimeout(timer); timer = setTimeout(look, 0); };

  ["pointerdown", "keydown"].forEach(kind => document.addEventListener(kind, () => { touched = true; }));
  document.querySelector(".controls").addEventListener("submit", event => event.preventDefault());
  document.querySelectorAll("[data-go]").forEach(button =>
    button.addEventListener("click", () => show(shown, button.dataset.go)));
  by("play").addEventListener("click", () => play(!playing));
  by("difference").addEventListener("click", difference);
  slider.addEventListener("input", () => show(Number(slider.value)));
  [series, against].forEach(select => select.addEventListener("change", () => show(shown)));
  const keys = {
    ArrowRight: () => show(shown, "next"), ArrowLeft: () => show(shown, "previous"),
    ArrowUp: () => show(shown, "next-window"), ArrowDown: () => show(shown, "previous-window"),
    Home: () => show(shown, "first"), End: () => show(shown, "last"), " ": () => play(!playing),
    f: () => turn(series, 1), F: () => turn(series, -1), d: () => turn(against, 1), g: difference,
  };
  document.addEventListener("keydown", event => {
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey || by("stepper").hidden) return;
    if (event.target.matches("select, pre, summary, button") && event.key !== "f" && event.key !== "d") return;
    event.preventDefault();
    act();
  });
  document.addEventListener("visibilitychange", () => {
    clearTimeout(timer);
    if (!document.hidden && !file) look();
  });
  if (file) take(file.state); else look();
})();
