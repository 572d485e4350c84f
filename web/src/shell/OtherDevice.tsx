import type { ReactNode } from "react";
import type { PageEntry } from "../families/family";
import { later } from "../lib/later";
import { useSelection } from "../live/selection";
import { isFor } from "./pages";

const NotFor = later(() => import("./NotFor").then((part) => part.NotFor));

/** A page of some devices: for another one it says so, with the ways out. Without a device the page decides. */
export function OtherDevice({ entry, children }: { entry: PageEntry; children: ReactNode }) {
  const { device } = useSelection();
  return device === undefined || isFor(entry, device.about.capabilities) ? children : <NotFor entry={entry} />;
}
