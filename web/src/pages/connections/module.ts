import { type Json, type Limits, numberOf, numberProblem, over, said } from "./limits";

export type ModuleKind = "emulator" | "serial" | "tcp" | "can";
type Wired = Exclude<ModuleKind, "emulator">;

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
  };
}

/** What goes to the server: what was said, so that its defaults hold, and what the form does not show as it was. */
export function moduleLink(kind: Wired, draft: ModuleDraft, before: Json): Json {
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
  }
}

/** Every problem of the link, by the path of its field: `module.baud`. */
export function moduleProblems(kind: Wired, draft: ModuleDraft): [path: string, problem: string][] {
  const found: [string, string][] = [];
  const note = (path: string, problem: string | null) => {
    if (problem !== null) found.push([path, problem]);
  };
  const check = (part: keyof typeof MODULE_LIMITS, required = false) =>
    note(`module.${part}`, numberProblem(draft[part], MODULE_LIMITS[part], required));
  const wanted = (part: "serialPort" | "host" | "canInterface" | "canChannel", what: string) => {
    if (draft[part].trim() === "") note(`module.${part}`, what);
  };
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
