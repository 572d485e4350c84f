import { describe, expect, it } from "vitest";
import { about } from "../../../test/catalog";
import type { Device } from "../../api/queries";
import { parseAddresses } from "./addresses";
import {
  changeBody,
  createBody,
  type Draft,
  draftOf,
  linkOf,
  linkValues,
  newDraft,
  problemsOf,
  withModel,
} from "./draft";
import { fieldsOf, linkForm, type Values } from "./form";
import { kindsOf } from "./models";
import { freeName, linkText } from "./words";

const DEVICE = {
  id: "bench",
  name: "bench",
  model: "tmc428",
  about: about("tmc428"),
  link: { kind: "emulator", seed: 7, stages: [{ right_at_fullsteps: 5000 }] },
  clock_hz: 8e6,
  axes: ["X", "Y", "Z"].map((name, index) => ({
    index,
    name,
    full_steps_per_rev: 400,
    driver_microsteps: 16,
    gear_ratio: 1,
    travel_mm_per_rev: index === 2 ? null : 8,
  })),
} as unknown as Device;

/** The draft with something typed of its link. */
function typed(draft: Draft, values: Values): Draft {
  return { ...draft, links: { ...draft.links, [draft.kind]: { ...linkValues(draft), ...values } } };
}

describe("a new connection", () => {
  it("says only what was typed, so that the server's defaults hold", () => {
    const draft = { ...newDraft(about("tmc428")), name: " bench " };
    expect(problemsOf(draft)).toEqual({});
    const body = createBody(draft);
    expect(body).toMatchObject({ name: "bench", model: "tmc428", link: { kind: "emulator" }, clock_hz: null });
    expect(Object.keys(body.link)).toEqual(["kind"]);
    expect(body.axes.map((axis) => axis.name)).toEqual(["X", "Y", "Z"]);
    expect(body.axes[0]).toMatchObject({ full_steps_per_rev: 200, gear_ratio: 1, travel_mm_per_rev: null });
  });

  it("has as many axes as the chip, and keeps what was typed of them", () => {
    const draft = newDraft(about("tmc428"), "tcp");
    draft.axes = draft.axes.map((axis) => ({ ...axis, gear_ratio: "3" }));
    const one = withModel(draft, about("tmc4210"));
    expect(one.axes).toHaveLength(1);
    expect(withModel(one, about("tmc428")).axes.map((axis) => axis.gear_ratio ?? "")).toEqual(["3", "", ""]);
  });

  it("says where the emulated chip lets its velocity be written, and keeps it in an edit", () => {
    const draft = typed(newDraft(about("tmc428")), { v_actual_writable: "velocity-mode" });
    expect(linkOf(draft)).toEqual({ kind: "emulator", v_actual_writable: "velocity-mode" });
    const held = { ...DEVICE, link: { kind: "emulator", v_actual_writable: "velocity-mode" } } as Device;
    expect(linkValues(draftOf(held)).v_actual_writable).toBe("velocity-mode");
    expect(changeBody(draftOf(held), typed(draftOf(held), { seed: "3" })).link).toMatchObject({
      kind: "emulator",
      seed: 3,
      v_actual_writable: "velocity-mode",
    });
  });

  it("gives the emulated driver the microsteps that the axis is reckoned with", () => {
    const draft = newDraft(about("tmc4210"));
    draft.axes = draft.axes.map((axis) => ({ ...axis, driver_microsteps: "32" }));
    expect(linkOf(draft)).toEqual({ kind: "emulator", driver_microsteps: 32 });
  });
});

describe("what is refused before it is sent", () => {
  const good = { ...newDraft(about("tmc428"), "tcp", { port: "4280" }), name: "far" };
  it("takes a complete tcp link", () => {
    expect(problemsOf(good, ["bench"])).toEqual({});
    expect(linkOf(good)).toEqual({ kind: "tcp", host: "127.0.0.1", port: 4280 });
  });

  it.each([
    ["name", { name: " " }],
    ["name", { name: "Bench" }],
    ["name", { name: "x".repeat(61) }],
    ["link.port", typed(good, { port: "" })],
    ["link.port", typed(good, { port: "70000" })],
    ["link.port", typed(good, { port: "42.5" })],
    ["link.host", typed(good, { host: "" })],
    ["link.host", typed(good, { host: "no name" })],
    ["link.timeout_s", typed(good, { timeout_s: "0" })],
    ["clock_mhz", { clockMhz: "0" }],
    ["clock_mhz", { clockMhz: "20" }],
    ["clock_mhz", { clockMhz: "fast" }],
    [
      "axes.1.gear_ratio",
      { axes: good.axes.map((axis, index) => (index === 1 ? { ...axis, gear_ratio: "0" } : axis)) },
    ],
    ["axes.2.name", { axes: good.axes.map((axis, index) => (index === 2 ? { ...axis, name: "" } : axis)) }],
  ])("refuses %s of %j", (path, change) => {
    expect(Object.keys(problemsOf({ ...good, ...change }, ["bench"]))).toEqual([path]);
  });

  it("lets a TMC4210 run at 32 MHz", () => {
    expect(problemsOf({ ...withModel(good, about("tmc4210")), clockMhz: "32" })).toEqual({});
  });

  it("checks a stage against the defaults of what was not said", () => {
    const draft = typed(
      { ...newDraft(about("tmc428")), name: "bench" },
      { "stages.0.left_at_fullsteps": "8000", "stages.0.ref_from_fullsteps": "400" },
    );
    expect(Object.keys(problemsOf(draft)).sort()).toEqual([
      "link.stages.0.ref_to_fullsteps",
      "link.stages.0.right_at_fullsteps",
    ]);
  });
});

describe("editing", () => {
  it("shows a device as it is and sends nothing when nothing changed", () => {
    const draft = draftOf(DEVICE);
    expect(draft.clockMhz).toBe("8");
    expect(linkValues(draft)).toMatchObject({ seed: "7", wiring: "", "stages.0.right_at_fullsteps": "5000" });
    expect(draft.axes[2]?.travel_mm_per_rev).toBe("");
    expect(changeBody(draft, { ...draft })).toEqual({});
  });

  it("does not touch the link for a new name or axis, and sends both for a new clock of an emulator", () => {
    const draft = draftOf(DEVICE);
    expect(changeBody(draft, { ...draft, name: "table" })).toEqual({ name: "table" });
    const axes = draft.axes.map((axis) => ({ ...axis, travel_mm_per_rev: "5" }));
    expect(Object.keys(changeBody(draft, { ...draft, axes }))).toEqual(["axes"]);
    const faster = changeBody(draft, { ...draft, clockMhz: "16" });
    expect(faster.clock_hz).toBe(16e6);
    expect(faster.link).toMatchObject({ kind: "emulator", seed: 7, clock_hz: 16e6 });
  });
});

describe("a link in one line", () => {
  it("names what matters", () => {
    expect(linkText({ kind: "tcp", host: "10.0.0.2", port: 4280 })).toBe("tcp 10.0.0.2:4280");
    expect(linkText({ kind: "emulator", time_scale: 10 })).toBe("emulated in this server, time × 10");
  });
});

describe("a name for a new device", () => {
  it("is the one wanted, or the next that is free", () => {
    expect(freeName("tmc428", [])).toBe("tmc428");
    expect(freeName("tmc428", ["TMC428", "tmc428 2"])).toBe("tmc428 3");
  });
});

describe("a link to a module", () => {
  const serial = () => ({ ...newDraft(about("pd42-1241"), "serial", { port: " /dev/ttyACM0 " }), name: "drive" });

  it("says only what was typed", () => {
    expect(problemsOf(serial())).toEqual({});
    expect(linkOf(serial())).toEqual({ kind: "serial", port: "/dev/ttyACM0" });
    const shared = typed(serial(), { baud: "115200", address: "3", timeout_s: "0.5" });
    expect(linkOf(shared)).toEqual({ kind: "serial", port: "/dev/ttyACM0", baud: 115200, address: 3, timeout_s: 0.5 });
    expect(createBody(shared)).toMatchObject({ model: "pd42-1241", clock_hz: null });
  });

  it.each([
    ["serial", "link.port", { port: "" }],
    ["serial", "link.address", { address: "0" }],
    ["serial", "link.baud", { baud: "12" }],
    ["tcp", "link.port", { port: "" }],
    ["can", "link.channel", { channel: " " }],
    ["can", "link.send_id", { send_id: "2048" }],
    ["emulator", "link.supply_v", { supply_v: "61" }],
    ["emulator", "link.stage.right_at_fullsteps", { "stage.right_at_fullsteps": "-4000" }],
  ] as const)("over %s refuses %s of %j", (kind, path, change) => {
    const port = kind === "serial" ? "/dev/ttyACM0" : "4242";
    const draft = { ...newDraft(about("pd42-1241"), kind, { port }), name: "drive" };
    expect(Object.keys(problemsOf(typed(draft, change)))).toEqual([path]);
  });

  it("over CAN names interface and channel", () => {
    const draft = newDraft(about("pd42-1241"), "can");
    expect(linkOf(draft)).toEqual({ kind: "can", interface: "socketcan", channel: "can0" });
  });

  it("to an emulated one keeps what the form does not show", () => {
    const link = { kind: "emulator", seed: 3, motor: { rotor_teeth: 100, holding_torque_nm: 1 }, stage: {} };
    const device = {
      ...DEVICE,
      model: "pd42-1241",
      about: about("pd42-1241"),
      link,
      axes: [DEVICE.axes[0]],
    } as unknown as Device;
    const draft = draftOf(device);
    expect(linkValues(draft)["motor.holding_torque_nm"]).toBe("1");
    expect(linkOf(typed(draft, { "motor.holding_torque_nm": "", "load.torque_nm": "0.1" }))).toEqual({
      kind: "emulator",
      seed: 3,
      motor: { rotor_teeth: 100 },
      load: { torque_nm: 0.1 },
    });
  });

  it("goes back to an emulator when the model has no such link", () => {
    expect(withModel(serial(), about("tmc428")).kind).toBe("emulator");
    expect(withModel(newDraft(about("tmc428"), "tcp"), about("pd42-1241")).kind).toBe("tcp");
  });

  it("is told in one line", () => {
    expect(linkText({ kind: "serial", port: "/dev/ttyACM0", baud: 115200, address: 2 })).toBe(
      "serial /dev/ttyACM0 at 115\u202f200 baud, address 2",
    );
    expect(linkText({ kind: "can", interface: "socketcan", channel: "can0" })).toBe("can socketcan can0");
  });
});

describe("a TMC4361", () => {
  const named = { ...newDraft(about("tmc4361")), name: "far" };

  it("has a board, a socket and an SPI bus besides the emulator", () => {
    expect(kindsOf(about("tmc4361")).map((kind) => kind.value)).toEqual([
      "emulator",
      "landungsbruecke",
      "tcp",
      "spidev",
    ]);
    expect(linkOf(named)).toEqual({ kind: "emulator" });
    expect(withModel({ ...named, kind: "landungsbruecke" }, about("tmc428")).kind).toBe("emulator");
  });

  it("is reached over a board once the port is said", () => {
    const board = { ...named, kind: "landungsbruecke" as const };
    expect(problemsOf(board)).toHaveProperty(["link.port"]);
    const ready = typed(board, { timeout_s: "0.5", port: " /dev/ttyACM0 " });
    expect(problemsOf(ready)).toEqual({});
    const link = { kind: "landungsbruecke", port: "/dev/ttyACM0", timeout_s: 0.5 };
    expect(linkOf(ready)).toEqual(link);
    expect(linkText(link)).toBe("evaluation board at /dev/ttyACM0");
    const device = {
      ...DEVICE,
      model: "tmc4361",
      about: about("tmc4361"),
      link,
      axes: DEVICE.axes.slice(0, 1),
    } as unknown as Device;
    expect(linkOf(draftOf(device))).toEqual(link);
  });

  it("keeps of its link what the form does not show", () => {
    const of = (link: object) =>
      draftOf({
        ...DEVICE,
        model: "tmc4361",
        about: about("tmc4361"),
        link,
        axes: DEVICE.axes.slice(0, 1),
      } as unknown as Device);
    const emulated = { kind: "emulator", seed: 3, motor: { resistance_ohm: 1 }, encoder: { kind: "ssi" } };
    const faster = typed(of(emulated), { time_scale: "2" });
    expect(changeBody(of(emulated), faster).link).toEqual({
      ...emulated,
      time_scale: 2,
      clock_hz: 8e6,
    });
    const board = { kind: "landungsbruecke", port: "/dev/ttyACM0", baud: 9600, motor: 2 };
    expect(changeBody(of(board), typed(of(board), { timeout_s: "0.5" })).link).toEqual({ ...board, timeout_s: 0.5 });
    const bus = { kind: "spidev", bus: 1, device: 0, mode: 0 };
    const other = changeBody(of(bus), typed(of(bus), { bus: "1", device: "1", speed_hz: "" }));
    expect(other.link).toEqual({ ...bus, device: 1 });
    // another kind of link is another link
    expect(linkOf({ ...of(board), kind: "spidev" })).toEqual({ kind: "spidev", bus: 0, device: 0 });
  });

  it("takes no more of the emulator's time than that can be worked out in", () => {
    expect(problemsOf(typed(named, { time_scale: "20" }))).toEqual({});
    expect(problemsOf(typed(named, { time_scale: "21" }))).toHaveProperty(["link.time_scale"]);
  });

  it("is reached on the first bus where nothing is said", () => {
    const spi = { ...named, kind: "spidev" as const };
    expect(problemsOf(spi)).toEqual({});
    expect(linkOf(spi)).toEqual({ kind: "spidev", bus: 0, device: 0 });
    const other = typed(spi, { bus: "1", device: "2", speed_hz: "4000000" });
    expect(linkOf(other)).toEqual({ kind: "spidev", bus: 1, device: 2, speed_hz: 4_000_000 });
    expect(problemsOf(typed(spi, { bus: "x", device: "256", speed_hz: "5" }))).toEqual({
      "link.bus": expect.stringContaining("Not a number"),
      "link.device": expect.stringContaining("255"),
      "link.speed_hz": expect.stringContaining("10"),
    });
    expect(linkText({ kind: "spidev", bus: 1, device: 0 })).toBe("spi 1.0");
  });
});

describe("a TMC5xxx", () => {
  const named = (model: string) => ({ ...newDraft(about(model)), name: "far" });
  const uart = (model: string, values: Values = {}) => ({
    ...newDraft(about(model), "uart", { port: " /dev/ttyUSB0 ", ...values }),
    name: "far",
  });

  it("has a UART where the chip has one, and two axes where it has two", () => {
    const kinds = (name: string) => kindsOf(about(name)).map((kind) => kind.value);
    expect(kinds("tmc5160")).toEqual(["emulator", "uart", "landungsbruecke", "tcp", "spidev"]);
    expect(kinds("tmc5031")).not.toContain("uart");
    expect(withModel(uart("tmc5130"), about("tmc5031")).kind).toBe("emulator");
    expect(named("tmc5072").axes.map((axis) => axis.name)).toEqual(["X", "Y"]);
    expect(named("tmc5130").axes).toHaveLength(1);
    expect(linkOf(named("tmc5062"))).toEqual({ kind: "emulator" });
  });

  it("is reached over a UART once the port is said", () => {
    expect(problemsOf(uart("tmc5130", { port: "" }))).toHaveProperty(["link.port"]);
    expect(problemsOf(uart("tmc5130"))).toEqual({});
    expect(linkOf(uart("tmc5130"))).toEqual({ kind: "uart", port: "/dev/ttyUSB0" });
    const said = uart("tmc5160", { timeout_s: "0.5", baud: "500000", node: "3", echo: "on" });
    const link = { kind: "uart", port: "/dev/ttyUSB0", baud: 500_000, node: 3, echo: "on", timeout_s: 0.5 };
    expect(linkOf(said)).toEqual(link);
    expect(linkText(link)).toBe("uart /dev/ttyUSB0 at 500\u202f000 baud, node 3");
    const device = {
      ...DEVICE,
      model: "tmc5160",
      about: about("tmc5160"),
      link,
      axes: DEVICE.axes.slice(0, 1),
    } as unknown as Device;
    expect(linkOf(draftOf(device))).toEqual(link);
    expect(changeBody(draftOf(device), draftOf(device))).toEqual({});
  });

  it("has drivers behind a controller to choose, of each axis or the one of a TMC4361", () => {
    const chain = typed(named("tmc428"), { "drivers.1.driver": "tmc2660", "drivers.1.supply_v": "36" });
    expect(problemsOf(chain)).toEqual({});
    expect(linkOf(chain)).toEqual({ kind: "emulator", drivers: [{}, { driver: "tmc2660", supply_v: 36 }, {}] });
    expect(linkOf(typed(named("tmc4361"), { driver: "tmc2660" }))).toEqual({ kind: "emulator", driver: "tmc2660" });
    const paths = fieldsOf(linkForm(about("tmc4210"), "emulator"), 1).map(({ path }) => path);
    expect(paths.some((path) => path.startsWith("drivers"))).toBe(false);
  });

  it("has a motor and a stage to set, and no home switch", () => {
    const draft = typed(named("tmc5072"), { "motor.holding_torque_nm": "1", "encoder.lines": "500" });
    expect(problemsOf(draft)).toEqual({});
    expect(linkOf(draft)).toEqual({ kind: "emulator", motor: { holding_torque_nm: 1 }, encoder: { lines: 500 } });
    const keys = (name: string) => fieldsOf(linkForm(about(name), "emulator")).map(({ path }) => path);
    expect(keys("tmc5072").some((key) => key.includes("home"))).toBe(false);
    expect(keys("tmc5031").some((key) => key.includes("encoder"))).toBe(false);
    expect(keys("tmc428").some((key) => key.includes("motor"))).toBe(false);
  });

  it("stays rigid until something is said of its motor", () => {
    const link = { kind: "emulator", motor: "rigid" };
    const device = {
      ...DEVICE,
      model: "tmc5130",
      about: about("tmc5130"),
      link,
      axes: DEVICE.axes.slice(0, 1),
    } as unknown as Device;
    const draft = draftOf(device);
    expect(linkOf(typed(draft, { seed: "7" }))).toMatchObject({ motor: "rigid", seed: 7 });
    const soft = typed(draft, { "motor.rated_current_a": "2" });
    expect(linkOf(soft)).toMatchObject({ motor: { rated_current_a: 2 } });
  });

  it("has no node to say where its datagrams bear none", () => {
    const draft = uart("tmc5062", { node: "3" });
    expect(problemsOf(draft)).toEqual({});
    expect(linkOf(draft)).toEqual({ kind: "uart", port: "/dev/ttyUSB0" });
  });

  it.each([
    ["link.node", uart("tmc5072", { node: "255" })],
    ["link.baud", uart("tmc5072", { baud: "12" })],
    ["link.timeout_s", uart("tmc5072", { timeout_s: "0" })],
    ["clock_mhz", { clockMhz: "20" }],
    ["clock_mhz", { clockMhz: "3.9" }],
  ])("refuses %s of %j", (path, change) => {
    expect(Object.keys(problemsOf({ ...uart("tmc5072"), ...change }))).toEqual([path]);
  });
});

describe("addresses to probe", () => {
  it("are numbers and ranges", () => {
    expect(parseAddresses("1-4, 7 2")).toEqual({ ok: true, list: [1, 2, 3, 4, 7] });
    expect(parseAddresses("")).toEqual({ ok: true, list: [] });
  });

  it.each(["0", "256", "4-1", "a", "1--2"])("refuses %s", (text) => {
    expect(parseAddresses(text).ok).toBe(false);
  });
});
