import { describe, expect, it } from "vitest";
import { about } from "../../../test/catalog";
import type { Device } from "../../api/queries";
import { parseAddresses } from "./addresses";
import { changeBody, createBody, draftOf, linkOf, newDraft, problemsOf, withModel } from "./draft";
import { kindsOf } from "./models";
import { optionsOf } from "./options";
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
    draft.axes = draft.axes.map((axis) => ({ ...axis, gear: "3" }));
    const one = withModel(draft, about("tmc4210"));
    expect(one.axes).toHaveLength(1);
    expect(withModel(one, about("tmc428")).axes.map((axis) => axis.gear)).toEqual(["3", "", ""]);
  });

  it("says where the emulated chip lets its velocity be written, and keeps it in an edit", () => {
    const draft = { ...newDraft(about("tmc428")), vActualWritable: "velocity-mode" };
    expect(linkOf(draft)).toEqual({ kind: "emulator", v_actual_writable: "velocity-mode" });
    const held = { ...DEVICE, link: { kind: "emulator", v_actual_writable: "velocity-mode" } } as Device;
    expect(draftOf(held).vActualWritable).toBe("velocity-mode");
    expect(changeBody(draftOf(held), { ...draftOf(held), seed: "3" }).link).toMatchObject({
      kind: "emulator",
      seed: 3,
      v_actual_writable: "velocity-mode",
    });
  });

  it("gives the emulated driver the microsteps that the axis is reckoned with", () => {
    const draft = newDraft(about("tmc4210"));
    draft.axes = draft.axes.map((axis) => ({ ...axis, driverMicrosteps: "32" }));
    expect(linkOf(draft)).toEqual({ kind: "emulator", driver_microsteps: 32 });
  });
});

describe("what is refused before it is sent", () => {
  const good = { ...newDraft(about("tmc428"), "tcp"), name: "far", port: "4280" };
  it("takes a complete tcp link", () => {
    expect(problemsOf(good, ["bench"])).toEqual({});
    expect(linkOf(good)).toEqual({ kind: "tcp", host: "127.0.0.1", port: 4280 });
  });

  it.each([
    ["name", { name: " " }],
    ["name", { name: "Bench" }],
    ["name", { name: "x".repeat(61) }],
    ["port", { port: "" }],
    ["port", { port: "70000" }],
    ["port", { port: "42.5" }],
    ["host", { host: "" }],
    ["timeoutS", { timeoutS: "0" }],
    ["clockMhz", { clockMhz: "0" }],
    ["clockMhz", { clockMhz: "20" }],
    ["clockMhz", { clockMhz: "fast" }],
    ["axes.1.gear", { axes: good.axes.map((axis, index) => (index === 1 ? { ...axis, gear: "0" } : axis)) }],
    ["axes.2.name", { axes: good.axes.map((axis, index) => (index === 2 ? { ...axis, name: "" } : axis)) }],
  ])("refuses %s of %j", (path, change) => {
    expect(Object.keys(problemsOf({ ...good, ...change }, ["bench"]))).toEqual([path]);
  });

  it("lets a TMC4210 run at 32 MHz", () => {
    expect(problemsOf({ ...withModel(good, about("tmc4210")), clockMhz: "32" })).toEqual({});
  });

  it("checks a stage against the defaults of what was not said", () => {
    const draft = { ...newDraft(about("tmc428")), name: "bench" };
    draft.stages = draft.stages.map((stage, index) =>
      index === 0 ? { ...stage, left: "8000", refFrom: "400" } : stage,
    );
    expect(Object.keys(problemsOf(draft))).toEqual(["stages.0.right", "stages.0.refTo"]);
  });
});

describe("editing", () => {
  it("shows a device as it is and sends nothing when nothing changed", () => {
    const draft = draftOf(DEVICE);
    expect(draft).toMatchObject({ seed: "7", clockMhz: "8", wiring: "" });
    expect(draft.stages[0]?.right).toBe("5000");
    expect(draft.axes[2]?.travelMm).toBe("");
    expect(changeBody(draft, { ...draft })).toEqual({});
  });

  it("does not touch the link for a new name or axis, and sends both for a new clock of an emulator", () => {
    const draft = draftOf(DEVICE);
    expect(changeBody(draft, { ...draft, name: "table" })).toEqual({ name: "table" });
    const axes = draft.axes.map((axis) => ({ ...axis, travelMm: "5" }));
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
  const serial = () => {
    const draft = { ...newDraft(about("pd42-1241"), "serial"), name: "drive" };
    draft.module = { ...draft.module, serialPort: " /dev/ttyACM0 " };
    return draft;
  };

  it("says only what was typed", () => {
    expect(problemsOf(serial())).toEqual({});
    expect(linkOf(serial())).toEqual({ kind: "serial", port: "/dev/ttyACM0" });
    const shared = serial();
    shared.module = { ...shared.module, baud: "115200", address: "3", timeoutS: "0.5" };
    expect(linkOf(shared)).toEqual({ kind: "serial", port: "/dev/ttyACM0", baud: 115200, address: 3, timeout_s: 0.5 });
    expect(createBody(shared)).toMatchObject({ model: "pd42-1241", clock_hz: null });
  });

  it.each([
    ["serial", "module.serialPort", { serialPort: "" }],
    ["serial", "module.address", { address: "0" }],
    ["serial", "module.baud", { baud: "12" }],
    ["tcp", "module.tcpPort", { tcpPort: "" }],
    ["can", "module.canChannel", { canChannel: " " }],
    ["can", "module.sendId", { sendId: "2048" }],
    ["emulator", "options.supply_v", { options: { supply_v: "61" } }],
    ["emulator", "options.stage.right_at_fullsteps", { options: { "stage.right_at_fullsteps": "-4000" } }],
  ] as const)("over %s refuses %s of %j", (kind, path, change) => {
    const draft = { ...newDraft(about("pd42-1241"), kind), name: "drive" };
    draft.module = { ...draft.module, serialPort: "/dev/ttyACM0", tcpPort: "4242", ...change };
    draft.options = { ...("options" in change ? change.options : {}) };
    expect(Object.keys(problemsOf(draft))).toEqual([path]);
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
    expect(draft.options["motor.holding_torque_nm"]).toBe("1");
    draft.options = { ...draft.options, "motor.holding_torque_nm": "", "load.torque_nm": "0.1" };
    expect(linkOf(draft)).toEqual({
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
    expect(withModel({ ...named, kind: "spidev" }, about("tmc428")).kind).toBe("emulator");
  });

  it("is reached over a board once the port is said", () => {
    const board = { ...named, kind: "landungsbruecke" as const };
    expect(problemsOf(board)).toHaveProperty("module.serialPort");
    const ready = { ...board, timeoutS: "0.5", module: { ...board.module, serialPort: " /dev/ttyACM0 " } };
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
    const faster = { ...of(emulated), options: { ...of(emulated).options, time_scale: "2" } };
    expect(changeBody(of(emulated), faster).link).toEqual({
      ...emulated,
      time_scale: 2,
      clock_hz: 8e6,
    });
    const board = { kind: "landungsbruecke", port: "/dev/ttyACM0", baud: 9600, motor: 2 };
    expect(changeBody(of(board), { ...of(board), timeoutS: "0.5" }).link).toEqual({ ...board, timeout_s: 0.5 });
    const bus = { kind: "spidev", bus: 1, device: 0, mode: 0 };
    const other = changeBody(of(bus), { ...of(bus), spi: { bus: "1", device: "1", speedHz: "" } });
    expect(other.link).toEqual({ ...bus, device: 1 });
    // another kind of link is another link
    expect(linkOf({ ...of(board), kind: "spidev" })).toEqual({ kind: "spidev", bus: 0, device: 0 });
  });

  it("takes no more of the emulator's time than that can be worked out in", () => {
    expect(problemsOf({ ...named, options: { time_scale: "20" } })).toEqual({});
    expect(problemsOf({ ...named, options: { time_scale: "21" } })).toHaveProperty(["options.time_scale"]);
  });

  it("is reached on the first bus where nothing is said", () => {
    const spi = { ...named, kind: "spidev" as const };
    expect(problemsOf(spi)).toEqual({});
    expect(linkOf(spi)).toEqual({ kind: "spidev", bus: 0, device: 0 });
    const other = { ...spi, spi: { bus: "1", device: "2", speedHz: "4000000" } };
    expect(linkOf(other)).toEqual({ kind: "spidev", bus: 1, device: 2, speed_hz: 4_000_000 });
    expect(problemsOf({ ...spi, spi: { bus: "x", device: "256", speedHz: "5" } })).toEqual({
      "spi.bus": expect.stringContaining("Not a number"),
      "spi.device": expect.stringContaining("255"),
      "spi.speedHz": expect.stringContaining("10"),
    });
    expect(linkText({ kind: "spidev", bus: 1, device: 0 })).toBe("spi 1.0");
  });
});

describe("a TMC5xxx", () => {
  const named = (model: string) => ({ ...newDraft(about(model)), name: "far" });
  const uart = (model: string) => {
    const draft = { ...named(model), kind: "uart" as const };
    draft.module = { ...draft.module, serialPort: " /dev/ttyUSB0 " };
    return draft;
  };

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
    expect(problemsOf({ ...uart("tmc5130"), module: newDraft(about("tmc428")).module })).toHaveProperty(
      "module.serialPort",
    );
    expect(problemsOf(uart("tmc5130"))).toEqual({});
    expect(linkOf(uart("tmc5130"))).toEqual({ kind: "uart", port: "/dev/ttyUSB0" });
    const said = { ...uart("tmc5160"), timeoutS: "0.5", uart: { baud: "500000", node: "3", echo: "on" as const } };
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

  it("has a motor and a stage to set, and no home switch", () => {
    const draft = { ...named("tmc5072"), options: { "motor.holding_torque_nm": "1", "encoder.lines": "500" } };
    expect(problemsOf(draft)).toEqual({});
    expect(linkOf(draft)).toEqual({ kind: "emulator", motor: { holding_torque_nm: 1 }, encoder: { lines: 500 } });
    const keys = (name: string) => optionsOf(about(name)).flatMap(([, rows]) => rows.map(({ key }) => key));
    expect(keys("tmc5072").some((key) => key.includes("home"))).toBe(false);
    expect(keys("tmc5031").some((key) => key.includes("encoder"))).toBe(false);
    expect(keys("tmc428")).toEqual([]);
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
    expect(linkOf({ ...draft, options: { ...draft.options, seed: "7" } })).toMatchObject({ motor: "rigid", seed: 7 });
    const soft = { ...draft, options: { ...draft.options, "motor.rated_current_a": "2" } };
    expect(linkOf(soft)).toMatchObject({ motor: { rated_current_a: 2 } });
  });

  it("has no node to say where its datagrams bear none", () => {
    const draft = { ...uart("tmc5062"), uart: { baud: "", node: "3", echo: "auto" as const } };
    expect(problemsOf(draft)).toEqual({});
    expect(linkOf(draft)).toEqual({ kind: "uart", port: "/dev/ttyUSB0" });
  });

  it.each([
    ["uart.node", { uart: { baud: "", node: "255", echo: "auto" as const } }],
    ["uart.baud", { uart: { baud: "12", node: "", echo: "auto" as const } }],
    ["timeoutS", { timeoutS: "0" }],
    ["clockMhz", { clockMhz: "20" }],
    ["clockMhz", { clockMhz: "3.9" }],
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
