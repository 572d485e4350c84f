import type { LeaseClient } from "./LeaseClient";
import { changesBench } from "./rules";

export type Fetch = (request: Request) => Promise<Response>;

/** The server's refusals for want of the lease. */
const REFUSALS: readonly unknown[] = ["/problems/bench-taken", "/problems/bench-not-taken"];
/** Ours: nothing was sent, because a user who only looks did not want the bench after all. */
export const ONLY_LOOKING = "/problems/only-looking";

/** What stands for the answer to a request that was not sent. */
function notSent(request: Request): Response {
  const problem = {
    type: ONLY_LOOKING,
    title: "Nothing was sent",
    status: 409,
    detail: "You are only looking: the bench is as it was.",
    way_out: "Take the bench, above, and do it again.",
    instance: new URL(request.url).pathname,
  };
  return new Response(JSON.stringify(problem), {
    status: problem.status,
    headers: { "content-type": "application/problem+json" },
  });
}

async function wantsLease(answer: Response): Promise<boolean> {
  if (answer.status !== 409) return false;
  const problem: unknown = await answer
    .clone()
    .json()
    .catch(() => null);
  return typeof problem === "object" && problem !== null && "type" in problem && REFUSALS.includes(problem.type);
}

interface Turn {
  request: Request;
  answer: Promise<Response>;
}

/**
 * Lets through what only reads. What changes the bench waits until it is ours, and is then sent, once. While it waits
 * the newest of a value's settings takes the place of those before it: a drag that opened the question sends its last.
 */
export class Gate {
  private readonly waiting = new Map<string, Turn>();

  constructor(
    private readonly lease: LeaseClient,
    private readonly send: Fetch,
    /** our token may never have the bench: the server says so to whatever is sent */
    private readonly onlyLooks: () => boolean = () => false,
  ) {}

  readonly fetch: Fetch = async (request) => {
    if (request.method === "GET" || this.onlyLooks()) return this.send(request);
    if (changesBench(request.method, request.url) && !this.lease.mine) return this.wait(request);
    const spare = request.clone();
    const answer = await this.send(request);
    if (!(await wantsLease(answer))) return answer;
    // it has done nothing, and may be sent once more when the bench is ours
    await this.lease.refused();
    return this.wait(spare);
  };

  /** For what is held down: goes now or not at all. Who holds it opens the question, `leaseClient.permitHeld`. */
  readonly held: Fetch = async (request) => {
    if (this.onlyLooks()) return this.send(request);
    if (this.lease.snapshot.lease !== null && !this.lease.mine) return notSent(request);
    const answer = await this.send(request);
    if (!(await wantsLease(answer))) return answer;
    await this.lease.refused();
    return notSent(request);
  };

  /** For what a page repeats by itself: never asks. */
  readonly quiet: Fetch = async (request) =>
    this.lease.snapshot.lease === null || this.lease.mine ? this.send(request) : notSent(request);

  private wait(request: Request): Promise<Response> {
    const key = `${request.method} ${request.url}`;
    const before = request.method === "PUT" || request.method === "PATCH" ? this.waiting.get(key) : undefined;
    if (before) {
      before.request = request;
      return before.answer.then((answer) => answer.clone());
    }
    const turn: Turn = { request, answer: this.lease.permit().then((go) => this.go(key, turn, go)) };
    this.waiting.set(key, turn);
    return turn.answer.then((answer) => answer.clone());
  }

  private go(key: string, turn: Turn, go: boolean): Promise<Response> {
    if (this.waiting.get(key) === turn) this.waiting.delete(key);
    return go ? this.send(turn.request) : Promise.resolve(notSent(turn.request));
  }
}
