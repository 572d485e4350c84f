/** Where commands stand in a text: `lines` has the line of each command, from 1, and 0 for one of an included file. */
export type Lines = readonly number[];

/** The address of the first command in that line or below it; null where none comes. */
export function addressAt(lines: Lines, line: number): number | null {
  let best: number | null = null;
  lines.forEach((at, address) => {
    if (at >= line && (best === null || at < (lines[best] ?? 0))) best = address;
  });
  return best;
}

/** The addresses at which a run halts, of lines with a breakpoint. */
export function addressesOf(lines: Lines, breakpoints: Iterable<number>): number[] {
  const found = new Set<number>();
  for (const line of breakpoints) {
    const address = addressAt(lines, line);
    if (address !== null) found.add(address);
  }
  return [...found].sort((one, other) => one - other);
}

/** The name of an address: the label before it, and how far behind that it is. */
export function placeName(labels: Readonly<Record<string, number>>, address: number): string {
  let name = "";
  let at = -1;
  for (const [label, its] of Object.entries(labels))
    if (its <= address && its > at) {
      name = label;
      at = its;
    }
  if (name === "") return String(address);
  return address === at ? `${address} ${name}` : `${address} ${name}+${address - at}`;
}

/** Bytes as base64, and back. */
export function toBase64(bytes: Uint8Array): string {
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text);
}

export function fromBase64(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}
