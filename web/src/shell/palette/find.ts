import uFuzzy from "@leeoniya/ufuzzy";
import type { Entry } from "./entries";

export const SHOWN_MAX = 30;

/** Names of registers are written together: what is looked for may begin anywhere, and its words come in any order. */
const matcher = new uFuzzy({ intraMode: 1 });
const ANY_ORDER = 1;
/** Where a kind of thing comes among those that fit as well. */
const PLACES: Readonly<Record<string, number>> = { Action: 0, Page: 0, Axis: 0, Help: 2 };

/** A list to be searched: all texts once, so that a key costs a comparison and nothing else. */
export class Index {
  private readonly titles: string[];
  private readonly texts: string[];

  constructor(readonly entries: readonly Entry[]) {
    this.titles = entries.map(({ title }) => named(title));
    this.texts = entries.map(({ title, section, detail }) => `${named(title)} ${plain(`${section} ${detail}`)}`);
  }

  /** What fits best first: what is called so, then what is told so. Nothing for an empty query. */
  find(query: string): Entry[] {
    const needle = plain(query).trim();
    if (needle === "") return [];
    const order = new Set([...this.ranked(this.titles, needle), ...this.ranked(this.texts, needle)]);
    return [...order].slice(0, SHOWN_MAX).flatMap((at) => this.entries[at] ?? []);
  }

  private ranked(texts: string[], needle: string): number[] {
    const [found, info, order] = matcher.search(texts, needle, ANY_ORDER);
    if (found === null) return [];
    const best = info && order ? order.flatMap((at) => info.idx[at] ?? []) : found;
    return best.sort((one, other) => this.place(one) - this.place(other)); // which keeps the order of equals
  }

  private place(at: number): number {
    return PLACES[this.entries[at]?.section ?? ""] ?? 1;
  }
}

/** A name as it is written, and in one word: A_MAX is looked for as "a max" and as "amax". */
function named(title: string): string {
  const words = plain(title);
  const word = words.replaceAll(" ", "");
  return word === words ? words : `${words} ${word}`;
}

/** The underscores and brackets of register names are spaces to whoever looks for them. */
function plain(text: string): string {
  return text.toLowerCase().replace(/[_[\]()]+/g, " ");
}
