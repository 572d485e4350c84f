import { parseNumber } from "../../lib/format";
import type { Draft, StageDraft } from "./draft";
import { type Json, type Limits, numberOf, numberProblem, over, said } from "./limits";
import { canModel, clockLimits, framesOf, type Model } from "./models";
import { emulatorLink, optionProblems, optionsOf } from "./options";

export interface SpiDraft {
  bus: string;
  device: string;
  speedHz: string;
}

export const ECHOES = ["auto", "on", "off"] as const;

export interface UartDraft {
  baud: string;
  node: string;
  /** whether what is sent comes back on the single wire */
  echo: (typeof ECHOES)[number];
}

/** The ranges of the server's own models (EmulatorOptions, TcpLink, UartLink), so that a slip shows at once. */
export const CHIP_LIMITS = {
  port: { minimum: 1, maximum: 65_535, integer: true, fallback: null },
  timeoutS: { minimum: 0.001, maximum: 60, fallback: 1 },
  lineTimeoutS: { minimum: 0.001, maximum: 60, fallback: 0.25 },
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
  baud: { minimum: 9000, maximum: 4e6, integer: true, fallback: 115_200 },
  node: { minimum: 0, maximum: 254, integer: true, fallback: 0 },
} as const satisfies Record<string, Limits>;

export const WIRINGS = [
  { value: "multiplexed", label: "multiplexed: both switches of every axis" },
  { value: "two-one-null", label: "two-one-null: both of motor 1, left of motor 2" },
  { value: "left-only", label: "left only: one switch an axis" },
];

/** Where a write of the velocity takes: the sheet's way first, which is the default. */
export const V_ACTUAL_WRITABLE = [
  { value: "hold-mode", label: "hold mode only: 0 in velocity mode brakes" },
  { value: "velocity-mode", label: "velocity mode too: 0 there stops dead" },
];

/** A link's wire as a draft, for editing. */
export function uartOf(link: Json): UartDraft {
  const echo = ECHOES.find((known) => known === link.echo) ?? "auto";
  return link.kind === "uart" ? { baud: said(link.baud), node: said(link.node), echo } : newUart();
}

export function newUart(): UartDraft {
  return { baud: "", node: "", echo: "auto" };
}

export function spiOf(link: Json): SpiDraft {
  return { bus: said(link.bus), device: said(link.device), speedHz: said(link.speed_hz) };
}

export function stagesOf(link: Json): StageDraft[] {
  const stages = Array.isArray(link.stages) ? (link.stages as Json[]) : [];
  return stages.map((stage) => ({
    left: said(stage.left_at_fullsteps),
    right: said(stage.right_at_fullsteps),
    refFrom: said(stage.ref_from_fullsteps),
    refTo: said(stage.ref_to_fullsteps),
    start: said(stage.start_fullsteps),
  }));
}

/** The port of a line is typed into the same field as a module's. */
export function linePortOf(link: Json): string {
  return typeof link.port === "string" ? link.port : "";
}

/** The chip's clock [Hz], where it is said. */
export function clockOf(draft: Draft): number | undefined {
  const mhz = numberOf(draft.clockMhz);
  return mhz === undefined ? undefined : Math.round(mhz * 1e6);
}

/** What goes to the server: what was said, so that its defaults hold, and what the form does not show as it was. */
export function chipLink(draft: Draft, model: Model): Json {
  const kept = (shown: Json) => over(draft.before, draft.kind, shown);
  const timeout_s = numberOf(draft.timeoutS);
  const line = draft.module.serialPort.trim();
  if (framesOf(model, draft.kind) === "board") return kept({ port: line, timeout_s });
  switch (draft.kind) {
    case "tcp":
      return kept({ host: draft.host.trim(), port: numberOf(draft.port), timeout_s });
    case "uart":
      return kept({
        port: line,
        baud: numberOf(draft.uart.baud),
        node: model.uart === "node" ? numberOf(draft.uart.node) : undefined,
        echo: draft.uart.echo === "auto" ? undefined : draft.uart.echo,
        timeout_s,
      });
    case "spidev":
      return kept({
        bus: numberOf(draft.spi.bus) ?? CHIP_LIMITS.bus.fallback,
        device: numberOf(draft.spi.device) ?? CHIP_LIMITS.device.fallback,
        speed_hz: numberOf(draft.spi.speedHz),
      });
    default:
      return optionsOf(model).length > 0
        ? emulatorLink(draft.options, model, draft.before, { clock_hz: clockOf(draft) })
        : kept(pulsesOf(draft, model));
  }
}

/** The emulator's options of a chip that only gives pulses. */
function pulsesOf(draft: Draft, model: Model): Json {
  const stages = draft.stages.map((stage) =>
    over({}, undefined, {
      left_at_fullsteps: numberOf(stage.left),
      right_at_fullsteps: numberOf(stage.right),
      ref_from_fullsteps: numberOf(stage.refFrom),
      ref_to_fullsteps: numberOf(stage.refTo),
      start_fullsteps: numberOf(stage.start),
    }),
  );
  return {
    seed: numberOf(draft.seed),
    time_scale: numberOf(draft.timeScale),
    clock_hz: clockOf(draft),
    wiring: model.axes > 1 && draft.wiring !== "" ? draft.wiring : undefined,
    v_actual_writable: draft.vActualWritable !== "" ? draft.vActualWritable : undefined,
    stages: stages.some((stage) => Object.keys(stage).length > 0) ? stages : undefined,
    // One motor, one driver: what the emulated driver does is what the axis is reckoned with.
    driver_microsteps: canModel(model, "step_dir") ? numberOf(draft.axes[0]?.driverMicrosteps ?? "") : undefined,
  };
}

/** Every problem of the link, by the path of its field: `port`, `uart.node`, `stages.1.left`. */
export function chipProblems(draft: Draft, model: Model): [path: string, problem: string][] {
  const found: [string, string][] = [];
  const note = (path: string, problem: string | null) => {
    if (problem !== null) found.push([path, problem]);
  };
  note("clockMhz", numberProblem(draft.clockMhz, clockLimits(model)));
  const line = () => {
    if (draft.module.serialPort.trim() === "")
      note("module.serialPort", "A port is needed: choose one, or type a device name or address");
    note("timeoutS", numberProblem(draft.timeoutS, CHIP_LIMITS.lineTimeoutS));
  };
  if (framesOf(model, draft.kind) === "board") {
    line();
    return found;
  }
  switch (draft.kind) {
    case "tcp":
      if (draft.host.trim() === "") note("host", "A host name or address is needed");
      note("port", numberProblem(draft.port, CHIP_LIMITS.port, true));
      note("timeoutS", numberProblem(draft.timeoutS, CHIP_LIMITS.timeoutS));
      break;
    case "uart":
      line();
      note("uart.baud", numberProblem(draft.uart.baud, CHIP_LIMITS.baud));
      if (model.uart === "node") note("uart.node", numberProblem(draft.uart.node, CHIP_LIMITS.node));
      break;
    case "spidev":
      for (const part of ["bus", "device", "speedHz"] as const)
        note(`spi.${part}`, numberProblem(draft.spi[part], CHIP_LIMITS[part]));
      break;
    default:
      found.push(...optionProblems(draft.options, model));
      note("seed", numberProblem(draft.seed, CHIP_LIMITS.seed));
      note("timeScale", numberProblem(draft.timeScale, CHIP_LIMITS.timeScale));
      draft.stages.forEach((stage, index) => {
        for (const part of ["left", "right", "refFrom", "refTo", "start"] as const)
          note(`stages.${index}.${part}`, numberProblem(stage[part], CHIP_LIMITS[part]));
        const at = (part: keyof StageDraft) => parseNumber(stage[part]) ?? CHIP_LIMITS[part].fallback;
        if (at("left") >= at("right")) note(`stages.${index}.right`, "The right switch lies right of the left one");
        if (at("refFrom") > at("refTo")) note(`stages.${index}.refTo`, "The end lies right of the beginning");
      });
  }
  return found;
}
