import { VisuallyHidden } from "@mantine/core";
import css from "./console.module.css";
import { FIELD_WORDS, type FieldBytes, type FieldKind } from "./frames";

/** A hue of ui.css a kind of field. */
const HUES: Record<FieldKind, string> = {
  address: "blue",
  host: "violet",
  command: "green",
  status: "pink",
  type: "olive",
  motor: "slate",
  value: "orange",
  text: "orange",
  checksum: "grey",
};

/** A frame's bytes, each field in its colour with its name below. */
export function Bytes({ label, fields }: { label: string; fields: readonly FieldBytes[] }) {
  return (
    <div className="lines-4 start text-12 mono">
      <VisuallyHidden>{label}</VisuallyHidden>
      <span className="dim" aria-hidden>
        {label === "request" ? "→" : "←"}
      </span>
      {fields.map((field, index) => (
        <span
          // biome-ignore lint/suspicious/noArrayIndexKey: the fields of one frame never change places
          key={index}
          className={`${css.fieldBytes} hue-${HUES[field.kind]}`}
          data-wrong={field.kind === "checksum" && field.meaning === "wrong"}
          title={`${FIELD_WORDS[field.kind]}: ${field.meaning}`}
        >
          <span className={css.hex}>{field.bytes.join(" ")}</span>
          <span className={`${css.fieldWord} hint centered`}>{FIELD_WORDS[field.kind]}</span>
        </span>
      ))}
    </div>
  );
}
