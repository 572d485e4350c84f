import { describe, expect, it } from "vitest";
import { about, MODELS } from "../../../test/catalog";
import { FAMILIES } from "../../families/families";
import { type EventEntry, EventLog, isFault, lanesOf, nearest } from "./EventLog";

const BITS = ["TARGET_REACHED", "STOPL_EVENT", "RST_EV"];
const entry = (seq: number, timeS: number, names: string[], unixS: number | null = 1000 + timeS): EventEntry => ({
  seq,
  timeS,
  unixS,
  names,
});

describe("EventLog", () => {
  it("takes each entry once, whoever tells it first, and keeps the fuller one", () => {
    const log = new EventLog();
    log.add([entry(2, 1.5, ["RST_EV"], null)]);
    log.page([entry(1, 1, ["STOPL_EVENT"]), entry(2, 1.5, ["RST_EV"])], 2, 0);
    expect(log.entries.map(({ seq, unixS }) => [seq, unixS])).toEqual([
      [1, 1001],
      [2, 1001.5],
    ]);
    const { revision } = log;
    log.add([entry(2, 1.5, ["RST_EV"], null)]);
    expect(log.revision).toBe(revision);
    expect(log.entries[1]?.unixS).toBe(1001.5);
  });

  it("begins anew where the server's count does", () => {
    const log = new EventLog();
    log.page([entry(7, 1, ["RST_EV"])], 7, 3);
    expect(log.lost).toBe(3);
    log.page([], 0, 0);
    expect(log.entries).toEqual([]);
    expect(log.asked).toBe(0);
    expect(log.lost).toBe(0);
  });

  it("forgets the oldest beyond what the server keeps", () => {
    const log = new EventLog();
    log.add(Array.from({ length: 2100 }, (_, index) => entry(index + 1, index, ["RST_EV"])));
    expect(log.entries).toHaveLength(2000);
    expect(log.entries[0]?.seq).toBe(101);
  });
});

describe("lanes", () => {
  const lanes = lanesOf([entry(1, 1, ["RST_EV", "NEW_ONE"]), entry(2, 2, ["TARGET_REACHED", "RST_EV"])], BITS);

  it("has a row for each bit that occurred, in the register's order", () => {
    expect(lanes.map((lane) => lane.name)).toEqual(["TARGET_REACHED", "RST_EV", "NEW_ONE"]);
    expect(lanes[1]).toMatchObject({ times: [1, 2], seqs: [1, 2] });
  });

  it("finds the mark under the pointer, and none where there is none", () => {
    expect(nearest(lanes[1], 1.4, 0.5)).toBe(0);
    expect(nearest(lanes[1], 1.5, 0.6)).toBe(1);
    expect(nearest(lanes[1], 3, 0.5)).toBeNull();
    expect(nearest(undefined, 1, 1)).toBeNull();
  });

  it("tells faults from what is wanted", () => {
    expect(isFault("ENC_FAIL")).toBe(true);
    expect(isFault("TARGET_REACHED")).toBe(false);
    expect(isFault("INT_REF_WRONG")).toBe(true);
    expect(isFault("INT_POS_END")).toBe(false);
    expect(isFault("drv_err2")).toBe(true);
    expect(isFault("event_pos_reached")).toBe(false);
    // standstill is one of the driver's flags that make it
    expect(isFault("MOTOR_EV")).toBe(false);
  });
});

describe("the registers of events", () => {
  const eventRegisters = (model: string) => FAMILIES[about(model).family]?.events;

  it("are the family's", () => {
    expect(eventRegisters("tmc4361")).toEqual(["EVENTS"]);
    expect(eventRegisters("tmc5072")).toEqual(["RAMP_STAT", "GSTAT"]);
    expect(eventRegisters("tmc428")).toContain("interrupt_mask_interrupt_flags");
  });

  it("are there where the chip has events, and nowhere else", () => {
    for (const { name, capabilities } of MODELS)
      expect(eventRegisters(name)?.length !== 0, name).toBe(capabilities.includes("events"));
  });
});
