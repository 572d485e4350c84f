import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import {
  chipLink,
  chipProblems,
  clockOf,
  linePortOf,
  newUart,
  type SpiDraft,
  spiOf,
  stagesOf,
  type UartDraft,
  uartOf,
} from "./chip";
import { type Json, type Limits, numberOf, numberProblem, said } from "./limits";
import { canModel, isModule, type Kind, kindsOf, type Model } from "./models";
import { type ModuleDraft, type ModuleKind, moduleLink, moduleOf, moduleProblems, newModule } from "./module";
import { emulatorLink, optionProblems, optionsIn } from "./options";
import { limitDraftOf, limitProblems, limitsOf, NO_LIMITS, type SoftLimitDraft } from "./softLimits";

export type Link = Schemas["DeviceCreate"]["link"];
export type AxisConfig = Schemas["AxisConfig"];

/** What is typed into the form. Empty text stands for "not said": the server's default then holds. */
export interface AxisDraft {
  name: string;
  fullSteps: string;
  driverMicrosteps: string;
  gear: string;
  travelMm: string;
  limits: SoftLimitDraft;
  /** from which deviation of the encoder on steps count as lost, and a motion as not followed [microsteps] */
  lostSteps: string;
  followingError: string;
}

export interface StageDraft {
  left: string;
  right: string;
  refFrom: string;
  refTo: string;
  start: string;
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
  vActualWritable: string;
  stages: StageDraft[];
  /** of an emulated motor and what is around it, by the keys of `optionsOf` */
  options: Record<string, string>;
  axes: AxisDraft[];
  /** the link of a module; a UART and an evaluation board have their port from here */
  module: ModuleDraft;
  uart: UartDraft;
  /** the SPI bus of the server's machine */
  spi: SpiDraft;
  /** the link as it was, so that what the form does not show stays as it is */
  before: Json;
}

/** The ranges of the server's AxisConfig, so that a slip shows at once. */
export const AXIS_LIMITS = {
  fullSteps: { minimum: 1, maximum: 100_000, integer: true, fallback: 200 },
  driverMicrosteps: { minimum: 1, maximum: 256, integer: true, fallback: 16 },
  gear: { minimum: 0, above: true, maximum: 1e6, fallback: 1 },
  travelMm: { minimum: 0, above: true, maximum: 1e6, fallback: null },
  lostSteps: { minimum: 1, maximum: 2 ** 31, integer: true, fallback: null },
  followingError: { minimum: 1, maximum: 2 ** 31, integer: true, fallback: null },
} as const satisfies Record<string, Limits>;

const EMPTY_STAGE: StageDraft = { left: "", right: "", refFrom: "", refTo: "", start: "" };

function emptyAxis(name: string): AxisDraft {
  return {
    name,
    fullSteps: "",
    driverMicrosteps: "",
    gear: "",
    travelMm: "",
    limits: NO_LIMITS,
    lostSteps: "",
    followingError: "",
  };
}

const AXIS_NAMES = ["X", "Y", "Z"];

export function newDraft(model: Model, kind: Kind = "emulator"): Draft {
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
      vActualWritable: "",
      stages: [],
      options: {},
      axes: [],
      module: newModule(),
      uart: newUart(),
      spi: { bus: "", device: "", speedHz: "" },
      before: {},
    },
    model,
  );
}

/** The draft for another model: axes that are there stay, missing ones come, surplus ones go. */
export function withModel(draft: Draft, model: Model): Draft {
  const indices = Array.from({ length: model.axes }, (_, index) => index);
  return {
    ...draft,
    model,
    kind: kindsOf(model).some((kind) => kind.value === draft.kind) ? draft.kind : "emulator",
    axes: indices.map((index) => draft.axes[index] ?? emptyAxis(AXIS_NAMES[index] ?? `axis ${index}`)),
    // A motor's stage is among the options.
    stages: pulsesOnly(model) ? indices.map((index) => draft.stages[index] ?? EMPTY_STAGE) : [],
  };
}

/** Chips that only give pulses: the motor at the far end is a stage and no more. */
function pulsesOnly(model: Model): boolean {
  return canModel(model, "ramp.pmul");
}

/** A device as a draft, for editing. */
export function draftOf(device: Device): Draft {
  const link = device.link as Json;
  return withModel(
    {
      name: device.name,
      model: device.about,
      kind: kindsOf(device.about).find((kind) => kind.value === link.kind)?.value ?? "emulator",
      clockMhz: String(device.clock_hz / 1e6),
      host: typeof link.host === "string" ? link.host : "",
      port: said(link.port),
      timeoutS: said(link.timeout_s),
      seed: said(link.seed),
      timeScale: said(link.time_scale),
      wiring: typeof link.wiring === "string" ? link.wiring : "",
      vActualWritable: typeof link.v_actual_writable === "string" ? link.v_actual_writable : "",
      stages: stagesOf(link),
      options: optionsIn(link, device.about),
      axes: device.axes.map((axis) => ({
        name: axis.name,
        fullSteps: String(axis.full_steps_per_rev),
        driverMicrosteps: String(axis.driver_microsteps),
        gear: String(axis.gear_ratio),
        travelMm: axis.travel_mm_per_rev === null ? "" : String(axis.travel_mm_per_rev),
        limits: limitDraftOf(axis.limits),
        lostSteps: said(axis.lost_steps_microsteps),
        followingError: said(axis.following_error_microsteps),
      })),
      module: isModule(device.about) ? moduleOf(link) : { ...newModule(), serialPort: linePortOf(link) },
      uart: uartOf(link),
      spi: spiOf(link),
      before: link,
    },
    device.about,
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
  const { model } = draft;
  const kind = moduleKind(draft);
  const problems = !isModule(model)
    ? chipProblems(draft, model)
    : kind === "emulator"
      ? optionProblems(draft.options, model)
      : moduleProblems(kind, draft.module);
  for (const [path, problem] of problems) note(path, problem);
  draft.axes.forEach((axis, index) => {
    if (axis.name.trim() === "") note(`axes.${index}.name`, "A name is needed");
    else if (axis.name.trim().length > 60) note(`axes.${index}.name`, "At most 60 characters");
    for (const part of ["fullSteps", "driverMicrosteps", "gear", "travelMm", "lostSteps", "followingError"] as const)
      note(`axes.${index}.${part}`, numberProblem(axis[part], AXIS_LIMITS[part]));
    for (const [part, problem] of limitProblems(axis.limits, model)) note(`axes.${index}.limits.${part}`, problem);
  });
  return found;
}

/** A module's kind: no form offers it another one. */
export function moduleKind(draft: Draft): ModuleKind {
  const { kind } = draft;
  return kind === "serial" || kind === "tcp" || kind === "can" ? kind : "emulator";
}

export function linkOf(draft: Draft): Link {
  const { model, before } = draft;
  const kind = moduleKind(draft);
  const link = !isModule(model)
    ? chipLink(draft, model)
    : kind === "emulator"
      ? emulatorLink(draft.options, model, before)
      : moduleLink(kind, draft.module, before);
  return link as unknown as Link;
}

export function axisConfigs(draft: Draft): AxisConfig[] {
  return draft.axes.map((axis) => ({
    name: axis.name.trim(),
    full_steps_per_rev: numberOf(axis.fullSteps) ?? AXIS_LIMITS.fullSteps.fallback,
    driver_microsteps: numberOf(axis.driverMicrosteps) ?? AXIS_LIMITS.driverMicrosteps.fallback,
    gear_ratio: numberOf(axis.gear) ?? AXIS_LIMITS.gear.fallback,
    travel_mm_per_rev: numberOf(axis.travelMm) ?? null,
    limits: limitsOf(axis.limits),
    lost_steps_microsteps: numberOf(axis.lostSteps) ?? null,
    following_error_microsteps: numberOf(axis.followingError) ?? null,
  }));
}

export interface DeviceBody {
  name: string;
  model: Model["name"];
  link: Link;
  clock_hz: number | null;
  axes: AxisConfig[];
  start_up: boolean;
}

export function createBody(draft: Draft): DeviceBody {
  return {
    name: draft.name.trim(),
    model: draft.model.name,
    link: linkOf(draft),
    // a module's crystal is its own affair
    clock_hz: isModule(draft.model) ? null : (clockOf(draft) ?? null),
    axes: axisConfigs(draft),
    // one that a click adds can move at once
    start_up: draft.kind === "emulator",
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
