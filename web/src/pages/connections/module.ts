import { parseNumber } from "../../lib/format";
import { type Json, type Limits, numberOf, numberProblem, over, said } from "./limits";

export type ModuleKind = "emulator" | "serial" | "tcp" | "can";

/** What is typed of a link to a module. Empty text stands for "not said". */
export interface ModuleDraft {
  /** a device name or an address of pyserial */
  serialPort: string;
  baud: string;
  address: string;
  host: string;
  tcpPort: string;
  timeoutS: string;
  canInterface: string;
  canChannel: string;
  bitrate: string;
  sendId: string;
  receiveId: string;
  /** of the emulated module, by the keys of OPTIONS */
  options: Record<string, string>;
}

export const BAUDS = [9600, 14400, 19200, 28800, 38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000];
export const CAN_BITRATES = [20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 1_000_000];
/** python-can's interfaces that a bench is likely to have. */
export const CAN_INTERFACES = ["socketcan", "pcan", "slcan", "kvaser", "ixxat", "vector", "gs_usb", "virtual"];

/** The ranges of the server's own models, so that a slip shows at once. */
export const MODULE_LIMITS = {
  baud: { minimum: 300, maximum: 4e6, integer: true, fallback: 9600 },
  address: { minimum: 1, maximum: 255, integer: true, fallback: 1 },
  tcpPort: { minimum: 1, maximum: 65_535, integer: true, fallback: null },
  timeoutS: { minimum: 0.001, maximum: 60, fallback: 0.25 },
  bitrate: { minimum: 10_000, maximum: 1e6, integer: true, fallback: 1_000_000 },
  sendId: { minimum: 1, maximum: 2047, integer: true, fallback: 1 },
  receiveId: { minimum: 1, maximum: 2047, integer: true, fallback: 2 },
} as const satisfies Record<string, Limits>;

export interface OptionRow {
  key: string;
  label: string;
  unit: string;
  /** where it stands in the link */
  path: readonly string[];
  limits: Limits;
}

const place = { minimum: -1e7, maximum: 1e7 };

function option(label: string, unit: string, path: string, limits: Limits): OptionRow {
  return { key: path, label, unit, path: path.split("."), limits };
}

/** What of an emulated module one wants to set when it is made; the rest is in the emulator panel, or in REST. */
export const OPTIONS: readonly (readonly [title: string, rows: readonly OptionRow[]])[] = [
  [
    "Module",
    [
      option("Time runs at", "× real time", "time_scale", { minimum: 0, maximum: 20, fallback: 1 }),
      option("Supply", "V", "supply_v", { minimum: 0, maximum: 60, fallback: 24 }),
      option("Seed of noise and faults", "", "seed", {
        minimum: 0,
        maximum: 2 ** 32 - 1,
        integer: true,
        fallback: 1241,
      }),
      option("Rotor at first", "full steps", "start_fullsteps", { ...place, fallback: 0 }),
    ],
  ],
  [
    "Motor and load",
    [
      option("Holding torque", "N m", "motor.holding_torque_nm", { minimum: 1e-4, maximum: 50, fallback: 0.45 }),
      option("Rated current", "A", "motor.rated_current_a", { minimum: 0.05, maximum: 20, fallback: 1.5 }),
      option("Load torque", "N m", "load.torque_nm", { minimum: -50, maximum: 50, fallback: 0 }),
      option("Load friction", "N m", "load.friction_nm", { minimum: 0, maximum: 50, fallback: 0 }),
      option("Load inertia", "kg m²", "load.inertia_kgm2", { minimum: 0, maximum: 1, fallback: 0 }),
    ],
  ],
  [
    "Stage: where switches are",
    [
      option("Left", "full steps", "stage.left_at_fullsteps", { ...place, fallback: -3750 }),
      option("Right", "full steps", "stage.right_at_fullsteps", { ...place, fallback: 3750 }),
      option("Home from", "full steps", "stage.home_from_fullsteps", { ...place, fallback: -3500 }),
      option("Home to", "full steps", "stage.home_to_fullsteps", { ...place, fallback: -3400 }),
    ],
  ],
  [
    "Encoders",
    [
      option("Eccentricity", "°", "encoders.eccentricity_deg", { minimum: 0, maximum: 10, fallback: 0.25 }),
      option("External lines", "", "encoders.external_lines", {
        minimum: 1,
        maximum: 1_048_576,
        integer: true,
        fallback: 1000,
      }),
    ],
  ],
];

const ALL_OPTIONS = OPTIONS.flatMap(([, rows]) => rows);

export function newModule(): ModuleDraft {
  return {
    serialPort: "",
    baud: "",
    address: "",
    host: "127.0.0.1",
    tcpPort: "",
    timeoutS: "",
    canInterface: "socketcan",
    canChannel: "can0",
    bitrate: "",
    sendId: "",
    receiveId: "",
    options: {},
  };
}

/** A link as a draft, for editing. */
export function moduleOf(link: Json): ModuleDraft {
  const text = (value: unknown, otherwise = "") => (typeof value === "string" ? value : otherwise);
  const fresh = newModule();
  return {
    ...fresh,
    serialPort: link.kind === "serial" ? text(link.port) : "",
    tcpPort: link.kind === "tcp" ? said(link.port) : "",
    host: text(link.host, fresh.host),
    baud: said(link.baud),
    address: link.kind === "emulator" ? "" : said(link.address),
    timeoutS: said(link.timeout_s),
    canInterface: text(link.interface, fresh.canInterface),
    canChannel: text(link.channel, fresh.canChannel),
    bitrate: said(link.bitrate),
    sendId: said(link.send_id),
    receiveId: said(link.receive_id),
    options: Object.fromEntries(ALL_OPTIONS.map((row) => [row.key, said(valueAt(link, row.path))])),
  };
}

function valueAt(record: Json, path: readonly string[]): unknown {
  return path.reduce<unknown>(
    (inner, key) => (typeof inner === "object" && inner !== null ? (inner as Json)[key] : undefined),
    record,
  );
}

/** `record` with one value more, or without it; records that become empty go. */
function withValueAt(record: Json, [key = "", ...rest]: readonly string[], value: unknown): Json {
  const copy = { ...record };
  const inner = rest.length === 0 ? value : withValueAt((copy[key] as Json | undefined) ?? {}, rest, value);
  const empty = inner === undefined || (rest.length > 0 && Object.keys(inner as Json).length === 0);
  if (empty) delete copy[key];
  else copy[key] = inner;
  return copy;
}

/** What goes to the server: what was said, so that its defaults hold, and what the form does not show as it was. */
export function moduleLink(kind: ModuleKind, draft: ModuleDraft, before: Json): Json {
  const kept = (shown: Json) => over(before, kind, shown);
  const timeout_s = numberOf(draft.timeoutS);
  const address = numberOf(draft.address);
  switch (kind) {
    case "serial":
      return kept({ port: draft.serialPort.trim(), baud: numberOf(draft.baud), address, timeout_s });
    case "tcp":
      return kept({ host: draft.host.trim(), port: numberOf(draft.tcpPort), address, timeout_s });
    case "can":
      return kept({
        interface: draft.canInterface.trim(),
        channel: draft.canChannel.trim(),
        bitrate: numberOf(draft.bitrate),
        send_id: numberOf(draft.sendId),
        receive_id: numberOf(draft.receiveId),
        timeout_s,
      });
    default:
      return ALL_OPTIONS.reduce<Json>(
        (link, row) => withValueAt(link, row.path, numberOf(draft.options[row.key] ?? "")),
        kept({}),
      );
  }
}

/** Every problem of the link, by the path of its field: `module.baud`, `options.stage.left_at_fullsteps`. */
export function moduleProblems(kind: ModuleKind, draft: ModuleDraft): [path: string, problem: string][] {
  const found: [string, string][] = [];
  const note = (path: string, problem: string | null) => {
    if (problem !== null) found.push([path, problem]);
  };
  const check = (part: keyof typeof MODULE_LIMITS, required = false) =>
    note(`module.${part}`, numberProblem(draft[part], MODULE_LIMITS[part], required));
  const wanted = (part: "serialPort" | "host" | "canInterface" | "canChannel", what: string) => {
    if (draft[part].trim() === "") note(`module.${part}`, what);
  };
  if (kind === "emulator") {
    for (const row of ALL_OPTIONS) note(`options.${row.key}`, numberProblem(draft.options[row.key] ?? "", row.limits));
    const at = (key: string) => {
      const row = ALL_OPTIONS.find((candidate) => candidate.key === `stage.${key}`);
      return parseNumber(draft.options[`stage.${key}`] ?? "") ?? row?.limits.fallback ?? 0;
    };
    if (at("left_at_fullsteps") >= at("right_at_fullsteps"))
      note("options.stage.right_at_fullsteps", "The right switch lies right of the left one");
    if (at("home_from_fullsteps") > at("home_to_fullsteps"))
      note("options.stage.home_to_fullsteps", "The end lies right of the beginning");
    return found;
  }
  check("timeoutS");
  if (kind === "serial") {
    wanted("serialPort", "A port is needed: choose one, or type a device name or address");
    check("baud");
    check("address");
  } else if (kind === "tcp") {
    wanted("host", "A host name or address is needed");
    check("tcpPort", true);
    check("address");
  } else {
    wanted("canInterface", "An interface of python-can is needed");
    wanted("canChannel", "A channel is needed, as the interface calls it");
    check("bitrate");
    check("sendId");
    check("receiveId");
  }
  return found;
}
