/** What a byte of a frame belongs to. */
export type FieldKind = "address" | "host" | "command" | "status" | "type" | "motor" | "value" | "checksum" | "text";

export interface FieldBytes {
  kind: FieldKind;
  /** "01", "04", ... */
  bytes: string[];
  /** what it says, in short */
  meaning: string;
}

const READ_MEMORY = 134;
const GET_VERSION = 136;
const FRAME_BYTES = 9;

export function bytesOf(hex: string): number[] {
  return (hex.match(/[\da-f]{2}/gi) ?? []).map((byte) => Number.parseInt(byte, 16));
}

function text(bytes: readonly number[]): string[] {
  return bytes.map((byte) => byte.toString(16).padStart(2, "0").toUpperCase());
}

function signed(bytes: readonly number[]): number {
  return bytes.reduce((sum, byte) => sum * 256 + byte, 0) | 0;
}

function sumOf(bytes: readonly number[]): number {
  return bytes.slice(0, FRAME_BYTES - 1).reduce((sum, byte) => sum + byte, 0) & 0xff;
}

function field(kind: FieldKind, bytes: readonly number[], meaning?: string): FieldBytes {
  return { kind, bytes: text(bytes), meaning: meaning ?? String(bytes[0] ?? "") };
}

function checksum(bytes: readonly number[]): FieldBytes {
  return field("checksum", bytes.slice(8, 9), bytes[8] === sumOf(bytes) ? "right" : "wrong");
}

/** A TMCL request: address, command, type, motor or bank, four bytes of value, checksum. */
export function requestFields(bytes: readonly number[]): FieldBytes[] {
  if (bytes.length !== FRAME_BYTES) return [field("text", bytes, `${bytes.length} bytes`)];
  return [
    field("address", bytes.slice(0, 1)),
    field("command", bytes.slice(1, 2)),
    field("type", bytes.slice(2, 3)),
    field("motor", bytes.slice(3, 4)),
    field("value", bytes.slice(4, 8), String(signed(bytes.slice(4, 8)))),
    checksum(bytes),
  ];
}

/** Whether the answer to that request is data without status and checksum. */
function plain(request: readonly number[]): boolean {
  return request[1] === READ_MEMORY || (request[1] === GET_VERSION && request[2] === 0);
}

/** The answer: host, module, status, command, four bytes of value, checksum; or eight bytes of data. */
export function replyFields(request: readonly number[], bytes: readonly number[]): FieldBytes[] {
  if (bytes.length !== FRAME_BYTES) return [field("text", bytes, `${bytes.length} bytes`)];
  const refused = bytes[8] === sumOf(bytes) && bytes[1] === request[0] && bytes[3] === request[1];
  if (plain(request) && !refused) {
    const data = bytes.slice(1);
    const meaning =
      request[1] === GET_VERSION ? data.map((byte) => String.fromCharCode(byte)).join("") : "a stored command";
    return [field("host", bytes.slice(0, 1)), field("text", data, meaning)];
  }
  return [
    field("host", bytes.slice(0, 1)),
    field("address", bytes.slice(1, 2)),
    field("status", bytes.slice(2, 3)),
    field("command", bytes.slice(3, 4)),
    field("value", bytes.slice(4, 8), String(signed(bytes.slice(4, 8)))),
    checksum(bytes),
  ];
}

export const FIELD_WORDS: Record<FieldKind, string> = {
  address: "module",
  host: "host",
  command: "command",
  status: "status",
  type: "type",
  motor: "motor",
  value: "value",
  checksum: "sum",
  text: "data",
};
