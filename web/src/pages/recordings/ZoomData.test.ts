import { describe, expect, it } from "vitest";
import { good, type Piece, type Window, ZoomData } from "./ZoomData";

const ROWS = 600_000;
const END = ROWS / 1000;

/** A server with ten minutes at 1 kHz; answers wait until they are let go. */
function server() {
  const asked: { window: Window | null; points: number; answer: (piece?: Piece) => void; fail: () => void }[] = [];
  const fetch = (window: Window | null, points: number) =>
    new Promise<Piece>((resolve, reject) => {
      const [from, to] = window ?? [Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY];
      const first = Math.max(0, from);
      const last = Math.min(END, to);
      const rows = Math.round((last - first) * 1000);
      const count = Math.min(rows, points);
      const x = Float64Array.from(
        { length: count },
        (_, row) => first + ((last - first) * row) / Math.max(1, count - 1),
      );
      const piece = { from, to, x, columns: [x], exact: rows <= points };
      asked.push({ window, points, answer: () => resolve(piece), fail: () => reject(new Error("gone")) });
    });
  return { asked, fetch };
}

const settled = () => new Promise((resolve) => setTimeout(resolve));

async function loaded() {
  const { asked, fetch } = server();
  let changes = 0;
  const data = new ZoomData(fetch, () => {
    changes += 1;
  });
  const loading = data.load(4000);
  asked[0]?.answer();
  await loading;
  return { asked, data, changes: () => changes };
}

describe("zooming into a recording", () => {
  it("draws the overview at once and fetches what is finer, wider than asked", async () => {
    const { asked, data, changes } = await loaded();
    data.show([0, END], 1200);
    expect(asked).toHaveLength(1); // the overview is enough
    data.show([100, 110], 1200);
    expect(data.best([100, 110])).toBe(data.overview);
    expect(asked[1]?.window).toEqual([95, 115]);
    asked[1]?.answer();
    await settled();
    expect(changes()).toBe(2);
    expect(data.best([100, 110])).not.toBe(data.overview);
    expect(good(data.best([100, 110]) as Piece, [100, 110], 1200)).toBe(true);
    data.show([103, 113], 1200); // panned a little: it is there
    expect(asked).toHaveLength(2);
  });

  it("asks for one piece at a time, and then for where the plot is by then", async () => {
    const { asked, data } = await loaded();
    for (let size = 100; size > 1; size *= 0.8) data.show([300, 300 + size], 1200);
    expect(asked).toHaveLength(2);
    asked[1]?.answer();
    await settled();
    expect(asked).toHaveLength(3);
    const [from = 0, to = 0] = asked[2]?.window ?? [];
    expect(to - from).toBeLessThan(3);
    asked[2]?.answer();
    await settled();
    expect(asked).toHaveLength(3);
    expect(data.best([300, 301])?.exact).toBe(true);
  });

  it("keeps what it has where a fetch fails, says so, and tries again with the next look", async () => {
    const { asked, data } = await loaded();
    data.show([10, 11], 1200);
    asked[1]?.fail();
    await settled();
    expect(data.problem).toBeInstanceOf(Error);
    expect(data.best([10, 11])).toBe(data.overview);
    expect(asked).toHaveLength(2);
    data.show([10, 11.1], 1200);
    asked[2]?.answer();
    await settled();
    expect(data.problem).toBeNull();
  });

  it("forgets pieces that reached the end of a recording that has grown", async () => {
    const { asked, data } = await loaded();
    data.show([END - 2, END], 1200);
    asked[1]?.answer();
    await settled();
    data.show([50, 51], 1200);
    asked[2]?.answer();
    await settled();
    const loading = data.load(4000);
    asked[3]?.answer();
    await loading;
    expect(data.best([50, 51])).not.toBe(data.overview);
    expect(data.best([END - 1.5, END - 0.5])).toBe(data.overview);
  });
});
