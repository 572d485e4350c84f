import { describe, expect, it, vi } from "vitest";
import { Scrubber } from "./Scrubber";

const at = (time_s: number) => ({ recording: "r", time_s });

function made() {
  const sent: { time_s: number; done: () => void; fail: (error: unknown) => void }[] = [];
  const send = ({ time_s }: { time_s: number }) =>
    new Promise<void>((done, fail) => {
      sent.push({ time_s, done, fail });
    });
  const failed = vi.fn();
  return { sent, failed, scrubber: new Scrubber(send, failed, () => Promise.resolve()) };
}
const settled = () => new Promise((done) => setTimeout(done, 0));

describe("Scrubber", () => {
  it("sends the latest place when the one before has arrived", async () => {
    const { sent, scrubber } = made();
    for (const time of [1, 2, 3]) scrubber.to(at(time));
    expect(sent.map(({ time_s }) => time_s)).toEqual([1]);
    sent[0]?.done();
    await settled();
    expect(sent.map(({ time_s }) => time_s)).toEqual([1, 3]);
  });

  it("goes on after a failure, and tells of it", async () => {
    const { sent, failed, scrubber } = made();
    scrubber.to(at(1));
    sent[0]?.fail("no");
    await settled();
    scrubber.to(at(2));
    expect(failed).toHaveBeenCalledWith("no");
    expect(sent.map(({ time_s }) => time_s)).toEqual([1, 2]);
  });

  it("is silent once it has ended", async () => {
    const { sent, failed, scrubber } = made();
    scrubber.to(at(1));
    scrubber.to(at(2));
    scrubber.end();
    sent[0]?.fail("late");
    await settled();
    scrubber.to(at(3));
    expect(sent).toHaveLength(1);
    expect(failed).not.toHaveBeenCalled();
  });
});
