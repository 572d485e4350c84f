import type { LayoutDocument } from "./document";
import { Slot } from "./Slot";
import css from "./workspace.module.css";

/** The same panels on a phone: one below the other, each as high as it is. */
export function Stack({ document }: { document: LayoutDocument }) {
  return (
    <div className={css.stack}>
      {document.screens.phone.map((id) => (
        <Slot key={id} id={id} />
      ))}
    </div>
  );
}
