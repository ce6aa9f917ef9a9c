// Talks with the server that the page came from.

const given = new URLSearchParams(location.search).get("token");
if (given) {
  sessionStorage.setItem("token", given);
  // It need not stand in the address for everybody to see.
  history.replaceState(null, "", location.pathname + location.hash);
}
const token = sessionStorage.getItem("token");

function headers(more = {}) {
  return token ? { ...more, authorization: `Bearer ${token}` } : more;
}

async function failed(response) {
  const text = await response.text();
  try {
    return new Error(JSON.parse(text).error || text);
  } catch {
    return new Error(text || `the server answered ${response.status}`);
  }
}

/** The JSON at an address; `query` is an object. */
export async function getJson(path, query = {}) {
  const text = new URLSearchParams(query).toString();
  const response = await fetch(text ? `${path}?${text}` : path, { headers: headers() });
  if (!response.ok) throw await failed(response);
  return response.json();
}

/** Sends a file as it is; gives the answer's JSON. */
export async function sendFile(path, query, file) {
  const address = `${path}?${new URLSearchParams(query)}`;
  const response = await fetch(address, { method: "POST", body: file, headers: headers() });
  if (!response.ok) throw await failed(response);
  return response.json();
}

/** Asks for work; `progress` is told the share done. Gives the result. */
export async function work(path, body, progress = () => {}) {
  const response = await fetch(path, {
    method: "POST",
    body: JSON.stringify(body),
    headers: headers({ "content-type": "application/json" }),
  });
  if (!response.ok) throw await failed(response);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let result;
  let rest = [];
  const take = (line) => {
    if (!line) return;
    const said = JSON.parse(line);
    if (said.error) throw new Error(said.error);
    if (said.progress !== undefined) progress(said.progress);
    if (said.result !== undefined) result = said.result;
  };
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    const lines = value.split("\n");
    // Long results come in many pieces: they are joined once, not again and again.
    while (lines.length > 1) {
      rest.push(lines.shift());
      take(rest.join(""));
      rest = [];
    }
    rest.push(lines[0]);
  }
  take(rest.join(""));
  if (result === undefined) throw new Error("the server broke off");
  return result;
}

/** The address of a WebSocket. */
export function socketAddress(path) {
  const query = token ? `?token=${encodeURIComponent(token)}` : "";
  return `ws://${location.host}${path}${query}`;
}
