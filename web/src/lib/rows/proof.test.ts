import { expect, it } from "vitest";
import { microstepShift } from "../../families/tmc428/ramps/Inverse";
import { sameNote } from "../../pages/microsteps/mslut/Chip";
import { READ_BACK, WRITTEN_BLIND, writtenLines } from "../../pages/profiles/steps";
import type { RegisterRow } from "./bits";
import { proofOf } from "./proof";

it("never calls read back what cannot be read", () => {
  expect(proofOf({ verified: true })).toBe("read back");
  expect(proofOf({ verified: null, note: "cannot be read back" })).toBe("written, cannot be read back");
  expect(proofOf({ verified: null, note: "" })).toBe("written, a read-back proves nothing");
});

it("says of a profile's writes which of them were read back", () => {
  const rows = [
    { name: "VMAX", axis: 0, access: "W" },
    { name: "XACTUAL", axis: 0, access: "RW" },
  ] as unknown as RegisterRow[];
  const written = ["VMAX", "XACTUAL", "NEWER"].map((name) => ({
    name,
    axis: 0,
    table: null,
    was: 0,
    now: 1,
    wanted: 1,
    why: "",
  }));
  const fates = writtenLines({ written }, rows).map(({ fate }) => fate);
  expect(fates).toEqual([WRITTEN_BLIND, READ_BACK, "written"]);
  expect(writtenLines({ written }, null)[0]?.fate).toBe("written");
});

it("does not say that a chip holds a wave whose registers are others", () => {
  const registers = (values: number[]) => values.map((value) => ({ value }) as never);
  const held = { registers: registers([1, 2, 3]), written: true };
  expect(sameNote({ registers: registers([1, 2, 3]) }, held)).toBe("this wave was written");
  expect(sameNote({ registers: registers([1, 5, 6]) }, held)).toContain("2 of 3 differ");
});

it("says what other microsteps shift", () => {
  expect(microstepShift(4, 4)).toBeNull();
  expect(microstepShift(4, 6)).toContain("16 to 64 microsteps");
  expect(microstepShift(4, 6)).toContain("1/4 as far");
  expect(microstepShift(6, 4)).toContain("4 times as far");
});
