import { withUnit } from "../../lib/format";
import { enumName, type FieldRow, type RegisterRow, toRaw, unpackField } from "../../lib/rows/bits";
import { derived, physicalText, scalesOf } from "../../lib/rows/physical";
import type { AxisScale } from "../../lib/units";
import type { Diff, Profile } from "./useProfiles";

/** A number that two profiles may say differently: a register, one field of it, an entry of a table, a fact. */
export interface Entry {
  key: string;
  /** what it is part of: the heading of its rows */
  part: string;
  name: string;
  axis: number | null;
  field: string | null;
  value: number | string;
  /** what the catalog says of the number; null of tables and facts */
  bits: FieldRow | RegisterRow | null;
  unit: string;
}

export interface Row extends Pick<Entry, "key" | "part" | "name" | "axis" | "field" | "unit"> {
  /** null where nobody knows, or that side says nothing of it */
  before: number | string | null;
  after: number | string | null;
  /** a value's name, or what it is in physical units */
  beforeMeaning: string;
  afterMeaning: string;
  differs: boolean;
  /** applying writes it */
  written: boolean;
  why: string;
}

type Rows = ReadonlyMap<string, RegisterRow>;
type Fact = readonly [name: string, value: number | string | null | undefined, unit: string];

/** The catalog's rows, to be found by name and axis. */
export function byName(rows: readonly RegisterRow[]): Rows {
  return new Map(rows.map((row) => [place(row.name, row.axis), row]));
}

function place(name: string, axis: number | null | undefined): string {
  return `${axis ?? "-"}/${name.toLowerCase()}`;
}

function rowOf(rows: Rows, name: string, axis: number | null | undefined): RegisterRow | undefined {
  // of a chip with one axis a profile need not say which
  return rows.get(place(name, axis)) ?? rows.get(place(name, axis == null ? 0 : null));
}

/** Everything that a profile says, number by number, in its order. */
export function entriesOf(profile: Profile, rows: Rows): Entry[] {
  return [
    ...facts(profile),
    ...profile.registers.flatMap((register) => registerEntries(register, rows)),
    ...profile.parameters.map((parameter) => {
      const row = rowOf(rows, parameter.name, 0);
      const axis = row?.axis ?? null;
      return { ...whole(parameter.name, axis, row), value: parameter.value, unit: parameter.unit };
    }),
    ...tableEntries(profile),
  ];
}

function whole(name: string, axis: number | null, row: RegisterRow | undefined): Omit<Entry, "value"> {
  return {
    key: place(name, axis),
    part: row?.group ?? "other",
    name: row?.name ?? name,
    axis,
    field: null,
    bits: row ?? null,
    unit: row?.unit ?? "",
  };
}

function registerEntries(register: Profile["registers"][number], rows: Rows): Entry[] {
  const row = rowOf(rows, register.name, register.axis);
  const head = whole(register.name, row?.axis ?? register.axis ?? null, row);
  const told = Object.entries(register.fields ?? {});
  if (row === undefined || row.fields.length === 0)
    return register.value == null ? [] : [{ ...head, value: register.value }];
  const raw = register.value == null ? null : toRaw(register.value, row.width);
  return row.fields
    .filter(({ when, access }) => !when && (access === "RW" || access === "W"))
    .flatMap((field) => {
      const given = told.find(([name]) => name.toLowerCase() === field.name.toLowerCase())?.[1];
      const value = numberOf(field, given) ?? (raw === null || told.length > 0 ? null : unpackField(raw, field));
      return value === null
        ? []
        : [{ ...head, key: `${head.key}.${field.name}`, field: field.name, bits: field, unit: field.unit, value }];
    });
}

/** People may write a value's name instead of its number. */
function numberOf(field: FieldRow, given: number | string | undefined): number | string | null {
  if (typeof given !== "string") return given ?? null;
  const found = Object.entries(field.values).find(([, name]) => name.toLowerCase() === given.toLowerCase());
  return found ? Number(found[0]) : given;
}

function facts(profile: Profile): Entry[] {
  const entry = (part: string, axis: number | null, [name, value, unit]: Fact): Entry[] =>
    value == null ? [] : [{ key: `${part}/${axis}/${name}`, part, name, axis, field: null, value, bits: null, unit }];
  return [
    ...entry("mechanics", null, ["clock", profile.clock_hz, "Hz"]),
    ...profile.axes.flatMap((axis, index) =>
      (
        [
          ["full steps a turn", axis.full_steps_per_rev, ""],
          ["driver microsteps", axis.driver_microsteps, ""],
          ["gear ratio", axis.gear_ratio, ""],
          ["travel a turn", axis.travel_mm_per_rev, "mm"],
          ["lowest position", axis.limits?.position_min, "microsteps"],
          ["highest position", axis.limits?.position_max, "microsteps"],
          ["highest velocity", axis.limits?.velocity_max_pps, "pps"],
          ["highest acceleration", axis.limits?.acceleration_max_pps2, "pps2"],
          ["highest current", axis.limits?.current_max_a, "A"],
        ] as const
      ).flatMap((fact, at) => entry(at < 4 ? "mechanics" : "soft limits", index, fact)),
    ),
  ];
}

function tableEntries({ tables }: Profile): Entry[] {
  const list = (part: string, name: string, axis: number | null, values: readonly (number | string)[]): Entry[] =>
    values.map((value, index) => ({
      key: `${part}/${axis}/${name}/${index}`,
      part,
      name: `${name}[${index}]`,
      axis,
      field: null,
      value,
      bits: null,
      unit: "",
    }));
  return [
    ...list("microstep table", "microstep", null, tables.microstep ?? []),
    ...list("driver chain", "chain", null, tables.driver_chain ?? []),
    ...(tables.mslut ?? []).flatMap((table) => [
      ...list("microstep table", "MSLUT", table.axis ?? null, table.words),
      ...list("microstep table", "MSLUTSEL", table.axis ?? null, [table.select]),
      ...list("microstep table", "MSLUTSTART", table.axis ?? null, [table.start]),
    ]),
    ...Object.entries(tables.user_variables ?? {}).map(([number, value]) => ({
      key: `user/${number}`,
      part: "user variables",
      name: `user variable ${number}`,
      axis: null,
      field: null,
      value,
      bits: null,
      unit: "",
    })),
  ];
}

/** What differs, number by number, and with `all` also what both sides agree in. */
export function rowsOf(diff: Diff, entries: readonly Entry[]): Row[] {
  const known = new Map(entries.map((entry) => [entry.key, entry]));
  const different = diff.differences.flatMap((difference): Row[] => {
    const { name, axis, table, left, right, unit } = difference;
    const head = place(name, axis);
    const whole = known.get(head) ?? [...known.values()].find(({ key }) => key.startsWith(`${head}.`));
    const row: Row = {
      key: head,
      part: table?.replaceAll("_", " ") ?? (whole?.part || difference.kind),
      name,
      axis,
      field: null,
      unit,
      before: left,
      after: right,
      beforeMeaning: physical(difference.left_physical),
      afterMeaning: physical(difference.right_physical),
      differs: true,
      written: difference.written,
      why: difference.why,
    };
    if (difference.fields.length === 0) return [row];
    return difference.fields.map((field) => ({
      ...row,
      key: `${head}.${field.name}`,
      field: field.name,
      unit: known.get(`${head}.${field.name}`)?.unit ?? "",
      before: field.left,
      after: field.right,
      beforeMeaning: field.left_meaning,
      afterMeaning: field.right_meaning,
    }));
  });
  return different;
}

/** The server's "1.67638e+06 pps^2" as numbers are written on the page. */
function physical(text: string | null): string {
  const [, number, unit] = /^(\S+)(?: (.*))?$/.exec(text ?? "") ?? [];
  return number === undefined || Number.isNaN(Number(number)) ? (text ?? "") : withUnit(Number(number), unit ?? "");
}

/** What both sides agree in: everything else that the profile says. `stepDir`: its driver makes the microsteps. */
export function sameRows(
  different: readonly Row[],
  entries: readonly Entry[],
  profile: Profile,
  stepDir: boolean,
): Row[] {
  const keys = new Set(different.map(({ key }) => key));
  const tables = new Set(different.map(({ part }) => part));
  const scales = new Map<number, AxisScale>();
  const scaleOf = (axis: number) => {
    const scale = scales.get(axis) ?? scaleIn(profile, stepDir, entries, axis);
    scales.set(axis, scale);
    return scale;
  };
  return entries
    .filter(({ key, part, bits }) => !keys.has(key) && (bits !== null || !tables.has(part)))
    .map((entry) => {
      const meaning = meaningOf(entry, scaleOf(entry.axis ?? 0));
      return {
        ...entry,
        before: entry.value,
        after: entry.value,
        beforeMeaning: meaning,
        afterMeaning: meaning,
        differs: false,
        written: false,
        why: "",
      };
    });
}

/** Rows under their headings, in the order in which these come first. */
export function grouped(rows: readonly Row[]): [string, Row[]][] {
  const groups = new Map<string, Row[]>();
  for (const row of rows) groups.set(row.part, [...(groups.get(row.part) ?? []), row]);
  return [...groups];
}

/** The axis of a profile as its own registers set it: dividers and microsteps are part of what is compared. */
export function scaleIn(profile: Profile, stepDir: boolean, entries: readonly Entry[], axis: number): AxisScale {
  const held = (names: readonly string[]) => {
    const found = entries.find(
      (entry) =>
        (entry.axis === axis || entry.axis === null) && names.includes((entry.field ?? entry.name).toLowerCase()),
    );
    return typeof found?.value === "number" ? found.value : null;
  };
  const mechanics = profile.axes[axis];
  const power = held(["usrs", "microstep_resolution"]);
  const divider = held(["mres", "mstep_per_fs"]);
  const own = power !== null ? 2 ** power : divider !== null ? 256 / 2 ** Math.min(divider, 8) : null;
  return {
    fullStepsPerRev: mechanics?.full_steps_per_rev ?? 200,
    microstepsPerFullStep: own ?? (stepDir ? (mechanics?.driver_microsteps ?? null) : 256),
    gearRatio: mechanics?.gear_ratio ?? 1,
    travelMmPerRev: mechanics?.travel_mm_per_rev ?? null,
    pulseDiv: held(["pulse_div"]),
    rampDiv: held(["ramp_div"]),
    clockHz: profile.clock_hz,
  };
}

/** What a number means: a value's name, or what it comes to in physical units; nothing where it is just a number. */
export function meaningOf({ value, bits, unit }: Entry, scale: AxisScale): string {
  if (typeof value !== "number" || bits === null) return "";
  const named = enumName(bits, value);
  if (named !== undefined) return named;
  return derived(bits, value, scale.clockHz) || physicalText(value, scalesOf(unit, scale));
}
