import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import type { PageEntry } from "../../families/family";
import { minutesAgo } from "../../lib/history/aim";
import type { Steps } from "../../lib/history/history";
import type { LayoutDocument } from "../../workspace/document";
import { misfit, type PanelType } from "../../workspace/panel";
import { isFor, pageAbout } from "../pages";

/** What can be found: where it leads, or what it does. */
export interface Entry {
  id: string;
  title: string;
  /** what it is: "Page", "Register" */
  section: string;
  /** beside the title, and searched behind it */
  detail: string;
  /** why it cannot be chosen now; null where it can */
  off: string | null;
  go: Target;
}

/** A place in the program, or in the help, which opens in a tab of its own; an axis to go to; or what is done at once. */
export type Target =
  | { to: string }
  | { help: string }
  | { device: string; axis: number }
  | { act: "stop" | "scheme" | "help" | "link" | "undo" | "redo" | "history" }
  | { minutesAgo: number; of: string }
  | { panel: string };

type Catalog = Schemas["CatalogModel"];

export function pageEntries(pages: readonly PageEntry[], device: Device | undefined): Entry[] {
  return pages.map((page) => ({
    id: `page ${page.path}`,
    title: page.label,
    section: "Page",
    detail: "",
    off: offFor(page, device),
    go: { to: page.path },
  }));
}

function offFor(page: PageEntry, device: Device | undefined): string | null {
  if (device === undefined) return page.alone ? null : "no device is chosen";
  return isFor(page, device.about.capabilities) ? null : `not for a ${device.title}`;
}

export function axisEntries(devices: readonly Device[]): Entry[] {
  return devices.flatMap((device) =>
    device.axes.map((axis) => ({
      id: `axis ${device.id}/${axis.index}`,
      title: device.axes.length > 1 ? `${device.name}, ${axis.name}` : device.name,
      section: "Axis",
      detail: `${device.title}, ${device.state}`,
      off: null,
      go: { device: device.id, axis: axis.index },
    })),
  );
}

/** Registers and their fields, or parameters: on the page that lists them. */
export function registerEntries(catalog: Catalog | undefined, device: Device | undefined): Entry[] {
  const page = device && pageAbout("settings", device.about.capabilities);
  if (catalog === undefined || page === undefined) return [];
  const kind = page.path === "/registers" ? "Register" : "Parameter";
  const found = new Map<string, Entry>();
  for (const row of catalog.rows) {
    const to = `${page.path}?find=${encodeURIComponent(row.name)}`;
    const id = `register ${row.name}`;
    if (!found.has(id)) found.set(id, { id, title: row.name, section: kind, detail: row.help, off: null, go: { to } });
    for (const field of row.fields) {
      const own = `field ${row.name} ${field.name}`;
      if (field.name === row.name || found.has(own)) continue;
      const detail = `${row.name}: ${field.help}`;
      const at = `${page.path}?find=${encodeURIComponent(`${row.name} ${field.name}`)}`;
      found.set(own, { id: own, title: field.name, section: "Field", detail, off: null, go: { to: at } });
    }
  }
  return [...found.values()];
}

export function recordingEntries(recordings: readonly Schemas["RecordingInfo"][]): Entry[] {
  return recordings.map((recording) => ({
    id: `recording ${recording.id}`,
    title: recording.name || recording.id,
    section: "Recording",
    detail: recording.device ?? "",
    off: null,
    go: { to: `/recordings/${recording.id}` },
  }));
}

export function profileEntries(profiles: readonly Schemas["ProfileInfo"][]): Entry[] {
  return profiles.map((profile) => ({
    id: `profile ${profile.id}`,
    title: profile.name,
    section: "Profile",
    detail: profile.model,
    off: null,
    go: { to: `/profiles?profile=${profile.id}` },
  }));
}

/** One entry of the help's index. */
export interface HelpItem {
  location: string;
  title: string;
  path: readonly string[];
}

export function helpEntries(items: readonly HelpItem[]): Entry[] {
  return items.map(({ location, title, path }) => ({
    id: `help ${location}`,
    title,
    section: "Help",
    detail: path.filter((part) => part !== title).join(" › "),
    off: null,
    go: { help: location },
  }));
}

const MINUTES = [10, 60];

/** What can be taken back, by what it is, and a device as it was. */
export function historyEntries({ past, future }: Steps, device: Device | undefined): Entry[] {
  const [back, forth] = [past.at(-1), future[0]];
  const act = (id: "undo" | "redo" | "history", title: string, detail: string, off: string | null): Entry => ({
    ...{ id: `act ${id}`, title, section: "Action", detail, off, go: { act: id } },
  });
  return [
    act("history", "Open the history", "designs, staged edits and what was written", null),
    act("undo", back ? `Undo: ${back.label}` : "Undo", "Ctrl Z", back ? null : "nothing was done on this page"),
    act("redo", forth ? `Redo: ${forth.label}` : "Redo", "Ctrl Shift Z", forth ? null : "nothing was undone"),
    ...MINUTES.map((minutes) => ({
      id: `act ago ${minutes}`,
      title: minutesAgo("", minutes).title,
      section: "Action",
      detail: device ? `a preview of what ${device.name} would be put back to` : "",
      off: device ? null : "no device is chosen",
      go: { minutesAgo: minutes, of: device?.id ?? "" },
    })),
  ];
}

/** Arrangements of the bench's panels. */
export function layoutEntries(layouts: readonly { id: string; name: string }[]): Entry[] {
  return layouts.map(({ id, name }) => ({
    id: `layout ${id}`,
    title: name,
    section: "Layout",
    detail: "panels of the bench",
    off: null,
    go: { to: `/?layout=${encodeURIComponent(id)}` },
  }));
}

/** Kinds of panels: each is put at the right of the bench, where it can show something and is not there already. */
export function panelEntries(
  kinds: readonly PanelType[],
  layout: LayoutDocument | undefined,
  device: Device | undefined,
  axis: number,
): Entry[] {
  const there = Object.values(layout?.panels ?? {}).map(({ type }) => type);
  return kinds.map((row) => ({
    id: `panel ${row.type}`,
    title: row.title,
    section: "Panel",
    detail: "added to the bench",
    off: row.single && there.includes(row.type) ? "it is there" : misfit(row, device, device?.axes[axis]),
    go: { panel: row.type },
  }));
}

/** Macros: each opens its form, and runs from there; nothing moves by being found. */
export function macroEntries(macros: readonly Schemas["MacroInfo"][]): Entry[] {
  return macros.map(({ id, name, model }) => ({
    id: `macro ${id}`,
    title: name,
    section: "Macro",
    detail: model ?? "",
    off: null,
    go: { to: `/?layout=macros&macro=${encodeURIComponent(id)}` },
  }));
}

export function actionEntries(scheme: "light" | "dark"): Entry[] {
  const other = scheme === "light" ? "dark" : "light";
  return [
    {
      id: "act stop",
      title: "Stop all axes",
      section: "Action",
      detail: "of all devices, at once",
      off: null,
      go: { act: "stop" },
    },
    {
      id: "act scheme",
      title: `Switch to ${other} colours`,
      section: "Action",
      detail: "",
      off: null,
      go: { act: "scheme" },
    },
    {
      id: "act link",
      title: "Copy the link to this view",
      section: "Action",
      detail: "",
      off: null,
      go: { act: "link" },
    },
    { id: "act help", title: "Open the help", section: "Action", detail: "", off: null, go: { act: "help" } },
  ];
}
