// The page: which view is shown.

import { byId } from "./common/dom.js";
import { getJson } from "./common/server.js";

const views = ["console", "lab"];
const started = {};
let session = false;

async function start(view) {
  if (started[view]) return;
  started[view] = true;
  // Each view is loaded when it is looked at.
  const module = await import(view === "console" ? "/console/console.js" : "/lab/lab.js");
  module.start();
}

function show() {
  const asked = location.hash.slice(1).split("/")[0];
  const view = session && asked !== "lab" ? "console" : "lab";
  for (const name of views) {
    byId(name).hidden = name !== view;
    const tab = byId(`tab-${name}`);
    if (name === view) tab.setAttribute("aria-current", "page");
    else tab.removeAttribute("aria-current");
  }
  document.title = view === "console" ? "ferntast · console" : "ferntast · lab";
  start(view);
}

({ session } = await getJson("/api/about").catch((error) => {
  byId("lab").textContent = error.message;
  return { session: false };
}));
byId("tab-console").hidden = !session;
byId("stop").hidden = !session;
if (session) start("console");
addEventListener("hashchange", show);
show();
