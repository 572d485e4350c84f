import type { ComponentType } from "react";
import type { Capability } from "../../api/queries";
import type { AxisScale } from "../../lib/units";
import type { Study, Wish } from "./study";
import type { Changes } from "./useStudies";

/** What the fields of a kind of study get: its part of the form, the axis, its scale, and what its chip can. */
export interface FieldsProps<F> {
  form: F;
  change: (part: Partial<F>) => void;
  scale: AxisScale;
  axis: { device: string; index: number };
  /** whether its chip can do that */
  can: (capability: Capability) => boolean;
}

/** A kind of study as it is asked for. */
export interface KindForm<F> {
  /** what a user can want, in their words */
  label: string;
  text: string;
  /** its name where a study of it has none */
  title: string;
  /** what the form begins with; `sees`: an encoder can tell of lost steps */
  first: (microstepsPerTurn: number | null, sees: boolean) => F;
  /** what the server wants of it: the study, and what it may cost where that is asked */
  wish: (form: F) => Pick<Wish, "study" | "budget">;
}

/** A kind of study on the page. */
export interface KindView<F> {
  Fields: ComponentType<FieldsProps<F>>;
  /** what came of it beside verdict, settings and findings */
  Results: ComponentType<{ study: Study; changes: Changes }> | null;
}
