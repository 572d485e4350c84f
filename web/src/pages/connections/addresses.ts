import { SEARCHED } from "./form";

export type Addresses = { ok: true; list: number[] } | { ok: false; why: string };

/** "1-4, 7" as addresses; nothing typed as none: the server then asks the first ones. */
export function parseAddresses(
  text: string,
  { lowest, highest }: { lowest: number; highest: number } = SEARCHED,
): Addresses {
  const found = new Set<number>();
  for (const part of text.split(/[\s,;]+/).filter(Boolean)) {
    const range = /^(\d+)(?:(?:-|–|\.\.)(\d+))?$/.exec(part);
    if (!range) return { ok: false, why: `"${part}" is no address. Write for example 1-4, 7` };
    const first = Number(range[1]);
    const last = Number(range[2] ?? range[1]);
    if (first < lowest || last > highest || first > last)
      return { ok: false, why: `Addresses are ${lowest} to ${highest}, the lower one first; not ${part}` };
    for (let address = first; address <= last; address += 1) found.add(address);
  }
  return { ok: true, list: [...found].sort((a, b) => a - b) };
}
