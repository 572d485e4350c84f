import type { Device } from "../../api/queries";
import { hex } from "../../lib/format";
import { type RegisterRow, readable, writable } from "../../lib/rows/bits";

/** What a raw frame asks for. */
export interface Asked {
  address: number;
  read: boolean;
  data: number;
}

export interface Request extends Asked {
  row: RegisterRow | null;
}

/** How registers are said on one kind of wire. */
export interface Wire {
  /** bytes of a frame that reads, and of one that writes */
  sizes: readonly [read: number, write: number];
  dataBits: number;
  /** what stands in the field while nothing is typed */
  example: string;
  frame: (address: number, read: boolean, data: number) => number[];
  /** null where it is no access to a register */
  asked: (bytes: readonly number[]) => Asked | null;
  /** what the receiver would find wrong, beside the length */
  wrong?: (bytes: readonly number[]) => string | null;
}

const bytesOf = (word: number): number[] => [24, 16, 8, 0].map((shift) => Math.floor(word / 2 ** shift) % 256);
const wordOf = (bytes: readonly number[]): number => bytes.reduce((word, byte) => word * 256 + byte, 0);

/** RRS and six address bits, RW (1 reads), 24 data bits: TMC428 data sheet, Table 6-3. */
const SPI32: Wire = {
  sizes: [4, 4],
  dataBits: 24,
  example: "03 00 00 00",
  frame: (address, read, data) => [(address << 1) | (read ? 1 : 0), ...bytesOf(data).slice(1)],
  asked: ([head = 0, ...data]) => ({ address: head >> 1, read: (head & 1) === 1, data: wordOf(data) }),
};

/** Bit 7 (1 writes), seven address bits, 32 data bits: TMC4361 data sheet, 4.1. */
const SPI40: Wire = {
  sizes: [5, 5],
  dataBits: 32,
  example: "21 00 00 00 00",
  frame: (address, read, data) => [address + (read ? 0 : 0x80), ...bytesOf(data)],
  asked: ([head = 0, ...data]) => ({ address: head & 0x7f, read: head < 0x80, data: wordOf(data) }),
};

/** Polynomial x^8 + x^2 + x + 1, from 0, each byte from its lowest bit: the CRC of the UART's datagrams. */
export function crc8(bytes: readonly number[]): number {
  let crc = 0;
  for (const byte of bytes)
    for (let bit = 0; bit < 8; bit++) {
      const feed = (crc >> 7) ^ ((byte >> bit) & 1);
      crc = ((crc << 1) & 0xff) ^ (feed ? 0x07 : 0);
    }
  return crc;
}

const SYNC = 0x05;

/** Sync byte, the node where the chip has one, register (bit 7 writes), data of a write, CRC. */
function uart(node: number | null): Wire {
  const head = node === null ? [SYNC] : [SYNC, node];
  const closed = (bytes: number[]) => [...bytes, crc8(bytes)];
  const frame = (address: number, read: boolean, data: number) =>
    closed([...head, address + (read ? 0 : 0x80), ...(read ? [] : bytesOf(data))]);
  const place = head.length;
  return {
    sizes: [place + 2, place + 6],
    dataBits: 32,
    example: frameText(frame(0x21, true, 0)),
    frame,
    asked: (bytes) => {
      const register = bytes[place] ?? 0;
      return { address: register & 0x7f, read: register < 0x80, data: wordOf(bytes.slice(place + 1, -1)) };
    },
    wrong: (bytes) => {
      const crc = crc8(bytes.slice(0, -1));
      return crc === bytes.at(-1) ? null : `the last byte is the CRC: it would be ${hex(crc, 8)}`;
    },
  };
}

const BOARD = { address: 1, write: 146, read: 148 } as const;

/** A TMCL command of an evaluation board: address, opcode, register, channel, value, checksum. */
function board(channel: number): Wire {
  const sum = (bytes: readonly number[]) => bytes.reduce((all, byte) => all + byte, 0) % 256;
  const frame = (address: number, read: boolean, data: number) => {
    const command = [BOARD.address, read ? BOARD.read : BOARD.write, address, channel, ...bytesOf(read ? 0 : data)];
    return [...command, sum(command)];
  };
  return {
    sizes: [9, 9],
    dataBits: 32,
    example: frameText(frame(0x21, true, 0)),
    frame,
    asked: ([, opcode, register = 0, , ...rest]) =>
      opcode === BOARD.read || opcode === BOARD.write
        ? { address: register, read: opcode === BOARD.read, data: wordOf(rest.slice(0, 4)) }
        : null,
    wrong: (bytes) => {
      const wanted = sum(bytes.slice(0, -1));
      return wanted === bytes.at(-1) ? null : `the last byte is the checksum: it would be ${hex(wanted, 8)}`;
    },
  };
}

type SpiFormat = NonNullable<Device["about"]["spi"]>;

/** Datagrams as the table of the chip tells them: address and write bit in whole bytes, then the data. */
function told(spi: SpiFormat): Wire {
  const headBytes = Math.ceil((spi.address_bits + 1) / 8);
  const dataBytes = spi.data_bits / 8;
  const low = spi.write_bit === "low";
  const split = (word: number, bytes: number) =>
    Array.from({ length: bytes }, (_, at) => Math.floor(word / 2 ** (8 * (bytes - 1 - at))) % 256);
  const ordered = (bytes: number[]) => (spi.byte_order === "big" ? bytes : bytes.reverse());
  const frame = (address: number, read: boolean, data: number) => {
    const bit = read ? 1 - spi.write_is : spi.write_is;
    const head = low ? address * 2 + bit : address + bit * 2 ** (8 * headBytes - 1);
    return [...split(head, headBytes), ...ordered(split(data, dataBytes))];
  };
  return {
    sizes: [headBytes + dataBytes, headBytes + dataBytes],
    dataBits: spi.data_bits,
    example: frameText(frame(1, true, 0)),
    frame,
    asked: (bytes) => {
      const head = wordOf(bytes.slice(0, headBytes));
      const bit = low ? head % 2 : Math.floor(head / 2 ** (8 * headBytes - 1));
      const address = (low ? Math.floor(head / 2) : head) % 2 ** spi.address_bits;
      return { address, read: bit !== spi.write_is, data: wordOf(ordered(bytes.slice(headBytes))) };
    },
  };
}

type TaggedFormat = NonNullable<Device["about"]["tagged"]>;

/** 20 bits in three bytes, whose uppermost say which register they write. Nothing is read by one. */
function tagged({ written, tag_lsb: lsb }: TaggedFormat): Wire {
  const bytesOfWord = (word: number) => bytesOf(word).slice(1);
  const frame = (address: number, _: boolean, data: number) => bytesOfWord((address % written) * 2 ** lsb + data);
  return {
    sizes: [3, 3],
    dataBits: lsb + 1,
    example: frameText(frame(written + 4, false, 0)),
    frame,
    asked: (bytes) => {
      const word = wordOf(bytes) % 2 ** 20;
      const upper = Math.floor(word / 2 ** lsb);
      const above = upper > 1 ? upper : 0;
      return { address: written + above, read: false, data: word - above * 2 ** lsb };
    },
  };
}

/** What goes to that device when a raw frame is sent. */
export function wireOf({ about, link }: Pick<Device, "about" | "link">): Wire {
  const { kind, node, motor } = link as Record<string, unknown>;
  const frames = about.wires.find((wire) => wire.kind === kind)?.frames;
  if (frames === "board") return board(typeof motor === "number" ? motor : 0);
  if (frames === "uart") return uart(about.uart === "plain" ? null : typeof node === "number" ? node : 0);
  if (about.spi) return told(about.spi);
  if (about.tagged) return tagged(about.tagged);
  return about.datagram_bits === 32 ? SPI32 : SPI40;
}

export type Frame = { ok: true; bytes: number[] } | { ok: false; why: string };

/** "4 bytes", or "4 bytes, or 8 to write". */
export function sizeText({ sizes: [read, write] }: Wire): string {
  return read === write ? `${read} bytes` : `${read} bytes, or ${write} to write`;
}

/** Hex as people write it: `01 00 00 00`, `0x01000000`, `01:00:00:00`. */
export function parseFrame(text: string, wire: Wire): Frame {
  const digits = text.replace(/0x/gi, "").replace(/[\s:,]/g, "");
  if (/[^\da-f]/i.test(digits)) return { ok: false, why: "only hex digits, spaces, colons and commas" };
  if (!wire.sizes.some((size) => digits.length === 2 * size))
    return { ok: false, why: `a datagram has ${sizeText(wire)}; here are ${digits.length} hex digits` };
  const bytes = Array.from({ length: digits.length / 2 }, (_, at) =>
    Number.parseInt(digits.slice(2 * at, 2 * at + 2), 16),
  );
  const why = wire.wrong?.(bytes) ?? null;
  return why === null ? { ok: true, bytes } : { ok: false, why };
}

export function frameText(bytes: readonly number[]): string {
  return bytes.map((byte) => byte.toString(16).padStart(2, "0")).join(" ");
}

/** The register that a frame asks for: of two at one address the one that is read, or written. */
export function decodeRequest(bytes: readonly number[], wire: Wire, rows: readonly RegisterRow[]): Request | null {
  const asked = wire.asked(bytes);
  if (asked === null) return null;
  const there = rows.filter((row) => row.address === asked.address);
  const fits = ({ access }: RegisterRow) => (asked.read ? readable(access) : writable(access));
  return { ...asked, row: there.find(fits) ?? there[0] ?? null };
}

/** What the request already says. */
const ECHOED = new Set(["address", "register", "axis", "rw"]);

/** What the server decoded, as lines of name and text: words in hex, set flags by their names. */
export function decodedLines(decoded: Record<string, unknown>, dataBits: number): [name: string, text: string][] {
  return Object.entries(decoded).flatMap(([name, value]): [string, string][] => {
    if (value === null || value === undefined || ECHOED.has(name)) return [];
    if (typeof value !== "object") {
      const bits = name.startsWith("data") ? dataBits : name === "status" ? 8 : null;
      const shown = bits !== null && typeof value === "number" ? hex(value, bits) : String(value);
      return [[name.replaceAll("_", " "), shown]];
    }
    const inner = Object.entries(value);
    if (inner.length === 0) return [];
    if (inner.every(([, flag]) => typeof flag === "boolean")) {
      const set = inner.filter(([, flag]) => flag).map(([flag]) => flag);
      return [[name, set.join(" ") || "none set"]];
    }
    return [[name, inner.map(([key, item]) => `${key} ${String(item)}`).join(" · ")]];
  });
}
