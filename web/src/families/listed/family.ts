import { later } from "../../lib/later";
import type { Family } from "../family";
import { topOf, zeroOf } from "./roles";

/** Chips and modules of which names are known: what a name means on every one that has it. */
export const listed: Family = {
  pages: [],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  top: topOf,
  zero: zeroOf,
  events: [],
};
