// The WebSocket to the session: snapshots in, requests out.

import { socketAddress } from "../common/server.js";

/** Snapshots kept: 30 s at 50 a second. */
const KEPT = 1500;

/** What is known of the session. */
export const session = {
  page: 0,
  about: null,
  /** The newest snapshot; null before the first. */
  now: null,
  /** Snapshots, the oldest first. */
  past: [],
  connected: false,
  nodes: [],
  /** What happened, the oldest first. */
  events: [],
};

const listeners = { hello: [], snapshot: [], refused: [], connection: [] };
let socket = null;
let pause = 500;

/** Calls `listener` on `hello`, `snapshot`, `refused` (with the reason) or `connection`. */
export function on(event, listener) {
  listeners[event].push(listener);
}

function tell(event, value) {
  listeners[event].forEach((listener) => listener(value));
}

/** The end of the link on this host, as measured there; the operator's where both are. */
export function ownLink(snapshot) {
  return snapshot.link ?? snapshot.follower_link;
}

/** Whether this page operates. */
export function operates() {
  return session.connected && session.now?.seat.operator === session.page;
}

/** Sends a request, if there is a connection. */
export function send(request) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(request));
}

function take(message) {
  if (message.type === "snapshot") {
    if (message.nodes) session.nodes = message.nodes;
    if (message.events) session.events = message.events;
    message.at = performance.now();
    session.now = message;
    session.past.push(message);
    if (session.past.length > KEPT) session.past.splice(0, session.past.length - KEPT);
    tell("snapshot", message);
  } else if (message.type === "hello") {
    session.page = message.page;
    session.about = message.session;
    session.past.length = 0;
    tell("hello");
  } else if (message.type === "refused") {
    tell("refused", message.reason);
  }
}

/** Connects, and again whenever the connection is lost. */
export function connect() {
  socket = new WebSocket(socketAddress("/api/session"));
  socket.onopen = () => {
    pause = 500;
    session.connected = true;
    tell("connection");
  };
  socket.onmessage = (event) => take(JSON.parse(event.data));
  socket.onclose = () => {
    session.connected = false;
    tell("connection");
    setTimeout(connect, pause);
    pause = Math.min(pause * 2, 8000);
  };
}
