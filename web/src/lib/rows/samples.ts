import type { FieldRow, RegisterRow } from "./bits";

/** Rows for tests, complete but for what the test is about. */
export function field(name: string, lsb: number, width: number, more: Partial<FieldRow> = {}): FieldRow {
  const top = 2 ** width - 1;
  return {
    name,
    lsb,
    width,
    access: "RW",
    signed: false,
    minimum: 0,
    maximum: top,
    reset: 0,
    unit: "",
    help: `help of ${name}`,
    values: {},
    when: "",
    behaviour: "",
    ...more,
  };
}

export function register(name: string, width: number, more: Partial<RegisterRow> = {}): RegisterRow {
  const signed = more.signed ?? false;
  return {
    name,
    address: 0x0c,
    space: "register",
    alias: "",
    axis: 0,
    group: "motion",
    access: "RW",
    width,
    signed,
    minimum: signed ? -(2 ** (width - 1)) : 0,
    maximum: 2 ** (signed ? width - 1 : width) - 1,
    reset: 0,
    unit: "",
    help: `help of ${name}`,
    write_note: "",
    volatile: false,
    untold: [],
    stored: "",
    internal_range: null,
    driver: null,
    read_clears: false,
    source: "data sheet 8",
    values: {},
    when: "",
    behaviour: "",
    fields: [],
    ...more,
  };
}
