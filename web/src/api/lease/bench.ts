import { onlyLooks } from "../access";
import { ApiError, problemOf } from "../problem";
import { startBeat } from "./beat";
import { Gate } from "./gate";
import { type Lease, LeaseClient } from "./LeaseClient";
import { sayGone, sayHere, sessionHeaders, userName } from "./session";

const URL = "/api/v1/lease";
const LOOK_EVERY_MS = 1000;
/** The user has told all motors to stop, here on this page. */
export const STOP_EVENT = "stepscope:stop";

async function call(method: string, path = "", body?: unknown): Promise<Lease> {
  const answer = await fetch(URL + path, {
    method,
    headers: { ...sessionHeaders(), ...(body === undefined ? {} : { "content-type": "application/json" }) },
    ...(body === undefined ? {} : { body: JSON.stringify(body) }),
  });
  const said: unknown = await answer.json().catch(() => undefined);
  if (!answer.ok) throw new ApiError(problemOf(said));
  return said as Lease;
}

/** This page's lease. */
export const leaseClient = new LeaseClient({
  look: () => {
    sayHere();
    return call("GET");
  },
  take: () => call("POST", "", { name: userName() }),
  change: (change) => call("PUT", "", change),
  giveBack: () => call("DELETE"),
  ask: () => call("POST", "/ask", { name: userName() }),
  handOver: (to) => call("POST", "/hand-over", { to }),
  beat: startBeat,
  onlyLooks,
});

/** Everything that the page sends goes through here. */
export const gate = new Gate(
  leaseClient,
  (request) => {
    for (const [name, value] of Object.entries(sessionHeaders())) request.headers.set(name, value);
    return fetch(request);
  },
  onlyLooks,
);

/**
 * The last tab that goes leaves: at rest the bench is free at once, else what is set for vanishing takes care of the
 * motors, and a page that is only loaded anew is back before. Not sendBeacon: that cannot say whose session it is. A
 * tab that is too busy for this is missed by the server when its socket ends.
 */
function leave() {
  if (sayGone() || !leaseClient.mine) return;
  void fetch(`${URL}/leave`, { method: "POST", headers: sessionHeaders(), keepalive: true });
}

/** Look at the lease from now on, for as long as the page is seen; what keeps it alive goes on when it is not. */
export function watchLease(): void {
  void leaseClient.refresh();
  setInterval(() => document.hidden || void leaseClient.refresh(), LOOK_EVERY_MS);
  document.addEventListener("visibilitychange", () => document.hidden || void leaseClient.refresh());
  window.addEventListener("pagehide", leave);
  window.addEventListener("pageshow", (event) => event.persisted && void leaseClient.refresh());
  window.addEventListener(STOP_EVENT, () => leaseClient.drop());
}
