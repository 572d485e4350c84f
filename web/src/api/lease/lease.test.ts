import { beforeEach, describe, expect, it } from "vitest";
import { Gate, ONLY_LOOKING } from "./gate";
import { type Lease, LeaseClient, type LeasePorts } from "./LeaseClient";
import { changesBench } from "./rules";
import { nameOfBrowser } from "./session";

const FREE: Lease = {
  state: "free",
  holder: null,
  mine: false,
  left: false,
  since_s: null,
  expires_in_s: null,
  asking: [],
  on_vanish: "stop",
  vanish_after_s: 15,
};
const MINE: Lease = { ...FREE, state: "taken", holder: "Me", mine: true, since_s: 0, expires_in_s: 15 };
const ANNS: Lease = { ...MINE, holder: "Ann", mine: false };
const MOVE = "http://bench/api/v1/devices/bench/axes/0/move";

const problem = (type: string) => new Response(JSON.stringify({ type, title: "No", detail: "no" }), { status: 409 });
const settle = () => new Promise((resolve) => setTimeout(resolve));
const post = (url = MOVE, body = "{}") => new Request(url, { method: "POST", body });
const patch = (body: string) => new Request("http://bench/api/v1/devices/bench/emulator", { method: "PATCH", body });

/** A server whose lease a test changes behind the page. */
class Server {
  lease: Lease = FREE;
  calls: string[] = [];
  beating = false;
  beat: () => void = () => undefined;
  sent: string[] = [];
  /** changes of the lease refused because it is not ours */
  refused = 0;
  /** refusals that the next requests get */
  refusals: string[] = [];

  readonly ports: LeasePorts = {
    look: () => this.say("look"),
    take: () => {
      if (this.lease.state === "taken" && !this.lease.mine && !this.lease.left)
        return Promise.reject(new Error("taken"));
      this.lease = MINE;
      return this.say("take");
    },
    change: () => {
      this.refused += Number(!this.lease.mine);
      return this.lease.mine ? this.say("change") : Promise.reject(new Error("refused"));
    },
    giveBack: () => {
      if (this.lease.mine) this.lease = FREE;
      return this.say("give back");
    },
    ask: () => this.say("ask"),
    handOver: (to) => {
      this.lease = ANNS;
      return this.say(`to ${to}`);
    },
    beat: (keep) => {
      this.beating = true;
      this.beat = keep;
      return () => {
        this.beating = false;
      };
    },
  };
  readonly client = new LeaseClient(this.ports);
  readonly gate = new Gate(this.client, async (request) => {
    const refusal = this.refusals.shift();
    if (refusal) return problem(refusal);
    this.sent.push(`${request.method} ${new URL(request.url).pathname.slice(8)} ${await request.text()}`.trim());
    return new Response("{}");
  });

  private async say(call: string): Promise<Lease> {
    this.calls.push(call);
    return this.lease;
  }
}

let server: Server;
beforeEach(() => {
  server = new Server();
});

describe("a page that has not got the bench", () => {
  it("reads, calculates and stops without a question", async () => {
    await server.gate.fetch(new Request("http://bench/api/v1/devices"));
    await server.gate.fetch(post("http://bench/api/v1/stop"));
    await server.gate.fetch(post("http://bench/api/v1/calc/ramp"));
    expect(server.sent).toEqual(["GET devices", "POST stop {}", "POST calc/ramp {}"]);
    expect(server.client.snapshot.question).toBeNull();
  });

  it.each([FREE, { ...ANNS, left: true }])("takes it with the first change, without a question", async (lease) => {
    server.lease = lease;
    const answer = server.gate.fetch(post(MOVE, "1"));
    expect((await answer).ok).toBe(true);
    expect(server.sent).toEqual(["POST devices/bench/axes/0/move 1"]);
    expect(server.client.snapshot).toMatchObject({ question: null, news: null, problem: null });
    await server.gate.fetch(post(MOVE, "2"));
    expect(server.sent).toHaveLength(2);
  });

  it("takes it once for everything that waits, and keeps its order", async () => {
    const answers = ["1", "2", "3"].map((body) => server.gate.fetch(post(MOVE, body)));
    await Promise.all(answers);
    expect(server.sent.map((line) => line.slice(-1))).toEqual(["1", "2", "3"]);
    expect(server.calls.filter((call) => call === "take")).toHaveLength(1);
  });

  it("sends nothing that a stop has come behind while the bench was taken", async () => {
    const answer = server.gate.fetch(post());
    server.client.drop();
    expect((await answer).status).toBe(409);
    expect(server.sent).toEqual([]);
  });

  it("asks when another session was quicker", async () => {
    await server.client.refresh();
    server.lease = ANNS;
    const answer = server.gate.fetch(post());
    await settle();
    expect(server.client.snapshot).toMatchObject({ lease: { holder: "Ann" }, question: { cause: "change" } });
    await server.client.answer(false);
    expect((await answer).status).toBe(409);
  });

  it("sends the last setting alone of a drag that has taken the bench", async () => {
    const answers = ["1", "2", "3"].map((body) => server.gate.fetch(patch(body)));
    expect((await Promise.all(answers)).map((answer) => answer.ok)).toEqual([true, true, true]);
    expect(server.sent).toEqual(["PATCH devices/bench/emulator 3"]);
    await server.gate.fetch(patch("4"));
    expect(server.sent).toHaveLength(2);
  });

  it.each(["no", "stop"])("sends nothing when the answer is %s, and says so", async (how) => {
    server.lease = ANNS;
    const answer = server.gate.fetch(post());
    await settle();
    if (how === "no") await server.client.answer(false);
    else server.client.drop();
    const refused = await answer;
    expect(refused.status).toBe(409);
    expect((await refused.json()).type).toBe(ONLY_LOOKING);
    expect(server.sent).toEqual([]);
    expect(server.client.snapshot.question).toBeNull();
  });

  it("does not begin later what was held down, nor asks for what repeats by itself", async () => {
    server.lease = ANNS;
    await server.client.refresh();
    expect((await server.gate.quiet(patch("{}"))).status).toBe(409);
    expect(server.client.snapshot.question).toBeNull();
    expect((await server.gate.held(post())).status).toBe(409);
    expect(await server.client.permitHeld()).toBe(false);
    expect(server.client.snapshot.question?.cause).toBe("held");
    server.lease = FREE; // Ann has given it back: the question is still there
    await server.client.refresh();
    await server.client.answer(true);
    expect(server.sent).toEqual([]);
    expect(await server.client.permitHeld()).toBe(true);
    await server.gate.held(post());
    expect(server.sent).toHaveLength(1);
  });
});

describe("a bench that another session has", () => {
  beforeEach(async () => {
    server.lease = ANNS;
    await server.client.refresh();
  });

  it("is asked for, again and again, and what waits asks once more when it is handed over", async () => {
    const answer = server.gate.fetch(post());
    await settle();
    await server.client.ask();
    const asked = performance.now();
    await server.client.refresh(asked + 1000);
    await server.client.refresh(asked + 3000);
    expect(server.calls.filter((call) => call === "ask")).toHaveLength(2);
    server.lease = MINE;
    await server.client.refresh(asked + 3100);
    expect(server.client.snapshot).toMatchObject({ asking: false, question: { cause: "change", handed: true } });
    expect(server.sent).toEqual([]);
    await server.client.answer(true);
    await answer;
    expect(server.sent).toHaveLength(1);
    expect(server.calls).not.toContain("take");
  });

  it("is not asked for any more by who does not want it any more", async () => {
    await server.client.ask();
    server.client.stopAsking();
    await settle();
    expect(server.calls.at(-1)).toBe("give back");
    await server.client.refresh(performance.now() + 60_000);
    expect(server.calls.at(-1)).toBe("look");
  });

  it("stays a question when another session was quicker", async () => {
    const answer = server.gate.fetch(post());
    await settle();
    server.lease = FREE;
    await server.client.refresh();
    server.lease = ANNS;
    await server.client.answer(true);
    expect(server.client.snapshot).toMatchObject({ lease: { holder: "Ann" }, question: { cause: "change" } });
    await server.client.answer(false);
    expect((await answer).status).toBe(409);
  });
});

describe("a page that has the bench", () => {
  beforeEach(() => server.client.take());

  it("says that it is there, until it has given the bench back", async () => {
    expect(server.beating).toBe(true);
    server.beat();
    await settle();
    expect(server.calls.at(-1)).toBe("look");
    await server.client.giveBack();
    expect(server.beating).toBe(false);
    expect(server.client.snapshot.news).toBeNull();
  });

  it("tells when it has lost it", async () => {
    server.lease = ANNS;
    await server.client.refresh();
    expect(server.client.snapshot.news).toBe("lost");
    expect(server.beating).toBe(false);
  });

  it.each([FREE, ANNS])(
    "tells that it has lost it when a heartbeat finds it gone, and sends nothing refused",
    async (lease) => {
      server.lease = lease;
      server.beat();
      await settle();
      expect(server.refused).toBe(0);
      expect(server.client.snapshot).toMatchObject({ news: "lost", problem: null });
      expect(server.beating).toBe(false);
    },
  );

  it("takes it again when the server knows better, and sends what was refused", async () => {
    server.lease = FREE;
    server.refusals = ["/problems/bench-not-taken"];
    const answer = server.gate.fetch(post(MOVE, "again"));
    expect((await answer).ok).toBe(true);
    expect(server.sent).toEqual(["POST devices/bench/axes/0/move again"]);
  });

  it("shows a second refusal instead of asking for ever", async () => {
    server.refusals = ["/problems/bench-taken", "/problems/bench-taken"];
    const answer = await server.gate.fetch(post());
    expect(answer.status).toBe(409);
    expect(server.sent).toEqual([]);
  });

  it("takes other conflicts for what they are", async () => {
    server.refusals = ["/problems/wrong-state"];
    expect((await server.gate.fetch(post())).status).toBe(409);
    expect(server.client.snapshot.question).toBeNull();
  });

  it("believes no answer that a later one has overtaken", async () => {
    let late: (lease: Lease) => void = () => undefined;
    const client = new LeaseClient({
      ...server.ports,
      look: () => new Promise((resolve) => (late = resolve)),
    });
    const looking = client.refresh();
    await client.take();
    late(FREE);
    await looking;
    expect(client.mine).toBe(true);
  });
});

describe("changesBench", () => {
  const at = (path: string) => `http://bench/api/v1${path}`;
  it("is what the server says it is", () => {
    expect(changesBench("GET", at("/devices"))).toBe(false);
    expect(changesBench("POST", at("/devices"))).toBe(true);
    expect(changesBench("POST", at("/devices/a/axes/0/stop"))).toBe(false);
    expect(changesBench("POST", at("/devices/a/axes/0/move"))).toBe(true);
    expect(changesBench("DELETE", at("/devices/a/axes/0/shuttle"))).toBe(false);
    expect(changesBench("POST", at("/recordings"))).toBe(false);
    expect(changesBench("DELETE", at("/recordings/7"))).toBe(true);
    expect(changesBench("PUT", at("/devices/a/profile?dry_run=true"))).toBe(false);
    expect(changesBench("PUT", at("/devices/a/profile"))).toBe(true);
    expect(changesBench("POST", at("/devices/a/start-up?dry_run=true"))).toBe(false);
    expect(changesBench("POST", at("/devices/a/start-up"))).toBe(true);
    expect(changesBench("POST", at("/devices/a/profile?dry_run=true"))).toBe(true);
  });
});

describe("nameOfBrowser", () => {
  it.each([
    ["Mozilla/5.0 (X11; Linux x86_64; rv:140.0) Gecko/20100101 Firefox/140.0", "Firefox on Linux"],
    ["Mozilla/5.0 (Windows NT 10.0) AppleWebKit/537.36 Chrome/140.0 Safari/537.36 Edg/140.0", "Edge on Windows"],
    ["Mozilla/5.0 (iPhone; CPU iPhone OS 18_0 like Mac OS X) Version/18.0 Mobile Safari/604.1", "Safari on iOS"],
    ["curl/8", "Browser"],
  ])("%s", (agent, name) => expect(nameOfBrowser(agent)).toBe(name));
});
