import { Shared } from "../lib/shared";
import type { LayoutDocument } from "./document";

export interface Layout {
  id: string;
  document: LayoutDocument;
  /** on the server; undefined where it was never saved */
  saved: LayoutDocument | undefined;
  /** it differs from what is saved, or from what it was at first */
  touched: boolean;
  /** nobody knows yet what this layout is, or whether there is one */
  waiting: boolean;
  /** there is none: the bench is shown */
  missing: boolean;
  put: (document: LayoutDocument, said: string) => void;
}

export function labelOf({ document, touched }: Layout): string {
  return `Layout: ${document.name}${touched ? ", not saved" : ""}`;
}

/** What was just done to the layout, for those who do not see it. */
export const SAID = new Shared("");
/** The layout is being arranged. */
export const ARRANGING = new Shared(false);
/** As it was found; undefined before that. */
export const FOUND = new Shared<Layout | undefined>(undefined);

/** Where this browser keeps what was changed of layouts and not yet saved, and what the server last had. */
export const COPIES_KEY = "stepscope.layouts";
export const SAVED_KEY = "stepscope.layouts.saved";
