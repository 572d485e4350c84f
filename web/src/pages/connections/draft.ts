import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { parseNumber } from "../../lib/format";
import {
  AXIS_FIELDS,
  axisForm,
  complete,
  type Field,
  fieldsOf,
  type Json,
  linkForm,
  NAME,
  problemsIn,
  proposed,
  textProblem,
  type Values,
  valuesIn,
  withValueAt,
  written,
} from "./form";
import { canModel, isModule, type Kind, kindsOf, type Model } from "./models";

export type Link = Schemas["DeviceCreate"]["link"];
export type AxisConfig = Schemas["AxisConfig"];

/** What is typed into the form. */
export interface Draft {
  name: string;
  model: Model;
  kind: Kind;
  clockMhz: string;
  /** by kind of link, so that what was typed of one is there again when one comes back to it */
  links: Partial<Record<Kind, Values>>;
  axes: readonly Values[];
  /** the link as it was, so that what the form does not show stays as it is */
  before: Json;
}

const AXIS_NAMES = ["X", "Y", "Z"];

export function newDraft(model: Model, kind: Kind = "emulator", link: Values = {}): Draft {
  return withModel({ name: "", model, kind, clockMhz: "", links: { [kind]: link }, axes: [], before: {} }, model);
}

/** The draft for another model: axes that are there stay, missing ones come, surplus ones go. */
export function withModel(draft: Draft, model: Model): Draft {
  const fresh = (index: number) => ({ ...proposed(AXIS_FIELDS), name: AXIS_NAMES[index] ?? `axis ${index}` });
  return {
    ...draft,
    model,
    kind: kindsOf(model).some((kind) => kind.value === draft.kind) ? draft.kind : "emulator",
    axes: Array.from({ length: model.axes }, (_, index) => draft.axes[index] ?? fresh(index)),
  };
}

/** A device as a draft, for editing. */
export function draftOf(device: Device): Draft {
  const { about: model, name, link: before } = device;
  const kind = kindsOf(model).find(({ value }) => value === before.kind)?.value ?? "emulator";
  const links = { [kind]: valuesIn(before, fieldsOf(linkForm(model, kind), model.axes)) };
  const axes = device.axes.map((axis) => valuesIn(axis as unknown as Json, AXIS_FIELDS));
  return withModel({ name, model, kind, clockMhz: String(device.clock_hz / 1e6), links, axes, before }, model);
}

/** What is typed of the link that is chosen. */
export function linkValues({ model, kind, links }: Draft): Values {
  return { ...proposed(fieldsOf(linkForm(model, kind), model.axes)), ...links[kind] };
}

/** The chip's clock as the catalog has its range. A module's crystal is its own affair. */
export function clockField(model: Model): Field | null {
  if (isModule(model)) return null;
  const [minimum, maximum] = [model.clock_hz_min / 1e6, model.clock_hz_max / 1e6];
  return {
    path: "clock_mhz",
    title: "Clock of the chip",
    type: "number",
    unit: "MHz",
    help: "what speeds and times of its registers hang on",
    minimum,
    above_minimum: minimum === 0,
    maximum,
    default: model.clock_hz_default / 1e6,
  };
}

/** The chip's clock [Hz], where it is said. */
function clockOf({ clockMhz, model }: Draft): number | undefined {
  const mhz = parseNumber(clockMhz);
  return mhz === null || isModule(model) ? undefined : Math.round(mhz * 1e6);
}

/** Every problem of the form, by the path of its field: `name`, `link.port`, `axes.0.gear_ratio`. */
export function problemsOf(draft: Draft, others: readonly string[] = []): Record<string, string> {
  const { model } = draft;
  const name = draft.name.trim();
  const taken = others.some((other) => other.toLowerCase() === name.toLowerCase());
  const clock = clockField(model);
  const under = (prefix: string, fields: readonly Field[], values: Values) =>
    problemsIn(fields, values).map(([path, problem]) => [`${prefix}.${path}`, problem]);
  return Object.fromEntries(
    [
      ["name", textProblem(NAME, name) ?? (taken ? "Another device has that name" : null)],
      ["clock_mhz", clock && textProblem(clock, draft.clockMhz)],
      ...under("link", fieldsOf(linkForm(model, draft.kind), model.axes), linkValues(draft)),
      ...draft.axes.flatMap((axis, index) => under(`axes.${index}`, fieldsOf(axisForm(model)), axis)),
    ].filter(([, problem]) => problem !== null),
  );
}

/** What goes to the server: what was said, so that its defaults hold, and what the form does not show as it was. */
export function linkOf(draft: Draft): Link {
  const { model, kind, before } = draft;
  const kept = before.kind === kind ? before : { kind };
  const link = written(kept, linkForm(model, kind), linkValues(draft), model.axes);
  return (kind === "emulator" && !isModule(model) ? reckoned(link, draft) : link) as unknown as Link;
}

/** An emulated chip runs at the clock, and its driver with the microsteps, that the device is reckoned with. */
function reckoned(link: Json, draft: Draft): Json {
  const clocked = withValueAt(link, ["clock_hz"], clockOf(draft));
  if (!canModel(draft.model, "step_dir")) return clocked;
  return withValueAt(clocked, ["driver_microsteps"], parseNumber(draft.axes[0]?.driver_microsteps ?? "") ?? undefined);
}

export function axisConfigs(draft: Draft): AxisConfig[] {
  return draft.axes.map((axis) => complete(AXIS_FIELDS, axis) as unknown as AxisConfig);
}

export interface DeviceBody {
  name: string;
  model: Model["name"];
  link: Link;
  clock_hz: number | null;
  axes: AxisConfig[];
  start_up: boolean;
}

export function createBody(draft: Draft): DeviceBody {
  return {
    name: draft.name.trim(),
    model: draft.model.name,
    link: linkOf(draft),
    clock_hz: clockOf(draft) ?? null,
    axes: axisConfigs(draft),
    // one that a click adds can move at once
    start_up: draft.kind === "emulator",
  };
}

/** Only what differs: a link that is sent again would be interrupted. */
export function changeBody(before: Draft, after: Draft): Partial<Omit<DeviceBody, "model">> {
  const [old, now] = [createBody(before), createBody(after)];
  const differs = (key: keyof DeviceBody) => JSON.stringify(old[key]) !== JSON.stringify(now[key]);
  return {
    ...(differs("name") ? { name: now.name } : {}),
    ...(differs("link") ? { link: now.link } : {}),
    ...(differs("clock_hz") && now.clock_hz !== null ? { clock_hz: now.clock_hz } : {}),
    ...(differs("axes") ? { axes: now.axes } : {}),
  };
}
