import type { ChipRows } from "./useChipRows";

/** What a page shows and sets by names of its own, wherever it is kept: parameters of a module, registers of a chip. */
export interface Settings {
  /** what the device holds; null while unknown */
  held: (name: string) => number | null;
  /** the same, with what is staged in its place */
  planned: (name: string) => number | null;
  staged: { has: (name: string) => boolean };
  stage: (name: string, value: number) => void;
}

/** Where a chip keeps something: a register, or a field of one. */
export interface Place {
  register: string;
  field?: string;
}

/** The part of a chip's rows that settings need. */
export type Rows = Pick<ChipRows, "spot" | "held" | "planned" | "isStaged" | "put">;
/** Of several places the first counts that the chip has. */
export type Places<P extends Place> = Readonly<Record<string, readonly P[]>>;

/** Where the chip keeps `name`; null where it has no such thing. */
export function placeIn<P extends Place>(chip: Pick<Rows, "spot">, places: Places<P>, name: string): P | null {
  return places[name]?.find(({ register, field }) => chip.spot(register, field) !== null) ?? null;
}

/** The registers of a chip as settings; `read` and `write` turn their numbers into those of the page and back. */
export function settingsIn<P extends Place>(
  chip: Rows,
  places: Places<P>,
  read: (raw: number, place: P) => number,
  write: (value: number, place: P) => number,
): Settings {
  const value = (name: string, from: Rows["held"]): number | null => {
    const place = placeIn(chip, places, name);
    const raw = place === null ? null : from(place.register, place.field);
    return place === null || raw === null ? null : read(raw, place);
  };
  return {
    held: (name) => value(name, chip.held),
    planned: (name) => value(name, chip.planned),
    staged: {
      has: (name) => {
        const place = placeIn(chip, places, name);
        return place !== null && chip.isStaged(place.register, place.field);
      },
    },
    stage: (name, wanted) => {
      const place = placeIn(chip, places, name);
      if (place !== null) chip.put(place.register, place.field, write(wanted, place));
    },
  };
}
