// Draws the figures, then shows one moment of the flight after the other; what is pressed is asked, never done at once.
"use strict";

(() => {
  const TOKEN = location.pathname.split("/")[1];
  const MOST = 6000;
  const byId = (id) => document.getElementById(id);
  const live = document.body.dataset.live === "yes";
  const slider = byId("moment"), play = byId("play"), dialog = byId("ask");
  let moments = [], follows = live, drawn = null, shownPlan = null, timer = null;

  function state(link, words) {
    document.body.dataset.link = link;
    byId("state").textContent = words;
  }

  // Names and words come from files and vehicles: they are set as text, never as markup.
  function show(row) {
    const now = moments[row];
    if (now === undefined) return;
    if (now.plan !== shownPlan) drawFigures(now.plan);
    for (const element of document.querySelectorAll("[data-value]")) {
      const value = now[element.dataset.value];
      element.textContent = value === null || value === "" ? "–" : String(value);
      if (!live) element.closest("div").hidden = value === null;
    }
    byId("nearest").textContent = now.nearest === null ? "–" : `${now.nearest}, ${now.near.toFixed(1)} m away`;
    byId("time").textContent = now.t === null ? "" : `${now.t.toFixed(1)} s`;
    byId("states").textContent = now.states.length ? `in ${now.states.map((each) => `q${each}`).join(" or ")}` : "has left all states";
    slider.max = String(moments.length - 1);
    slider.value = String(row);
    slider.setAttribute("aria-valuetext", `${byId("time").textContent}, ${now.doing}`);
    if (drawn !== null) draw(now);
  }

  function draw(now) {
    const known = now.x !== null;
    // A screen's angle runs counter-clockwise from the east.
    const angle = now.heading === null ? NaN : (90 - now.heading) * Math.PI / 180;
    drawn.cursor.data = known ? {t: [now.t], x: [now.x], y: [now.y], angle: [angle]} : {t: [], x: [], y: [], angle: []};
    MissionMotion.show(drawn.told.moving, drawn.doc, now.clock);
    const places = now.states.map((each) => drawn.told.states[each]).filter((each) => each !== undefined);
    drawn.present.data = {x: places.map(([x]) => x), y: places.map(([, y]) => y)};
  }

  function drawPath() {
    if (drawn === null) return;
    const places = moments.filter(({x}) => x !== null);
    const column = (key) => places.map((each) => each[key]);
    drawn.flown.data = {t: column("t"), x: column("x"), y: column("y")};
  }

  function addNews(news) {
    byId("log").hidden &&= news.length === 0;
    for (const [t, words] of news) {
      const line = document.createElement("li");
      line.textContent = t === null ? words : `${t.toFixed(0)} s: ${words}`;
      byId("news").prepend(line);
    }
  }

  function take(message) {
    if (message.over !== undefined) { over(message.over); return; }
    if (message.fresh) { moments = []; byId("news").replaceChildren(); }
    let before = {};
    message.moments.forEach((changes) => { before = {...before, ...changes}; moments.push(before); });
    if (moments.length > MOST) moments = moments.filter((_, row) => row % 2 === 0 || row === moments.length - 1);
    addNews(message.news);
    for (const words of live ? message.answers : []) byId("answer").textContent = words;
    drawPath();
    show(follows ? moments.length - 1 : Math.min(Number(slider.value), moments.length - 1));
  }

  function over(words) {
    state("over", words);
    for (const button of document.querySelectorAll("[data-request]")) button.disabled = true;
  }

  function connect() {
    const socket = new WebSocket(`ws://${location.host}/${TOKEN}/moments`);
    let heard = false;
    socket.onmessage = ({data}) => {
      if (!heard) { heard = true; state("live", document.body.dataset.shown); }
      take(JSON.parse(data));
    };
    socket.onclose = () => {
      if (document.body.dataset.link === "over") return;
      state("lost", "not connected: the program that shows this has ended, or does not answer");
      setTimeout(connect, 2000);
    };
  }

  function addSwitches(layers, doc) {
    for (const box of byId("layers").querySelectorAll("label")) box.remove();
    const map = doc.get_model_by_name("map");
    for (const [label, colour] of Object.entries(layers)) {
      const drawnAs = map.renderers.filter((each) => each.name === label);
      const line = document.createElement("label"), box = document.createElement("input");
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = colour;
      box.type = "checkbox";
      box.checked = true;
      box.addEventListener("change", () => { for (const each of drawnAs) each.visible = box.checked; });
      line.append(box, swatch, label);
      byId("layers").append(line);
    }
  }

  // Of one of the plans that were flown; another one may be wanted before it is there.
  async function drawFigures(plan) {
    shownPlan = plan;
    drawn = null;
    const told = await (await fetch(`figures?plan=${plan}`)).json();
    if (shownPlan !== plan) return;
    Bokeh.documents.length = 0;
    byId("map").replaceChildren();
    byId("automaton").replaceChildren();
    await Bokeh.embed.embed_items(told.documents, told.items);
    if (shownPlan !== plan) return;
    const [doc] = Bokeh.documents.slice(-1);
    const model = (name) => doc.get_model_by_name(name);
    drawn = {told, doc, flown: model("flown"), cursor: model("cursor"), present: model("present")};
    addSwitches(told.layers, doc);
    byId("key").replaceChildren(...told.key.map((words) => {
      const line = document.createElement("li");
      line.textContent = words;
      return line;
    }));
    drawPath();
    show(Number(slider.value));
    document.body.dataset.ready = "yes";
  }

  function ask(button) {
    byId("question").textContent = `${button.textContent}? ${button.dataset.asks}`;
    byId("yes").textContent = button.textContent;
    dialog.dataset.asksFor = button.dataset.request;
    dialog.returnValue = "no";
    dialog.showModal();
  }

  async function send(request) {
    byId("answer").textContent = `${request}: asked`;
    try {
      const reply = await fetch("request", {
        method: "POST",
        headers: {"X-Mission-Token": TOKEN, "Content-Type": "application/json"},
        body: JSON.stringify({request}),
      });
      if (!reply.ok) byId("answer").textContent = `${request}: ${await reply.text()}`;
    } catch {
      byId("answer").textContent = `${request}: not asked, for the program does not answer`;
    }
  }

  function stop() {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
  }

  slider.addEventListener("input", () => {
    stop();
    follows = live && Number(slider.value) === moments.length - 1;
    show(Number(slider.value));
  });
  play.addEventListener("click", () => {
    if (timer !== null) { stop(); return; }
    let row = Number(slider.value) >= moments.length - 1 ? 0 : Number(slider.value);
    follows = false;
    play.textContent = "Stop";
    timer = setInterval(() => {
      show(row);
      row += 1;
      if (row >= moments.length) { follows = live; stop(); }
    }, 50);
  });
  for (const button of document.querySelectorAll("[data-request]")) {
    button.addEventListener("click", () => ask(button));
  }
  dialog.addEventListener("close", () => {
    if (dialog.returnValue === "yes") send(dialog.dataset.asksFor);
  });
  connect();
  drawFigures(1);
})();
