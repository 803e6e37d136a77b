// Shows what moves on a map where it is at a time: straight between the instants that are told.
"use strict";

const MissionMotion = (() => {
  const between = (a, b, share) =>
    Array.isArray(a) ? a.map((each, k) => between(each, b[k], share)) : a + share * (b - a);

  // `told` has instants, and for each source that moves its columns at each of them; none where all stands.
  function show(told, doc, clock) {
    if (told === undefined || !Number.isFinite(clock)) return;
    const {times, sources} = told, last = times.length - 1;
    let k = times.findIndex((time) => time > clock) - 1;
    if (k === -2) k = last;
    if (k < 0) k = 0;
    const next = Math.min(k + 1, last);
    const share = next === k ? 0 : Math.min(1, Math.max(0, (clock - times[k]) / (times[next] - times[k])));
    for (const [name, frames] of Object.entries(sources)) {
      const source = doc.get_model_by_name(name), moved = {...source.data};
      for (const [column, values] of Object.entries(frames[k])) {
        moved[column] = between(values, frames[next][column], share);
      }
      source.data = moved;
    }
  }

  return {show};
})();
