import { createContext } from "react";
import { BENCH } from "./benchLayout";
import type { LayoutDocument } from "./document";

export interface WorkspaceState {
  document: LayoutDocument;
  /** puts another document in its place; `said` tells it to those who do not see it */
  put: (document: LayoutDocument, said: string) => void;
}

export const WorkspaceContext = createContext<WorkspaceState>({ document: BENCH, put: () => {} });
