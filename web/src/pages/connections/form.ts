import forms from "../../api/forms.json";
import { bound, compact, parseNumber } from "../../lib/format";
import type { Kind, Model } from "./models";

/** A field as the server's schema tells it (scripts/forms.py): nothing of it is written down in the page. */
export interface Field {
  /** where it stands in its object: "stage.left_at_fullsteps" */
  path: string;
  title: string;
  type: string;
  help?: string;
  unit?: string;
  required?: boolean;
  default?: unknown;
  minimum?: number;
  maximum?: number;
  /** more than, not at least, `minimum` */
  above_minimum?: boolean;
  pattern?: string;
  maxLength?: number;
  examples?: readonly (string | number)[];
  options?: readonly { value: string; label: string }[];
  heading?: string;
  proposed?: string;
  empty?: string;
  ports?: boolean;
  where?: Readonly<Record<string, readonly (string | number)[]>>;
  above?: string;
  at_least?: string;
  needed_with?: string;
}

export interface Group {
  title: string;
  help: string;
  /** its fields are there once an axis, in a list of that name */
  list?: string;
  fields: readonly Field[];
}

export interface Form {
  /** what the fields are about that are folded away */
  fold?: string;
  groups: readonly Group[];
}

/** What is typed, by the path of its field. Empty text stands for "not said": the server's default then holds. */
export type Values = Readonly<Record<string, string>>;
export type Json = Record<string, unknown>;

const FORMS = forms as {
  models: readonly { names: readonly string[]; links: Partial<Record<Kind, string>> }[];
  links: Record<string, Form>;
  axis: Form;
  name: Field;
};

/** The name of a device. */
export const NAME = FORMS.name;
/** Every field of an axis, of whatever model. */
export const AXIS_FIELDS = fieldsOf(FORMS.axis);

const serial = (path: string) => FORMS.links.ModuleSerialLink?.groups[0]?.fields.find((field) => field.path === path);
/** What a search on a serial line can ask for. */
export const SEARCHED = {
  bauds: serial("baud")?.examples?.map(Number) ?? [],
  lowest: serial("address")?.minimum ?? 0,
  highest: serial("address")?.maximum ?? 0,
};

/** The form of a link of that kind to that model, as far as the model has its fields. */
export function linkForm(model: Model, kind: Kind): Form {
  // listed models have no names here: theirs is the entry that has all of their wires
  const found =
    FORMS.models.find(({ names }) => names.includes(model.name)) ??
    FORMS.models.find(({ names, links }) => names.length === 0 && model.wires.every((wire) => wire.kind in links));
  return shownOf(FORMS.links[found?.links[kind] ?? ""] ?? { groups: [] }, model);
}

/** The form of each axis of that model. */
export function axisForm(model: Model): Form {
  return shownOf(FORMS.axis, model);
}

/** A form without what the model has not. */
export function shownOf(form: Form, model: Model): Form {
  const has = ({ where = {} }: Field) =>
    Object.entries(where).every(([key, values]) =>
      [(model as unknown as Json)[key]].flat().some((own) => values.includes(own as string)),
    );
  const groups = form.groups.map((group) => ({ ...group, fields: group.fields.filter(has) }));
  return { ...form, groups: groups.filter(({ fields, title }) => fields.length > 0 || title === "") };
}

/** All fields; those that are there once an axis under `stages.0.left_at_fullsteps`. */
export function fieldsOf(form: Form, axes = 0): Field[] {
  return form.groups.flatMap(({ list, fields }) =>
    list === undefined
      ? fields
      : Array.from({ length: axes }, (_, index) =>
          fields.map((field) => ({ ...field, path: `${list}.${index}.${field.path}` })),
        ).flat(),
  );
}

/** What a new form begins with. */
export function proposed(fields: readonly Field[]): Values {
  return Object.fromEntries(fields.flatMap(({ path, proposed }) => (proposed === undefined ? [] : [[path, proposed]])));
}

/** What a field may hold, in words; nothing where that is anything. */
export function wanted({ type, minimum, maximum, above_minimum, maxLength, help = "" }: Field): string {
  if (type === "string") return help || (maxLength === undefined ? "" : `at most ${maxLength} characters`);
  const [least, most] = [bound(minimum), bound(maximum)];
  let range = most && `at most ${most}`;
  if (least && above_minimum) range = [`above ${least}`, range].filter(Boolean).join(", ");
  else if (least) range = most ? `${least} to ${most}` : `at least ${least}`;
  return [type === "integer" ? "a whole number" : "", range].filter(Boolean).join(", ");
}

/** What a field is for and may hold. */
export function helpOf(field: Field): string {
  const allowed = field.type === "string" || field.options ? "" : wanted(field);
  return [field.help ?? "", allowed].filter(Boolean).join("; ");
}

/** What holds when nothing is typed. */
export function emptyOf({ empty, default: fallback, examples }: Field): string {
  if (empty !== undefined) return empty;
  if (typeof fallback === "number") return Number.isInteger(fallback) ? compact(fallback) : String(fallback);
  return String(fallback ?? examples?.[0] ?? "");
}

/** The value that is typed; undefined where there is none. */
export function typedValue({ type }: Field, text = ""): unknown {
  const typed = text.trim();
  if (typed === "") return undefined;
  if (type === "string") return typed;
  return type === "boolean" ? typed === "true" : (parseNumber(typed) ?? undefined);
}

/** Whether a form cannot be sent without it. */
export function needed({ required, proposed }: Field): boolean {
  return required === true || proposed !== undefined;
}

/** Why the text of a field cannot be, alone; or null. */
export function textProblem(field: Field, text = ""): string | null {
  const typed = text.trim();
  if (typed === "") return needed(field) ? `Needed: ${wanted(field) || field.title}` : null;
  if (field.options) return null;
  if (field.type === "string") {
    if (typed.length > (field.maxLength ?? Number.POSITIVE_INFINITY)) return `At most ${field.maxLength} characters`;
    return field.pattern && !new RegExp(field.pattern).test(typed) ? `Wanted: ${wanted(field)}` : null;
  }
  const value = parseNumber(typed);
  if (value === null) return `Not a number. Wanted: ${wanted(field)}`;
  const { minimum = -Infinity, maximum = Infinity } = field;
  const low = field.above_minimum ? value <= minimum : value < minimum;
  return low || value > maximum || (field.type === "integer" && !Number.isInteger(value))
    ? `Wanted: ${wanted(field)}`
    : null;
}

/** Every problem of a form, by the path of its field, each alone and against the others. */
export function problemsIn(fields: readonly Field[], values: Values): [path: string, problem: string][] {
  const numberAt = (field: Field) => parseNumber(values[field.path] ?? "") ?? (field.default as number | undefined);
  const problem = (field: Field): string | null => {
    const alone = textProblem(field, values[field.path]);
    if (alone !== null) return alone;
    const beside = (name: string | undefined) =>
      name === undefined ? undefined : fields.find(({ path }) => path === field.path.replace(/[^.]+$/, name));
    const giver = beside(field.needed_with);
    if (giver && values[giver.path]?.trim() && !values[field.path]?.trim())
      return `Needed with ${giver.title}: ${wanted(field)}`;
    const lower = beside(field.above ?? field.at_least);
    const [own, least] = [numberAt(field), lower && numberAt(lower)];
    if (lower === undefined || own === undefined || least === undefined) return null;
    if (field.above !== undefined) return own > least ? null : `Wanted: above ${lower.title}, ${bound(least)}`;
    return own >= least ? null : `Wanted: not below ${lower.title}, ${bound(least)}`;
  };
  return fields.flatMap((field) => {
    const found = problem(field);
    return found === null ? [] : [[field.path, found] as [string, string]];
  });
}

/** What an object says of those fields, as text. */
export function valuesIn(record: Json, fields: readonly Field[]): Values {
  const text = (value: unknown) => (value === null || value === undefined ? "" : String(value));
  return Object.fromEntries(fields.map(({ path }) => [path, text(valueAt(record, path.split(".")))]));
}

/** The object with what was typed; what the form does not show stays as it was. */
export function written(before: Json, form: Form, values: Values, axes = 0): Json {
  return form.groups.reduce<Json>((record, { list, fields }) => {
    if (list === undefined)
      return fields.reduce(
        (now, field) => withValueAt(now, field.path.split("."), typedValue(field, values[field.path])),
        record,
      );
    const rows = Array.from({ length: axes }, (_, index) => {
      const own = Object.fromEntries(fields.map(({ path }) => [path, values[`${list}.${index}.${path}`] ?? ""]));
      return written(
        valueAt(record, [list, String(index)]) as Json,
        { groups: [{ title: "", help: "", fields }] },
        own,
      );
    });
    return withValueAt(record, [list], rows.some((row) => Object.keys(row).length > 0) ? rows : undefined);
  }, before);
}

/** The object with every field said: the default, or null, where nothing was typed. */
export function complete(fields: readonly Field[], values: Values): Json {
  return fields.reduce<Json>(
    (record, field) =>
      withValueAt(record, field.path.split("."), typedValue(field, values[field.path]) ?? field.default ?? null),
    {},
  );
}

function valueAt(record: Json, path: readonly string[]): unknown {
  return path.reduce<unknown>(
    (inner, key) => (typeof inner === "object" && inner !== null ? (inner as Json)[key] : undefined),
    record,
  );
}

/** `record` with one value more, or without it; records that become empty go. */
export function withValueAt(record: Json = {}, [key = "", ...rest]: readonly string[], value: unknown): Json {
  // a rigid motor is a word, not a record: nothing said of its parts leaves it so
  if (rest.length > 0 && value === undefined && typeof record[key] !== "object") return record;
  const inner = record[key];
  const next =
    rest.length === 0 ? value : withValueAt(typeof inner === "object" && inner ? (inner as Json) : {}, rest, value);
  const empty = next === undefined || (rest.length > 0 && Object.keys(next as Json).length === 0);
  const { [key]: _, ...others } = record;
  return empty ? others : { ...record, [key]: next };
}
