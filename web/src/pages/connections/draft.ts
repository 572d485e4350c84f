import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { type ChipModel, familyOf } from "../../lib/family";
import { compact, fixed, parseNumber } from "../../lib/format";
import { type Limits, numberOf, numberProblem, only, said } from "./limits";
import { type ModuleDraft, type ModuleKind, moduleLink, moduleOf, moduleProblems, newModule } from "./module";

export type Model = Device["model"];
export type Kind = ModuleKind | "landungsbruecke" | "spidev";
export type Link = Schemas["DeviceCreate"]["link"];
export type AxisConfig = Schemas["AxisConfig"];

/** What is typed into the form. Empty text stands for "not said": the server's default then holds. */
export interface AxisDraft {
  name: string;
  fullSteps: string;
  driverMicrosteps: string;
  gear: string;
  travelMm: string;
}

export interface StageDraft {
  left: string;
  right: string;
  refFrom: string;
  refTo: string;
  start: string;
}

export interface SpiDraft {
  bus: string;
  device: string;
  speedHz: string;
}

export interface Draft {
  name: string;
  model: Model;
  kind: Kind;
  clockMhz: string;
  host: string;
  port: string;
  timeoutS: string;
  seed: string;
  timeScale: string;
  wiring: string;
  stages: StageDraft[];
  axes: AxisDraft[];
  /** the link of a module; an evaluation board has its port and its time from here */
  module: ModuleDraft;
  /** the SPI bus of the server's machine */
  spi: SpiDraft;
}

/** The ranges of the server's own models (AxisConfig, EmulatorOptions, TcpLink), so that a slip shows at once. */
export const LIMITS = {
  fullSteps: { minimum: 1, maximum: 100_000, integer: true, fallback: 200 },
  driverMicrosteps: { minimum: 1, maximum: 256, integer: true, fallback: 16 },
  gear: { minimum: 0, above: true, maximum: 1e6, fallback: 1 },
  travelMm: { minimum: 0, above: true, maximum: 1e6, fallback: null },
  port: { minimum: 1, maximum: 65_535, integer: true, fallback: null },
  timeoutS: { minimum: 0.001, maximum: 60, fallback: 1 },
  seed: { minimum: 0, maximum: 2 ** 32 - 1, integer: true, fallback: 428 },
  timeScale: { minimum: 0, maximum: 1000, fallback: 1 },
  left: { minimum: -1e6, maximum: 1e6, fallback: 0 },
  right: { minimum: -1e6, maximum: 1e6, fallback: 7500 },
  refFrom: { minimum: -1e6, maximum: 1e6, fallback: 250 },
  refTo: { minimum: -1e6, maximum: 1e6, fallback: 350 },
  start: { minimum: -1e6, maximum: 1e6, fallback: 3750 },
  bus: { minimum: 0, maximum: 255, integer: true, fallback: 0 },
  device: { minimum: 0, maximum: 255, integer: true, fallback: 0 },
  speedHz: { minimum: 10_000, maximum: 16e6, integer: true, fallback: 1_000_000 },
  boardTimeoutS: { minimum: 0.001, maximum: 60, fallback: 0.25 },
} as const satisfies Record<string, Limits>;

export const WIRINGS = [
  { value: "multiplexed", label: "multiplexed: both switches of every axis" },
  { value: "two-one-null", label: "two-one-null: both of motor 1, left of motor 2" },
  { value: "left-only", label: "left only: one switch an axis" },
];

const CLOCK: Record<ChipModel, Limits> = {
  tmc428: { minimum: 0, above: true, maximum: 16, fallback: 16 },
  tmc4210: { minimum: 0, above: true, maximum: 32, fallback: 16 },
  tmc4361: { minimum: 4.194304, maximum: 32, fallback: 16 },
};

export function clockLimits(model: ChipModel): Limits {
  return CLOCK[model];
}

const EMPTY_STAGE: StageDraft = { left: "", right: "", refFrom: "", refTo: "", start: "" };

function emptyAxis(name: string): AxisDraft {
  return { name, fullSteps: "", driverMicrosteps: "", gear: "", travelMm: "" };
}

const AXIS_NAMES = ["X", "Y", "Z"];

export function isModule(model: Model): model is Exclude<Model, ChipModel> {
  return familyOf(model) === "module";
}

/** The kinds of link that lead to that model, most likely first. */
export function kindsOf(model: Model): { value: Kind; label: string }[] {
  const emulator = { value: "emulator" as const, label: "Emulated here" };
  const tcp = { value: "tcp" as const, label: "TCP" };
  if (model === "tmc4361")
    return [emulator, { value: "landungsbruecke", label: "Eval board" }, tcp, { value: "spidev", label: "SPI bus" }];
  if (!isModule(model)) return [emulator, tcp];
  return [emulator, { value: "serial", label: "Serial" }, tcp, { value: "can", label: "CAN" }];
}

export function axesOf(model: Model): number {
  return model === "tmc428" ? 3 : 1;
}

export function newDraft(model: Model = "tmc428", kind: Kind = "emulator"): Draft {
  return withModel(
    {
      name: "",
      model,
      kind,
      clockMhz: "",
      host: kind === "tcp" ? "127.0.0.1" : "",
      port: "",
      timeoutS: "",
      seed: "",
      timeScale: "",
      wiring: "",
      stages: [],
      axes: [],
      module: newModule(),
      spi: { bus: "", device: "", speedHz: "" },
    },
    model,
  );
}

/** The draft for another model: axes that are there stay, missing ones come, surplus ones go. */
export function withModel(draft: Draft, model: Model): Draft {
  const indices = Array.from({ length: axesOf(model) }, (_, index) => index);
  return {
    ...draft,
    model,
    kind: kindsOf(model).some((kind) => kind.value === draft.kind) ? draft.kind : "emulator",
    axes: indices.map((index) => draft.axes[index] ?? emptyAxis(AXIS_NAMES[index] ?? `axis ${index}`)),
    // A TMC4361's stage is one object of its own, changed in the emulator panel.
    stages: isModule(model) || model === "tmc4361" ? [] : indices.map((index) => draft.stages[index] ?? EMPTY_STAGE),
  };
}

/** A device as a draft, for editing. */
export function draftOf(device: Device): Draft {
  const link = device.link as Record<string, unknown>;
  const stages = Array.isArray(link.stages) ? (link.stages as Record<string, unknown>[]) : [];
  return withModel(
    {
      name: device.name,
      model: device.model,
      kind: kindsOf(device.model).find((kind) => kind.value === link.kind)?.value ?? "emulator",
      clockMhz: String(device.clock_hz / 1e6),
      host: typeof link.host === "string" ? link.host : "",
      port: said(link.port),
      timeoutS: said(link.timeout_s),
      seed: said(link.seed),
      timeScale: said(link.time_scale),
      wiring: typeof link.wiring === "string" ? link.wiring : "",
      stages: stages.map((stage) => ({
        left: said(stage.left_at_fullsteps),
        right: said(stage.right_at_fullsteps),
        refFrom: said(stage.ref_from_fullsteps),
        refTo: said(stage.ref_to_fullsteps),
        start: said(stage.start_fullsteps),
      })),
      axes: device.axes.map((axis) => ({
        name: axis.name,
        fullSteps: String(axis.full_steps_per_rev),
        driverMicrosteps: String(axis.driver_microsteps),
        gear: String(axis.gear_ratio),
        travelMm: axis.travel_mm_per_rev === null ? "" : String(axis.travel_mm_per_rev),
      })),
      module: isModule(device.model)
        ? moduleOf(link)
        : { ...newModule(), serialPort: link.kind === "landungsbruecke" ? String(link.port) : "" },
      spi: { bus: said(link.bus), device: said(link.device), speedHz: said(link.speed_hz) },
    },
    device.model,
  );
}

/** Every problem of the form, by the path of its field: `name`, `axes.0.gear`, `stages.1.left`. */
export function problemsOf(draft: Draft, others: readonly string[] = []): Record<string, string> {
  const found: Record<string, string> = {};
  const note = (path: string, problem: string | null) => {
    if (problem !== null) found[path] = problem;
  };
  const name = draft.name.trim();
  if (name === "") note("name", "A name is needed: the device goes by it everywhere");
  else if (name.length > 60) note("name", "At most 60 characters");
  else if (others.some((other) => other.toLowerCase() === name.toLowerCase()))
    note("name", "Another device has that name");
  if (isModule(draft.model))
    for (const [path, problem] of moduleProblems(moduleKind(draft), draft.module)) note(path, problem);
  else noteChipLink(draft, draft.model, note);
  draft.axes.forEach((axis, index) => {
    if (axis.name.trim() === "") note(`axes.${index}.name`, "A name is needed");
    else if (axis.name.trim().length > 60) note(`axes.${index}.name`, "At most 60 characters");
    for (const part of ["fullSteps", "driverMicrosteps", "gear", "travelMm"] as const)
      note(`axes.${index}.${part}`, numberProblem(axis[part], LIMITS[part]));
  });
  return found;
}

function noteChipLink(draft: Draft, model: ChipModel, note: (path: string, problem: string | null) => void): void {
  note("clockMhz", numberProblem(draft.clockMhz, clockLimits(model)));
  if (draft.kind === "tcp") {
    if (draft.host.trim() === "") note("host", "A host name or address is needed");
    note("port", numberProblem(draft.port, LIMITS.port, true));
    note("timeoutS", numberProblem(draft.timeoutS, LIMITS.timeoutS));
  } else if (draft.kind === "landungsbruecke") {
    if (draft.module.serialPort.trim() === "")
      note("module.serialPort", "A port is needed: choose one, or type a device name or address");
    note("timeoutS", numberProblem(draft.timeoutS, LIMITS.boardTimeoutS));
  } else if (draft.kind === "spidev") {
    for (const part of ["bus", "device", "speedHz"] as const)
      note(`spi.${part}`, numberProblem(draft.spi[part], LIMITS[part]));
  } else {
    note("seed", numberProblem(draft.seed, LIMITS.seed));
    note("timeScale", numberProblem(draft.timeScale, LIMITS.timeScale));
    draft.stages.forEach((stage, index) => {
      for (const part of ["left", "right", "refFrom", "refTo", "start"] as const)
        note(`stages.${index}.${part}`, numberProblem(stage[part], LIMITS[part]));
      const at = (part: keyof StageDraft) => parseNumber(stage[part]) ?? LIMITS[part].fallback;
      if (at("left") >= at("right")) note(`stages.${index}.right`, "The right switch lies right of the left one");
      if (at("refFrom") > at("refTo")) note(`stages.${index}.refTo`, "The end lies right of the beginning");
    });
  }
}

/** A module's kind: no form offers it another one. */
export function moduleKind(draft: Draft): ModuleKind {
  return draft.kind === "landungsbruecke" || draft.kind === "spidev" ? "emulator" : draft.kind;
}

export function linkOf(draft: Draft): Link {
  if (isModule(draft.model)) return moduleLink(moduleKind(draft), draft.module) as unknown as Link;
  if (draft.kind === "landungsbruecke")
    return only({
      kind: draft.kind,
      port: draft.module.serialPort.trim(),
      timeout_s: numberOf(draft.timeoutS),
    }) as Link;
  if (draft.kind === "spidev")
    return only({
      kind: draft.kind,
      bus: numberOf(draft.spi.bus) ?? LIMITS.bus.fallback,
      device: numberOf(draft.spi.device) ?? LIMITS.device.fallback,
      speed_hz: numberOf(draft.spi.speedHz),
    }) as Link;
  if (draft.kind === "tcp") {
    const link = {
      kind: "tcp",
      host: draft.host.trim(),
      port: numberOf(draft.port),
      timeout_s: numberOf(draft.timeoutS),
    };
    return only(link) as Link;
  }
  const stages = draft.stages.map((stage) =>
    only({
      left_at_fullsteps: numberOf(stage.left),
      right_at_fullsteps: numberOf(stage.right),
      ref_from_fullsteps: numberOf(stage.refFrom),
      ref_to_fullsteps: numberOf(stage.refTo),
      start_fullsteps: numberOf(stage.start),
    }),
  );
  const tmc428 = draft.model === "tmc428";
  return only({
    kind: "emulator",
    seed: numberOf(draft.seed),
    time_scale: numberOf(draft.timeScale),
    clock_hz: clockOf(draft),
    wiring: tmc428 && draft.wiring !== "" ? draft.wiring : undefined,
    stages: stages.some((stage) => Object.keys(stage).length > 0) ? stages : undefined,
    // One motor, one driver: what the emulated driver does is what the axis is reckoned with.
    driver_microsteps: draft.model !== "tmc4210" ? undefined : numberOf(draft.axes[0]?.driverMicrosteps ?? ""),
  }) as Link;
}

export function clockOf(draft: Draft): number | undefined {
  if (isModule(draft.model)) return undefined; // its crystal is its own affair
  const mhz = numberOf(draft.clockMhz);
  return mhz === undefined ? undefined : Math.round(mhz * 1e6);
}

export function axisConfigs(draft: Draft): AxisConfig[] {
  return draft.axes.map((axis) => ({
    name: axis.name.trim(),
    full_steps_per_rev: numberOf(axis.fullSteps) ?? LIMITS.fullSteps.fallback,
    driver_microsteps: numberOf(axis.driverMicrosteps) ?? LIMITS.driverMicrosteps.fallback,
    gear_ratio: numberOf(axis.gear) ?? LIMITS.gear.fallback,
    travel_mm_per_rev: numberOf(axis.travelMm) ?? null,
  }));
}

export interface DeviceBody {
  name: string;
  model: Model;
  link: Link;
  clock_hz: number | null;
  axes: AxisConfig[];
}

export function createBody(draft: Draft): DeviceBody {
  return {
    name: draft.name.trim(),
    model: draft.model,
    link: linkOf(draft),
    clock_hz: clockOf(draft) ?? null,
    axes: axisConfigs(draft),
  };
}

/** Only what differs: a link that is sent again would be interrupted. */
export function changeBody(before: Draft, after: Draft): Partial<Omit<DeviceBody, "model">> {
  const [old, now] = [createBody(before), createBody(after)];
  const differs = (key: keyof DeviceBody) => JSON.stringify(old[key]) !== JSON.stringify(now[key]);
  return {
    ...(differs("name") ? { name: now.name } : {}),
    ...(differs("link") ? { link: now.link } : {}),
    ...(differs("clock_hz") && now.clock_hz !== null ? { clock_hz: now.clock_hz } : {}),
    ...(differs("axes") ? { axes: now.axes } : {}),
  };
}

/** A link in one line. */
export function linkText(link: Record<string, unknown>): string {
  const address = typeof link.address === "number" && link.address !== 1 ? `, address ${link.address}` : "";
  if (link.kind === "tcp") return `tcp ${String(link.host)}:${String(link.port)}${address}`;
  if (link.kind === "serial") {
    const baud = typeof link.baud === "number" ? ` at ${fixed(link.baud)} baud` : "";
    return `serial ${String(link.port)}${baud}${address}`;
  }
  if (link.kind === "landungsbruecke") return `evaluation board at ${String(link.port)}`;
  if (link.kind === "spidev") return `spi ${String(link.bus)}.${String(link.device)}`;
  if (link.kind === "can") return `can ${String(link.interface)} ${String(link.channel)}`;
  const scale =
    typeof link.time_scale === "number" && link.time_scale !== 1 ? `, time × ${compact(link.time_scale)}` : "";
  return link.kind === "emulator" ? `emulated in this server${scale}` : String(link.kind);
}

/** `tmc428`, or `tmc428 2` where that is taken. */
export function freeName(wanted: string, names: readonly string[]): string {
  const taken = new Set(names.map((name) => name.toLowerCase()));
  for (let count = 1; ; count += 1) {
    const name = count === 1 ? wanted : `${wanted} ${count}`;
    if (!taken.has(name)) return name;
  }
}
