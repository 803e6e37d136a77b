// Links a map, its histories, a slider and a line of words: what is pointed at in one is shown in all.
"use strict";

const MissionPage = (() => {
  // The last row that is not later; rows are in the order of their times.
  function rowAt(times, time) {
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle; else high = middle - 1;
    }
    return low < times.length - 1 && times[low + 1] - time < time - times[low] ? low + 1 : low;
  }

  function rowNear(data, x, y) {
    let best = -1, least = Infinity;
    for (let row = 0; row < data.t.length; row++) {
      const distance = (data.x[row] - x) ** 2 + (data.y[row] - y) ** 2;
      if (distance < least) { least = distance; best = row; }
    }
    return [best, Math.sqrt(least)];
  }

  const bandAt = (bands, time) => {
    const found = bands.find(([from, to]) => from <= time && time <= to);
    return found === undefined ? "" : found[2];
  };

  function words(told, data, row) {
    const time = data.t[row];
    const parts = [`${time.toFixed(1)} s`, bandAt(told.phases, time), bandAt(told.regions, time) || "open ground"];
    for (const {column, title, unit, digits} of told.quantities) {
      const value = data[column][row];
      if (Number.isFinite(value)) parts.push(`${title}: ${value.toFixed(digits)} ${unit}`);
    }
    return parts.filter(Boolean).join(" · ");
  }

  // `element` holds the page's controls; all that is told of the flight in words is set as text, never as markup.
  function link(element, told, doc) {
    const slider = element.querySelector("input[type=range]"), here = element.querySelector("output");
    const flown = doc.get_model_by_name("flown"), cursor = doc.get_model_by_name("cursor");
    const map = doc.get_model_by_name("map");

    for (const box of element.querySelectorAll("input[data-layer]")) {
      const layer = map.renderers.find((each) => each.name === box.dataset.layer);
      box.addEventListener("change", () => { layer.visible = box.checked; });
    }
    if (flown === null || slider === null) return;

    function show(row) {
      const {t, x, y} = flown.data;
      if (!(row >= 0 && row < t.length)) return;
      cursor.data = {t: [t[row]], x: [x[row]], y: [y[row]]};
      if (told.moving !== undefined && told.moving.begun !== null) MissionMotion.show(told.moving, doc, t[row] - told.moving.begun);
      slider.value = String(row);
      here.textContent = words(told, flown.data, row);
      slider.setAttribute("aria-valuetext", here.textContent);
    }

    const showTime = (event) => show(rowAt(flown.data.t, event.x));
    const showPlace = (event) => {
      const [row, distance] = rowNear(flown.data, event.x, event.y);
      const {start, end} = map.x_range;
      if (distance < 0.05 * Math.abs(end - start)) show(row);
    };
    for (const kind of ["mousemove", "tap"]) {
      map.on_event(kind, showPlace);
      for (const name of told.histories) doc.get_model_by_name(name).on_event(kind, showTime);
    }
    for (const moment of element.ownerDocument.querySelectorAll("[data-time]")) {
      moment.addEventListener("click", () => show(rowAt(flown.data.t, Number(moment.dataset.time))));
    }
    slider.addEventListener("input", () => show(Number(slider.value)));
    show(flown.data.t.length - 1);
  }

  // Draws what the element "figures" holds into the elements of the page, then links it.
  async function open() {
    const told = JSON.parse(document.getElementById("figures").textContent);
    await Bokeh.embed.embed_items(told.documents, told.items);
    const [doc] = Bokeh.documents.slice(-1);
    link(document.getElementById("flight"), told, doc);
    document.getElementById("flight").dataset.ready = "yes";
  }

  return {link, open};
})();
