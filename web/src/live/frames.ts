/** One binary telemetry frame, as views into the message: nothing is copied. */
export interface Frame {
  sequence: number;
  rows: number;
  /** rows that the server dropped for this reader so far */
  dropped: number;
  /** the device's own time [s] */
  time: Float64Array;
  columns: Float64Array[];
}

const HEADER_BYTES = 24;
const MAGIC = 0x31_43_53_53; // "SSC1", little-endian
const LITTLE_ENDIAN = new Uint8Array(new Uint32Array([1]).buffer)[0] === 1;

/** A message that is no frame of ours. */
export class FrameError extends Error {}

/**
 * b"SSC1", u32 sequence, u32 rows, u32 columns, u64 rows dropped so far, then float64 time [rows] and float64 [rows]
 * a column, little-endian. The header is a multiple of 8 bytes, so that the numbers can be viewed in place.
 */
export function decodeFrame(message: ArrayBuffer): Frame {
  if (!LITTLE_ENDIAN) throw new FrameError("this machine is big-endian: its typed arrays cannot view the samples");
  if (message.byteLength < HEADER_BYTES)
    throw new FrameError(`a frame has 24 bytes or more, got ${message.byteLength}`);
  const header = new DataView(message, 0, HEADER_BYTES);
  if (header.getUint32(0, true) !== MAGIC) throw new FrameError("the message does not begin with SSC1");
  const rows = header.getUint32(8, true);
  const columnCount = header.getUint32(12, true);
  const expected = HEADER_BYTES + 8 * rows * (columnCount + 1);
  if (message.byteLength !== expected)
    throw new FrameError(`${rows} rows of ${columnCount} columns are ${expected} bytes, got ${message.byteLength}`);
  const view = (index: number) => new Float64Array(message, HEADER_BYTES + 8 * rows * index, rows);
  return {
    sequence: header.getUint32(4, true),
    rows,
    dropped: Number(header.getBigUint64(16, true)),
    time: view(0),
    columns: Array.from({ length: columnCount }, (_, index) => view(index + 1)),
  };
}
