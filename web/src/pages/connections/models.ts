import type { Device } from "../../api/queries";
import { type ChipModel, familyOf } from "../../lib/family";
import type { Limits } from "./limits";
import type { ModuleKind } from "./module";

export type Model = Device["model"];
export type Kind = ModuleKind | "uart" | "landungsbruecke" | "spidev";

/** What the form has to know of a chip: the ranges are the server's own, so that a slip shows at once. */
interface ChipFacts {
  axes: number;
  /** its links besides the emulator and a socket */
  wires: readonly ("uart" | "landungsbruecke" | "spidev")[];
  /** whether its datagrams on a UART bear a node address */
  nodes: boolean;
  /** whether it reads an encoder */
  encoder: boolean;
  clockMhz: Limits;
}

const PULSES = { wires: [], nodes: false, encoder: false } as const;
const MOTOR = { wires: ["landungsbruecke", "spidev"], nodes: false, encoder: true } as const;
const SIXPOINT = {
  ...MOTOR,
  axes: 1,
  wires: ["uart", "landungsbruecke", "spidev"],
  nodes: true,
  clockMhz: { minimum: 4, maximum: 18, fallback: 16 },
} as const;

const CHIPS: Record<ChipModel, ChipFacts> = {
  tmc428: { ...PULSES, axes: 3, clockMhz: { minimum: 0, above: true, maximum: 16, fallback: 16 } },
  tmc4210: { ...PULSES, axes: 1, clockMhz: { minimum: 0, above: true, maximum: 32, fallback: 16 } },
  tmc4361: { ...MOTOR, axes: 1, clockMhz: { minimum: 4.194304, maximum: 32, fallback: 16 } },
  tmc5031: { ...SIXPOINT, axes: 2, wires: MOTOR.wires, nodes: false, encoder: false },
  tmc5062: { ...SIXPOINT, axes: 2, nodes: false },
  tmc5072: { ...SIXPOINT, axes: 2 },
  tmc5130: SIXPOINT,
  tmc5160: SIXPOINT,
};

export function isModule(model: Model): model is Exclude<Model, ChipModel> {
  return familyOf(model) === "module";
}

export function factsOf(model: ChipModel): ChipFacts {
  return CHIPS[model];
}

const LABELS: Record<Kind, string> = {
  emulator: "Emulated here",
  serial: "Serial",
  uart: "UART",
  landungsbruecke: "Eval board",
  tcp: "TCP",
  can: "CAN",
  spidev: "SPI bus",
};
const ORDER = Object.keys(LABELS) as Kind[];

/** The kinds of link that lead to that model, most likely first. */
export function kindsOf(model: Model): { value: Kind; label: string }[] {
  const kinds: Kind[] = isModule(model)
    ? ["emulator", "serial", "tcp", "can"]
    : ["emulator", "tcp", ...CHIPS[model].wires];
  const place = (kind: Kind) => ORDER.indexOf(kind);
  return kinds.sort((a, b) => place(a) - place(b)).map((value) => ({ value, label: LABELS[value] }));
}

export function hasEncoder(model: Model): boolean {
  return isModule(model) || CHIPS[model].encoder;
}

export function axesOf(model: Model): number {
  return isModule(model) ? 1 : CHIPS[model].axes;
}
