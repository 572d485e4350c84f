import { createContext } from "react";
import type { LayoutDocument } from "./document";

export interface WorkspaceState {
  document: LayoutDocument;
  /** puts another document in its place; `said` tells it to those who do not see it */
  put: (document: LayoutDocument, said: string) => void;
}

export const WorkspaceContext = createContext<WorkspaceState>({
  document: {
    format: "stepscope.layout",
    version: 1,
    id: "",
    name: "",
    revision: 0,
    screens: { desktop: { tabs: [] }, phone: [] },
    panels: {},
  },
  put: () => {},
});
